//! The text decoder as a filter of presses.

use std::any::Any;
use std::time::Duration;

use crate::correction::MAX_EDITS;
use crate::keyboard::Millimetres;
use crate::{Corrector, Edit, Tap};
use arrayvec::ArrayVec;

use super::burst;
use super::candidates::candidate_text;
use super::decoder_mode;
use super::keys::TextKeys;
use super::literal::{ends_inside_word, takes_space};
use super::step::Step;
use super::stroke::{Progress, Stroke};
use ademan_core::command::TextMode;
use ademan_core::device::pressed_keys::PressedKeys;
use ademan_core::device::{EventKind, Events, KeyCode, OutputEvent};
use ademan_core::hand::Side;
use ademan_core::pipeline::press_filter::FilterInput;
use ademan_core::pipeline::{PressFilter, TextState};
use ademan_core::time::Timestamp;

/// Longest time for which Backspace is held without repeating: the shortest delay of a desktop. After it, the text in the field is not
/// known.
const REPEAT_DELAY: Duration = Duration::from_millis(250);

/// Time without a key after which the person may have gone to another text field with another device.
const IDLE_TIME: Duration = Duration::from_secs(10);

/// The longest time from a press to its event: a chord, or a key that acts on release.
const EVIDENCE_TIME: Duration = Duration::from_millis(1_000);

/// A press whose event may follow.
#[derive(Clone, Copy, Debug)]
struct Evidence {
    character: char,
    position: Millimetres,
    time: Timestamp,
}

/// A text decoder between the devices of a layout and the output gate.
///
/// In [`TextMode::Literal`] it changes nothing. In the other modes it taps keys that type characters, so that no receiver repeats them.
pub(super) struct TextFilter {
    corrector: Corrector<'static>,
    keys: TextKeys,
    /// The mode in which the decoder starts on its layout.
    first_mode: TextMode,
    state: TextState,
    evidence: ArrayVec<Evidence, 10>,
    /// The last letter that was pressed, until its finger is lifted.
    stroke: Option<Stroke>,
    /// The start of the stroke that was going on when the other hand was lost: the text is forgotten when this stroke has ended.
    known_until: Option<Timestamp>,
    /// The number of the candidate that is taken in the next step of a hand that may type.
    choice: Option<u8>,
    /// The time of the last key.
    last_key: Timestamp,
    /// The time since which the person holds Backspace.
    backspace_since: Option<Timestamp>,
    /// `true` if the last key chose a candidate, which brought its space.
    is_spaced: bool,
    /// `true` if a mark is in front of that space.
    has_mark: bool,
    /// `true` if the typed text ends inside a word, in the mode `literal`.
    is_inside_word: bool,
    /// The text in the field, for the candidates.
    shown: String,
    is_changed: bool,
    /// The keys that a control holds although they are up, because the filter tapped them.
    tapped: PressedKeys,
}

impl TextFilter {
    /// Creates a filter. The text before the cursor is not known.
    pub(super) fn new(mut corrector: Corrector<'static>, keys: TextKeys, mode: TextMode) -> Self {
        corrector.start_word();
        Self {
            corrector,
            keys,
            first_mode: mode,
            state: TextState {
                mode,
                candidates: ArrayVec::new(),
            },
            evidence: ArrayVec::new(),
            stroke: None,
            known_until: None,
            choice: None,
            last_key: Timestamp::default(),
            backspace_since: None,
            is_spaced: false,
            has_mark: false,
            is_inside_word: false,
            shown: String::with_capacity(4_096),
            is_changed: false,
            tapped: PressedKeys::default(),
        }
    }

