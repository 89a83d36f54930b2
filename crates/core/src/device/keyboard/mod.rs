//! Keyboards: touches of keys become presses, with modifiers, layers, chords and dwell.

mod binding;
mod chords;
mod depth;
mod dwell;
mod pending;
mod velocity;

pub use self::binding::{Activation, KeyBinding, TapHold, action_in_layer};
pub use self::chords::{Chord, MAX_CHORD_KEYS};

use arrayvec::ArrayVec;

use self::chords::Chords;
use self::depth::DepthReporter;
use self::dwell::PendingDwell;
use self::pending::PendingPress;
use self::velocity::VelocityReporter;
use super::debounce::Debouncer;
use super::target_index::TargetIndex;
use super::{Capabilities, DeviceInput, DeviceOutput, KeyAction, PressSource, VirtualDevice};
use crate::contact::{MAX_TOUCHES, Phase, Press, TargetId, Touch};
use crate::hand::{FINGERS_OF_BOTH_HANDS, FingerSet, Side};
use crate::time::Timestamp;

/// The keys of a layout.
///
/// The action of a key is chosen at the press; the release ends that action, even if the layer has changed
/// during the hold. Each press belongs to its finger and target, and ends only there.
///
/// In one step, the keys that were down before are released first; then presses follow in order of time;
/// then the releases of presses of the same step. Where this is not the order of time, the later event gets
/// the later time; times never decrease. A key that fires at its release counts as a press of that moment.
///
/// A key that fires after a time, such as a dwell or a hold, waits for a pose of its own hand: poses of the other hand do not show
/// that a fingertip is still on it.
#[derive(Clone, Debug)]
pub struct Keyboard {
    bindings: Vec<KeyBinding>,
    index: TargetIndex,
    /// Presses whose action has not fired yet, in order of pressing.
    pending: ArrayVec<PendingPress, FINGERS_OF_BOTH_HANDS>,
    dwells: ArrayVec<PendingDwell, FINGERS_OF_BOTH_HANDS>,
    chords: Chords,
    debouncer: Debouncer,
    depths: DepthReporter,
    velocities: VelocityReporter,
    /// The time of the latest pose of each hand, by side.
    seen: [Timestamp; Side::COUNT],
}

/// The touches of a step, in the order in which they are handled; the index keeps the order of ties.
type SortedTouches<'a> = ArrayVec<(Turn, Timestamp, usize, &'a Touch), MAX_TOUCHES>;

/// The position of a touch in the order of a step.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
enum Turn {
    ReleaseOfEarlierStep,
    Press,
    ReleaseOfThisStep,
}

impl Keyboard {
    /// Creates a keyboard with nothing pressed. If several bindings have the same target, the first one
    /// applies. Targets without a binding are ignored.
    pub fn new(bindings: Vec<KeyBinding>) -> Self {
        Self {
            debouncer: Debouncer::new(bindings.len()),
            index: TargetIndex::new(bindings.iter().map(|binding| binding.target)),
            bindings,
            pending: ArrayVec::new(),
            dwells: ArrayVec::new(),
            chords: Chords::default(),
            depths: DepthReporter::default(),
            velocities: VelocityReporter::default(),
            seen: Default::default(),
        }
    }

    /// Returns the time until which the fingers of a press have been seen.
    fn seen_until(&self, source: PressSource) -> Timestamp {
        let fingers = self.chords.fingers_of(source);
        let seen = fingers.filter_map(|finger| match finger {
            PressSource::Touch(side, ..) => Some(self.seen[side.index()]),
            PressSource::Part(..) => None,
        });
        seen.min().unwrap_or_default()
    }

    fn binding(&self, target: TargetId) -> Option<&KeyBinding> {
        self.bindings.get(self.index.get(target)?)
    }

    /// Returns the action of a target in a layer.
    fn action(&self, target: TargetId, layer: usize) -> Option<KeyAction> {
        action_in_layer(&self.binding(target)?.actions, layer)
    }

    /// Returns the action of a press at `time`: in the active layer, or in the one-shot layer of the letter that it replaces.
    fn action_of_press(
        &self,
        source: PressSource,
        target: TargetId,
        time: Timestamp,
        out: &DeviceOutput,
    ) -> Option<KeyAction> {
        // A chord may have had the same finger on the same key.
        let is_own = |action: &KeyAction| {
            let binding = self.binding(target);
            binding.is_some_and(|it| it.actions.contains(&Some(*action)))
        };
        let repeated = out.arbiter.repeated_tap(source, time).filter(is_own);
        repeated.or_else(|| self.action(target, out.arbiter.active_layer()))
    }

    fn press(&mut self, touch: &Touch, presses: &[Press], out: &mut DeviceOutput) {
        self.cancel_finger(touch, out);
        self.press_gathered_if_due(touch.time, out);
        let Some(index) = self.index.get(touch.target) else {
            return;
        };
        let KeyBinding {
            activation,
            debounce,
            reports_velocity,
            ..
        } = self.bindings[index];
        let is_dwell = matches!(activation, Activation::Dwell(_));
        if is_dwell || self.debouncer.ignores(index, touch, debounce) {
            return;
        }
        if reports_velocity {
            self.velocities.press(touch, presses, out);
        }
        if !self.gather(touch, out) {
            self.press_gathered(touch.time, out);
            self.press_single(touch, touch.time, out);
        }
    }

