//! Edits as steps that are undone and redone.

use std::mem;

use super::history::Step;
use super::{Edit, EditError, Edited, LayoutEditor, Part, Patch};
use ademan_core::editing;

impl LayoutEditor {
    /// Makes an edit. The text may become invalid, which [`problems`](Self::problems) tells; undo leads back.
    pub fn apply(&mut self, edit: &Edit) -> Result<(), EditError> {
        let edited = editing::edit(&self.text, edit)?;
        self.adopt(edited)
    }

    /// Makes an edit in place of the last one: the present state of a drag.
    pub fn amend(&mut self, edit: &Edit) -> Result<(), EditError> {
        let Some(step) = self.history.last().cloned() else {
            return self.apply(edit);
        };
        // The text in between is not read: a drag on a layout with 10 000 keys reads one text per frame.
        let text = patched(&self.text, &step.undo).ok_or(EditError::Overlap)?;
        let edited = editing::edit(&text, edit)?;
        self.history.take_last();
        let [before, _] = step.selection;
        (self.text, self.selection) = (text, before);
        let adopted = self.adopt(edited);
        if adopted.is_err() {
            self.read();
        }
        adopted
    }

    /// Takes the last edit back, as if it had not been made: a drag that has come back to where it began. Returns `false` if there is
    /// none.
    pub fn take_back(&mut self) -> bool {
        let Some(step) = self.history.take_last() else {
            return false;
        };
        let [before, _] = step.selection;
        self.patch(&step.undo, before);
        true
    }

    pub(super) fn adopt(&mut self, edited: Edited) -> Result<(), EditError> {
        let mut text = self.text.clone();
        let (mut undo, mut redo) = (Vec::new(), Vec::new());
        for patch in edited.patches {
            let (patched, inverse) = patch.apply(&text).ok_or(EditError::Overlap)?;
            text = patched;
            undo.insert(0, inverse);
            redo.push(patch);
        }
        if text == self.text {
            (undo, redo) = (Vec::new(), Vec::new());
        }
        let before = mem::take(&mut self.selection);
        self.text = text;
        self.read();
        self.select(edited.parts);
        self.history.push(Step {
            undo,
            redo,
            selection: [before, self.selection.clone()],
        });
        Ok(())
    }

    /// Undoes the last edit. Returns `false` if there is none.
    pub fn undo(&mut self) -> bool {
        let Some(step) = self.history.undo().cloned() else {
            return false;
        };
        let [before, _] = step.selection;
        self.patch(&step.undo, before);
        true
    }

    /// Makes the last undone edit again. Returns `false` if there is none.
    pub fn redo(&mut self) -> bool {
        let Some(step) = self.history.redo().cloned() else {
            return false;
        };
        let [_, after] = step.selection;
        self.patch(&step.redo, after);
        true
    }

    /// Returns `true` if there is an edit to undo.
    pub fn can_undo(&self) -> bool {
        self.history.can_undo()
    }

    /// Returns `true` if there is an edit to redo.
    pub fn can_redo(&self) -> bool {
        self.history.can_redo()
    }

    /// Applies patches that were made for the present text.
    fn patch(&mut self, patches: &[Patch], selection: Vec<Part>) {
        if let Some(text) = patched(&self.text, patches) {
            self.text = text;
        }
        self.read();
        self.select(selection);
    }
}

/// Returns the text after patches that were made for it and for each other.
fn patched(text: &str, patches: &[Patch]) -> Option<String> {
    let mut text = text.to_owned();
    for patch in patches {
        (text, _) = patch.apply(&text)?;
    }
    Some(text)
}