    /// Returns the decoder, with what it has learned.
    pub(super) fn corrector(&self) -> &Corrector<'static> {
        &self.corrector
    }

    fn remember_presses(&mut self, input: &FilterInput) {
        self.evidence
            .retain(|press| input.time.since(press.time) < EVIDENCE_TIME);
        let is_swiping = self.ignores_presses(input.side);
        let is_typing = input.may_type && !is_swiping;
        for press in input.presses.iter().filter(|_| is_typing) {
            let Some((character, position)) = self.keys.locate(press) else {
                continue;
            };
            self.stroke = Stroke::new(press, (character, position), &self.keys);
            if self.evidence.is_full() {
                self.evidence.remove(0);
            }
            self.evidence.push(Evidence {
                character,
                position,
                time: press.time,
            });
        }
    }

    /// Follows the finger of a stroke. Returns `true` if it was lifted.
    fn follow_stroke(&mut self, input: &FilterInput) -> bool {
        let stroke = self.stroke.as_mut();
        let Some(stroke) = stroke.filter(|stroke| stroke.side == input.side) else {
            return false;
        };
        let progress = stroke.follow(input, &self.keys);
        if progress == Progress::Lost {
            self.stroke = None;
        }
        progress == Progress::Lifted
    }

    /// Forgets the text if the stroke has ended that was going on when the other hand was lost.
    fn forget_after_stroke(&mut self) {
        let Some(start) = self.known_until else {
            return;
        };
        let stroke = self.stroke.as_ref();
        if stroke.is_none_or(|stroke| stroke.start != start) {
            self.reset();
        }
    }

    /// Replaces the letter of a swipe by its word.
    fn end_stroke(&mut self, time: Timestamp, step: &mut Step) {
        let Some(stroke) = self.stroke.take() else {
            return;
        };
        let Some(path) = stroke.path() else { return };
        self.is_changed = true;
        self.last_key = time;
        let edits = burst::copy(self.corrector.swipe(path));
        self.is_spaced = match edits {
            Ok(edits) if edits.is_empty() => return,
            Ok(edits) => step.append(&edits, &self.keys, time),
            Err(burst::TooMany) => false,
        };
        self.has_mark = false;
        if !self.is_spaced {
            self.corrector.leave();
        }
    }

    /// Returns the position at which the key of a character was tapped, or its center if the position is not known. `None` if no key
    /// types it.
    fn position(&mut self, character: char) -> Option<Millimetres> {
        let center = self.keys.center(character)?;
        let (pressed, shift) = self.keys.pressed_for(character);
        let is_own = |press: &Evidence| press.character == pressed;
        let index = self.evidence.iter().position(is_own);
        Some(index.map_or(center, |index| {
            let [x, y] = self.evidence.remove(index).position;
            [x + shift, y]
        }))
    }

    fn leave(&mut self) {
        self.corrector.leave();
        self.is_changed = true;
    }

    /// Handles the press of a character by an event, and appends it.
    fn type_character(&mut self, character: char, event: OutputEvent, step: &mut Step) {
        self.leave_after_repeats(event.time);
        let stroke = self.stroke.as_mut();
        if !stroke.is_some_and(|stroke| stroke.note_typed(character)) {
            self.stroke = None;
        }
        let Some(position) = self.position(character) else {
            self.leave();
            return step.tap(event);
        };
        self.is_changed = true;
        let edits = self.corrector.press(Tap {
            position,
            typed: Some(character),
        });
        if !step.append_press(edits, &self.keys, event) {
            // The typed text stays.
            self.corrector.start_word();
            step.tap(event);
        }
    }

    /// Handles a Backspace of the person, and appends it unless it undoes a correction.
    fn delete(&mut self, event: OutputEvent, step: &mut Step) {
        self.is_changed = true;
        let edits = burst::copy(self.corrector.backspace());
        match edits.as_deref() {
            Ok([Edit::Backspace]) => {}
            Ok(edits) if step.append(edits, &self.keys, event.time) => {
                // The person holds it, and it is up.
                step.tapped.press(KeyCode::BACKSPACE);
                return;
            }
            _ => self.corrector.leave(),
        }
        self.backspace_since = Some(event.time);
        step.push(event);
    }

    /// Replaces the typed word by a candidate that was chosen.
    fn accept(&mut self, number: Option<u8>, time: Timestamp, step: &mut Step) {
        let Some(number) = number else { return };
        self.leave_after_repeats(time);
        self.is_changed = true;
        self.last_key = time;
        let index = usize::from(number).saturating_sub(1);
        let is_inside = self.corrector.is_inside_word();
        let edits: ArrayVec<Edit, MAX_EDITS> = match burst::copy(self.corrector.accept(index)) {
            Ok(edits) => edits,
            Err(burst::TooMany) => return self.corrector.set_inside_word(is_inside),
        };
        if edits.is_empty() {
            // It brings no space, and the space of a previous candidate stays.
            return;
        }
        let has_space = edits.last() == Some(&Edit::Type(' '));
        let is_appended = step.append(&edits, &self.keys, time);
        self.is_spaced = is_appended && has_space;
        self.has_mark = false;
        if !is_appended {
            self.corrector.set_inside_word(is_inside);
        }
    }

    /// Handles punctuation after a word that has brought its space: the space moves after the mark.
    fn punctuate(&mut self, mark: char, event: OutputEvent, step: &mut Step) {
        self.is_changed = true;
        let edits: ArrayVec<Edit, MAX_EDITS> =
            self.corrector.punctuate(mark).iter().copied().collect();
        self.is_spaced = step.append(&edits, &self.keys, event.time);
        self.has_mark = self.is_spaced;
        if self.is_spaced {
            step.swallow(event);
        } else {
            self.leave();
            step.tap(event);
        }
    }

    /// Appends the Backspace of a multitap key, which deletes its last letter and has another letter after it.
    fn replace_letter(&mut self, letter: EventKind, event: OutputEvent, step: &mut Step) {
        self.leave();
        if self.is_spaced && !self.has_mark {
            // A candidate has taken the place of the letter.
            return step.swallow(event);
        }
        let is_mark = |key: KeyCode| key.us_character(step.is_shifted()).is_some_and(takes_space);
        let follows_mark = matches!(letter, EventKind::KeyDown(key) if is_mark(key));
        if self.is_spaced && !follows_mark {
            // The letter is a mark with a space after it.
            self.is_spaced = false;
            step.append(&[Edit::Backspace], &self.keys, event.time);
        }
        step.push(event);
    }

    /// Leaves the text if Backspace is held for so long that the receiver repeats it and has deleted more than is known.
    fn leave_after_repeats(&mut self, time: Timestamp) {
        let held = self.backspace_since.map(|since| time.since(since));
        if held > Some(REPEAT_DELAY) {
            self.leave();
        }
    }

    fn press(&mut self, key: KeyCode, event: OutputEvent, step: &mut Step) {
        self.last_key = event.time;
        if key.is_shift() {
            return step.push(event);
        }
        let is_spaced = std::mem::take(&mut self.is_spaced);
        let types_character = key.us_character(step.is_shifted()).is_some();
        self.stroke = self.stroke.take().filter(|_| types_character);
        if key.is_modifier() || step.has_shortcut() {
            self.leave();
            return step.push(event);
        }
        if key == KeyCode::BACKSPACE {
            return self.delete(event, step);
        }
        match key.us_character(step.is_shifted()) {
            // A line break or a tab.
            Some(character) if character.is_control() => {
                self.corrector.start_line();
                self.is_changed = true;
                step.push(event);
            }
            // The previous candidate has brought the space.
            Some(' ') if is_spaced => step.swallow(event),
            Some(mark) if is_spaced && takes_space(mark) => self.punctuate(mark, event, step),
            Some(character) => self.type_character(character, event, step),
            None => {
                self.leave();
                step.push(event);
            }
        }
    }

    /// Updates the candidates for displays. Text that will be forgotten has none.
    fn update_candidates(&mut self) {
        self.state.candidates.clear();
        self.shown.clear();
        self.shown.push_str(self.corrector.shown());
        if self.known_until.is_some() || self.shown.trim_end().is_empty() {
            return;
        }
        for candidate in self.corrector.candidates() {
            let short = candidate_text(&self.shown, &candidate.text);
            let _ = self.state.candidates.try_push(short);
        }
    }
}

