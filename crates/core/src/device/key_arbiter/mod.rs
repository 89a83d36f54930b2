//! The keys that should be down, from the presses of all controls of a layout.

mod action;
mod locks;
mod multitap;
mod one_shots;
mod sequence;
mod step_hand;
mod tap_pace;

pub use self::action::{KeyAction, Latch, TextId};
pub use self::multitap::{Multitap, MultitapId, Multitaps};
pub use self::sequence::{
    MAX_SEQUENCE_KEYS, Sequence, SequenceHand, SequenceId, SequenceStep, TIME_PER_CHARACTER,
};

use arrayvec::ArrayVec;

use self::locks::Locks;
use self::multitap::Cycle;
use self::one_shots::OneShots;
use self::sequence::RunningSequence;
use self::step_hand::StepHand;
use self::tap_pace::TapPace;
use super::pressed_keys::PressedKeys;
use super::{EventKind, Events, KeyCode, OutputEvent};
use crate::contact::{TargetId, Touch};
use crate::hand::{Finger, Side};
use crate::time::Timestamp;

/// The number of modifier keys.
pub(super) const MODIFIER_COUNT: usize = 8;

/// Maximum number of presses: ten fingers, and 30 controls that stay on, such as toggle switches. Further presses are refused.
const MAX_PRESSES: usize = 40;

/// Maximum number of keys that are down: one per press, the modifiers, and the keys of a sequence.
const MAX_PRESSED_KEYS: usize = MAX_PRESSES + MODIFIER_COUNT + MAX_SEQUENCE_KEYS;

/// Decides which keys are down when several controls, modifiers and layers share them.
///
/// Each press belongs to its source and ends only there. A key that two presses hold goes down with the
/// first and up with the last. A press keeps its action when the layer changes. A press that does not fit
/// into the event list is refused; a release never is.
#[derive(Clone, Debug, Default)]
pub struct KeyArbiter {
    texts: Vec<String>,
    sequences: Vec<Sequence>,
    /// The sequence that runs. Only one runs at a time.
    running: Option<RunningSequence>,
    multitaps: Multitaps,
    /// `true` if a text decoder finds the letters of words, so that each of several consecutive taps is a letter.
    first_letters_only: bool,
    /// The letter that another tap replaces, until another press, a time-out or a loss.
    cycle: Option<Cycle>,
    /// The number of presses that replaced letters.
    replacing_presses: usize,
    /// The presses, in the order in which they began.
    presses: ArrayVec<Press, MAX_PRESSES>,
    one_shots: OneShots,
    locks: Locks,
    /// The keys that are down for the receiver, in order of pressing.
    pressed_keys: ArrayVec<PressedKey, MAX_PRESSED_KEYS>,
    /// The time of the last event; times never decrease.
    time: Timestamp,
    hand: StepHand,
    tap_pace: TapPace,
}

/// The source of a press.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum PressSource {
    /// A fingertip on a target.
    Touch(Side, Finger, TargetId),
    /// A part of a control, such as the left side of a joystick.
    Part(TargetId, u8),
}

impl PressSource {
    /// Returns the fingertip and the target of a touch.
    pub fn from_touch(touch: &Touch) -> Self {
        Self::Touch(touch.side, touch.finger, touch.target)
    }
}

#[derive(Clone, Copy, Debug)]
struct Press {
    source: PressSource,
    /// The hand that presses.
    side: Side,
    action: KeyAction,
    /// `true` for a one-shot or lock during whose hold another key was pressed: it acts as momentary.
    is_used: bool,
    /// `true` for a one-shot or lock that a tap activates; `false` if this press has ended an active one.
    latches: bool,
    /// `true` if the press of its key was suppressed: it holds nothing.
    is_suppressed: bool,
}

#[derive(Clone, Copy, Debug, PartialEq, Eq)]
struct PressedKey {
    code: KeyCode,
    is_modifier: bool,
    /// The hand that has pressed it first.
    side: Side,
}

impl KeyArbiter {
    /// Creates an arbiter with nothing pressed. `texts[i]` is the text of [`TextId`] `i`.
    pub fn new(texts: Vec<String>) -> Self {
        Self {
            texts,
            ..Self::default()
        }
    }

    /// Returns the keys that are down for the receiver.
    pub fn pressed_keys(&self) -> PressedKeys {
        let mut pressed = PressedKeys::default();
        for key in &self.pressed_keys {
            pressed.press(key.code);
        }
        pressed
    }

