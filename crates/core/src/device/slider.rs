//! Sliders and levers: a handle that a fingertip moves along a track.

use super::grips::Grips;
use super::pending_returns::PendingReturns;
use super::steps::{nearest_step, snap};
use super::target_index::TargetIndex;
use super::value_output::{ValueEmitter, ValueOutput, catch_up, drop_waiting};
use super::{Capabilities, DeviceInput, DeviceOutput, VirtualDevice};
use crate::contact::{Phase, TargetId, Touch};
use crate::hand::Side;
use crate::time::Timestamp;

/// A slider or a lever.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Slider {
    /// The target that is its track. The handle moves along the target's X axis.
    pub target: TargetId,
    /// Half the length of the track, in metres, more than 0. The value is 0 and 1 at its ends.
    pub half_length: f32,
    /// The value between the ends.
    pub track: Track,
    /// The effect of a press on the handle.
    pub grab: GrabMode,
    /// Number of steps of the range, at least 1; `None` for a continuous value.
    pub steps: Option<u16>,
    /// The value at the start, 0..=1.
    pub initial: f32,
    /// `true` if it returns to `initial` when it is released. Its axis must be 0 there.
    pub springs_back: bool,
    /// The events for its value.
    pub output: ValueOutput,
}

/// The relation between the position on a track and the value.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Track {
    /// Proportional: a slider.
    Straight,
    /// The handle is the end of a lever that is upright at the middle of the track. The lever turns by this
    /// angle from end to end, in radians, more than 0 and less than π; the value is proportional to the angle.
    Hinged(f32),
}

/// The effect of a press on the handle of a slider.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum GrabMode {
    /// The handle jumps to the fingertip.
    Absolute,
    /// The handle stays, and moves by as much as the fingertip does.
    Relative,
}

impl Track {
    /// Returns the value at a position, −1..=1 from end to end.
    fn value(self, position: f32) -> f32 {
        let value = match self {
            Self::Straight => (position + 1.0) / 2.0,
            Self::Hinged(throw) => (position * (throw / 2.0).sin()).asin() / throw + 0.5,
        };
        value.clamp(0.0, 1.0)
    }

    /// Returns the position of a value, −1..=1 from end to end.
    pub fn position(self, value: f32) -> f32 {
        match self {
            Self::Straight => value * 2.0 - 1.0,
            Self::Hinged(throw) => ((value - 0.5) * throw).sin() / (throw / 2.0).sin(),
        }
    }
}

/// The sliders and levers of a layout.
///
/// The fingertip that presses a track moves its handle until it releases it; other fingertips are ignored. A fingertip above the track
/// moves nothing, and none does during a pause. When the fingertip is lost or strays off, and in [`VirtualDevice::release_all`], the
/// handle stays or springs back. `release_all` also returns every axis to 0; the axis of a handle that stays is restored when the
/// handle is held again.
#[derive(Clone, Debug)]
pub struct Sliders {
    sliders: Vec<(Slider, ValueEmitter)>,
    index: TargetIndex,
    /// The state is the distance from the fingertip to the handle along the track, in metres.
    grips: Grips<f32>,
    pending_returns: PendingReturns,
}

impl Sliders {
    /// Creates the sliders at their initial values.
    pub fn new(sliders: Vec<Slider>) -> Self {
        let with_emitter = |slider: Slider| {
            let initial = nearest_step(slider.initial, slider.steps);
            let emitter = ValueEmitter::new(slider.target, slider.output, initial);
            let rest = slider.springs_back.then_some(initial);
            (slider, emitter.with_rest(rest))
        };
        Self {
            index: TargetIndex::new(sliders.iter().map(|slider| slider.target)),
            grips: Grips::new(),
            pending_returns: PendingReturns::with_capacity(sliders.len()),
            sliders: sliders.into_iter().map(with_emitter).collect(),
        }
    }

    fn grab(&mut self, touch: &Touch, out: &mut DeviceOutput) {
        self.release(touch, out);
        let Some(index) = self.index.get(touch.target) else {
            return;
        };
        if self.grips.on_control(index).is_some() {
            return;
        }
        self.pending_returns.cancel(index);
        let (slider, emitter) = &mut self.sliders[index];
        let offset = match slider.grab {
            GrabMode::Absolute => 0.0,
            GrabMode::Relative => {
                slider.track.position(emitter.value()) * slider.half_length - touch.position.x
            }
        };
        self.grips.grab(touch, index, offset);
        // Also if the handle stays: an axis that was returned to 0 is restored.
        self.follow(touch, out);
    }

    fn follow(&mut self, touch: &Touch, out: &mut DeviceOutput) {
        let Some(grip) = self.grips.get_mut(touch) else {
            return;
        };
        let (slider, emitter) = &mut self.sliders[grip.control];
        if !emitter.can_move(out) {
            return;
        }
        let position = (touch.position.x + grip.state) / slider.half_length;
        let value = slider.track.value(position.clamp(-1.0, 1.0));
        emitter.set(snap(value, slider.steps, emitter.value()), touch.time, out);
    }

    fn release(&mut self, touch: &Touch, out: &mut DeviceOutput) {
        let Some(grip) = self.grips.release(touch) else {
            return;
        };
        let (_, emitter) = &mut self.sliders[grip.control];
        if emitter.springs_back() {
            self.pending_returns
                .start(grip.control, emitter, touch.time, out);
        }
    }
}

impl VirtualDevice for Sliders {
    fn add_capabilities(&self, required: &mut Capabilities) {
        for (slider, _) in &self.sliders {
            slider.output.add_capabilities(required);
        }
    }

    fn update(&mut self, input: &DeviceInput, out: &mut DeviceOutput) {
        self.pending_returns
            .retry(&mut self.sliders, input.pose.time, out);
        for touch in input.touches {
            match touch.phase {
                Phase::Touched => {}
                Phase::Pressed => self.grab(touch, out),
                Phase::Moved => self.follow(touch, out),
                Phase::Released | Phase::Left | Phase::Cancelled => self.release(touch, out),
            }
        }
        catch_up(&mut self.sliders, input.pose.time, out);
    }

    fn release_all(&mut self, time: Timestamp, out: &mut DeviceOutput) {
        self.grips.clear();
        self.pending_returns.start_all(&mut self.sliders, time, out);
    }

    fn release_hand(&mut self, side: Side, _: Timestamp, _: &mut DeviceOutput) {
        drop_waiting(&mut self.sliders, side);
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_value_of_a_lever_is_its_angle() {
        let lever = Track::Hinged(120_f32.to_radians());
        // The handle is at sin 60° at the end and at sin 30° at half the angle.
        let half_angle = 30_f32.to_radians().sin() / 60_f32.to_radians().sin();
        for (position, value) in [(-1.0, 0.0), (0.0, 0.5), (half_angle, 0.75), (1.0, 1.0)] {
            assert!((lever.value(position) - value).abs() < 1e-6, "{position}");
            assert!((lever.position(value) - position).abs() < 1e-6, "{value}");
        }
    }
}
