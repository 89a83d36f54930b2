//! The hand of the present step, and the hands that may not type.

use arrayvec::ArrayVec;

use super::{KeyAction, KeyArbiter, PressSource};
use crate::device::EventKind;
use crate::hand::Side;

/// Maximum number of different keys and characters that are pressed for the other hand in one step. Further ones count for the hand of the
/// step.
const MAX_PRESSES_OF_OTHER_HAND: usize = 64;

/// The hand of the present step.
#[derive(Clone, Debug)]
pub(super) struct StepHand {
    side: Side,
    /// `true` if the hand may point but not type, by side.
    pointer_only: [bool; Side::COUNT],
    /// `true` during a pause.
    is_paused: bool,
    /// The number of typing presses that were dropped because their hand may only point.
    dropped_presses: u64,
    /// The keys and characters of this step that the other hand has caused: presses that were delayed.
    of_other_hand: ArrayVec<EventKind, MAX_PRESSES_OF_OTHER_HAND>,
    /// The hand that has asked last to be zeroed.
    to_zero: Side,
}

impl Default for StepHand {
    fn default() -> Self {
        Self {
            side: Side::Right,
            pointer_only: [false; Side::COUNT],
            is_paused: false,
            dropped_presses: 0,
            of_other_hand: ArrayVec::new(),
            to_zero: Side::Right,
        }
    }
}

impl StepHand {
    /// Returns the side that causes a press of a source: the side of the touch, or the side of the step for a part of a control.
    pub(super) fn side_of(&self, source: PressSource) -> Side {
        match source {
            PressSource::Touch(side, ..) => side,
            PressSource::Part(..) => self.side,
        }
    }

    /// Records that `side` has caused the press of a key, or a character.
    pub(super) fn note_press(&mut self, side: Side, kind: EventKind) {
        if side != self.side && !self.of_other_hand.contains(&kind) {
            let _ = self.of_other_hand.try_push(kind);
        }
    }

    /// Returns `true`, and counts the press, if an action types and the hand of its source may only point.
    pub(super) fn drops(&mut self, source: PressSource, action: KeyAction) -> bool {
        let is_dropped = action.is_typing() && self.pointer_only[self.side_of(source).index()];
        self.dropped_presses += u64::from(is_dropped);
        is_dropped
    }
}

impl KeyArbiter {
    /// Begins a step of the hand of `side`. From now on, typing presses of hands that are `pointer_only`, by side, are dropped. This is
    /// checked at each press, because a delayed press may begin in a step of the other hand.
    pub fn begin_step(&mut self, side: Side, pointer_only: [bool; Side::COUNT]) {
        self.hand.side = side;
        self.hand.pointer_only = pointer_only;
        self.hand.of_other_hand.clear();
    }

    /// Sets whether the steps from now on belong to a pause, whose events are not sent.
    pub fn set_paused(&mut self, is_paused: bool) {
        self.hand.is_paused = is_paused;
    }

    /// Returns the hand of the present step.
    pub(in crate::device) fn step_side(&self) -> Side {
        self.hand.side
    }

    /// Returns `true` if the session is paused.
    pub(in crate::device) fn is_paused(&self) -> bool {
        self.hand.is_paused
    }

    /// Returns `true` if the other hand has caused this press of a key, or character, of the present step.
    pub fn is_of_other_hand(&self, kind: EventKind) -> bool {
        self.hand.of_other_hand.contains(&kind)
    }

    /// Returns `true` if the other hand has caused a press or character of the present step.
    pub fn has_press_of_other_hand(&self) -> bool {
        !self.hand.of_other_hand.is_empty()
    }

    /// Returns `true`, and counts the press, if an action types and the hand of its source may only point.
    pub(in crate::device) fn drops(&mut self, source: PressSource, action: KeyAction) -> bool {
        self.hand.drops(source, action)
    }

    /// Notes that a source has issued the command that zeroes its hand.
    pub(in crate::device) fn ask_to_zero(&mut self, source: PressSource) {
        self.hand.to_zero = self.hand.side_of(source);
    }

    /// Returns the hand that has asked last to be zeroed.
    pub fn hand_to_zero(&self) -> Side {
        self.hand.to_zero
    }

