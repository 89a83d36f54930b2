//! Sequences: keys, texts and waits that one press starts.

use std::time::Duration;

use arrayvec::ArrayVec;

use super::{KeyArbiter, TextId};
use crate::device::{Capabilities, Capability, Events, KeyCode};
use crate::hand::Side;
use crate::time::Timestamp;

/// The maximum number of keys that a sequence holds at once.
pub const MAX_SEQUENCE_KEYS: usize = 4;

/// The time after a text for each of its characters, before the next step. A receiver needs it to read them.
pub const TIME_PER_CHARACTER: Duration = Duration::from_millis(5);

/// The steps that a press starts.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct Sequence {
    /// The name.
    pub name: String,
    /// The steps, in order. Every key that they press is released later.
    pub steps: Vec<SequenceStep>,
}

/// The index of a sequence in the list of the [`KeyArbiter`].
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct SequenceId(pub u16);

/// A step of a sequence. A sequence takes at most one step per reading.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum SequenceStep {
    /// Presses a key, in addition to those that the sequence holds.
    Press(KeyCode),
    /// Releases all keys that the sequence holds.
    Release,
    /// Types a text.
    Text(TextId),
    /// Waits.
    Wait(Duration),
}

impl Sequence {
    /// Adds the capabilities that an output needs for it.
    pub fn add_capabilities(&self, required: &mut Capabilities) {
        let capabilities = self.steps.iter().filter_map(|step| match *step {
            SequenceStep::Press(code) => Some(Capability::Key(code)),
            SequenceStep::Text(_) => Some(Capability::Text),
            SequenceStep::Release | SequenceStep::Wait(_) => None,
        });
        required.extend(capabilities);
    }
}

/// The hand of a step, for the sequence that one of its presses has started.
#[derive(Clone, Copy, Debug)]
pub struct SequenceHand {
    /// The hand.
    pub side: Side,
    /// The time of its reading.
    pub time: Timestamp,
    /// `true` if its position is known.
    pub is_placed: bool,
    /// `true` if a finger is measured.
    pub is_seen: bool,
    /// Time between two presses of a sequence.
    pub press_gap: Duration,
}

/// The sequence that runs.
#[derive(Clone, Debug)]
pub(super) struct RunningSequence {
    index: usize,
    next: usize,
    /// The time of the next step.
    due: Timestamp,
    performer: Performer,
    /// The keys that it holds, in order of pressing.
    pub(super) keys: ArrayVec<KeyCode, MAX_SEQUENCE_KEYS>,
}

impl RunningSequence {
    pub(super) fn new(SequenceId(index): SequenceId, side: Side, time: Timestamp) -> Self {
        Self {
            index: index.into(),
            next: 0,
            due: time,
            performer: Performer::new(side),
            keys: ArrayVec::new(),
        }
    }

    /// Returns the hand that has started it.
    pub(super) fn side(&self) -> Side {
        self.performer.side
    }
}

/// The hand that has started an action that continues after its press.
#[derive(Clone, Copy, Debug)]
pub(super) struct Performer {
    side: Side,
    was_placed: bool,
}

impl Performer {
    pub(super) fn new(side: Side) -> Self {
        Self {
            side,
            was_placed: false,
        }
    }

    /// Returns `true` if the hand of a step is lost; `None` if it is the other hand.
    pub(super) fn is_lost(&mut self, hand: &SequenceHand) -> Option<bool> {
        if self.side != hand.side {
            return None;
        }
        let is_lost = !hand.is_seen || self.was_placed && !hand.is_placed;
        self.was_placed = hand.is_placed;
        Some(is_lost)
    }
}

impl KeyArbiter {
    /// Sets the sequences that presses start. `sequences[i]` is the sequence of [`SequenceId`] `i`.
    #[must_use]
    pub fn with_sequences(self, sequences: Vec<Sequence>) -> Self {
        Self { sequences, ..self }
    }

