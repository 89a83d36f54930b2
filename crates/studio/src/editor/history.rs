//! The edits that can be undone, and those that can be redone.

use ademan_core::editing::Part;
use ademan_core::editing::Patch;

/// A finished edit.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct Step {
    /// Patches to undo it, in the order in which they apply.
    pub undo: Vec<Patch>,
    /// Patches to do it again.
    pub redo: Vec<Patch>,
    /// The selection before and after it.
    pub selection: [Vec<Part>; 2],
}

/// Edits before and after the present text. It holds replaced parts of the text, not whole texts, so it grows by what
/// is typed only.
#[derive(Clone, Debug, Default)]
pub(super) struct History {
    steps: Vec<Step>,
    /// Number of steps that are done.
    done: usize,
    /// The steps that could be redone before the last edit, for the case that it is taken back.
    replaced: Vec<Step>,
    /// The last edit, if it has changed nothing: it is no step.
    unchanged: Option<Step>,
}

impl History {
    /// Adds an edit, and forgets those that were undone. An edit that changes nothing leaves them.
    pub fn push(&mut self, step: Step) {
        if step.redo.is_empty() {
            self.unchanged = Some(step);
            return;
        }
        self.unchanged = None;
        self.replaced = self.steps.split_off(self.done);
        self.steps.push(step);
        self.done = self.steps.len();
    }

    /// Returns the last edit, even if it has changed nothing.
    pub fn last(&self) -> Option<&Step> {
        match &self.unchanged {
            Some(step) => Some(step),
            None => self.steps.get(self.done.checked_sub(1)?),
        }
    }

    /// Removes the last edit. What could be redone before it can be redone again.
    pub fn take_last(&mut self) -> Option<Step> {
        if let Some(step) = self.unchanged.take() {
            return Some(step);
        }
        self.done = self.done.checked_sub(1)?;
        let step = self.steps.drain(self.done..).next();
        self.steps.append(&mut self.replaced);
        step
    }

    /// Returns the step to undo, and counts it as undone.
    pub fn undo(&mut self) -> Option<&Step> {
        self.end_last();
        self.done = self.done.checked_sub(1)?;
        self.steps.get(self.done)
    }

    /// Returns the step to redo, and counts it as done.
    pub fn redo(&mut self) -> Option<&Step> {
        self.end_last();
        let step = self.steps.get(self.done)?;
        self.done += 1;
        Some(step)
    }

    /// Forgets what only the last edit needs.
    fn end_last(&mut self) {
        self.unchanged = None;
        self.replaced.clear();
    }

    pub fn can_undo(&self) -> bool {
        self.done > 0
    }

    pub fn can_redo(&self) -> bool {
        self.done < self.steps.len()
    }
}