impl PressFilter for TextFilter {
    fn filter(&mut self, input: &FilterInput, events: &mut Events) {
        if self.state.mode == TextMode::Literal {
            self.choice = None;
            self.is_inside_word = ends_inside_word(self.is_inside_word, input.held, events);
            return;
        }
        let was_swiping = self.ignores_presses(input.side);
        self.remember_presses(input);
        let is_lifted = self.follow_stroke(input);
        let is_pending = self.corrector.is_pending() || self.is_spaced;
        if is_pending && input.time.since(self.last_key) > IDLE_TIME {
            self.corrector.reset();
            self.is_spaced = false;
            self.is_changed = true;
        }
        let mut choice = self.choice.take_if(|_| input.may_type);
        if !events.is_empty() || choice.is_some() || is_lifted {
            let mut step = Step::new(input.held, &self.tapped, events.len());
            let given = std::mem::take(events);
            for (index, &event) in given.iter().enumerate() {
                step.waiting = given.len() - index;
                match event.kind {
                    EventKind::KeyUp(key) => {
                        if key == KeyCode::BACKSPACE {
                            self.leave_after_repeats(event.time);
                            self.backspace_since = None;
                        }
                        step.push(event);
                        continue;
                    }
                    _ => self.accept(choice.take(), event.time, &mut step),
                }
                match event.kind {
                    EventKind::KeyDown(_) | EventKind::Character(_) if was_swiping => {
                        step.swallow(event);
                    }
                    EventKind::KeyDown(_) if burst::replaces_letter(&given[index..]) => {
                        self.replace_letter(given[index + 2].kind, event, &mut step);
                    }
                    EventKind::KeyDown(key) => self.press(key, event, &mut step),
                    EventKind::Character(character) => {
                        self.last_key = event.time;
                        self.is_spaced = false;
                        if burst::is_part_of_text(&given, index) {
                            self.leave();
                            step.push(event);
                        } else {
                            self.type_character(character, event, &mut step);
                        }
                    }
                    _ => step.push(event),
                }
            }
            step.waiting = 0;
            if is_lifted {
                self.end_stroke(input.time, &mut step);
            }
            self.accept(choice, input.time, &mut step);
            self.tapped = step.tapped;
            *events = step.events;
        }
        self.forget_after_stroke();
        if std::mem::take(&mut self.is_changed) {
            self.update_candidates();
        }
    }

