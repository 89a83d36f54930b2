//! Corrections: from key presses to the edits of a text field.
//!
//! Letters are typed at once. At the end of a word, [`Mode::Auto`] replaces what differs from the most probable text, in one burst of
//! Backspaces and characters. One Backspace right after it brings back what was typed, and that word is never changed again.
//!
//! | state | event | becomes | edits |
//! |---|---|---|---|
//! | any | character | typing | the character |
//! | typing | character that ends a word, or a tap that most probably means one beside its key, and another text is likelier by the margin | corrected | the character, Backspaces, the new tail |
//! | corrected | Backspace | restored | Backspaces, the tail that was typed; its words are learned |
//! | a candidate was taken inside a word | Backspace | partial | Backspaces, the tail that was typed |
//! | other | Backspace | typing, or partial inside a word that was corrected or is after a long text that is not final | Backspace |
//! | typing | a swipe that began with the last letter | swiped | Backspace if its word starts otherwise, the word, a space |
//! | swiped | Backspace | typing, or partial after a word without a space | Backspaces for the word and its space |
//! | any | pause, loss, stall, another key | partial, if inside a word | none; the person is learned, and nothing is pending any more |
//! | partial | character that ends a word | typing | the character |
//!
//! Where letters share keys, [`Mode::Auto`] corrects the text after each letter, and a Backspace deletes one character: the typed
//! letters are only the first ones of their keys, so there is nothing to restore.
//!
//! In [`Mode::Literal`] every press is passed on as it is, and the decoder does not see it.

mod names;
mod restored;
mod swiped;
mod tail;

use serde::{Deserialize, Serialize};

use crate::decoder::{Candidate, Decoder, MAX_TAPS, same_letters};
use crate::keyboard::Tap;
use crate::model::ends_sentence;
use names::Names;
pub use restored::Restored;
use swiped::Swiped;
pub(crate) use tail::ends_word;
use tail::{Difference, difference};

/// The way in which presses become text.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum Mode {
    /// Passes every press on as it is.
    #[default]
    Literal,
    /// Has candidates, and changes nothing by itself.
    Suggest,
    /// Corrects at the end of a word.
    Auto,
}

/// A key press for the text field.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Edit {
    /// Deletes the character before the cursor.
    Backspace,
    /// Types a character.
    Type(char),
}

/// The most edits of a correction, about half of them Backspaces: as many as one step of the pipeline has room for.
pub const MAX_EDITS: usize = 84;
/// At the end of a word, after this many taps, the text before is final.
const SETTLED_TAPS: usize = 60;
/// The most taps of which a Backspace takes back the last one, as all before it are decoded again in the same step: the taps of a text
/// that becomes final at the end of its last word, which has 24 letters at most.
const MAX_RETAKEN_TAPS: usize = SETTLED_TAPS + 24;

/// A correction that one Backspace undoes.
#[derive(Clone, Debug, Default)]
struct Undo {
    is_possible: bool,
    /// The characters that the correction typed.
    corrected: usize,
    /// The text that they replaced.
    typed: String,
    /// `true` if that text ends inside a word.
    is_inside: bool,
}

/// Turns presses into edits.
#[derive(Clone, Debug)]
pub struct Corrector<'m> {
    decoder: Decoder<'m>,
    mode: Mode,
    restored: Restored,
    names: Names,
    /// The text in the field since the last commit of the decoder.
    shown: String,
    target: String,
    undo: Undo,
    /// `true` if the decoder has not seen the beginning of the word.
    is_partial: bool,
    /// The last word was swiped.
    swiped: Option<Swiped>,
    edits: Vec<Edit>,
}

impl<'m> Corrector<'m> {
    /// Makes a corrector of a mode, with the words of the person.
    pub fn new(mut decoder: Decoder<'m>, mode: Mode, restored: Restored) -> Self {
        let text = || String::with_capacity(8 * MAX_TAPS);
        restored.words().for_each(|word| decoder.add_own_word(word));
        Self {
            decoder,
            mode,
            restored,
            names: Names::default(),
            shown: text(),
            target: text(),
            undo: Undo {
                typed: text(),
                ..Undo::default()
            },
            is_partial: false,
            swiped: None,
            edits: Vec::with_capacity(16 * MAX_TAPS),
        }
    }

