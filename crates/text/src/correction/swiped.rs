//! Words that a finger swiped.

use super::tail::{Difference, difference, ends_word};
use super::{Corrector, Edit, Mode};
use crate::decoder::Before;
use crate::keyboard::Millimetres;

/// A swiped word, as long as it is the last one in the field.
#[derive(Clone, Copy, Debug)]
pub(super) struct Swiped {
    /// The text before it.
    pub before: Before,
    /// `true` if a space was typed before it, because a word without one was there.
    has_space: bool,
    /// `true` if the text before it ends inside a word, as far as is known.
    is_inside: bool,
}

impl Corrector<'_> {
    /// Replaces the last letter by the word that a path means, which began with the press of that letter, and adds a space. A word right
    /// before it, which has no space yet, gets one. One Backspace deletes all of it. Without a word the letter stays.
    pub fn swipe(&mut self, path: &[Millimetres]) -> &[Edit] {
        self.edits.clear();
        let letter = self.shown.chars().next_back();
        let Some(letter) = letter.filter(|it| !ends_word(*it) && self.mode != Mode::Literal) else {
            return &self.edits;
        };
        self.shown.pop();
        let has_space = self.shown.ends_with(|last| !ends_word(last));
        let is_inside = has_space || self.is_partial;
        if self.shown.trim_end().is_empty() {
            // A space after a text that is final says nothing more about it.
            self.decoder.start_after(self.decoder.before());
        } else {
            // The text before is final.
            self.decoder.commit_text(Some(&self.shown));
        }
        let before = self.decoder.before();
        if self.decoder.swipe(path, letter.is_uppercase()).is_empty() {
            self.shown.clear();
            self.is_partial = true;
            return &self.edits;
        }
        self.is_partial = false;
        self.shown.clear();
        self.shown.push(letter);
        let swiped = Swiped {
            before,
            has_space,
            is_inside,
        };
        self.replace_swiped(0, swiped);
        &self.edits
    }

    /// Replaces what is shown, or the last swiped word, by a candidate for it.
    pub(super) fn replace_swiped(&mut self, candidate: usize, swiped: Swiped) {
        let Some(chosen) = self.decoder.last_candidates().get(candidate) else {
            return;
        };
        self.target.clear();
        self.target.extend(swiped.has_space.then_some(' '));
        self.target.push_str(&chosen.text);
        self.target.push(' ');
        if let Some(Difference { prefix, removed }) = difference(&self.shown, &self.target) {
            let deleted = std::iter::repeat_n(Edit::Backspace, removed);
            let typed = self.target[prefix..].chars().map(Edit::Type);
            self.edits.extend(deleted.chain(typed));
        }
        self.undo.is_possible = true;
        self.undo.corrected = self.target.chars().count();
        self.undo.typed.clear();
        self.undo.is_inside = swiped.is_inside;
        std::mem::swap(&mut self.shown, &mut self.target);
        self.decoder.commit_text(Some(&self.shown));
        self.swiped = Some(swiped);
    }
}
