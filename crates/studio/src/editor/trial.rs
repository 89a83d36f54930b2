//! The edited layout in the running session before it is saved.

use std::time::Duration;

use super::LayoutEditor;
use ademan_core::document::Document;
use ademan_core::layout::Layout;
use ademan_runtime::session::{LayoutTrial, TrialOutcome};

/// Shortest time between two texts that are tried: each releases everything.
const PERIOD: Duration = Duration::from_millis(300);

/// The trial of the layout of an editor. The session has the last valid text while it is on.
pub struct EditorTrial {
    /// Name of the layout in the session.
    file: String,
    is_on: bool,
    /// The text that the session has, or has refused.
    tried: String,
    outcome: Option<TrialOutcome>,
    /// Time of the next text.
    due: Duration,
}

impl EditorTrial {
    /// Creates the trial in place of the layout that the session has, which may differ from the editor's.
    pub fn new(used: &Layout, is_on: bool) -> Self {
        Self {
            file: used.file.clone(),
            is_on,
            tried: used.text.clone(),
            outcome: None,
            due: Duration::ZERO,
        }
    }

    /// Returns `true` if the session follows the edits.
    pub fn is_on(&self) -> bool {
        self.is_on
    }

    /// Lets the session follow the edits, or returns it to the saved text.
    pub fn set_on(&mut self, is_on: bool) {
        self.is_on = is_on;
    }

    /// Sends the text that the session should have, if it has another one. `now` is the time since the start of the window.
    /// Returns the reason why the session has refused one.
    pub fn advance(
        &mut self,
        now: Duration,
        editor: &LayoutEditor,
        session: &LayoutTrial,
    ) -> Option<String> {
        let outcome = self.outcome.as_ref().map(TrialOutcome::poll);
        let refusal = match outcome {
            Some(None) => return None,
            Some(Some(outcome)) => outcome.err(),
            None => None,
        };
        self.outcome = None;
        let text = if !self.is_on {
            editor.saved_text()
        } else if editor.is_valid() {
            editor.text()
        } else {
            return refusal;
        };
        // A file with faults is opened while the session has another layout.
        if !self.is_on && Layout::parse(text, editor.name()).is_err() {
            return refusal;
        }
        if text != self.tried && now >= self.due {
            let edited = Document::new(editor.name(), text);
            self.outcome = session.start(&self.file, edited);
            if self.outcome.is_some() {
                text.clone_into(&mut self.tried);
                self.due = now + PERIOD;
            }
        }
        refusal
    }
}