    /// Returns the active layer, 0 for the base layer: the layer of the layer key pressed last, or else the
    /// one-shot layer, or else the locked one.
    pub fn active_layer(&self) -> usize {
        let pressed = self
            .presses
            .iter()
            .rev()
            .find_map(|press| match press.action {
                KeyAction::Layer(layer, _) => Some(layer),
                _ => None,
            });
        let latched = self.one_shots.layer.or(self.locks.layer);
        pressed.or(latched.map(|(layer, _)| layer)).unwrap_or(0)
    }

    /// Returns `true` if a key is down for the receiver.
    fn is_down(&self, code: KeyCode) -> bool {
        self.pressed_keys.iter().any(|key| key.code == code)
    }

    /// Returns `true` if an action is pressed.
    pub fn is_pressed(&self, action: KeyAction) -> bool {
        self.presses.iter().any(|press| press.action == action)
    }

    /// Returns `true` if a source presses anything.
    pub fn has_press_from(&self, source: PressSource) -> bool {
        self.presses.iter().any(|press| press.source == source)
    }

    /// Returns `true` if nothing is pressed, no key is down and no sequence runs.
    pub fn is_idle(&self) -> bool {
        self.presses.is_empty() && self.pressed_keys.is_empty() && self.running.is_none()
    }

    /// Returns the time of the last event.
    pub fn last_event_time(&self) -> Timestamp {
        self.time
    }

    /// Returns `true` if a press fits: after it and its modifiers there must be room to release everything
    /// that is down. This is why a press may be dropped and a release never is.
    pub fn has_room(&self, events: &Events) -> bool {
        !self.presses.is_full() && self.has_room_for_key(events)
    }

    /// Returns `true` if a key that goes down fits into the event list, however many presses there are.
    fn has_room_for_key(&self, events: &Events) -> bool {
        let max_pressed = self.pressed_keys.len() + 1 + MODIFIER_COUNT;
        events.remaining_capacity() >= 1 + MODIFIER_COUNT + max_pressed
    }

    /// Starts a press. Returns `false`, and starts none, if there is no room. The keys that it holds are
    /// emitted by the next [`emit_changes`](Self::emit_changes). A typing press of a hand that may only point is dropped: the result is
    /// `true`, and the source presses nothing.
    ///
    /// [`KeyAction::Command`] only counts as pressed here; [`DeviceOutput`](super::DeviceOutput) issues it. A sequence that runs
    /// ends before the press of a key, button or text, so that its keys and the person's do not mix. Any press but the next tap of
    /// the same multitap key keeps the letter that was chosen last.
    pub fn press(
        &mut self,
        source: PressSource,
        action: KeyAction,
        time: Timestamp,
        events: &mut Events,
    ) -> bool {
        if self.drops(source, action) {
            return true;
        }
        let side = self.hand.side_of(source);
        let has_room = match action {
            KeyAction::Text(text) => self.has_room_for_text(text, events),
            _ => true,
        };
        if !has_room || !self.has_room(events) {
            return false;
        }
        if action.ends_sequence() {
            self.end_sequence(time, events);
        }
        let cycle = self.cycle.take();
        match action {
            KeyAction::Multitap(letters)
                if !self.tap_multitap(letters, source, cycle, time, events) =>
            {
                return false;
            }
            KeyAction::Text(text) if !self.write(text, side, time, events) => return false,
            KeyAction::Sequence(sequence) if self.running.is_none() => {
                self.running = Some(RunningSequence::new(sequence, side, time));
            }
            _ => {}
        }
        let was_one_shot = self.one_shots.deactivate(action);
        let was_locked = self.locks.deactivate(action);
        match action {
            KeyAction::Key(_) => self.apply_one_shots(source),
            KeyAction::Text(_) => self.use_layers(),
            _ => {}
        }
        self.presses.push(Press {
            source,
            side,
            action,
            is_used: false,
            latches: !was_one_shot && !was_locked,
            is_suppressed: false,
        });
        true
    }

    /// Ends the presses of matching sources, as taps. Their keys are released by the next
    /// [`emit_changes`](Self::emit_changes).
    pub fn release(&mut self, matches: impl Fn(PressSource) -> bool) {
        self.end(matches, true);
    }

