//! Layouts that are tried in a running session before they are saved.

use crossbeam_channel::{Receiver, Sender, TryRecvError, bounded};

use ademan_core::document::Document;

/// Trials that wait for a busy layout manager: the latest of one editor.
pub(super) const QUEUE_LENGTH: usize = 1;

/// A text for the layout manager.
#[derive(Debug)]
pub(super) struct TrialRequest {
    /// Name of the layout that it replaces, as in [`Layout::file`](ademan_core::layout::Layout::file).
    pub file: String,
    /// The text of the layout, with the name of the file that is edited.
    pub edited: Document,
    /// Channel for the outcome.
    pub reply: Sender<Result<(), String>>,
}

/// The sending end for layouts that are tried.
#[derive(Clone, Debug)]
pub struct LayoutTrial {
    requests: Sender<TrialRequest>,
}

/// The outcome of a trial, once there is one.
#[derive(Debug)]
pub struct TrialOutcome(Receiver<Result<(), String>>);

impl LayoutTrial {
    pub(super) fn new(requests: Sender<TrialRequest>) -> Self {
        Self { requests }
    }

    /// Activates a document in place of a layout of the session, named as in [`Layout::file`](ademan_core::layout::Layout::file), after
    /// everything is released. An invalid text changes nothing. Does not wait; returns `None` while the session is busy with another
    /// trial, or has ended.
    ///
    /// The file of the layout is neither read nor written. Its next save with another content replaces the tried text. Errors and the
    /// messages of simulated hands name the file of the document.
    pub fn start(&self, file: &str, edited: Document) -> Option<TrialOutcome> {
        let (reply, outcome) = bounded(1);
        let request = TrialRequest {
            file: file.to_owned(),
            edited,
            reply,
        };
        self.requests.try_send(request).ok()?;
        Some(TrialOutcome(outcome))
    }
}

impl TrialOutcome {
    /// Returns the outcome, or `None` while the layout is built. An `Err` is the reason why the active layout stays.
    pub fn poll(&self) -> Option<Result<(), String>> {
        match self.0.try_recv() {
            Ok(outcome) => Some(outcome),
            Err(TryRecvError::Empty) => None,
            Err(TryRecvError::Disconnected) => Some(Err("the session has ended".into())),
        }
    }
}
