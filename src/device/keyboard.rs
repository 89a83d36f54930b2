//! A keyboard: touches of keys become presses, with modifiers and layers.

mod binding;
mod debounce;
mod chords;
mod depths;
mod dwell;
mod pending;

pub use self::binding::{Activation, KeyBinding, TapHold};
pub use self::chords::{Chord, MAX_CHORD_KEYS};

use arrayvec::ArrayVec;

use self::chords::Chords;
use self::debounce::Bounces;
use self::depths::Depths;
use self::dwell::Dwell;
use self::pending::Waiting;
use super::target_index::Places;
use super::{Capabilities, DeviceInput, DeviceOutput, KeyAction, PressSource, VirtualDevice};
use crate::contact::{MAX_TOUCHES, Phase, TargetId, Touch};
use crate::hand::{FINGERS_OF_BOTH_HANDS, FingerSet};
use crate::time::Timestamp;

/// Turns touches into presses.
///
/// What a key does is settled when it is pressed; it comes up as what it went down, whatever the
/// layer is by then. Every press belongs to its finger and target: nothing else ends it.
///
/// In a frame, what was down before comes up first, then presses follow in order of time, then the ends
/// of presses of the same frame. Where that order is not the order of time, the later event is dated
/// forward; times never go back. What fires when it is let go of counts as a press of that moment.
#[derive(Clone, Debug)]
pub struct Keyboard {
    bindings: Vec<KeyBinding>,
    places: Places,
    /// Presses of which it is not known yet what they do, in order of pressing.
    waiting: ArrayVec<Waiting, FINGERS_OF_BOTH_HANDS>,
    dwells: ArrayVec<Dwell, FINGERS_OF_BOTH_HANDS>,
    chords: Chords,
    bounces: Bounces,
    depths: Depths,
}

/// The touches of a frame, in the order in which a keyboard takes them.
type Sorted<'a> = ArrayVec<(Turn, Timestamp, usize, &'a Touch), MAX_TOUCHES>;

/// When in a frame a touch is taken.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
enum Turn {
    EndsOld,
    Begins,
    EndsNew,
}

impl Keyboard {
    /// A keyboard with nothing pressed. Of several bindings for one target the first counts;
    /// targets without a binding do nothing.
    pub fn new(bindings: Vec<KeyBinding>) -> Self {
        Self {
            bounces: Bounces::new(bindings.len()),
            places: Places::new(bindings.iter().map(|binding| binding.target)),
            bindings,
            waiting: ArrayVec::new(),
            dwells: ArrayVec::new(),
            chords: Chords::default(),
            depths: Depths::default(),
        }
    }

    fn binding(&self, target: TargetId) -> Option<&KeyBinding> {
        self.bindings.get(self.places.of(target)?)
    }

    /// What a target does in a layer.
    fn action(&self, target: TargetId, layer: usize) -> Option<KeyAction> {
        let actions = &self.binding(target)?.actions;
        let own = actions.get(layer).copied().flatten();
        own.or_else(|| actions.first().copied().flatten())
    }

    fn press(&mut self, touch: &Touch, out: &mut DeviceOutput) {
        self.lift(touch, out);
        self.press_gathered_by(touch.time, out);
        let Some(place) = self.places.of(touch.target) else {
            return;
        };
        let KeyBinding {
            activation: fires,
            debounce: repress,
            ..
        } = self.bindings[place];
        let is_dwell = matches!(fires, Activation::Dwell(_));
        if is_dwell || self.bounces.is_bounce(place, touch.time, repress) {
            return;
        }
        if !self.gather(touch, out) {
            self.press_gathered(touch.time, out);
            self.press_alone(touch, touch.time, out);
        }
    }

    /// Lets a key that was pressed by a touch act on its own at `time`.
    fn press_alone(&mut self, touch: &Touch, time: Timestamp, out: &mut DeviceOutput) {
        let owner = PressSource::from_touch(touch);
        let Some(binding) = self.binding(touch.target) else {
            return;
        };
        let fires = binding.activation;
        self.hold_for_another_key(time, out);
        let Some(action) = self.action(touch.target, out.arbiter.active_layer()) else {
            return;
        };
        match Waiting::of(owner, action, fires, touch.time) {
            Some(waiting) if out.arbiter.has_room(out.events) => {
                // Each finger has one press at most, so there is room.
                let _ = self.waiting.try_push(waiting);
            }
            Some(_) => {}
            None => {
                out.press(owner, action, time);
            }
        }
    }