    /// Ends the presses of matching sources that were lost or slid off: none of them counts as a tap.
    pub fn cancel(&mut self, matches: impl Fn(PressSource) -> bool) {
        self.end(matches, false);
    }

    /// Emits the difference between the pressed and the wanted keys, releases first. A release that does not
    /// fit into the event list is retried by the next call.
    pub fn emit_changes(&mut self, time: Timestamp, events: &mut Events) {
        if self.pressed_keys.is_empty() && self.wants_nothing() {
            return;
        }
        let wanted = self.wanted_keys();
        self.release_unwanted(&wanted, time, events);
        for &key in &wanted {
            if self.is_down(key.code) || self.pressed_keys.is_full() {
                continue;
            }
            if self.push_press(key.side, time, EventKind::KeyDown(key.code), events) {
                self.pressed_keys.push(key);
            }
        }
    }

    /// Ends all presses, one-shots, locks, the sequence that runs and the choice of a letter, and releases all keys.
    pub fn release_all(&mut self, time: Timestamp, events: &mut Events) {
        self.running = None;
        self.cycle = None;
        self.presses.clear();
        self.one_shots = OneShots::default();
        self.locks = Locks::default();
        self.time = self.time.max(time);
        self.release_unwanted(&[], time, events);
    }

    /// Ends the one-shots and locks of a hand that is lost. The presses of its fingers end with their touches.
    pub fn release_hand(&mut self, side: Side) {
        self.one_shots.release_hand(side);
        self.locks.release_hand(side);
    }

    /// Ends the one-shots that a hand has armed. A one-shot that is active for a press ends with that press.
    pub fn end_one_shots(&mut self, side: Side) {
        self.one_shots.release_hand(side);
    }

    /// Records that the output gate suppressed the press of a key. The presses of this key hold nothing until they end, and do not count
    /// as taps that lock; a later press presses the key again.
    pub fn suppress_key(&mut self, code: KeyCode) {
        let Some(index) = self.pressed_keys.iter().position(|key| key.code == code) else {
            return;
        };
        self.pressed_keys.remove(index);
        self.locks.unlock(code);
        self.one_shots.active.retain(|(active, _)| *active != code);
        for press in &mut self.presses {
            if matches!(press.action, KeyAction::Key(key) | KeyAction::Modifier(key, _) if key == code)
            {
                press.is_suppressed = true;
                press.latches = false;
            }
        }
        self.running.take_if(|running| running.keys.contains(&code));
    }

    /// Emits an event that is neither a press nor a release. Returns `false` if it would take the room that
    /// releases need.
    pub fn emit(&mut self, time: Timestamp, kind: EventKind, events: &mut Events) -> bool {
        events.remaining_capacity() > self.pressed_keys.len() && self.push_event(time, kind, events)
    }

    /// Applies the armed one-shots to the key press of a source.
    fn apply_one_shots(&mut self, source: PressSource) {
        self.one_shots.apply_to(source);
        for press in &mut self.presses {
            press.is_used = true;
        }
    }

    /// Ends the one-shot layer. Layer keys that are pressed act as momentary. A text leaves modifiers as they are.
    fn use_layers(&mut self) {
        self.one_shots.layer = None;
        for press in &mut self.presses {
            press.is_used |= matches!(press.action, KeyAction::Layer(..));
        }
    }

    /// Returns `true` if a text fits into the event list, and room for releases is left.
    fn has_room_for_text(&self, TextId(text): TextId, events: &Events) -> bool {
        let text = self.texts.get(usize::from(text));
        let for_releases = self.pressed_keys.len() + 1 + MODIFIER_COUNT;
        text.is_some_and(|text| events.remaining_capacity() > text.chars().count() + for_releases)
    }

    /// Emits a text, or nothing if not all of it fits.
    fn write(&mut self, text: TextId, side: Side, time: Timestamp, events: &mut Events) -> bool {
        let time = self.time.max(time);
        let fits = self.has_room_for_text(text, events);
        let Some(text) = self.texts.get(usize::from(text.0)).filter(|_| fits) else {
            return false;
        };
        for kind in text.chars().map(EventKind::Character) {
            self.hand.note_press(side, kind);
            events.push(OutputEvent { time, kind });
        }
        self.time = time;
        true
    }

    /// Returns the number of characters of a text.
    fn text_length(&self, TextId(text): TextId) -> u32 {
        let text = self.texts.get(usize::from(text));
        text.map_or(0, |text| text.chars().count() as u32)
    }

