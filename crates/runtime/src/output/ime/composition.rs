//! The split of events into text and keys: which of them a text field takes as text, and in which pieces.

use crate::output::sentence::{Place, Sentence};
use crate::output::text_field::Text;
use ademan_core::device::pressed_keys::PressedKeys;
use ademan_core::device::{EventKind, KeyCode, OutputEvent};

/// The way in which a character reaches the receiver.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Way {
    /// As a key: no text field has the focus, or one that takes no text from an input method.
    Keys,
    /// As text, at once.
    Text,
    /// As text at the end of the word.
    Words,
}

/// A part of a step, in order.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) enum Part {
    /// The field shows this word instead of the previous one.
    Show(Text),
    /// The field takes this text instead of the word that it shows.
    Commit(Text),
    /// An event for the output of keys.
    Key(OutputEvent),
}

/// The word that a text field shows, and the keys that went each way.
#[derive(Default)]
pub(super) struct Composition {
    /// The word; a longer one is committed in pieces.
    word: Text,
    /// `true` if `word` differs from what the field shows.
    is_changed: bool,
    /// The keys whose press became text: their release is dropped.
    composed: PressedKeys,
    /// The modifiers that the output of keys holds.
    modifiers: PressedKeys,
    /// The place of the cursor, as the field reports it.
    place: Place,
    sentence: Sentence,
}

impl Composition {
    /// Returns the word that is open.
    pub(super) fn word(&self) -> &str {
        &self.word
    }

    /// Forgets the word: the field has taken it, or has lost the focus.
    pub(super) fn forget_word(&mut self) {
        self.word.clear();
        self.is_changed = false;
        self.sentence.forget();
    }

    /// Sets the place of the cursor, as the field reports it. Words that start a sentence get a capital.
    pub(super) fn set_place(&mut self, place: Place) {
        self.place = place;
    }

    /// Passes an event on.
    pub(super) fn handle(&mut self, event: OutputEvent, way: Way, emit: &mut dyn FnMut(Part)) {
        match event.kind {
            EventKind::KeyDown(key) => self.press(key, event, way, emit),
            EventKind::KeyUp(key) if self.composed.release(key) => {}
            EventKind::KeyUp(key) => {
                self.modifiers.release(key);
                emit(Part::Key(event));
            }
            EventKind::Character(character) if way != Way::Keys => {
                self.type_character(character, way, emit);
            }
            EventKind::Character(_) => self.forward(event, emit),
            // Motion, values, depths.
            _ => emit(Part::Key(event)),
        }
    }

    /// Shows the word as it is after the events so far.
    pub(super) fn show(&mut self, emit: &mut dyn FnMut(Part)) {
        if std::mem::take(&mut self.is_changed) {
            emit(Part::Show(self.word));
        }
    }

    /// Commits the word as it is.
    pub(super) fn commit(&mut self, emit: &mut dyn FnMut(Part)) {
        // A word that was deleted is no longer shown.
        if self.word.is_empty() {
            return self.show(emit);
        }
        self.is_changed = false;
        let text = std::mem::take(&mut self.word);
        self.sentence.push(&text, self.place);
        emit(Part::Commit(text));
    }

    fn press(&mut self, key: KeyCode, event: OutputEvent, way: Way, emit: &mut dyn FnMut(Part)) {
        if key.is_modifier() {
            self.modifiers.press(key);
            return emit(Part::Key(event));
        }
        if way == Way::Keys || self.has_shortcut() {
            return self.forward(event, emit);
        }
        if key == KeyCode::BACKSPACE && self.word.pop().is_some() {
            self.is_changed = true;
            self.composed.press(key);
            return;
        }
        let is_shifted = !self.modifiers.is_empty();
        match key.us_character(is_shifted) {
            Some(character) if !character.is_control() => {
                self.composed.press(key);
                self.type_character(character, way, emit);
            }
            _ => self.forward(event, emit),
        }
    }

    /// Passes an event to the output of keys, after the word.
    fn forward(&mut self, event: OutputEvent, emit: &mut dyn FnMut(Part)) {
        self.commit(emit);
        match event.kind {
            EventKind::KeyDown(KeyCode::BACKSPACE) if !self.has_shortcut() => self.sentence.pop(),
            _ => self.sentence.forget(),
        }
        emit(Part::Key(event));
    }

    /// Returns `true` if a modifier other than Shift is down.
    fn has_shortcut(&self) -> bool {
        self.modifiers.release_order().any(|key| !key.is_shift())
    }

    fn type_character(&mut self, character: char, way: Way, emit: &mut dyn FnMut(Part)) {
        if self.word.remaining_capacity() < 2 * character.len_utf8() {
            self.commit(emit);
        }
        let starts_word = way == Way::Words && self.word.is_empty();
        if starts_word && self.sentence.is_start(self.place) {
            self.word.push(capital(character));
        } else {
            self.word.push(character);
        }
        self.is_changed = true;
        let is_in_word = character.is_alphabetic() || character == '\'';
        if way != Way::Words || !is_in_word {
            self.commit(emit);
        }
    }
}

