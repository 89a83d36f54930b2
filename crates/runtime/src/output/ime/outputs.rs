//! The outputs of keys and of text.

use std::sync::Arc;

use super::client::{Action, Candidates, Client};
use crate::output::text_field::{FocusedField, Text};
use crate::output::{Backend, OpenRequest, OutputError, Sink};
use ademan_core::device::{EventKind, Events, KeyKind};

#[cfg(feature = "wayland")]
use crate::output::desktop::{
    self, Desktop,
    composing::{Composing, Refusal},
};

/// The outputs of keys and of text.
pub(super) enum Outputs {
    /// An IBus engine for text beside an output of keys.
    Bus { keys: Box<dyn Sink>, client: Client },
    /// The input method of a compositor: one queue and one thread for both.
    #[cfg(feature = "wayland")]
    Compositor(Box<Desktop>),
}

impl Outputs {
    /// Opens the output `keys`, and text beside it: through the compositor of the session if it has input methods and keys go to it, or
    /// else through IBus. `name` is the name of the output for messages.
    pub(super) fn open(
        name: &str,
        keys: &Backend,
        request: &OpenRequest,
        field: &Arc<FocusedField>,
    ) -> Result<Self, OutputError> {
        let open_bus = || {
            // First, as it may fail: the desktop would be left without the engine that it had before.
            let keys = (keys.open)(request)?;
            let client = Client::start(Arc::clone(field));
            let client = client.map_err(|reason| OutputError::open(name, reason))?;
            Ok(Self::Bus { keys, client })
        };
        #[cfg(feature = "wayland")]
        if *keys == desktop::BACKEND {
            return match Desktop::open_composing(request.watchdog, request.required, field) {
                Ok(desktop) => Ok(Self::Compositor(Box::new(desktop))),
                Err(Refusal::NotOffered) => open_bus(),
                // It may be IBus.
                Err(Refusal::Taken) => open_bus()
                    .map_err(|_| OutputError::open(name, crate::advice::input_method_taken())),
                Err(Refusal::Failed(error)) => Err(error),
            };
        }
        open_bus()
    }

    /// Returns the output of keys.
    pub(super) fn keys(&self) -> &dyn Sink {
        match self {
            Self::Bus { keys, .. } => &**keys,
            #[cfg(feature = "wayland")]
            Self::Compositor(desktop) => &**desktop,
        }
    }

    /// Returns the output of keys.
    pub(super) fn keys_mut(&mut self) -> &mut dyn Sink {
        match self {
            Self::Bus { keys, .. } => &mut **keys,
            #[cfg(feature = "wayland")]
            Self::Compositor(desktop) => &mut **desktop,
        }
    }

    /// Writes a text to the field of this generation, which takes it or shows it. `keys` are the events before it; they are removed if
    /// they had to be sent. A text that is dropped is [counted](Self::dropped_presses).
    #[cfg_attr(
        not(feature = "wayland"),
        allow(unused_variables, reason = "only a compositor has one queue for both")
    )]
    pub(super) fn write(
        &mut self,
        text: Text,
        is_committed: bool,
        field: u32,
        keys: &mut Events,
    ) -> Result<(), OutputError> {
        match self {
            Self::Bus { client, .. } => {
                let action = if is_committed {
                    Action::Commit(text)
                } else {
                    Action::Show(text)
                };
                client.request(action, field);
                Ok(())
            }
            #[cfg(feature = "wayland")]
            Self::Compositor(desktop) => {
                let sent = desktop.send(keys);
                keys.clear();
                let composed = desktop.compose(Composing {
                    text,
                    is_committed,
                    field,
                });
                sent.and(composed)
            }
        }
    }

    /// Counts an event for the output of keys.
    pub(super) fn count(&mut self, event: EventKind) {
        match self {
            Self::Bus { client, .. } if is_key_press(event) => client.count_press(),
            _ => {}
        }
    }

    /// Returns `true` if the field loses a shown word with the focus.
    pub(super) fn loses_word(&self) -> bool {
        !matches!(self, Self::Bus { .. })
    }

    /// Returns the number of presses and characters that were dropped.
    pub(super) fn dropped_presses(&self) -> u64 {
        match self {
            Self::Bus { keys, client } => keys.dropped_presses() + client.dropped_characters(),
            #[cfg(feature = "wayland")]
            Self::Compositor(desktop) => desktop.dropped_presses(),
        }
    }

    /// Makes presses and text void that have not been sent. `has_requests` is `true` if there were any since the last call.
    pub(super) fn void(&mut self, has_requests: bool) {
        match self {
            Self::Bus { keys, client } => {
                keys.void_presses();
                if has_requests {
                    client.stop();
                }
            }
            // The word of the last call may still wait for the compositor.
            #[cfg(feature = "wayland")]
            Self::Compositor(desktop) if !has_requests && !desktop.has_stalled() => {}
            #[cfg(feature = "wayland")]
            Self::Compositor(desktop) => desktop.void_presses(),
        }
    }

    /// Lists candidates for the field of this generation.
    pub(super) fn list(&self, candidates: &Candidates, field: u32) {
        match self {
            Self::Bus { client, .. } => {
                client.request(Action::List(candidates.clone()), field);
            }
            // It would have to draw the list itself.
            #[cfg(feature = "wayland")]
            Self::Compositor(_) => {}
        }
    }

    /// Returns the candidate that was chosen since the last call.
    pub(super) fn take_choice(&self) -> Option<u8> {
        match self {
            Self::Bus { client, .. } => client.take_choice(),
            #[cfg(feature = "wayland")]
            Self::Compositor(_) => None,
        }
    }

    /// Releases all keys, and lets the input method take what was written.
    pub(super) fn close(&mut self) -> Result<(), OutputError> {
        let closed = self.keys_mut().close();
        match self {
            Self::Bus { client, .. } => client.close(),
            #[cfg(feature = "wayland")]
            Self::Compositor(_) => {}
        }
        closed
    }
}

/// Returns `true` if an input method sees this event.
fn is_key_press(event: EventKind) -> bool {
    match event {
        EventKind::KeyDown(key) => key.kind() == KeyKind::Keyboard,
        EventKind::Character(_) => true,
        _ => false,
    }
}
