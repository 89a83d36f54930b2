//! The text of a hypothesis, with capitals.

use super::finish::Finished;
use super::history::{Entry, History};
use crate::keyboard::Tap;
use crate::model::ends_sentence;
use crate::model::lexicon::Case;

/// The most characters of a text.
const MAX_ENTRIES: usize = 4 * super::MAX_TAPS;

/// The place at which a sentence starts in front of a text.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum SentenceStart {
    /// None is known.
    None,
    /// The first character.
    Here,
    /// After a space, as the text before ends with a mark: an address has none there.
    AfterSpace,
}

/// The text of a hypothesis, in memory that is used again.
#[derive(Clone, Debug)]
pub struct Rendered {
    entries: Vec<Entry>,
    text: String,
}

impl Rendered {
    pub fn new() -> Self {
        Self {
            entries: Vec::with_capacity(MAX_ENTRIES),
            text: String::with_capacity(16 * super::MAX_TAPS),
        }
    }

    /// Returns the text of a complete hypothesis.
    pub fn text(
        &mut self,
        history: &History,
        finished: &Finished,
        taps: &[Tap],
        sentence: SentenceStart,
    ) -> &str {
        self.entries.clear();
        self.text.clear();
        let mut end = finished.end;
        while let Some(entry) = history.get(end) {
            if self.entries.len() == MAX_ENTRIES {
                break;
            }
            self.entries.push(entry);
            end = entry.previous;
        }
        self.entries.reverse();
        let mut start = 0;
        let mut capital = sentence == SentenceStart::Here;
        let mut is_after_mark = sentence == SentenceStart::AfterSpace;
        for index in 0..self.entries.len() {
            let entry = self.entries[index];
            if entry.character.is_alphanumeric() || entry.character == '\'' {
                continue;
            }
            self.word(start, index, entry.case, taps, capital);
            if index > start {
                capital = false;
                is_after_mark = false;
            }
            match entry.character {
                ' ' => capital |= std::mem::take(&mut is_after_mark),
                '"' | ')' => {}
                mark => is_after_mark = ends_sentence(mark),
            }
            self.text.push(entry.character);
            start = index + 1;
        }
        let is_in_capitals = self.word(start, self.entries.len(), finished.case, taps, capital);
        if let Some(letter) = finished.omitted {
            let upper = finished.case == Case::Upper || is_in_capitals;
            self.text
                .extend(upper.then(|| letter.to_uppercase()).into_iter().flatten());
            self.text.extend((!upper).then_some(letter));
        }
        &self.text
    }

    /// Returns the last text.
    pub fn shown(&self) -> &str {
        &self.text
    }

    /// Appends a word. The capitals that were typed inside it are kept if its letters are: in a word that is corrected, one of them is a
    /// slip to Shift. A capital that was typed first stays first, and a word of capitals has no other letters. Returns `true` for such a
    /// word.
    fn word(&mut self, start: usize, end: usize, case: Case, taps: &[Tap], capital: bool) -> bool {
        let word = &self.entries[start..end];
        let typed_for = |entry: &Entry| taps.get(entry.tap as usize).and_then(|tap| tap.typed);
        let is_same = |(entry, before): (&Entry, Option<&Entry>)| {
            let follows = before.is_none_or(|before| before.tap.wrapping_add(1) == entry.tap);
            let same = |typed: char| typed.to_lowercase().eq(entry.character.to_lowercase());
            follows && typed_for(entry).is_some_and(same)
        };
        let before = [None].into_iter().chain(word.iter().map(Some));
        let is_typed = word.iter().zip(before).all(is_same);
        let is_capital = |entry: &Entry| typed_for(entry).is_some_and(char::is_uppercase);
        // The first tap of the word, which may stand for its second letter.
        let first = word.iter().min_by_key(|entry| entry.tap);
        let starts_with_capital = first.is_some_and(is_capital);
        let mut letters = word
            .iter()
            .filter_map(typed_for)
            .filter(|typed| typed.is_alphabetic());
        // One capital may be the first one of any word.
        let is_in_capitals = letters.clone().count() > 1 && letters.all(char::is_uppercase);
        for index in start..end {
            let entry = self.entries[index];
            let is_first = index == start;
            let by_case = match case {
                Case::Lower => false,
                Case::Title => is_first,
                Case::Upper => true,
            };
            let by_place = is_first && (capital || starts_with_capital);
            let as_typed = is_capital(&entry) && (is_first || is_typed);
            if by_case || by_place || as_typed || is_in_capitals {
                self.text.extend(entry.character.to_uppercase());
            } else {
                self.text.push(entry.character);
            }
        }
        is_in_capitals
    }
}