    fn end(&mut self, matches: impl Fn(PressSource) -> bool, is_tap: bool) {
        let (one_shots, locks) = (&mut self.one_shots, &mut self.locks);
        let cycle = &mut self.cycle;
        self.presses.retain(|press| {
            if !matches(press.source) {
                return true;
            }
            if !is_tap && matches!(press.action, KeyAction::Multitap(_)) {
                *cycle = None;
            }
            one_shots.end_press(press, is_tap);
            locks.end_press(press, is_tap);
            false
        });
    }

    /// Returns `true` if no key should be down now.
    fn wants_nothing(&self) -> bool {
        let modifiers = self.locks.modifiers.is_empty() && self.one_shots.active.is_empty();
        modifiers && self.presses.is_empty() && self.sequence_keys().is_empty()
    }

    /// Returns the keys that the running sequence holds.
    fn sequence_keys(&self) -> &[KeyCode] {
        let running = self.running.as_ref();
        running.map_or(&[], |running| running.keys.as_slice())
    }

    /// Returns the keys that should be down now, modifiers first.
    fn wanted_keys(&self) -> ArrayVec<PressedKey, MAX_PRESSED_KEYS> {
        let mut wanted = ArrayVec::new();
        let mut add = |code: KeyCode, is_modifier: bool, side: Side| {
            if !wanted.iter().any(|other: &PressedKey| other.code == code) {
                let _ = wanted.try_push(PressedKey {
                    code,
                    is_modifier,
                    side,
                });
            }
        };
        let presses = self.presses.iter().filter(|press| !press.is_suppressed);
        for press in presses.clone() {
            match press.action {
                KeyAction::Modifier(_, Latch::OneShot) if !press.is_used => {}
                KeyAction::Modifier(code, _) => add(code, true, press.side),
                _ => {}
            }
        }
        for &(code, side) in self.locks.modifiers.iter().chain(&self.one_shots.active) {
            add(code, true, side);
        }
        let sequence_keys = self.sequence_keys().iter().copied();
        let performer = self.running.as_ref().map(RunningSequence::side);
        let sequence_side = performer.unwrap_or(Side::Right);
        for code in sequence_keys.clone().filter(|code| code.is_modifier()) {
            add(code, true, sequence_side);
        }
        for press in presses {
            if let KeyAction::Key(code) = press.action {
                add(code, false, press.side);
            }
        }
        for code in sequence_keys.filter(|code| !code.is_modifier()) {
            add(code, false, sequence_side);
        }
        wanted
    }

    /// Releases the keys that are down but not wanted: in reverse order of pressing, modifiers last.
    fn release_unwanted(&mut self, wanted: &[PressedKey], time: Timestamp, events: &mut Events) {
        for is_modifier in [false, true] {
            for index in (0..self.pressed_keys.len()).rev() {
                let key = self.pressed_keys[index];
                let is_wanted = wanted.iter().any(|other| other.code == key.code);
                if is_wanted || key.is_modifier != is_modifier {
                    continue;
                }
                if self.push_event(time, EventKind::KeyUp(key.code), events) {
                    self.pressed_keys.remove(index);
                }
            }
        }
    }

    /// Emits the press of a key for a hand.
    fn push_press(
        &mut self,
        side: Side,
        time: Timestamp,
        kind: EventKind,
        events: &mut Events,
    ) -> bool {
        let has_room = self.push_event(time, kind, events);
        if has_room {
            self.hand.note_press(side, kind);
        }
        has_room
    }

    fn push_event(&mut self, time: Timestamp, kind: EventKind, events: &mut Events) -> bool {
        let time = self.time.max(time);
        let has_room = events.try_push(OutputEvent { time, kind }).is_ok();
        if has_room {
            self.time = time;
        }
        has_room
    }
}

/// Returns events as text, for tests of the parts: `+A` for a press, `-A` for a release, and characters.
#[cfg(test)]
fn words(events: &Events) -> String {
    let words = events.iter().map(|event| match event.kind {
        EventKind::KeyDown(code) => format!("+{code}"),
        EventKind::KeyUp(code) => format!("-{code}"),
        EventKind::Character(character) => character.to_string(),
        kind => panic!("{kind:?}"),
    });
    words.collect::<Vec<_>>().join(" ")
}
