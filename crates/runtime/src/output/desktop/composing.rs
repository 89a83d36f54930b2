//! The output `desktop` as the input method of a compositor: one thread sends keys and text, so they arrive in their order.

use std::sync::{Arc, OnceLock};

use super::press_ticket::MAX_PRESS_AGE;
use super::worker::WorkerRequest;
use super::{Desktop, connect, needs_pointer, wayland};
use crate::output::OutputError;
use crate::output::text_field::{FocusedField, Text};
use crate::output::watchdog::WatchdogSettings;
use ademan_core::device::Capabilities;

/// Text for the focused field. It replaces the word that the field shows.
#[derive(Clone, Copy)]
pub struct Composing {
    /// The text.
    pub text: Text,
    /// `true` if the field takes the text. Otherwise it shows the text as the word that is typed.
    pub is_committed: bool,
    /// The generation of the field for which the text was typed: another one does not get it.
    pub field: u32,
}

impl Composing {
    /// Returns the number of characters that are lost if it is not sent. A word that is shown is committed later.
    pub fn characters(&self) -> usize {
        if self.is_committed {
            self.text.chars().count()
        } else {
            0
        }
    }
}

/// The reason why this program is not the input method of the desktop.
#[derive(Clone, Debug)]
pub enum Refusal {
    /// The session has no compositor, or one without the protocol.
    NotOffered,
    /// Another program is the input method.
    Taken,
    /// The output cannot be opened.
    Failed(OutputError),
}

impl Desktop {
    /// Connects to the compositor of the session as its keyboard, pointer and input method. The latter reports the field that has the
    /// focus.
    pub(in crate::output) fn open_composing(
        watchdog: Option<&WatchdogSettings>,
        required: &Capabilities,
        field: &Arc<FocusedField>,
    ) -> Result<Self, Refusal> {
        let name = wayland::compositor(None).ok_or(Refusal::NotOffered)?;
        let needs_pointer = required.iter().any(needs_pointer);
        let refused = Arc::new(OnceLock::new());
        let refusal = Arc::clone(&refused);
        let mut field = Some(Arc::clone(field));
        let connect = move || match field.take() {
            Some(field) => wayland::connect_composing(&name, needs_pointer, field, &refusal),
            // After a failure, to release keys.
            None => connect(None, needs_pointer),
        };
        Self::start(watchdog, MAX_PRESS_AGE, connect).map_err(|error| {
            let refused = refused.get().cloned();
            refused.unwrap_or(Refusal::Failed(error))
        })
    }

    /// Sends text after the keys so far.
    pub(in crate::output) fn compose(&mut self, composing: Composing) -> Result<(), OutputError> {
        let characters = composing.characters();
        if !self.accept_presses(characters, characters)? {
            return Ok(());
        }
        let ticket = self.status.tickets.issue(self.generation);
        self.request(WorkerRequest::Compose(composing, ticket))
    }
}