    /// Returns the number of presses dropped because their hand may only point since the last call.
    pub fn take_dropped_presses(&mut self) -> u64 {
        std::mem::take(&mut self.hand.dropped_presses)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::contact::TargetId;
    use crate::device::key_arbiter::words;
    use crate::device::{Events, KeyCode, Latch, TextId};
    use crate::hand::Finger;
    use crate::time::Timestamp;

    const LEFT_MAY_ONLY_POINT: [bool; Side::COUNT] = [true, false];

    fn key(name: &str) -> KeyCode {
        name.parse().expect("the name of a key")
    }

    fn finger(side: Side) -> PressSource {
        PressSource::Touch(side, Finger::Index, TargetId(0))
    }

    fn part(target: u32) -> PressSource {
        PressSource::Part(TargetId(target), 0)
    }

    /// Presses an action in a step of the hand of `side`, and returns the events.
    fn press(
        arbiter: &mut KeyArbiter,
        side: Side,
        source: PressSource,
        action: KeyAction,
    ) -> String {
        let mut events = Events::new();
        arbiter.begin_step(side, LEFT_MAY_ONLY_POINT);
        assert!(arbiter.press(source, action, Timestamp(0), &mut events));
        arbiter.emit_changes(Timestamp(0), &mut events);
        words(&events)
    }

    fn release(arbiter: &mut KeyArbiter, source: PressSource) -> String {
        let mut events = Events::new();
        arbiter.release(|other| other == source);
        arbiter.emit_changes(Timestamp(0), &mut events);
        words(&events)
    }

    #[test]
    fn a_part_of_a_control_presses_for_the_hand_of_the_step() {
        let mut arbiter = KeyArbiter::default();
        let shift = KeyAction::Modifier(key("ShiftLeft"), Latch::Momentary);
        assert_eq!(press(&mut arbiter, Side::Left, part(1), shift), "");
        assert!(!arbiter.has_press_from(part(1)));
        assert_eq!(
            press(&mut arbiter, Side::Right, part(2), shift),
            "+ShiftLeft"
        );
        assert_eq!(release(&mut arbiter, part(1)), "");
        assert_eq!(release(&mut arbiter, part(2)), "-ShiftLeft");
        let click = KeyAction::Key(key("MouseLeft"));
        assert_eq!(
            press(&mut arbiter, Side::Left, part(1), click),
            "+MouseLeft"
        );
        assert_eq!(arbiter.take_dropped_presses(), 1);
    }

    #[test]
    fn a_touch_presses_for_its_own_hand_in_any_step() {
        let mut arbiter = KeyArbiter::new(vec!["ab".to_owned()]);
        let a = KeyAction::Key(key("A"));
        assert_eq!(press(&mut arbiter, Side::Right, finger(Side::Left), a), "");
        assert_eq!(
            press(&mut arbiter, Side::Left, finger(Side::Right), a),
            "+A"
        );
        assert!(arbiter.is_of_other_hand(EventKind::KeyDown(key("A"))));
        assert!(arbiter.has_press_of_other_hand());
        let text = KeyAction::Text(TextId(0));
        assert_eq!(
            press(&mut arbiter, Side::Left, finger(Side::Right), text),
            "a b"
        );
        assert!(arbiter.is_of_other_hand(EventKind::Character('b')));
        assert!(!arbiter.is_of_other_hand(EventKind::KeyDown(key("A"))));
        assert_eq!(
            press(&mut arbiter, Side::Right, finger(Side::Right), text),
            "a b"
        );
        assert!(!arbiter.has_press_of_other_hand());
    }

    #[test]
    fn a_suppressed_key_is_held_by_nothing_until_it_is_pressed_again() {
        let mut arbiter = KeyArbiter::default();
        let lock = KeyAction::Modifier(key("MetaLeft"), Latch::Lock);
        for source in [part(1), part(2)] {
            assert_eq!(press(&mut arbiter, Side::Right, source, lock), "+MetaLeft");
            arbiter.suppress_key(key("MetaLeft"));
            assert!(arbiter.has_press_from(source));
        }
        assert_eq!(release(&mut arbiter, part(1)), "");
        assert_eq!(release(&mut arbiter, part(2)), "", "it is not locked");
        assert!(arbiter.is_idle());
        assert_eq!(press(&mut arbiter, Side::Right, part(1), lock), "+MetaLeft");
        assert_eq!(release(&mut arbiter, part(1)), "", "it is locked");
        arbiter.suppress_key(key("MetaLeft"));
        assert!(arbiter.is_idle());
        assert_eq!(release(&mut arbiter, part(1)), "");
    }

    #[test]
    fn a_suppressed_one_shot_is_not_held_during_the_key_that_it_is_meant_for() {
        let mut arbiter = KeyArbiter::default();
        let meta = KeyAction::Modifier(key("MetaLeft"), Latch::OneShot);
        assert_eq!(press(&mut arbiter, Side::Right, part(1), meta), "");
        assert_eq!(release(&mut arbiter, part(1)), "");
        let a = KeyAction::Key(key("A"));
        let pressed = press(&mut arbiter, Side::Right, part(2), a);
        assert_eq!(pressed, "+MetaLeft +A");
        arbiter.suppress_key(key("MetaLeft"));
        let b = KeyAction::Key(key("B"));
        assert_eq!(
            press(&mut arbiter, Side::Right, part(3), KeyAction::Clutch),
            ""
        );
        assert_eq!(press(&mut arbiter, Side::Right, part(4), b), "+B");
    }

    #[test]
    fn a_one_shot_comes_up_with_a_key_that_is_lost() {
        let mut arbiter = KeyArbiter::default();
        let shift = KeyAction::Modifier(key("ShiftLeft"), Latch::OneShot);
        press(&mut arbiter, Side::Right, part(1), shift);
        release(&mut arbiter, part(1));
        let a = KeyAction::Key(key("A"));
        let pressed = press(&mut arbiter, Side::Right, part(2), a);
        assert_eq!(pressed, "+ShiftLeft +A");
        let mut events = Events::new();
        arbiter.cancel(|other| other == part(2));
        arbiter.emit_changes(Timestamp(0), &mut events);
        assert_eq!(words(&events), "-A -ShiftLeft");
        assert!(arbiter.is_idle());
    }

    #[test]
    fn a_lost_hand_ends_what_it_has_locked_and_armed() {
        let mut arbiter = KeyArbiter::default();
        let control = KeyAction::Modifier(key("ControlLeft"), Latch::Lock);
        let alt = KeyAction::Modifier(key("AltLeft"), Latch::OneShot);
        let layer = KeyAction::Layer(1, Latch::Lock);
        for action in [control, alt, layer] {
            press(&mut arbiter, Side::Right, finger(Side::Right), action);
            release(&mut arbiter, finger(Side::Right));
        }
        arbiter.release_hand(Side::Left);
        assert_eq!(release(&mut arbiter, part(0)), "");
        assert_eq!(arbiter.active_layer(), 1);
        arbiter.release_hand(Side::Right);
        assert_eq!(release(&mut arbiter, part(0)), "-ControlLeft");
        assert_eq!(arbiter.active_layer(), 0);
        let a = KeyAction::Key(key("A"));
        assert_eq!(
            press(&mut arbiter, Side::Right, finger(Side::Right), a),
            "+A"
        );
    }
}
