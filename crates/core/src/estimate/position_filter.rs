//! The 1-Euro filter of measured joint positions.

use std::f32::consts::TAU;

use parry3d::math::Vec3;

use super::{MeasuredJoints, OneEuroSettings};
use crate::hand::Joint;

/// Settings for landmarks that a network finds in an image, with 1.5 mm of noise; `beta` in Hz per m/s.
///
/// MediaPipe uses this `beta` for world landmarks, and the filter's authors the cutoff at rest. The cutoff of the
/// speed lets a tap of 100 ms through: at 30 images per second, 0.7 mm of the noise remain, and a tap lags by 13 ms.
pub const LANDMARK_SMOOTHING: OneEuroSettings = OneEuroSettings {
    min_cutoff_hz: 1.0,
    beta: 40.0,
    derivative_cutoff_hz: 4.0,
};

/// Settings for optical markers, with 0.3 mm of noise: at 100 images per second, 0.1 mm remain, and a tap lags by 3 ms.
pub const MARKER_SMOOTHING: OneEuroSettings = OneEuroSettings {
    min_cutoff_hz: 5.0,
    beta: 100.0,
    derivative_cutoff_hz: 10.0,
};

/// A 1-Euro filter for each joint. The cutoff rises with the speed of the joint, so that its path keeps its direction.
#[derive(Clone, Debug)]
pub(super) struct PositionFilter {
    settings: OneEuroSettings,
    positions: MeasuredJoints,
    /// The velocity of each joint, in m/s.
    velocities: [Vec3; Joint::COUNT],
}

impl PositionFilter {
    /// Creates a filter without state.
    pub(super) fn new(settings: OneEuroSettings) -> Self {
        Self {
            settings,
            positions: MeasuredJoints::default(),
            velocities: [Vec3::ZERO; Joint::COUNT],
        }
    }

    /// Clears the state: the next positions pass unchanged.
    pub(super) fn reset(&mut self) {
        self.positions = MeasuredJoints::default();
    }

    /// Filters the positions in place, measured `seconds` after the previous ones. A joint that was not measured before
    /// passes unchanged.
    pub(super) fn filter(&mut self, measured: &mut MeasuredJoints, seconds: f64) {
        let seconds = seconds as f32;
        let speed_factor = smoothing_factor(self.settings.derivative_cutoff_hz as f32, seconds);
        let (min_cutoff, beta) = (
            self.settings.min_cutoff_hz as f32,
            self.settings.beta as f32,
        );
        let mut filtered = MeasuredJoints::default();
        for (joint, position) in measured.iter() {
            let velocity = &mut self.velocities[joint.index()];
            let smooth = match self.positions.get(joint) {
                Some(last) => {
                    let change = position - last;
                    if seconds > 0.0 {
                        *velocity += speed_factor * (change / seconds - *velocity);
                    }
                    let cutoff = min_cutoff + beta * velocity.length();
                    last + smoothing_factor(cutoff, seconds) * change
                }
                None => {
                    *velocity = Vec3::ZERO;
                    position
                }
            };
            filtered.set(joint, smooth);
        }
        self.positions = filtered;
        *measured = filtered;
    }
}

/// Returns α of a first-order low-pass filter.
fn smoothing_factor(cutoff_hz: f32, seconds: f32) -> f32 {
    1.0 - 1.0 / (1.0 + TAU * cutoff_hz * seconds)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::estimate::OneEuroFilter;

    fn measured(joints: &[(Joint, Vec3)]) -> MeasuredJoints {
        let mut measured = MeasuredJoints::default();
        for &(joint, position) in joints {
            measured.set(joint, position);
        }
        measured
    }

    #[test]
    fn a_joint_that_moves_along_an_axis_is_filtered_like_a_single_value() {
        let mut positions = PositionFilter::new(MARKER_SMOOTHING);
        let mut values = OneEuroFilter::new(MARKER_SMOOTHING);
        for step in 0..60_u32 {
            let x = (f64::from(step) * 0.2).sin() * 0.05;
            let mut joint = measured(&[(Joint::IndexTip, Vec3::X * x as f32)]);
            positions.filter(&mut joint, 0.01);
            let mut value = [x];
            values.filter(&mut value, 0.01);
            let found = joint.get(Joint::IndexTip).expect("a tip");
            assert!((f64::from(found.x) - value[0]).abs() < 1e-6, "{step}");
            assert_eq!((found.y, found.z), (0.0, 0.0));
        }
    }

    #[test]
    fn a_joint_that_appears_passes_unchanged_and_a_reset_forgets_all() {
        let mut filter = PositionFilter::new(LANDMARK_SMOOTHING);
        let mut first = measured(&[(Joint::Wrist, Vec3::X)]);
        filter.filter(&mut first, 0.03);
        let mut both = measured(&[(Joint::Wrist, Vec3::Y), (Joint::IndexTip, Vec3::Z)]);
        filter.filter(&mut both, 0.03);
        assert_eq!(both.get(Joint::IndexTip), Some(Vec3::Z));
        assert_ne!(both.get(Joint::Wrist), Some(Vec3::Y));
        filter.reset();
        let mut again = measured(&[(Joint::Wrist, Vec3::ZERO)]);
        filter.filter(&mut again, 0.03);
        assert_eq!(again.get(Joint::Wrist), Some(Vec3::ZERO));
    }
}