    fn reset(&mut self) {
        self.corrector.reset();
        self.evidence.clear();
        self.stroke = None;
        self.known_until = None;
        self.choice = None;
        self.is_spaced = false;
        self.backspace_since = None;
        self.state.candidates.clear();
    }

    fn lose_hand(&mut self, side: Side) {
        match self.stroke.as_ref().filter(|stroke| stroke.side != side) {
            Some(stroke) => {
                self.known_until = Some(stroke.start);
                self.choice = None;
                self.state.candidates.clear();
            }
            None => self.reset(),
        }
    }

    fn set_mode(&mut self, mode: TextMode) {
        let is_inside = self.is_inside_word();
        self.reset();
        self.tapped = PressedKeys::default();
        self.corrector.set_mode(decoder_mode(mode));
        self.state.mode = mode;
        self.set_inside_word(is_inside.unwrap_or_default());
    }

    fn is_inside_word(&self) -> Option<bool> {
        Some(match self.state.mode {
            TextMode::Literal => self.is_inside_word,
            _ => self.corrector.is_inside_word(),
        })
    }

    fn finds_letters(&self) -> bool {
        self.state.mode != TextMode::Literal
            && self.keys.keyboard().has_shared_keys()
            && self.corrector.knows_word()
    }

    fn set_inside_word(&mut self, is_inside: bool) {
        self.is_inside_word = is_inside;
        self.corrector.set_inside_word(is_inside);
    }

    fn take_over(&mut self, before: &dyn PressFilter) {
        let before = before.as_any().and_then(<dyn Any>::downcast_ref::<Self>);
        let Some(before) = before else { return };
        // A file that now states another mode sets it, as at the start.
        let is_kept = before.first_mode == self.first_mode;
        self.set_mode(if is_kept {
            before.state.mode
        } else {
            self.first_mode
        });
        self.corrector.take_over(&before.corrector);
        self.set_inside_word(before.is_inside_word().unwrap_or_default());
    }

    fn as_any(&self) -> Option<&dyn Any> {
        Some(self)
    }

    fn forget(&mut self) {
        let is_inside = self.is_inside_word();
        self.reset();
        self.corrector.forget();
        self.set_inside_word(is_inside.unwrap_or_default());
    }

    fn choose(&mut self, number: u8) {
        self.choice = Some(number);
    }

    fn ignores_presses(&self, side: Side) -> bool {
        let stroke = self.stroke.as_ref();
        stroke.is_some_and(|stroke| stroke.is_swipe && stroke.side == side)
    }

    fn text_state(&self) -> Option<&TextState> {
        Some(&self.state)
    }
}
