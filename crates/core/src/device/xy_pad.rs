//! XY pads: a handle that is under the fingertip, with a value for each direction.

use parry3d::math::Vec2;

use super::grips::Grips;
use super::pending_returns::PendingReturns;
use super::steps::{nearest_step, snap};
use super::target_index::TargetIndex;
use super::value_output::{NamedValue, ValueEmitter, ValueOutput, catch_up, drop_waiting};
use super::{Capabilities, DeviceInput, DeviceOutput, VirtualDevice};
use crate::contact::{Phase, TargetId, Touch};
use crate::hand::Side;
use crate::time::Timestamp;

/// An XY pad. Its values are 0 at the left and at the near edge, and 1 at the opposite edges.
#[derive(Clone, Debug, PartialEq)]
pub struct XyPad {
    /// The target that is its front, a box.
    pub target: TargetId,
    /// Half of its width and height, in metres, more than 0.
    pub half_extents: Vec2,
    /// The names of its values and the targets of their events: to the right, away from the wearer.
    pub values: [NamedValue; 2],
    /// The settings of its values, in the same order.
    pub axes: [PadAxis; 2],
    /// `true` if both values return to their initial ones when it is released. Their axes must be 0 there.
    pub springs_back: bool,
}

/// The settings of a value of an XY pad.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct PadAxis {
    /// Number of steps of the range, at least 1; `None` for a continuous value.
    pub steps: Option<u16>,
    /// The value at the start, 0..=1.
    pub initial: f32,
    /// The events for the value.
    pub output: ValueOutput,
}

/// The XY pads of a layout.
///
/// The fingertip that presses a pad moves its handle until it releases it; beyond an edge the value of that direction stays at its
/// end. Other fingertips are ignored. When the fingertip is lost or strays off, and in [`VirtualDevice::release_all`], the handle
/// stays or springs back. `release_all` also returns every axis to 0; the axes of a handle that stays are restored when it is held
/// again.
#[derive(Clone, Debug)]
pub struct XyPads {
    /// Half of the width and height of each pad, in metres.
    half_extents: Vec<Vec2>,
    /// Two for each pad.
    values: Vec<(Option<u16>, ValueEmitter)>,
    index: TargetIndex,
    grips: Grips<()>,
    pending_returns: PendingReturns,
}

impl XyPads {
    /// Creates the pads at their initial values.
    pub fn new(pads: Vec<XyPad>) -> Self {
        let with_emitters = |pad: &XyPad| {
            let springs_back = pad.springs_back;
            let emitter = |value: &NamedValue, axis: PadAxis| {
                let initial = nearest_step(axis.initial, axis.steps);
                let emitter = ValueEmitter::new(value.target, axis.output, initial);
                (
                    axis.steps,
                    emitter.with_rest(springs_back.then_some(initial)),
                )
            };
            std::array::from_fn::<_, 2, _>(|index| emitter(&pad.values[index], pad.axes[index]))
        };
        Self {
            index: TargetIndex::new(pads.iter().map(|pad| pad.target)),
            half_extents: pads.iter().map(|pad| pad.half_extents).collect(),
            values: pads.iter().flat_map(with_emitters).collect(),
            grips: Grips::new(),
            pending_returns: PendingReturns::with_capacity(2 * pads.len()),
        }
    }

    fn grab(&mut self, touch: &Touch, out: &mut DeviceOutput) {
        self.release(touch, out);
        let Some(pad) = self.index.get(touch.target) else {
            return;
        };
        if self.grips.on_control(pad).is_some() {
            return;
        }
        for value in values_of(pad) {
            self.pending_returns.cancel(value);
        }
        self.grips.grab(touch, pad, ());
        self.follow(touch, out);
    }

    fn follow(&mut self, touch: &Touch, out: &mut DeviceOutput) {
        let Some(grip) = self.grips.get_mut(touch) else {
            return;
        };
        let position = 0.5 + touch.position / (2.0 * self.half_extents[grip.control]);
        for (component, value) in values_of(grip.control).into_iter().enumerate() {
            let (steps, emitter) = &mut self.values[value];
            if !emitter.can_move(out) {
                continue;
            }
            let fraction = position[component].clamp(0.0, 1.0);
            emitter.set(snap(fraction, *steps, emitter.value()), touch.time, out);
        }
    }

    fn release(&mut self, touch: &Touch, out: &mut DeviceOutput) {
        let Some(grip) = self.grips.release(touch) else {
            return;
        };
        for value in values_of(grip.control) {
            let (_, emitter) = &mut self.values[value];
            if emitter.springs_back() {
                self.pending_returns.start(value, emitter, touch.time, out);
            }
        }
    }
}

/// Returns the indices of the values of a pad.
fn values_of(pad: usize) -> [usize; 2] {
    [2 * pad, 2 * pad + 1]
}

impl VirtualDevice for XyPads {
    fn add_capabilities(&self, required: &mut Capabilities) {
        for (_, emitter) in &self.values {
            emitter.output().add_capabilities(required);
        }
    }

    fn update(&mut self, input: &DeviceInput, out: &mut DeviceOutput) {
        self.pending_returns
            .retry(&mut self.values, input.pose.time, out);
        for touch in input.touches {
            match touch.phase {
                Phase::Touched => {}
                Phase::Pressed => self.grab(touch, out),
                Phase::Moved => self.follow(touch, out),
                Phase::Released | Phase::Left | Phase::Cancelled => self.release(touch, out),
            }
        }
        catch_up(&mut self.values, input.pose.time, out);
    }

    fn release_all(&mut self, time: Timestamp, out: &mut DeviceOutput) {
        self.grips.clear();
        self.pending_returns.start_all(&mut self.values, time, out);
    }

    fn release_hand(&mut self, side: Side, _: Timestamp, _: &mut DeviceOutput) {
        drop_waiting(&mut self.values, side);
    }
}