    /// A finger that presses a second target has let go of the first, told or not.
    fn lift(&mut self, touch: &Touch, out: &mut DeviceOutput) {
        let places = &self.places;
        let is_of_finger = |owner: PressSource| match owner {
            PressSource::Touch(side, finger, target) => {
                (side, finger) == (touch.side, touch.finger) && places.of(target).is_some()
            }
            PressSource::Part(..) => false,
        };
        out.arbiter.cancel(is_of_finger);
        self.waiting.retain(|press| !is_of_finger(press.owner));
        self.chords.lift(is_of_finger, out);
    }

    /// Ends a press; one that is cancelled does not count as tapped.
    fn end(&mut self, touch: &Touch, out: &mut DeviceOutput) {
        let owner = PressSource::from_touch(touch);
        if let Some(place) = self.places.of(touch.target)
            && (self.is_pending(owner) || out.arbiter.has_press_from(owner))
        {
            self.bounces.came_up(place, touch.time);
        }
        self.waiting.retain(|press| press.owner != owner);
        match touch.phase {
            Phase::Cancelled => out.arbiter.cancel(|other| other == owner),
            _ => out.arbiter.release(|other| other == owner),
        }
    }

    /// Takes at most as many touches as a frame can have.
    fn take_presses(&mut self, touches: &[Touch], out: &mut DeviceOutput) {
        for (.., touch) in self.sorted(touches, out) {
            match touch.phase {
                Phase::Pressed => self.press(touch, out),
                phase => {
                    self.end_in_chords(touch, out);
                    if phase != Phase::Cancelled {
                        self.fire(PressSource::from_touch(touch), touch.time, out);
                    }
                    self.end(touch, out);
                }
            }
            out.arbiter.emit_changes(touch.time, out.events);
        }
    }

    fn take_depths(&mut self, touches: &[Touch], out: &mut DeviceOutput) {
        let mut time = out.arbiter.last_event_time();
        for touch in touches {
            let is_analogue = |binding: &KeyBinding| binding.reports_depth;
            if self.binding(touch.target).is_some_and(is_analogue) {
                self.depths.take(touch);
                time = time.max(touch.time);
            }
        }
        self.depths.tell(time, out);
    }

    /// The beginnings and ends of presses, in the order in which they are taken; touches of one
    /// finger keep their order.
    fn sorted<'a>(&self, touches: &'a [Touch], out: &DeviceOutput) -> Sorted<'a> {
        let mut begun = FingerSet::NONE;
        let mut sorted = Sorted::new();
        for (place, touch) in touches.iter().enumerate() {
            let turn = match touch.phase {
                Phase::Touched | Phase::Moved => continue,
                Phase::Pressed => {
                    begun = begun.with(touch.finger);
                    Turn::Begins
                }
                // Nothing of it is down yet, and what it fires is a press.
                _ if self.is_waiting(touch, out) => Turn::Begins,
                _ if begun.contains(touch.finger) => Turn::EndsNew,
                _ => Turn::EndsOld,
            };
            let _ = sorted.try_push((turn, touch.time, place, touch));
        }
        sorted.sort_unstable_by_key(|&(turn, time, place, _)| (turn, time, place));
        sorted
    }
}

impl VirtualDevice for Keyboard {
    fn add_capabilities(&self, needs: &mut Capabilities) {
        for binding in &self.bindings {
            let held = match binding.activation {
                Activation::TapHold(TapHold {
                    hold_action: action,
                    ..
                }) => Some(action),
                _ => None,
            };
            let actions = binding.actions.iter().copied().flatten().chain(held);
            needs.extend(actions.filter_map(KeyAction::required_capability));
        }
        needs.extend(
            self.chords
                .actions()
                .filter_map(KeyAction::required_capability),
        );
    }

    fn update(&mut self, seen: &DeviceInput, out: &mut DeviceOutput) {
        // Releases that found no room in the frame before.
        out.arbiter
            .emit_changes(out.arbiter.last_event_time(), out.events);
        // One frame of one hand is one chunk; a longer list must not lose a release either.
        for touches in seen.touches.chunks(MAX_TOUCHES) {
            self.take_presses(touches, out);
        }
        self.take_dwells(seen.touches, out);
        self.press_gathered_by(seen.pose.time, out);
        self.hold_by(seen.pose.time, out);
        self.dwell_by(seen.pose.time, out);
        self.take_depths(seen.touches, out);
    }

    fn release_all(&mut self, time: Timestamp, out: &mut DeviceOutput) {
        self.waiting.clear();
        self.dwells.clear();
        self.chords.forget();
        self.bounces.forget();
        self.depths.forget();
        self.depths.tell(time, out);
    }
}
