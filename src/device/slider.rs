//! Sliders and levers: a handle that a fingertip moves along a track.

use super::grips::Grips;
use super::pending_returns::Resting;
use super::steps::{nearest, step_to};
use super::target_index::Places;
use super::value_output::{Driver, ValueOutput};
use super::{Capabilities, DeviceInput, DeviceOutput, VirtualDevice};
use crate::contact::{Phase, TargetId, Touch};
use crate::time::Timestamp;

/// One slider or lever.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Slider {
    /// The target that is its track; the handle runs along the target's own X.
    pub target: TargetId,
    /// Half the length of the track, in metres, more than 0: the value is 0 and 1 at its ends.
    pub half_length: f32,
    /// What the value is between them.
    pub track: Track,
    /// What a press does to the handle.
    pub grab: GrabMode,
    /// The value is on one of so many steps, at least 1; anywhere when `None`.
    pub steps: Option<u16>,
    /// Where it stands at first, 0..=1.
    pub initial: f32,
    /// Whether it springs back to `start` when it is let go of. Then its axis is 0 there.
    pub springs_back: bool,
    /// What its value drives.
    pub output: ValueOutput,
}

/// How the value goes with the way along a track.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Track {
    /// In proportion: a slider.
    Straight,
    /// The handle is the end of a lever that stands upright in the middle of the track. It turns by this
    /// angle from one end to the other, in radians, more than 0 and less than π; the value is in proportion
    /// to the angle.
    Hinged(f32),
}

/// What a press does to the handle of a slider.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum GrabMode {
    /// The handle comes to the fingertip.
    Absolute,
    /// The handle stays where it is and moves as far as the fingertip does.
    Relative,
}

impl Track {
    /// The value at a place, −1..=1 from one end to the other.
    fn value(self, place: f32) -> f32 {
        let value = match self {
            Self::Straight => (place + 1.0) / 2.0,
            Self::Hinged(throw) => (place * (throw / 2.0).sin()).asin() / throw + 0.5,
        };
        value.clamp(0.0, 1.0)
    }

    /// The inverse of [`value`](Self::value).
    fn place(self, value: f32) -> f32 {
        match self {
            Self::Straight => value * 2.0 - 1.0,
            Self::Hinged(throw) => ((value - 0.5) * throw).sin() / (throw / 2.0).sin(),
        }
    }
}

/// The sliders and levers of a layout.
///
/// The fingertip that presses a track moves its handle until it is released; all others are ignored. What
/// it does while it is lifted off moves nothing. When it is lost or strays off the handle stays, or springs
/// back, and so it does when everything is let go of. Then an axis goes to 0 in any case: that of a handle
/// that stays comes back when it is next held.
#[derive(Clone, Debug)]
pub struct Sliders {
    sliders: Vec<(Slider, Driver)>,
    places: Places,
    /// How far each handle is ahead of the fingertip that holds it, in metres along the track.
    grips: Grips<f32>,
    resting: Resting,
}

impl Sliders {
    /// All where they stand at first.
    pub fn new(sliders: Vec<Slider>) -> Self {
        let with_driver = |slider: Slider| {
            let start = nearest(slider.initial, slider.steps);
            let driver = Driver::new(slider.target, slider.output, start);
            let springs_to = slider.springs_back.then_some(start);
            (slider, driver.springing_to(springs_to))
        };
        Self {
            places: Places::new(sliders.iter().map(|slider| slider.target)),
            grips: Grips::none(),
            resting: Resting::of(sliders.len()),
            sliders: sliders.into_iter().map(with_driver).collect(),
        }
    }

    fn grab(&mut self, touch: &Touch, out: &mut DeviceOutput) {
        self.let_go(touch, out);
        let Some(place) = self.places.of(touch.target) else {
            return;
        };
        if self.grips.on(place).is_some() {
            return;
        }
        self.resting.end(place);
        let (slider, driver) = &mut self.sliders[place];
        let ahead = match slider.grab {
            GrabMode::Absolute => 0.0,
            GrabMode::Relative => {
                slider.track.place(driver.value()) * slider.half_length - touch.position.x
            }
        };
        self.grips.begin(touch, place, ahead);
        // Also where the handle stays: an axis that went to 0 comes back.
        self.follow(touch, out);
    }

    fn follow(&mut self, touch: &Touch, out: &mut DeviceOutput) {
        let Some(grip) = self.grips.of(touch) else {
            return;
        };
        let (slider, driver) = &mut self.sliders[grip.place];
        let place = (touch.position.x + grip.state) / slider.half_length;
        let value = slider.track.value(place.clamp(-1.0, 1.0));
        driver.set(
            step_to(value, slider.steps, driver.value()),
            touch.time,
            out,
        );
    }

    fn let_go(&mut self, touch: &Touch, out: &mut DeviceOutput) {
        let Some(grip) = self.grips.end(touch) else {
            return;
        };
        let (_, driver) = &mut self.sliders[grip.place];
        if driver.springs() {
            self.resting.begin(grip.place, driver, touch.time, out);
        }
    }
}

impl VirtualDevice for Sliders {
    fn add_capabilities(&self, needs: &mut Capabilities) {
        for (slider, _) in &self.sliders {
            slider.output.add_capabilities(needs);
        }
    }

    fn update(&mut self, seen: &DeviceInput, out: &mut DeviceOutput) {
        self.resting.go_on(&mut self.sliders, seen.pose.time, out);
        for touch in seen.touches {
            match touch.phase {
                Phase::Touched => {}
                Phase::Pressed => self.grab(touch, out),
                Phase::Moved => self.follow(touch, out),
                Phase::Released | Phase::Left | Phase::Cancelled => self.let_go(touch, out),
            }
        }
    }

    fn release_all(&mut self, time: Timestamp, out: &mut DeviceOutput) {
        self.grips.clear();
        for (place, (_, driver)) in self.sliders.iter_mut().enumerate() {
            self.resting.begin(place, driver, time, out);
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_value_of_a_lever_is_its_angle() {
        let lever = Track::Hinged(120_f32.to_radians());
        // The handle is at sin 60° at the end, at sin 30° half way there.
        let half_way = 30_f32.to_radians().sin() / 60_f32.to_radians().sin();
        for (place, value) in [(-1.0, 0.0), (0.0, 0.5), (half_way, 0.75), (1.0, 1.0)] {
            assert!((lever.value(place) - value).abs() < 1e-6, "{place}");
            assert!((lever.place(value) - place).abs() < 1e-6, "{value}");
        }
    }
}
