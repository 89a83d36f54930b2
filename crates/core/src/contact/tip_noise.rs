//! The noise of fingertips, and the movements that stand out from it.
//!
//! White noise of a source without a filter carries a finger that rests close above a key through its press depth again and again.
//! With noise a press has to stand out: the mean of the last positions of the finger has to be further below the position in which it
//! rested, or below the highest one of the last positions, than noise explains. The last position of a finger that comes from further
//! above stands out, so that it does not wait; with little noise every press stands out.

use std::time::Duration;

use glam::Vec3A;
use parry3d::math::Vec3;

use super::surface::Target;
use super::tracker::{StepContext, TargetLocation};
use crate::hand::{Finger, FingerSet};

/// The standard deviations of noise along the press direction, in metres, between which a press has to stand out. Less noise presses no
/// key that a finger rests 1 mm above. With more, a tap that is 3 mm deep does not stand out in a few readings, so that taps would be
/// missed.
const NOISE: [f32; 2] = [0.3e-3, 1.5e-3];

/// The distance from the rest at which a mean stands out, in standard deviations: 3 of 10 million means of white noise are as far below it.
const PRESS_DISTANCE: f32 = 5.0;

/// The distance from the highest one of the last positions at which a movement stands out, in standard deviations. It is larger, because
/// the highest one of several is chosen.
const FALL_DISTANCE: f32 = 6.0;

/// The distance of a position from the rest, in standard deviations, with which another rest begins.
const REST_DISTANCE: f32 = 3.5;

/// The time in which a finger goes down and presses, in seconds. Positions before it belong to the rest.
const TAP_TIME: f32 = 0.08;

/// The largest number of the last positions whose mean may stand out.
const RECENT: usize = 8;

/// The time constant of the position of the rest, in seconds.
const REST_TIME: f32 = 0.25;

/// The time constant of the variance of the noise, in seconds.
const NOISE_TIME: f32 = 1.0;

/// The fewest readings from which the noise is known.
const MIN_READINGS: u16 = 16;

/// The number of the first readings whose mean the noise is, unless it forgets sooner.
const FIRST_READINGS: u16 = 256;

/// The longest time between two readings whose changes tell noise from movement.
const MAX_PERIOD: Duration = Duration::from_millis(25);

/// The longest time between two readings of one movement: two readings of a camera with 30 pictures per second.
const MAX_GAP: Duration = Duration::from_millis(70);

/// The largest product of two changes that counts, as a multiple of the variance: an outlier is no noise.
const MAX_PRODUCT: f32 = 16.0;

/// The mean of the negated product of two successive changes of white noise, with 0 for a negative one, as a multiple of the variance:
/// `(1 + 2 · (√3 / π + 1 / 6)) / 2`, for two normal numbers with the variance 2 and the correlation −1/2.
const MEAN_PRODUCT: f32 = 1.218;

/// The noise of the fingertips of one hand, in the frame of one surface.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct TipNoise {
    fingers: [FingerNoise; Finger::COUNT],
    /// The number of the last readings that are younger than [`TAP_TIME`].
    recent: usize,
}

/// The last positions of a fingertip, in metres, and the noise along each axis.
#[derive(Clone, Copy, Debug, Default)]
struct FingerNoise {
    /// The last positions, a ring.
    positions: [Vec3A; RECENT],
    newest: usize,
    /// The number of known positions in the ring.
    len: usize,
    /// The mean of the positions before them while there is noise, and how many it is the mean of.
    rest: Vec3A,
    averaged: Vec3A,
    /// The variance of the noise, and the number of readings from which it is known.
    variance: Vec3A,
    readings: u16,
}

/// The time since the last reading, and the weights that follow from it.
#[derive(Clone, Copy)]
struct Step {
    is_short: bool,
    recent: usize,
    max_averaged: Vec3A,
    noise_weight: f32,
}