    /// Returns `true` if a sequence runs.
    pub fn runs_sequence(&self) -> bool {
        self.running.is_some()
    }

    /// Executes the step of the running sequence that is due. The sequence runs only in steps of the hand that has started it, and
    /// ends when that hand is lost. Each press and text follows the previous step by `press_gap` or more: a late step delays the rest. A
    /// step for which there is no room is executed later.
    pub fn advance_sequence(&mut self, hand: &SequenceHand, events: &mut Events) {
        let Some(running) = &mut self.running else {
            return;
        };
        match running.performer.is_lost(hand) {
            None => return,
            Some(true) => return self.end_sequence(hand.time, events),
            Some(false) => {}
        }
        if hand.time < running.due {
            return;
        }
        let (index, next) = (running.index, running.next);
        let steps = self.sequences.get(index).map(|it| it.steps.as_slice());
        let Some(&step) = steps.and_then(|steps| steps.get(next)) else {
            self.end_sequence(hand.time, events);
            return;
        };
        let Some(gap) = self.take_step(step, hand, events) else {
            return;
        };
        if let Some(sequence) = &mut self.running {
            sequence.next += 1;
            sequence.due = hand.time + gap;
        }
    }

    /// Executes a step and returns the time until the next one; `None` if there is no room for it.
    fn take_step(
        &mut self,
        step: SequenceStep,
        hand: &SequenceHand,
        events: &mut Events,
    ) -> Option<Duration> {
        match step {
            SequenceStep::Press(code) => {
                if !self.has_room_for_key(events) {
                    return None;
                }
                self.running.as_mut()?.keys.try_push(code).ok()?;
                self.emit_changes(hand.time, events);
            }
            SequenceStep::Release => {
                self.running.as_mut()?.keys.clear();
                self.emit_changes(hand.time, events);
            }
            SequenceStep::Text(text) => {
                if !self.write(text, hand.side, hand.time, events) {
                    return None;
                }
                let length = self.text_length(text);
                return Some(hand.press_gap.max(TIME_PER_CHARACTER * length));
            }
            SequenceStep::Wait(time) => return Some(time),
        }
        Some(hand.press_gap)
    }

    /// Ends the running sequence. The next [`emit_changes`](Self::emit_changes) releases its keys.
    pub fn abandon_sequence(&mut self) {
        self.running = None;
    }

