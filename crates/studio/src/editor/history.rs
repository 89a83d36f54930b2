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

/// Edits before and after the present text. It holds replaced parts of the text, not texts, so that its size is that of
/// what was typed.
#[derive(Clone, Debug, Default)]
pub(super) struct History {
    steps: Vec<Step>,
    /// Number of steps that are done.
    done: usize,
}

impl History {
    /// Adds an edit, and forgets those that were undone.
    pub fn push(&mut self, step: Step) {
        self.steps.truncate(self.done);
        self.steps.push(step);
        self.done = self.steps.len();
    }

    /// Returns the step to undo, and counts it as undone.
    pub fn undo(&mut self) -> Option<&Step> {
        self.done = self.done.checked_sub(1)?;
        self.steps.get(self.done)
    }

    /// Returns the step to redo, and counts it as done.
    pub fn redo(&mut self) -> Option<&Step> {
        let step = self.steps.get(self.done)?;
        self.done += 1;
        Some(step)
    }

    pub fn can_undo(&self) -> bool {
        self.done > 0
    }

    pub fn can_redo(&self) -> bool {
        self.done < self.steps.len()
    }
}
