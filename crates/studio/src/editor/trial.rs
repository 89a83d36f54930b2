//! The edited layout in the running session before it is saved.

use std::time::Duration;

use super::LayoutEditor;
use ademan_core::document::{Document, FileKind};
use ademan_core::layout::Layout;
use ademan_runtime::files::OpenDocument;
use ademan_runtime::session::{LayoutTrial, TrialOutcome};

/// Shortest time between two texts that are tried: each releases everything.
const PERIOD: Duration = Duration::from_millis(300);

/// The trial of the layout of an editor. The session has the last valid text while it is on.
pub struct EditorTrial {
    /// Name of the layout in the session.
    file: String,
    /// The text that the session returns to, if its layout is another one than the editor's.
    other: Option<String>,
    /// The text of the file of that layout, when it was read last.
    written: Option<String>,
    is_on: bool,
    /// The text that the session has, or has refused.
    tried: String,
    outcome: Option<TrialOutcome>,
    /// Time of the next text.
    due: Duration,
}

impl EditorTrial {
    /// Creates the trial in place of the layout that the session has, which may be another one than the editor's.
    pub fn new(used: &Layout, editor: &LayoutEditor, is_on: bool) -> Self {
        let is_own = used.file == editor.name() || used.text == editor.saved_text();
        Self {
            file: used.file.clone(),
            other: (!is_own).then(|| used.text.clone()),
            written: read(&used.file),
            is_on,
            tried: used.text.clone(),
            outcome: None,
            due: Duration::ZERO,
        }
    }

    /// Keeps the text that the session returns to before another layout is edited in place of this one.
    pub fn leave(&mut self, editor: &LayoutEditor) {
        if self.other.is_none() {
            self.other = Some(editor.saved_text().to_owned());
        }
    }

    /// Goes on with another editor after [`leave`](Self::leave). It stays on only if it may be on.
    #[must_use]
    pub fn go_on(mut self, editor: &LayoutEditor, may_be_on: bool) -> Self {
        let is_own =
            self.file == editor.name() || self.other.as_deref() == Some(editor.saved_text());
        self.other = self.other.filter(|_| !is_own);
        self.is_on &= may_be_on;
        self
    }

    /// Returns `true` if the session follows the edits.
    pub fn is_on(&self) -> bool {
        self.is_on
    }

    /// Lets the session follow the edits, or returns it to the saved text or to the other layout that it had, with what was written to its
    /// file since.
    pub fn set_on(&mut self, is_on: bool) {
        if !is_on {
            self.update_other();
        }
        self.is_on = is_on;
    }

    /// Replaces the text of the other layout if its file has changed, which the session follows. One that cannot be used changes nothing.
    fn update_other(&mut self) {
        let written = read(&self.file);
        let (Some(other), Some(text)) = (&mut self.other, &written) else {
            return;
        };
        if written != self.written && Layout::parse(text, &self.file).is_ok() {
            other.clone_from(text);
            self.written = written;
        }
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
        let wanted = self.wanted(editor);
        let Some((name, text)) = wanted.filter(|(_, text)| *text != self.tried && now >= self.due)
        else {
            return refusal;
        };
        let edited = Document::new(name, text);
        // A file may have faults when it is opened.
        if !self.is_on && Layout::parse(&edited.text, &edited.file).is_err() {
            self.due = now + PERIOD;
            return refusal;
        }
        let sent = edited.text.clone();
        self.outcome = session.start(&self.file, edited);
        if self.outcome.is_some() {
            self.tried = sent;
            self.due = now + PERIOD;
        }
        refusal
    }

    /// Returns the name and the text that the session should have; `None` while the edited one is not valid.
    fn wanted<'a>(&'a self, editor: &'a LayoutEditor) -> Option<(&'a str, &'a str)> {
        match &self.other {
            _ if self.is_on => editor.is_valid().then(|| (editor.name(), editor.text())),
            Some(other) => Some((self.file.as_str(), other.as_str())),
            None => Some((editor.name(), editor.saved_text())),
        }
    }
}

