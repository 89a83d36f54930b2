//! Knobs and valves, turned by a fingertip on the rim or by pinching and rotating the hand.

mod pinch;

use std::f32::consts::TAU;

use parry3d::math::Vec2;

use self::pinch::{PinchGrip, PinchState, PinchTips};
use super::grips::Grips;
use super::pending_returns::PendingReturns;
use super::steps::{nearest_step, snap};
use super::target_index::TargetIndex;
use super::value_output::{ValueEmitter, ValueOutput, catch_up, drop_waiting};
use super::{Capabilities, DeviceInput, DeviceOutput, VirtualDevice};
use crate::contact::{Phase, TargetId, Touch};
use crate::hand::Side;
use crate::time::Timestamp;

/// Radius of the center in which a fingertip turns nothing, as a fraction of the knob's radius: that close
/// to the axis, hand tremor is a large angle.
const DEAD_CENTER: f32 = 0.25;

/// A knob or valve. Its value increases clockwise, as seen from the front.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Knob {
    /// The target that is its front. It turns about the middle of the target.
    pub target: TargetId,
    /// The radius, in metres, more than 0.
    pub radius: f32,
    /// The range of rotation.
    pub range: KnobRange,
    /// Number of steps of the range, at least 1; `None` for a continuous value.
    pub steps: Option<u16>,
    /// The value at the start; 0..=1 for a limited range.
    pub initial: f32,
    /// The value to which it returns when it is released, at which its axis must be 0; `None` if it stays.
    pub rest: Option<f32>,
    /// The rotation per rotation of a hand that pinches it, more than 0.
    pub twist_gain: f32,
    /// The events for its value.
    pub output: ValueOutput,
}

/// The range of rotation of a knob.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum KnobRange {
    /// The angle between its ends, in radians, more than 0, any number of turns. The value is 0..=1.
    Limited(f32),
    /// No ends. The value is the number of turns.
    Endless,
}

impl Knob {
    /// Returns the value after a counter-clockwise rotation by `angle`, in radians.
    fn value_after_rotation(&self, value: f32, angle: f32) -> f32 {
        match self.range {
            KnobRange::Limited(range) => (value - angle / range).clamp(0.0, 1.0),
            KnobRange::Endless => value - angle / TAU,
        }
    }
}

/// A fingertip on the rim of a knob.
#[derive(Clone, Copy, Debug)]
struct RimGrip {
    /// The last position relative to the knob's axis, in metres; `None` in the dead center.
    position: Option<Vec2>,
    /// The value before quantisation.
    value: f32,
}

/// The knobs and valves of a layout.
///
/// **Rim.** The fingertip that presses a knob turns it by the angle that it travels around the axis, until
/// it releases the knob; other fingertips are ignored. The value does not jump at the press, nor in the dead
/// center, a quarter of the radius, where the fingertip turns nothing.
///
/// **Pinch.** Thumb and index finger take a knob when they close over it: their midpoint is inside its
/// outline and at most 40 mm from its front. If one of these two fingers held the rim, the pinch takes over.
/// Until the fingers open, the knob follows the rotation of the hand about the knob's normal.
///
/// At its ends a knob stops, and turns back as soon as the hand does. When it is released or the hand is lost, it keeps its
/// value or returns to rest. [`VirtualDevice::release_all`] does the same, and returns the axis to 0 until the knob is held
/// again.
#[derive(Clone, Debug)]
pub struct Knobs {
    knobs: Vec<(Knob, ValueEmitter)>,
    index: TargetIndex,
    rim_grips: Grips<RimGrip>,
    pinches: [PinchState; Side::COUNT],
    pending_returns: PendingReturns,
}

impl Knobs {
    /// Creates the knobs at their initial values.
    pub fn new(knobs: Vec<Knob>) -> Self {
        let with_emitter = |knob: Knob| {
            let initial = nearest_step(knob.initial, knob.steps);
            let emitter = ValueEmitter::new(knob.target, knob.output, initial);
            (knob, emitter.with_rest(knob.rest.map(|_| initial)))
        };
        Self {
            index: TargetIndex::new(knobs.iter().map(|knob| knob.target)),
            rim_grips: Grips::new(),
            pinches: [PinchState::default(); Side::COUNT],
            pending_returns: PendingReturns::with_capacity(knobs.len()),
            knobs: knobs.into_iter().map(with_emitter).collect(),
        }
    }

    fn grab_rim(&mut self, touch: &Touch, out: &mut DeviceOutput) {
        self.release_rim(touch, out);
        let Some(index) = self.index.get(touch.target) else {
            return;
        };
        if self.is_pinched(index) || self.rim_grips.on_control(index).is_some() {
            return;
        }
        let value = self.take_hold(index, touch.time, out);
        let position = self.outside_dead_center(index, touch.position);
        self.rim_grips
            .grab(touch, index, RimGrip { position, value });
    }

    fn release_rim(&mut self, touch: &Touch, out: &mut DeviceOutput) {
        if let Some(grip) = self.rim_grips.release(touch) {
            self.return_to_rest(grip.control, touch.time, out);
        }
    }

    /// Returns a knob that nothing holds to rest, if it has a rest value.
    fn return_to_rest(&mut self, index: usize, time: Timestamp, out: &mut DeviceOutput) {
        let (_, emitter) = &mut self.knobs[index];
        if emitter.springs_back() {
            self.pending_returns.start(index, emitter, time, out);
        }
    }

