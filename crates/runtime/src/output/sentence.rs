//! The position of the cursor in a sentence: a word at its start gets a capital.

use std::sync::atomic::{AtomicU8, Ordering};

use arrayvec::ArrayString;

use super::text_field::Text;

/// Number of bytes of text that Backspace can delete before the position in the sentence is no longer known.
const MAX_TAIL: usize = 256;

/// The place of the cursor in a sentence.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub(super) enum Place {
    /// Not known, or the field does not ask for capitals.
    #[default]
    Unknown,
    /// Inside a sentence.
    Inside,
    /// Directly after a mark that may end a sentence.
    AfterMark,
    /// At the start of a sentence.
    Start,
}

impl Place {
    /// All places; the index of each is its number.
    const ALL: [Self; 4] = [Self::Unknown, Self::Inside, Self::AfterMark, Self::Start];

    /// Returns the place after the whole text before the cursor.
    #[cfg_attr(
        not(feature = "wayland"),
        allow(dead_code, reason = "only a compositor reports it")
    )]
    pub(super) fn at_end_of(text: &str) -> Self {
        Self::Start.after(text)
    }

    /// Returns the place after text at this place.
    fn after(self, text: &str) -> Self {
        if self == Self::Unknown {
            return self;
        }
        text.chars().fold(self, |place, character| match character {
            '.' | '!' | '?' => Self::AfterMark,
            '\n' => Self::Start,
            _ if character.is_whitespace() && place == Self::AfterMark => Self::Start,
            _ if character.is_whitespace() => place,
            // Quotes and brackets around a sentence.
            '"' | '\'' | '(' | ')' | '¡' | '¿' => place,
            _ => Self::Inside,
        })
    }
}

/// A place that a thread writes and another one reads.
#[derive(Debug, Default)]
pub(super) struct SharedPlace(AtomicU8);

impl SharedPlace {
    pub(super) fn get(&self) -> Place {
        let number = usize::from(self.0.load(Ordering::Acquire));
        Place::ALL.get(number).copied().unwrap_or_default()
    }

    #[cfg_attr(
        not(feature = "wayland"),
        allow(dead_code, reason = "only a compositor reports it")
    )]
    pub(super) fn set(&self, place: Place) {
        self.0.store(place as u8, Ordering::Release);
    }
}

/// The place of the cursor in a field, derived from the text that was sent to the field.
#[derive(Default)]
pub(super) struct Sentence {
    /// The place before `tail`; `None` if only the field knows it.
    base: Option<Place>,
    tail: ArrayString<MAX_TAIL>,
}

impl Sentence {
    /// Returns `true` if a word starts a sentence; `reported` is the place as the field reports it.
    pub(super) fn is_start(&self, reported: Place) -> bool {
        self.base.unwrap_or(reported).after(&self.tail) == Place::Start
    }

    /// Appends text that is sent to the field; `reported` is the place as the field reports it.
    pub(super) fn push(&mut self, text: &Text, reported: Place) {
        let base = self.base.unwrap_or(reported);
        if base == Place::Unknown {
            return;
        }
        self.base = Some(base);
        if self.tail.remaining_capacity() < text.len() {
            self.base = Some(base.after(&self.tail));
            self.tail.clear();
        }
        self.tail.push_str(text);
    }

    /// Removes the last character.
    pub(super) fn pop(&mut self) {
        if self.tail.pop().is_none() {
            self.base = None;
        }
    }

    /// Forgets the text: the cursor may be elsewhere.
    pub(super) fn forget(&mut self) {
        *self = Self::default();
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_sentence_starts_after_a_mark_and_a_space_and_in_an_empty_field() {
        let table = [
            ("", true),
            ("  ", true),
            ("Hello", false),
            ("Hello ", false),
            ("Hello.", false),
            ("Hello. ", true),
            ("\"Hello!\" ", true),
            ("3.5 ", false),
            ("Dear Ana,\n", true),
            ("Hola. ¿", true),
        ];
        for (text, is_start) in table {
            assert_eq!(Place::at_end_of(text) == Place::Start, is_start, "{text:?}");
        }
    }

    #[test]
    fn text_that_the_field_has_taken_counts_before_the_field_reports_it() {
        let mut sentence = Sentence::default();
        let text = |text| Text::from(text).unwrap();
        assert!(sentence.is_start(Place::Start));
        sentence.push(&text("Hello. "), Place::Start);
        sentence.push(&text("it "), Place::Start);
        assert!(!sentence.is_start(Place::Start));
        for _ in 0.."it ".len() {
            sentence.pop();
        }
        assert!(sentence.is_start(Place::Inside));
        for _ in 0..MAX_TAIL {
            sentence.push(&text("a "), Place::Start);
        }
        assert!(!sentence.is_start(Place::Start));
        sentence.forget();
        assert!(sentence.is_start(Place::Start));
        sentence.push(&text("a"), Place::Unknown);
        assert!(sentence.is_start(Place::Start));
        assert!(!sentence.is_start(Place::Unknown));
    }
}