    /// Returns the decoder.
    pub fn decoder(&self) -> &Decoder<'m> {
        &self.decoder
    }

    /// Returns the words of the person, which are never changed.
    pub fn restored(&self) -> &Restored {
        &self.restored
    }

    fn shares_keys(&self) -> bool {
        self.decoder.keyboard().has_shared_keys()
    }

    /// Returns the mode.
    pub fn mode(&self) -> Mode {
        self.mode
    }

    /// Changes the mode. What is pending is dropped.
    pub fn set_mode(&mut self, mode: Mode) {
        self.reset();
        self.mode = mode;
    }

    /// Drops what is pending, and learns the person from it: after a pause, a loss, a stall, and a key that moves the cursor.
    pub fn reset(&mut self) {
        self.learn();
        self.drop_pending();
    }

    /// Learns where the person taps from the text in the field, which is final. Returns `true` if the decoder knows that text.
    fn learn(&mut self) -> bool {
        let is_known = self.mode != Mode::Literal && !self.is_partial && self.decoder.taps() > 0;
        // A text that stays although another one is more probable is not evidence.
        if is_known && same_letters(self.decoder.best(), &self.shown) {
            self.decoder.commit();
        }
        is_known
    }

    fn drop_pending(&mut self) {
        self.is_partial |= !self.shown.is_empty() && !self.shown.ends_with(ends_word);
        self.shown.clear();
        self.undo.is_possible = false;
        self.swiped = None;
        self.decoder.start_anywhere();
    }

    /// Drops what is pending after a key that may have moved the cursor into a word, such as an arrow: what is typed next may be the
    /// rest of that word.
    pub fn leave(&mut self) {
        // The key may have deleted the text.
        self.drop_pending();
        self.is_partial = true;
    }

    /// Returns `true` if the decoder has seen the word from its beginning.
    pub fn knows_word(&self) -> bool {
        !self.is_partial
    }

    /// Returns `true` if the text before the cursor ends inside a word, as far as is known.
    pub fn is_inside_word(&self) -> bool {
        self.is_partial || self.shown.ends_with(|last| !ends_word(last))
    }

    /// Drops what is pending, and continues after other text; `is_inside` is `true` if that text ends inside a word.
    pub fn set_inside_word(&mut self, is_inside: bool) {
        self.reset();
        self.is_partial = is_inside;
    }

    /// Copies what another corrector has learned about the person.
    pub fn take_over(&mut self, before: &Self) {
        self.restored.take_over(&before.restored);
        self.names.take_over(&before.names);
        self.decoder.take_over(&before.decoder);
    }

    /// Forgets what was learned about the person, and drops what is pending.
    pub fn forget(&mut self) {
        self.restored.clear();
        self.names.clear();
        self.decoder.forget();
        self.drop_pending();
    }

    /// Counts the whole words of the text in the field, which is final. One that the lexicon lacks becomes one of the person's words
    /// after a few uses. The decoder has no hypotheses then: a new word moves the others.
    fn count_words(&mut self, mut starts_sentence: bool) {
        let whole = self.shown.rfind(ends_word).unwrap_or(0);
        for piece in self.shown[..whole].split_inclusive(ends_word) {
            let word = piece.trim_end_matches(ends_word);
            if !word.is_empty()
                && self.decoder.model().find(word).is_none()
                && let Some(name) = self.names.count(word, starts_sentence)
            {
                self.restored.add(&name);
                self.decoder.add_own_word(&name);
            }
            starts_sentence &= word.is_empty();
            starts_sentence |= piece.ends_with(ends_sentence);
        }
    }

    /// Leaves the text as it is, learns the person from it, and starts at the beginning of a line.
    pub fn start_line(&mut self) {
        self.start_word();
        self.decoder.start_line();
    }

    /// Leaves the text as it is, learns the person from it, and starts at the beginning of a word after text that is not known.
    pub fn start_word(&mut self) {
        let starts_sentence = self.decoder.starts_sentence();
        if self.learn() {
            self.decoder.start_anywhere();
            self.count_words(starts_sentence);
        }
        self.drop_pending();
        self.is_partial = false;
    }

    /// Returns the text in the field since the last commit.
    pub fn shown(&self) -> &str {
        &self.shown
    }

    /// Returns `true` if later keys may change text that is in the field already.
    pub fn is_pending(&self) -> bool {
        !self.shown.is_empty() || self.undo.is_possible || self.swiped.is_some()
    }

    /// Handles the press of a character key. If the tap does not state its character, the nearest key counts.
    pub fn press(&mut self, tap: Tap) -> &[Edit] {
        self.edits.clear();
        let keyboard = self.decoder.keyboard();
        let nearest = || Some(keyboard.keys()[keyboard.nearest(tap.position)?].character);
        let Some(character) = tap.typed.or_else(nearest) else {
            return &self.edits;
        };
        self.edits.push(Edit::Type(character));
        if self.mode == Mode::Literal {
            return &self.edits;
        }
        self.undo.is_possible = false;
        if self.swiped.take().is_some() {
            self.shown.clear();
        }
        if self.decoder.taps() + 1 >= MAX_TAPS {
            self.reset();
        }
        self.shown.push(character);
        self.decoder.tap(Tap {
            typed: Some(character),
            ..tap
        });
        // Where a hand lies beside the keys, hardly a typed character ends a word, and text would grow beyond what a step corrects.
        let reads_ahead = self.mode == Mode::Auto && !self.is_partial;
        let shares_keys = self.shares_keys();
        if ends_word(character)
            || reads_ahead && !shares_keys && self.decoder.ends_word_beside_its_key()
        {
            self.end_word();
        } else if reads_ahead && shares_keys {
            self.target.clear();
            self.target.push_str(self.decoder.reading());
            self.replace();
        }
        &self.edits
    }

    fn end_word(&mut self) {
        if std::mem::take(&mut self.is_partial) {
            let last = self.shown.char_indices().next_back();
            let end = last.map_or(0, |(start, _)| start);
            // The rest of a word is no word that the lexicon lacks.
            let is_word = self.decoder.model().find(&self.shown[..end]).is_some();
            let start = if is_word { 0 } else { end };
            self.decoder.commit_text(Some(&self.shown[start..]));
            return self.shown.clear();
        }
        let is_clear = self.mode != Mode::Auto || self.correct();
        let taps = self.decoder.taps();
        if taps >= SETTLED_TAPS && is_clear || taps >= 2 * SETTLED_TAPS {
            // The shown text is final; the person is learned from the text that was most probably meant.
            let starts_sentence = self.decoder.starts_sentence();
            self.decoder.commit();
            self.count_words(starts_sentence);
            self.shown.clear();
        }
    }

    /// Replaces what differs from the most probable text. Returns `true` if that ends a word.
    fn correct(&mut self) -> bool {
        self.target.clear();
        self.target.push_str(self.decoder.reading());
        // A space that may mean nothing, or a letter, is kept until it is clear where the word ends.
        let is_clear = self.target.ends_with(ends_word);
        if is_clear && !self.replace() {
            // A word that stays as it was typed is not evidence for what follows.
            let starts_sentence = self.decoder.starts_sentence();
            self.decoder.commit_typed();
            self.count_words(starts_sentence);
            self.shown.clear();
        }
        is_clear
    }

    /// Replaces the tail that differs from the target. Returns `false` if a word is in the way that the person restored.
    fn replace(&mut self) -> bool {
        let Some(Difference { prefix, removed }) = difference(&self.shown, &self.target) else {
            return true;
        };
        let is_restored = || self.restored.touches(&self.shown, prefix, &self.target);
        if !self.shares_keys() && is_restored() {
            return false;
        }
        self.replace_tail(prefix, removed);
        true
    }

    /// Replaces the tail after a prefix, unless it is too long.
    fn replace_tail(&mut self, prefix: usize, removed: usize) {
        let (old, new) = (&self.shown[prefix..], &self.target[prefix..]);
        if removed + new.chars().count() > MAX_EDITS {
            // Out of reach: what follows starts again, so that it can be corrected.
            self.decoder.commit();
            self.shown.clear();
            return;
        }
        self.edits.extend(old.chars().map(|_| Edit::Backspace));
        self.edits.extend(new.chars().map(Edit::Type));
        self.undo.is_possible = !self.shares_keys();
        self.undo.is_inside = self.shown.ends_with(|last| !ends_word(last));
        self.undo.corrected = new.chars().count();
        self.undo.typed.clear();
        self.undo.typed.push_str(old);
        // The whole first word of the tail, so that it can be learned.
        self.restored.remember(&self.shown, prefix, &self.target);
        std::mem::swap(&mut self.shown, &mut self.target);
        self.decoder.follow(&self.shown);
    }

    /// Handles a Backspace.
    pub fn backspace(&mut self) -> &[Edit] {
        self.edits.clear();
        if std::mem::take(&mut self.undo.is_possible) {
            self.edits
                .extend((0..self.undo.corrected).map(|_| Edit::Backspace));
            self.edits.extend(self.undo.typed.chars().map(Edit::Type));
            // Nothing of a text that is final, but the tail.
            let kept = self
                .shown
                .chars()
                .count()
                .saturating_sub(self.undo.corrected);
            self.target.clear();
            self.target.extend(self.shown.chars().take(kept));
            self.target.push_str(&self.undo.typed);
            self.shown.clear();
            // The rest of a word is not a word, and its beginning is not a word to be learned.
            self.is_partial = self.undo.is_inside;
            if let Some(swiped) = self.swiped.take() {
                self.decoder.start_after(swiped.before);
            } else {
                if !self.is_partial {
                    let decoder = &mut self.decoder;
                    self.restored.learn(|word| decoder.add_own_word(word));
                }
                let text = (!self.is_partial).then_some(self.target.as_str());
                self.decoder.commit_text(text);
            }
            return &self.edits;
        }
        self.edits.push(Edit::Backspace);
        if self.mode == Mode::Literal {
            return &self.edits;
        }
        let inside = self
            .shown
            .chars()
            .next_back()
            .is_some_and(|last| !ends_word(last));
        if inside || !self.shown.is_empty() && self.shown == self.decoder.typed() {
            self.shown.pop();
            if self.decoder.taps() > MAX_RETAKEN_TAPS {
                self.drop_pending();
            } else {
                self.decoder.untap();
                // The taps of a corrected word do not spell what is left of it.
                if !self.shares_keys() && !same_letters(&self.shown, self.decoder.typed()) {
                    self.drop_pending();
                }
            }
        } else {
            // Back in text that is final: what follows is the rest of a word.
            self.shown.clear();
            self.decoder.start_anywhere();
            self.is_partial = true;
        }
        &self.edits
    }

    /// Returns the candidates for the text since the last commit; none in [`Mode::Literal`].
    pub fn candidates(&mut self) -> &[Candidate] {
        match self.mode {
            Mode::Literal => &[],
            _ if self.swiped.is_some() => self.decoder.last_candidates(),
            _ if self.is_partial => &[],
            _ => self.decoder.candidates(),
        }
    }

    /// Types punctuation in place of the space that a word has brought, and that space after it.
    pub fn punctuate(&mut self, mark: char) -> &[Edit] {
        self.undo.is_possible = false;
        self.swiped = None;
        self.shown.clear();
        self.decoder.commit_mark(mark);
        self.edits.clear();
        self.edits
            .extend([Edit::Backspace, Edit::Type(mark), Edit::Type(' ')]);
        &self.edits
    }

    /// Takes a candidate in place of what is shown, with a space after it unless it ends a word already. One Backspace takes it
    /// back. Its words are the context of what follows.
    pub fn accept(&mut self, candidate: usize) -> &[Edit] {
        self.edits.clear();
        self.target.clear();
        if let Some(swiped) = self.swiped {
            self.replace_swiped(candidate, swiped);
            return &self.edits;
        }
        let is_usable = self.mode != Mode::Literal && !self.is_partial;
        let chosen = self
            .decoder
            .candidates()
            .get(candidate)
            .filter(|_| is_usable);
        let Some(chosen) = chosen else {
            return &self.edits;
        };
        self.target.push_str(&chosen.text);
        if self.target.is_empty() {
            return &self.edits;
        }
        if !self.target.ends_with(ends_word) {
            self.target.push(' ');
        }
        let is_inside = self.is_inside_word();
        if let Some(Difference { prefix, removed }) = difference(&self.shown, &self.target) {
            self.replace_tail(prefix, removed);
            // Out of reach: what was typed stays.
            self.is_partial = is_inside && self.shown.is_empty();
        }
        self.decoder.commit_text(Some(&self.shown));
        self.shown.clear();
        &self.edits
    }
}