    /// Presses the key of a touch on its own, not as part of a chord.
    fn press_single(&mut self, touch: &Touch, time: Timestamp, out: &mut DeviceOutput) {
        let source = PressSource::from_touch(touch);
        let Some(binding) = self.binding(touch.target) else {
            return;
        };
        let activation = binding.activation;
        self.hold_pending(time, out);
        let Some(action) = self.action_of_press(source, touch.target, time, out) else {
            return;
        };
        match PendingPress::new(source, action, activation, touch.time) {
            Some(press) if out.arbiter.has_room(out.events) => {
                // Each finger has one press at most, so there is room.
                let _ = self.pending.try_push(press);
            }
            Some(_) => {}
            None => {
                out.press(source, action, time);
            }
        }
    }

    /// Cancels the other presses of the touching finger: one that presses a second target has left the
    /// first, whether or not that was reported.
    fn cancel_finger(&mut self, touch: &Touch, out: &mut DeviceOutput) {
        let index = &self.index;
        let is_of_finger = |source: PressSource| match source {
            PressSource::Touch(side, finger, target) => {
                (side, finger) == (touch.side, touch.finger) && index.get(target).is_some()
            }
            PressSource::Part(..) => false,
        };
        out.arbiter.cancel(is_of_finger);
        self.velocities.end(is_of_finger, touch.time, out);
        self.pending.retain(|press| !is_of_finger(press.source));
        self.chords
            .cancel_finger(is_of_finger, &mut self.pending, out);
    }

    /// Ends the press of a touch. A cancelled press does not count as a tap.
    fn end_press(&mut self, touch: &Touch, out: &mut DeviceOutput) {
        let source = PressSource::from_touch(touch);
        if let Some(index) = self.index.get(touch.target) {
            self.debouncer.end_press(index, touch);
        }
        self.pending.retain(|press| press.source != source);
        self.velocities
            .end(|other| other == source, touch.time, out);
        match touch.phase {
            Phase::Cancelled => out.arbiter.cancel(|other| other == source),
            _ => out.arbiter.release(|other| other == source),
        }
    }

    /// Handles the presses and releases of at most [`MAX_TOUCHES`] touches.
    fn handle_touches(&mut self, touches: &[Touch], presses: &[Press], out: &mut DeviceOutput) {
        let sorted = self.sorted(touches, out);
        for &(.., touch) in &sorted {
            match touch.phase {
                Phase::Pressed => self.press(touch, presses, out),
                phase => {
                    self.end_chords(touch, out);
                    if phase != Phase::Cancelled {
                        self.fire_on_release(PressSource::from_touch(touch), touch.time, out);
                    }
                    self.end_press(touch, out);
                }
            }
            out.arbiter.emit_changes(touch.time, out.events);
        }
    }

    fn emit_depths(&mut self, touches: &[Touch], out: &mut DeviceOutput) {
        let mut time = out.arbiter.last_event_time();
        for touch in touches {
            if self
                .binding(touch.target)
                .is_some_and(|it| it.reports_depth)
            {
                self.depths.update(touch);
                time = time.max(touch.time);
            }
        }
        self.depths.emit(time, out);
    }

    /// Returns the starts and ends of presses in the order in which they are handled. The touches of one
    /// finger keep their order.
    fn sorted<'a>(&self, touches: &'a [Touch], out: &DeviceOutput) -> SortedTouches<'a> {
        let mut pressed = FingerSet::NONE;
        let mut sorted = SortedTouches::new();
        for (index, touch) in touches.iter().enumerate() {
            let turn = match touch.phase {
                Phase::Touched | Phase::Moved => continue,
                Phase::Pressed => {
                    pressed = pressed.with(touch.finger);
                    Turn::Press
                }
                // It has not emitted anything yet, and what it fires is a press.
                _ if self.is_or_would_be_pending(touch, out) => Turn::Press,
                _ if pressed.contains(touch.finger) => Turn::ReleaseOfThisStep,
                _ => Turn::ReleaseOfEarlierStep,
            };
            let _ = sorted.try_push((turn, touch.time, index, touch));
        }
        sorted.sort_unstable_by_key(|&(turn, time, index, _)| (turn, time, index));
        sorted
    }
}

impl VirtualDevice for Keyboard {
    fn add_capabilities(&self, required: &mut Capabilities) {
        for binding in &self.bindings {
            let hold = match binding.activation {
                Activation::TapHold(TapHold { hold_action, .. }) => Some(hold_action),
                _ => None,
            };
            let actions = binding.actions.iter().copied().flatten().chain(hold);
            required.extend(actions.filter_map(KeyAction::required_capability));
        }
        let chords = self.chords.actions();
        required.extend(chords.filter_map(KeyAction::required_capability));
    }

    fn update(&mut self, input: &DeviceInput, out: &mut DeviceOutput) {
        // Releases that did not fit into the event list of the last step.
        let last_time = out.arbiter.last_event_time();
        self.velocities.emit_releases(last_time, out);
        let is_bent = input.scene.has_bend_targets();
        self.chords.begin_step(input.pose.may_hide_presses(is_bent));
        // The touches of one step fit into one chunk; a longer list must not lose a release either.
        for touches in input.touches.chunks(MAX_TOUCHES) {
            self.handle_touches(touches, input.presses, out);
        }
        self.update_dwells(input.touches, out);
        self.seen[input.pose.side.index()] = input.pose.time;
        self.press_gathered_if_seen(out);
        self.hold_due(out);
        self.fire_due_dwells(out);
        self.emit_depths(input.touches, out);
    }

    fn release_all(&mut self, time: Timestamp, out: &mut DeviceOutput) {
        self.pending.clear();
        self.dwells.clear();
        self.chords.reset();
        self.debouncer.reset();
        self.depths.reset();
        self.velocities.end(|_| true, time, out);
        self.depths.emit(time, out);
    }
}