    /// Ends the running sequence, if there is one, and releases its keys. The rest of it is not typed.
    pub(super) fn end_sequence(&mut self, time: Timestamp, events: &mut Events) {
        if self.running.take().is_some() {
            self.emit_changes(time, events);
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::contact::TargetId;
    use crate::device::key_arbiter::{MODIFIER_COUNT, words};
    use crate::device::{EventKind, KeyAction, Latch, PressSource};
    use crate::hand::Finger;

    const GAP: Duration = Duration::from_millis(30);

    fn key(name: &str) -> KeyCode {
        name.parse().expect("the name of a key")
    }

    /// Returns an arbiter with a long text, whose only sequence copies, waits for a second and types.
    fn arbiter() -> KeyArbiter {
        let steps = vec![
            SequenceStep::Press(key("ControlLeft")),
            SequenceStep::Press(key("C")),
            SequenceStep::Release,
            SequenceStep::Wait(Duration::from_secs(1)),
            SequenceStep::Text(TextId(0)),
        ];
        let name = "copy".to_owned();
        let texts = vec!["ok".to_owned(), "x".repeat(40)];
        KeyArbiter::new(texts).with_sequences(vec![Sequence { name, steps }])
    }

    fn finger(side: Side, target: u32) -> PressSource {
        PressSource::Touch(side, Finger::Index, TargetId(target))
    }

    /// Starts the sequence with the right hand, at time 0.
    fn start(arbiter: &mut KeyArbiter) {
        press(arbiter, 0, KeyAction::Sequence(SequenceId(0)), 0);
    }

    /// Presses an action with the right hand and returns the events.
    fn press(arbiter: &mut KeyArbiter, target: u32, action: KeyAction, ms: u64) -> String {
        let (mut events, time) = (Events::new(), Timestamp(ms * 1_000));
        assert!(arbiter.press(finger(Side::Right, target), action, time, &mut events));
        arbiter.emit_changes(time, &mut events);
        words(&events)
    }

    fn hand(side: Side, ms: u64) -> SequenceHand {
        SequenceHand {
            side,
            time: Timestamp(ms * 1_000),
            is_placed: true,
            is_seen: true,
            press_gap: GAP,
        }
    }

    fn advance(arbiter: &mut KeyArbiter, hand: SequenceHand) -> String {
        let mut events = Events::new();
        arbiter.advance_sequence(&hand, &mut events);
        words(&events)
    }

    /// Takes a step of the right hand every 10 ms until `end`, and returns the events with their times in milliseconds.
    fn run(arbiter: &mut KeyArbiter, start: u64, end: u64) -> String {
        let steps = (start..end).step_by(10);
        let steps = steps.map(|ms| (ms, advance(arbiter, hand(Side::Right, ms))));
        let steps = steps.filter(|(_, words)| !words.is_empty());
        let steps: Vec<String> = steps.map(|(ms, words)| format!("{ms}: {words}")).collect();
        steps.join(", ")
    }

    #[test]
    fn each_press_takes_a_step_of_its_own_and_keys_are_released_together() {
        let mut arbiter = arbiter();
        start(&mut arbiter);
        let expected = "0: +ControlLeft, 30: +C, 60: -C -ControlLeft, 1090: o k";
        assert_eq!(run(&mut arbiter, 0, 3_000), expected);
        assert!(!arbiter.runs_sequence());
    }

    #[test]
    fn a_late_step_delays_the_rest() {
        let mut arbiter = arbiter();
        start(&mut arbiter);
        assert_eq!(
            run(&mut arbiter, 500, 580),
            "500: +ControlLeft, 530: +C, 560: -C -ControlLeft"
        );
    }

    #[test]
    fn a_press_while_it_runs_starts_it_no_second_time() {
        let mut arbiter = arbiter();
        start(&mut arbiter);
        assert_eq!(
            run(&mut arbiter, 0, 100),
            "0: +ControlLeft, 30: +C, 60: -C -ControlLeft"
        );
        start(&mut arbiter);
        assert_eq!(run(&mut arbiter, 100, 3_000), "1090: o k");
        arbiter.release(|_| true);
        start(&mut arbiter);
        assert!(arbiter.runs_sequence());
    }

    #[test]
    fn a_press_of_the_person_ends_it_after_the_release_of_its_keys() {
        for (action, expected) in [
            (KeyAction::Key(key("Q")), "-ControlLeft +Q"),
            (KeyAction::Key(key("MouseLeft")), "-ControlLeft +MouseLeft"),
            (KeyAction::Text(TextId(0)), "-ControlLeft o k"),
            (
                KeyAction::Modifier(key("AltLeft"), Latch::Momentary),
                "-ControlLeft +AltLeft",
            ),
        ] {
            let mut arbiter = arbiter();
            start(&mut arbiter);
            assert_eq!(run(&mut arbiter, 0, 20), "0: +ControlLeft");
            assert_eq!(press(&mut arbiter, 1, action, 20), expected);
            assert_eq!(run(&mut arbiter, 30, 3_000), "");
        }
    }

    #[test]
    fn a_layer_and_a_command_do_not_end_it() {
        let mut arbiter = arbiter();
        start(&mut arbiter);
        press(&mut arbiter, 1, KeyAction::Layer(1, Latch::Momentary), 0);
        press(&mut arbiter, 2, KeyAction::Clutch, 0);
        assert!(arbiter.runs_sequence());
    }

    #[test]
    fn a_modifier_of_the_person_stays_down() {
        let mut arbiter = arbiter();
        let control = KeyAction::Modifier(key("ControlLeft"), Latch::Momentary);
        assert_eq!(press(&mut arbiter, 1, control, 0), "+ControlLeft");
        start(&mut arbiter);
        assert_eq!(run(&mut arbiter, 0, 200), "30: +C, 60: -C");
    }

    #[test]
    fn it_runs_in_steps_of_its_hand_and_ends_when_that_is_lost() {
        let lost = SequenceHand {
            is_seen: false,
            ..hand(Side::Right, 20)
        };
        let nowhere = SequenceHand {
            is_placed: false,
            ..hand(Side::Right, 20)
        };
        for gone in [lost, nowhere] {
            let mut arbiter = arbiter();
            start(&mut arbiter);
            assert_eq!(advance(&mut arbiter, hand(Side::Left, 10)), "");
            assert_eq!(advance(&mut arbiter, hand(Side::Right, 10)), "+ControlLeft");
            let other = SequenceHand {
                side: Side::Left,
                ..gone
            };
            assert_eq!(advance(&mut arbiter, other), "");
            assert!(arbiter.runs_sequence());
            assert_eq!(advance(&mut arbiter, gone), "-ControlLeft");
            assert_eq!(run(&mut arbiter, 30, 3_000), "");
        }
    }

    #[test]
    fn releasing_everything_ends_it() {
        let mut arbiter = arbiter();
        start(&mut arbiter);
        assert_eq!(run(&mut arbiter, 0, 20), "0: +ControlLeft");
        let mut events = Events::new();
        arbiter.release_all(Timestamp(20_000), &mut events);
        assert_eq!(words(&events), "-ControlLeft");
        assert_eq!(run(&mut arbiter, 30, 3_000), "");
    }

    #[test]
    fn a_step_without_room_is_taken_later() {
        let mut arbiter = arbiter();
        start(&mut arbiter);
        arbiter.advance_sequence(&hand(Side::Right, 0), &mut with_room(0));
        assert_eq!(run(&mut arbiter, 10, 20), "10: +ControlLeft");
    }

    /// Returns a list with room for this number of events.
    fn with_room(room: usize) -> Events {
        let event = crate::device::OutputEvent {
            time: Timestamp(0),
            kind: EventKind::MoveBy(1, 0),
        };
        let mut events = Events::new();
        while events.remaining_capacity() > room {
            events.push(event);
        }
        events
    }

    #[test]
    fn a_text_without_room_is_typed_whole_in_a_later_step() {
        let mut arbiter = arbiter();
        start(&mut arbiter);
        run(&mut arbiter, 0, 1_090);
        // One event less than the text and the room for releases take.
        let full = with_room(2 + 1 + MODIFIER_COUNT);
        let mut events = full.clone();
        arbiter.advance_sequence(&hand(Side::Right, 1_090), &mut events);
        assert_eq!(events, full);
        assert_eq!(run(&mut arbiter, 1_100, 3_000), "1100: o k");
    }

    #[test]
    fn a_text_of_the_person_without_room_does_not_end_it() {
        let mut arbiter = arbiter();
        start(&mut arbiter);
        assert_eq!(run(&mut arbiter, 0, 20), "0: +ControlLeft");
        let full = with_room(40);
        assert!(arbiter.has_room(&full));
        let mut events = full.clone();
        let (text, time) = (KeyAction::Text(TextId(1)), Timestamp(20_000));
        assert!(!arbiter.press(finger(Side::Right, 1), text, time, &mut events));
        assert_eq!(events, full);
        assert!(!arbiter.has_press_from(finger(Side::Right, 1)));
        assert_eq!(
            run(&mut arbiter, 20, 3_000),
            "30: +C, 60: -C -ControlLeft, 1090: o k"
        );
    }
}
