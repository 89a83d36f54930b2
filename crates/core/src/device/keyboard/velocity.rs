//! The velocity of keys that play notes.

use arrayvec::ArrayVec;

use crate::contact::{Press, TargetId, Touch};
use crate::device::{DeviceOutput, EventKind, PressSource};
use crate::hand::FINGERS_OF_BOTH_HANDS;
use crate::time::Timestamp;

/// The speed of a fingertip into a key whose press has velocity 1, in metres per second: keys of a piano that are struck as loudly
/// as possible move at 0.7 to 1 m/s.
const FULL_SPEED: f32 = 1.0;

/// The smallest velocity of a press, the step of MIDI velocities; 0 is a release.
const MIN_VELOCITY: f32 = 1.0 / 127.0;

/// The velocity of a press without evidence: the velocity of keyboards that do not measure it (MIDI 1.0: 64).
const UNKNOWN_VELOCITY: f32 = 64.0 / 127.0;

/// Emits the velocity of each press, and 0 at its release.
///
/// A key that two fingers press plays with the first, and ends with the last.
#[derive(Clone, Debug, Default)]
pub(super) struct VelocityReporter {
    /// The fingers that hold keys.
    held: ArrayVec<PressSource, FINGERS_OF_BOTH_HANDS>,
    /// The keys whose press was emitted and whose release was not.
    down: ArrayVec<TargetId, FINGERS_OF_BOTH_HANDS>,
}

impl VelocityReporter {
    /// Emits the velocity of a press. A press that does not fit into the event list is dropped.
    pub(super) fn press(&mut self, touch: &Touch, presses: &[Press], out: &mut DeviceOutput) {
        let is_full = self.held.is_full() || self.down.is_full();
        if is_full && !self.down.contains(&touch.target) {
            return;
        }
        let velocity = velocity(touch, presses);
        let event = EventKind::Velocity(touch.target, velocity);
        if !self.down.contains(&touch.target) {
            if !out.emit(touch.time, event) {
                return;
            }
            self.down.push(touch.target);
        }
        let source = PressSource::from_touch(touch);
        if !self.is_held_by(source) {
            let _ = self.held.try_push(source);
        }
    }

    /// Returns `true` if a finger holds a key that was emitted.
    fn is_held_by(&self, source: PressSource) -> bool {
        self.held.contains(&source)
    }

    /// Ends the presses of matching fingers.
    pub(super) fn end(
        &mut self,
        matches: impl Fn(PressSource) -> bool,
        time: Timestamp,
        out: &mut DeviceOutput,
    ) {
        self.held.retain(|source| !matches(*source));
        self.emit_releases(time, out);
    }

    /// Emits the release of each key that no finger holds. A release that does not fit into the event list is retried by the next call.
    pub(super) fn emit_releases(&mut self, time: Timestamp, out: &mut DeviceOutput) {
        let held = &self.held;
        self.down.retain(|down| {
            let is_held = held
                .iter()
                .any(|source| matches!(source, PressSource::Touch(_, _, target) if target == down));
            is_held || !out.emit(time, EventKind::Velocity(*down, 0.0))
        });
    }
}

/// Returns the velocity of a press, above 0 to 1.
fn velocity(touch: &Touch, presses: &[Press]) -> f32 {
    let is_own = |press: &&Press| {
        (press.side, press.finger, press.target) == (touch.side, touch.finger, touch.target)
    };
    match presses.iter().find(is_own) {
        Some(press) => (press.speed / FULL_SPEED).clamp(MIN_VELOCITY, 1.0),
        None => UNKNOWN_VELOCITY,
    }
}