impl TipNoise {
    /// Appends the centers of the known fingertips, `gap` after the last ones.
    pub fn push(&mut self, known: FingerSet, centers: &[Vec3A; Finger::COUNT], gap: Duration) {
        let seconds = gap.as_secs_f32();
        let step = Step {
            is_short: gap <= MAX_PERIOD,
            // Saturates if the time is the same.
            recent: ((TAP_TIME / seconds) as usize).clamp(1, RECENT),
            max_averaged: Vec3A::splat((REST_TIME / seconds).max(1.0)),
            noise_weight: seconds / (NOISE_TIME + seconds),
        };
        self.recent = step.recent;
        for (noise, &finger) in self.fingers.iter_mut().zip(Finger::ALL) {
            if gap > MAX_GAP || !known.contains(finger) {
                noise.forget_positions();
            }
            if known.contains(finger) {
                noise.push(centers[finger.index()], &step);
            }
        }
    }

    /// Forgets the positions, and keeps the noise.
    pub fn forget_positions(&mut self) {
        self.fingers
            .iter_mut()
            .for_each(FingerNoise::forget_positions);
    }

    /// Returns `true` if a fingertip has moved against a direction of unit length by more than its noise, or if it is not known to have
    /// noise.
    fn stands_out(&self, finger: Finger, direction: Vec3) -> bool {
        self.fingers[finger.index()].stands_out(direction.into(), self.recent)
    }
}

impl FingerNoise {
    fn forget_positions(&mut self) {
        self.len = 0;
        self.averaged = Vec3A::ZERO;
    }

    /// Returns the position `age` readings before the last one, less than [`RECENT`].
    fn position(&self, age: usize) -> Vec3A {
        self.positions[(self.newest + RECENT - age) % RECENT]
    }

    fn push(&mut self, at: Vec3A, step: &Step) {
        if self.len >= 2 && step.is_short {
            let last = self.position(0);
            self.measure([last - self.position(1), at - last], step);
        }
        let is_noisy = self.variance.max_element() >= NOISE[0] * NOISE[0];
        if !is_noisy {
            self.averaged = Vec3A::ZERO;
        } else if self.len >= step.recent {
            self.average(self.position(step.recent - 1), step);
        }
        self.newest = (self.newest + 1) % RECENT;
        self.positions[self.newest] = at;
        self.len = (self.len + 1).min(RECENT);
    }

    /// Updates the noise with two successive changes: noise changes its direction from one to the other, a movement does not.
    fn measure(&mut self, [before, now]: [Vec3A; 2], step: &Step) {
        let weight = if self.readings < FIRST_READINGS {
            self.readings += 1;
            step.noise_weight.max(1.0 / f32::from(self.readings))
        } else {
            step.noise_weight
        };
        let limit = (MAX_PRODUCT * self.variance).max(Vec3A::splat(NOISE[0] * NOISE[0]));
        let product = (-before * now).max(Vec3A::ZERO).min(limit);
        self.variance += weight * (product / MEAN_PRODUCT - self.variance);
    }

    /// Adds a position to the rest. One that is too far from it begins another rest.
    fn average(&mut self, at: Vec3A, step: &Step) {
        let change = at - self.rest;
        let limit = REST_DISTANCE * REST_DISTANCE * self.variance;
        let is_near = (change * change).cmple(limit);
        let averaged = (self.averaged + 1.0).min(step.max_averaged);
        self.rest = Vec3A::select(is_near, self.rest + change / averaged, at);
        self.averaged = Vec3A::select(is_near, averaged, Vec3A::ONE);
    }

    fn stands_out(&self, direction: Vec3A, recent: usize) -> bool {
        let weights = direction * direction;
        let variance = weights.dot(self.variance);
        let [least, most] = NOISE.map(|deviation| deviation * deviation);
        let has_noise = self.readings >= MIN_READINGS && (least..=most).contains(&variance);
        if !has_noise || self.averaged == Vec3A::ZERO {
            return true;
        }
        let heights = (0..recent.min(self.len)).map(|age| direction.dot(self.position(age)));
        let rest = direction.dot(self.rest);
        let variance_of_rest = weights.dot(self.variance / self.averaged);
        let highest = heights.clone().fold(f32::NEG_INFINITY, f32::max);
        let mut sum = 0.0;
        (1_u8..).zip(heights).any(|(count, height)| {
            let count = f32::from(count);
            sum += height;
            let (mean, variance_of_mean) = (sum / count, variance / count);
            rest - mean > PRESS_DISTANCE * (variance_of_mean + variance_of_rest).sqrt()
                || highest - mean > FALL_DISTANCE * (variance_of_mean + variance).sqrt()
        })
    }
}