/// Returns the text of a layout by the name that a session gives it; `None` if it cannot be read.
fn read(name: &str) -> Option<String> {
    let document = Document::open_kind(FileKind::Layout, name).ok()?;
    Some(document.text)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::editor::{Edit, NewPart};
    use ademan_core::layout::Fit;
    use ademan_runtime::files::Load;

    #[test]
    fn a_session_with_another_layout_gets_the_edited_one_only_on_request() {
        let used = Layout::load("qwerty-flat").unwrap();
        let editor = LayoutEditor::open("numpad", Fit::default()).unwrap();
        let mut trial = EditorTrial::new(&used, &editor, false);
        let own = (used.file.as_str(), used.text.as_str());
        assert_eq!(trial.wanted(&editor), Some(own));
        trial.set_on(true);
        let edited = (editor.name(), editor.text());
        assert_eq!(trial.wanted(&editor), Some(edited));
        trial.set_on(false);
        assert_eq!(trial.wanted(&editor), Some(own));
    }

    #[test]
    fn a_session_with_the_edited_layout_returns_to_its_saved_text() {
        let used = Layout::load("qwerty-flat").unwrap();
        let mut editor = LayoutEditor::open("qwerty-flat", Fit::default()).unwrap();
        let mut trial = EditorTrial::new(&used, &editor, true);
        editor.apply(&Edit::Add(NewPart::Layer)).unwrap();
        assert_ne!(editor.text(), used.text);
        let edited = (editor.name(), editor.text());
        assert_eq!(trial.wanted(&editor), Some(edited));
        trial.set_on(false);
        let saved = (editor.name(), used.text.as_str());
        assert_eq!(trial.wanted(&editor), Some(saved));
    }

    #[test]
    fn a_session_returns_to_its_own_layout_also_after_another_one_is_opened() {
        let used = Layout::load("qwerty-flat").unwrap();
        let mut first = LayoutEditor::open("qwerty-flat", Fit::default()).unwrap();
        first.apply(&Edit::Add(NewPart::Layer)).unwrap();
        let mut begun = EditorTrial::new(&used, &first, true);
        begun.leave(&first);
        let second = LayoutEditor::open("numpad", Fit::default()).unwrap();
        let mut trial = begun.go_on(&second, true);
        let edited = (second.name(), second.text());
        assert_eq!(trial.wanted(&second), Some(edited));
        trial.set_on(false);
        let own = (used.file.as_str(), used.text.as_str());
        assert_eq!(trial.wanted(&second), Some(own));
        trial.leave(&second);
        let again = trial.go_on(&first, true);
        assert!(!again.is_on(), "as it was");
        let saved = (first.name(), first.saved_text());
        assert_eq!(again.wanted(&first), Some(saved));
    }

    #[test]
    fn a_session_returns_to_what_was_written_to_the_file_of_its_layout() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("mine.ron");
        let name = path.to_str().unwrap();
        let text = |key: &str| {
            format!(
                "Layout(name: \"a\", boards: [(pose: (anchor: elbow), rows: [(at_mm: (0, 0), keys: \"{key}\")])])"
            )
        };
        std::fs::write(&path, text("A")).unwrap();
        let used = Layout::load(name).unwrap();
        let editor = LayoutEditor::open("numpad", Fit::default()).unwrap();
        let mut trial = EditorTrial::new(&used, &editor, true);
        // One that cannot be used is not in the session.
        for (written, expected) in [("B", "B"), ("NoSuchKey", "B"), ("C", "C")] {
            std::fs::write(&path, text(written)).unwrap();
            trial.set_on(false);
            let content = text(expected);
            let wanted = (used.file.as_str(), content.as_str());
            assert_eq!(trial.wanted(&editor), Some(wanted), "{written}");
            trial.set_on(true);
        }
    }
}