    fn is_pinched(&self, index: usize) -> bool {
        self.pinches.iter().any(|pinch| pinch.holds(index))
    }

    /// Prepares a knob for a new holder: restores its axis, and returns its value.
    fn take_hold(&mut self, index: usize, time: Timestamp, out: &mut DeviceOutput) -> f32 {
        self.pending_returns.cancel(index);
        let (_, emitter) = &mut self.knobs[index];
        emitter.set(emitter.value(), time, out);
        emitter.value()
    }

    /// Returns the position, or `None` if it is in the dead center of the knob.
    fn outside_dead_center(&self, index: usize, position: Vec2) -> Option<Vec2> {
        let dead_radius = self.knobs[index].0.radius * DEAD_CENTER;
        (position.length_squared() > dead_radius * dead_radius).then_some(position)
    }

    fn follow_rim(&mut self, touch: &Touch, out: &mut DeviceOutput) {
        let Some(grip) = self.rim_grips.get_mut(touch) else {
            return;
        };
        let (index, before) = (grip.control, grip.state.position);
        let now = self.outside_dead_center(index, touch.position);
        let angle = match (before, now) {
            (Some(before), Some(now)) => before.angle_to(now),
            _ => 0.0,
        };
        let Some(rim_grip) = self.rim_grips.get_mut(touch) else {
            return;
        };
        rim_grip.state.position = now;
        turn(
            &mut self.knobs[index],
            &mut rim_grip.state.value,
            angle,
            touch.time,
            out,
        );
    }

    fn update_pinch(&mut self, input: &DeviceInput, out: &mut DeviceOutput) {
        let hand = input.pose.side.index();
        let tips = PinchTips::from_pose(input.pose);
        let before = self.pinches[hand];
        self.pinches[hand] = match (before, tips) {
            (_, None) => PinchState::Closed,
            (_, Some(tips)) if tips.are_open() => PinchState::Open,
            (PinchState::Open, Some(tips)) if tips.are_closed() => {
                self.begin_pinch(&tips, input, out)
            }
            (PinchState::Holding(grip), Some(_)) => self.follow_pinch(grip, input, out),
            (state, Some(_)) => state,
        };
        if let PinchState::Holding(grip) = before
            && !self.pinches[hand].holds(grip.knob)
        {
            self.return_to_rest(grip.knob, input.pose.time, out);
        }
    }

    /// Grips the knob when thumb and index finger close over it.
    fn begin_pinch(
        &mut self,
        tips: &PinchTips,
        input: &DeviceInput,
        out: &mut DeviceOutput,
    ) -> PinchState {
        let pose = input.pose;
        let Some(mut grip) = pinch::grip_between(tips, pose, input.scene, &self.index) else {
            return PinchState::Closed;
        };
        let is_held_by_another_finger = self
            .rim_grips
            .on_control(grip.knob)
            .is_some_and(|rim| rim.side != pose.side || !PinchTips::FINGERS.contains(&rim.finger));
        if self.is_pinched(grip.knob) || is_held_by_another_finger {
            return PinchState::Closed;
        }
        self.rim_grips.release_control(grip.knob);
        grip.value = self.take_hold(grip.knob, pose.time, out);
        PinchState::Holding(grip)
    }

    fn follow_pinch(
        &mut self,
        mut grip: PinchGrip,
        input: &DeviceInput,
        out: &mut DeviceOutput,
    ) -> PinchState {
        let Some(angle) = grip.rotation_since_last(input.pose, input.scene) else {
            return PinchState::Closed;
        };
        let knob = &mut self.knobs[grip.knob];
        let angle = angle * knob.0.twist_gain;
        turn(knob, &mut grip.value, angle, input.pose.time, out);
        PinchState::Holding(grip)
    }
}

/// Turns a knob counter-clockwise by an angle, in radians. `value` is the holder's, before quantisation.
fn turn(
    (knob, emitter): &mut (Knob, ValueEmitter),
    value: &mut f32,
    angle: f32,
    time: Timestamp,
    out: &mut DeviceOutput,
) {
    if !angle.is_finite() || angle == 0.0 || !emitter.can_move(out) {
        return;
    }
    *value = knob.value_after_rotation(*value, angle);
    emitter.set(snap(*value, knob.steps, emitter.value()), time, out);
}

impl VirtualDevice for Knobs {
    fn add_capabilities(&self, required: &mut Capabilities) {
        for (knob, _) in &self.knobs {
            knob.output.add_capabilities(required);
        }
    }

    fn update(&mut self, input: &DeviceInput, out: &mut DeviceOutput) {
        self.pending_returns
            .retry(&mut self.knobs, input.pose.time, out);
        for touch in input.touches {
            match touch.phase {
                Phase::Touched => {}
                Phase::Pressed => self.grab_rim(touch, out),
                Phase::Moved => self.follow_rim(touch, out),
                Phase::Released | Phase::Left | Phase::Cancelled => self.release_rim(touch, out),
            }
        }
        self.update_pinch(input, out);
        catch_up(&mut self.knobs, input.pose.time, out);
    }

    fn release_all(&mut self, time: Timestamp, out: &mut DeviceOutput) {
        self.rim_grips.clear();
        self.pinches = [PinchState::default(); Side::COUNT];
        self.pending_returns.start_all(&mut self.knobs, time, out);
    }

    fn release_hand(&mut self, side: Side, _: Timestamp, _: &mut DeviceOutput) {
        drop_waiting(&mut self.knobs, side);
    }
}
