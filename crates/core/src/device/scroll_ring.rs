//! Scroll rings: a fingertip that slides around a ring scrolls, or changes a value that wraps around.

use std::f32::consts::TAU;

use parry3d::math::Vec2;

use super::grips::Grips;
use super::pending_returns::PendingReturns;
use super::steps::snap;
use super::target_index::TargetIndex;
use super::value_output::{ValueEmitter, ValueOutput, catch_up, drop_waiting};
use super::{Capabilities, DeviceInput, DeviceOutput, VirtualDevice};
use crate::contact::{Phase, TargetId, Touch};
use crate::hand::Side;
use crate::time::Timestamp;

/// A scroll ring. Its value is a fraction of a turn, clockwise as seen from the front, and wraps around.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ScrollRing {
    /// The target that is its front. The ring is around the middle of the target.
    pub target: TargetId,
    /// Outer radius, in metres, more than 0.
    pub radius: f32,
    /// Radius of the dead center, in which a fingertip turns nothing, in metres, less than the outer radius: close to the middle, hand
    /// tremor is a large angle.
    pub dead_radius: f32,
    /// Number of detents of a turn, at least 1.
    pub detents: u16,
    /// `true` if the value increases counter-clockwise, instead of clockwise.
    pub is_reversed: bool,
    /// The value at the start, 0..=1.
    pub initial: f32,
    /// The events for a turn.
    pub output: ValueOutput,
}

/// A fingertip on a ring.
#[derive(Clone, Copy, Debug)]
struct RingGrip {
    /// The last position relative to the middle, in metres; `None` in the dead center.
    position: Option<Vec2>,
    /// The value before quantisation.
    value: f32,
}

impl ScrollRing {
    /// Returns the change of the value for a movement around the middle.
    fn change(&self, from: Vec2, to: Vec2) -> f32 {
        let counter_clockwise = from.angle_to(to) / TAU;
        if self.is_reversed {
            counter_clockwise
        } else {
            -counter_clockwise
        }
    }

    /// Returns the position, or `None` if it is in the dead center.
    fn outside_dead_center(&self, position: Vec2) -> Option<Vec2> {
        let is_outside = position.length_squared() > self.dead_radius * self.dead_radius;
        (is_outside && position.is_finite()).then_some(position)
    }
}

/// The scroll rings of a layout.
///
/// The fingertip that presses a ring turns it by the angle that it travels around the middle, detent by detent; a tenth of a detent
/// of hysteresis keeps a trembling finger from scrolling to and fro. Nothing turns at the press, nor on the way through the dead
/// center. Other fingertips are ignored. The ring is released with the fingertip, and when the fingertip leaves its outline; a part
/// of a detent is then forgotten. The value stays.
#[derive(Clone, Debug)]
pub struct ScrollRings {
    rings: Vec<(ScrollRing, ValueEmitter)>,
    index: TargetIndex,
    grips: Grips<RingGrip>,
    pending_returns: PendingReturns,
}

impl ScrollRings {
    /// Creates the rings at their initial values.
    pub fn new(rings: Vec<ScrollRing>) -> Self {
        let with_emitter = |ring: ScrollRing| {
            let emitter = ValueEmitter::new(ring.target, ring.output, ring.initial);
            (ring, emitter)
        };
        Self {
            index: TargetIndex::new(rings.iter().map(|ring| ring.target)),
            grips: Grips::new(),
            pending_returns: PendingReturns::with_capacity(rings.len()),
            rings: rings.into_iter().map(with_emitter).collect(),
        }
    }

    fn grab(&mut self, touch: &Touch) {
        self.grips.release(touch);
        let Some(index) = self.index.get(touch.target) else {
            return;
        };
        if self.grips.on_control(index).is_some() {
            return;
        }
        self.pending_returns.cancel(index);
        let (ring, emitter) = &self.rings[index];
        let grip = RingGrip {
            position: ring.outside_dead_center(touch.position),
            value: emitter.value(),
        };
        self.grips.grab(touch, index, grip);
    }

    fn follow(&mut self, touch: &Touch, out: &mut DeviceOutput) {
        let Some(grip) = self.grips.get_mut(touch) else {
            return;
        };
        let (ring, emitter) = &mut self.rings[grip.control];
        if !emitter.can_move(out) {
            return;
        }
        let before = grip.state.position;
        grip.state.position = ring.outside_dead_center(touch.position);
        let (Some(before), Some(now)) = (before, grip.state.position) else {
            return;
        };
        grip.state.value += ring.change(before, now);
        let value = snap(grip.state.value, Some(ring.detents), emitter.value());
        grip.state.value -= emitter.turn_to(value, touch.time, out);
    }
}

impl VirtualDevice for ScrollRings {
    fn add_capabilities(&self, required: &mut Capabilities) {
        for (ring, _) in &self.rings {
            ring.output.add_capabilities(required);
        }
    }

    fn update(&mut self, input: &DeviceInput, out: &mut DeviceOutput) {
        self.pending_returns
            .retry(&mut self.rings, input.pose.time, out);
        for touch in input.touches {
            match touch.phase {
                Phase::Touched => {}
                Phase::Pressed => self.grab(touch),
                Phase::Moved => self.follow(touch, out),
                Phase::Released | Phase::Left | Phase::Cancelled => {
                    self.grips.release(touch);
                }
            }
        }
        catch_up(&mut self.rings, input.pose.time, out);
    }

    fn release_all(&mut self, time: Timestamp, out: &mut DeviceOutput) {
        self.grips.clear();
        self.pending_returns.start_all(&mut self.rings, time, out);
    }

    fn release_hand(&mut self, side: Side, _: Timestamp, _: &mut DeviceOutput) {
        drop_waiting(&mut self.rings, side);
    }
}