/// Returns the capital of a letter, or the character itself if that is not one character.
fn capital(character: char) -> char {
    let mut capitals = character.to_uppercase();
    match (capitals.next(), capitals.next()) {
        (Some(capital), None) => capital,
        _ => character,
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::output::tests::{down, event, up};

    /// Passes the events of each step on, and returns what comes out as text.
    fn parts(steps: &[(&[OutputEvent], Way)]) -> Vec<String> {
        let mut composition = Composition::default();
        let mut parts = Vec::new();
        for (events, way) in steps {
            let mut emit = |part| {
                parts.push(match part {
                    Part::Show(word) => format!("show {word}"),
                    Part::Commit(text) => format!("commit {text}"),
                    Part::Key(event) => format!("{:?}", event.kind),
                });
            };
            for event in *events {
                composition.handle(*event, *way, &mut emit);
            }
            composition.show(&mut emit);
        }
        parts
    }

    #[test]
    fn a_word_is_shown_until_the_character_that_ends_it() {
        let steps: [(&[OutputEvent], Way); 4] = [
            (&[down(1, "H"), up(1, "H")], Way::Words),
            (&[down(2, "I"), up(2, "I")], Way::Words),
            (&[down(3, "Space"), up(3, "Space")], Way::Words),
            (&[down(4, "Space")], Way::Words),
        ];
        assert_eq!(
            parts(&steps),
            ["show h", "show hi", "commit hi ", "commit  "]
        );
    }

    #[test]
    fn a_correction_changes_the_word_before_it_is_committed() {
        let backspace = [down(2, "Backspace"), up(2, "Backspace")];
        let steps: [(&[OutputEvent], Way); 2] = [
            (&[down(1, "T"), down(1, "G"), down(1, "E")], Way::Words),
            (
                &[
                    backspace[0],
                    backspace[1],
                    backspace[0],
                    backspace[1],
                    down(2, "H"),
                    up(2, "H"),
                    down(2, "E"),
                    down(2, "Space"),
                ],
                Way::Words,
            ),
        ];
        assert_eq!(parts(&steps), ["show tge", "commit the "]);
    }

    #[test]
    fn keys_without_a_character_and_shortcuts_are_keys_after_the_word() {
        let steps: [(&[OutputEvent], Way); 3] = [
            (
                &[down(1, "A"), up(1, "A"), down(1, "Enter"), up(1, "Enter")],
                Way::Words,
            ),
            (
                &[
                    down(2, "CtrlLeft"),
                    down(2, "C"),
                    up(2, "C"),
                    up(2, "CtrlLeft"),
                ],
                Way::Words,
            ),
            (&[down(3, "Backspace"), up(3, "Backspace")], Way::Words),
        ];
        let enter = down(0, "Enter").kind;
        let expected = [
            "commit a".to_owned(),
            format!("{enter:?}"),
            format!("{:?}", up(0, "Enter").kind),
            format!("{:?}", down(0, "CtrlLeft").kind),
            format!("{:?}", down(0, "C").kind),
            format!("{:?}", up(0, "C").kind),
            format!("{:?}", up(0, "CtrlLeft").kind),
            format!("{:?}", down(0, "Backspace").kind),
            format!("{:?}", up(0, "Backspace").kind),
        ];
        assert_eq!(parts(&steps), expected);
    }

    #[test]
    fn a_key_that_became_text_is_not_released_where_the_focus_goes() {
        let steps: [(&[OutputEvent], Way); 2] = [
            (&[down(1, "A")], Way::Text),
            (&[up(2, "A"), down(2, "B"), up(2, "B")], Way::Keys),
        ];
        let (press, release) = (down(0, "B").kind, up(0, "B").kind);
        assert_eq!(
            parts(&steps),
            [
                "commit a".to_owned(),
                format!("{press:?}"),
                format!("{release:?}")
            ]
        );
    }

    #[test]
    fn a_key_that_was_pressed_as_a_key_is_released_as_one() {
        let steps: [(&[OutputEvent], Way); 2] =
            [(&[down(1, "A")], Way::Keys), (&[up(2, "A")], Way::Words)];
        assert_eq!(parts(&steps).len(), 2);
    }

    #[test]
    fn shift_and_characters_without_a_key_are_text() {
        let steps: [(&[OutputEvent], Way); 1] = [(
            &[
                down(1, "ShiftLeft"),
                down(1, "A"),
                up(1, "ShiftLeft"),
                event(1, EventKind::Character('ñ')),
            ],
            Way::Words,
        )];
        assert_eq!(parts(&steps).last().unwrap(), "show Añ");
    }

    #[test]
    fn a_word_that_starts_a_sentence_gets_a_capital_if_the_field_asks_for_it() {
        let text = |place| {
            let mut composition = Composition::default();
            composition.set_place(place);
            let mut typed = String::new();
            for character in "ñu. it is. ßa".chars() {
                let event = event(1, EventKind::Character(character));
                composition.handle(event, Way::Words, &mut |part| {
                    if let Part::Commit(text) = part {
                        typed.push_str(&text);
                    }
                });
            }
            typed + composition.word()
        };
        assert_eq!(text(Place::Start), "Ñu. It is. ßa");
        assert_eq!(text(Place::Inside), "ñu. It is. ßa");
        assert_eq!(text(Place::Unknown), "ñu. it is. ßa");
    }

    #[test]
    fn a_long_word_is_committed_in_pieces_without_loss() {
        let typed = "a".repeat(200);
        let events: Vec<OutputEvent> = typed
            .chars()
            .map(|it| event(1, EventKind::Character(it)))
            .collect();
        let parts = parts(&[(&events, Way::Words)]);
        let text: String = parts
            .iter()
            .map(|part| part.split_once(' ').unwrap().1)
            .collect();
        assert_eq!(text, typed);
        assert!(parts.len() > 2, "{parts:?}");
    }
}