impl StepContext<'_> {
    /// Returns `true` if a finger presses a target by a movement, and not by noise.
    pub(super) fn stands_out(
        &self,
        location: TargetLocation,
        target: &Target,
        finger: Finger,
    ) -> bool {
        let outward = target.surface_from_target.rotation * Vec3::Z;
        let positions = self.positions.get(location.surface);
        positions.is_none_or(|positions| positions.noise.stands_out(finger, outward))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const PERIOD: Duration = Duration::from_millis(10);

    /// The noise after a fingertip was at heights in metres, one after another.
    fn after(heights: impl IntoIterator<Item = f32>) -> TipNoise {
        let mut noise = TipNoise::default();
        for height in heights {
            noise.push(FingerSet::ALL, &[Vec3A::Z * height; Finger::COUNT], PERIOD);
        }
        noise
    }

    /// White noise with a standard deviation in metres.
    fn white(deviation: f32) -> impl Iterator<Item = f32> {
        let mut random = fastrand::Rng::with_seed(4);
        // The sum of twelve uniform numbers is nearly normal.
        let mut normal = move || (0..12).map(|_| random.f32()).sum::<f32>() - 6.0;
        std::iter::repeat_with(move || deviation * normal())
    }

    fn deviation(noise: &TipNoise) -> f32 {
        noise.fingers[0].variance.z.sqrt()
    }

    #[test]
    fn noise_is_measured_and_movement_is_not() {
        let measured = deviation(&after(white(1e-3).take(400)));
        assert!((measured - 1e-3).abs() < 0.15e-3, "{measured}");
        // Taps by 10 mm, 5 times a second.
        let taps = (0..400).map(|step| 5e-3 * (std::f32::consts::TAU * 0.05 * step as f32).cos());
        let of_taps = deviation(&after(taps.clone()));
        assert!(of_taps < NOISE[0], "{of_taps}");
        let both = deviation(&after(
            taps.zip(white(1e-3)).map(|(tap, noise)| tap + noise),
        ));
        assert!((0.5e-3..1.5e-3).contains(&both), "{both}");
    }

    #[test]
    fn an_outlier_is_no_noise() {
        let with_outlier = |height: f32| {
            let mut heights: Vec<f32> = white(0.2e-3).take(200).collect();
            heights[195] += height;
            deviation(&after(heights))
        };
        let (without, with) = (with_outlier(0.0), with_outlier(0.05));
        assert!(with < 1.3 * without, "{with} after {without}");
    }

    #[test]
    fn a_single_position_stands_out_if_it_is_far_and_several_if_they_are_near() {
        let stands_out = |below: f32, count: usize| {
            let rest = white(1e-3).take(200);
            let heights = rest.chain(std::iter::repeat_n(-below, count));
            after(heights).stands_out(Finger::Index, Vec3::Z)
        };
        assert!(!stands_out(0.0, 1));
        assert!(!stands_out(0.004, 1) && stands_out(0.008, 1));
        assert!(!stands_out(0.002, 1) && stands_out(0.004, 4));
    }

    #[test]
    fn without_noise_and_before_it_is_known_everything_stands_out() {
        assert!(after(white(0.1e-3).take(200)).stands_out(Finger::Index, Vec3::Z));
        assert!(after(white(1e-3).take(10)).stands_out(Finger::Index, Vec3::Z));
        assert!(!after(white(1e-3).take(200)).stands_out(Finger::Index, Vec3::Z));
    }

    #[test]
    fn huge_positions_do_not_stay() {
        let huge = [f32::MAX, f32::MIN, f32::MAX, f32::MAX, f32::MIN];
        let heights = white(1e-3)
            .take(100)
            .chain(huge)
            .chain(white(1e-3).take(300));
        let noise = after(heights.chain([-0.05]));
        assert!(noise.stands_out(Finger::Index, Vec3::Z));
        assert!(noise.fingers[0].rest.is_finite());
    }
}
