//! The tremor of a simulated hand at rest.

use glam::DVec3;

use super::noise::displace;
use crate::capture::Sample;

/// Displacement upward, in metres: less than the tremor of any person, and more than encoders round.
const SIZE_M: f64 = 2e-5;

/// Time in seconds after which a hand at rest is displaced. A source that repeats its positions for 5 s counts as stuck.
const PERIOD_S: f64 = 4.0;

/// Keeps a simulated hand at rest from repeating its positions for so long that the program takes its tracker for stuck.
#[derive(Clone, Debug, Default)]
pub struct Tremor {
    /// The last posture without the tremor.
    last: Option<Sample>,
    /// The time for which it has been repeated, in seconds.
    repeated: f64,
}

impl Tremor {
    /// Adds a sample that comes `seconds` after the last one. Displaces the positions of one that repeats them, once in 4 s. Other samples
    /// stay as they are.
    pub fn add_to(&mut self, sample: &mut Sample, seconds: f64) {
        if self.last.as_ref() != Some(sample) {
            self.last = Some(sample.clone());
            self.repeated = 0.0;
            return;
        }
        self.repeated += seconds;
        if self.repeated >= PERIOD_S {
            self.repeated = 0.0;
            displace(sample, || DVec3::Y * SIZE_M);
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::estimate::JointAngles;
    use crate::hand::{Dof, Joint, JointPositions};

    #[test]
    fn positions_of_a_hand_at_rest_differ_once_in_4_s_and_others_stay() {
        let at = |height: f64| {
            let mut positions = JointPositions::default();
            positions.set(Joint::Wrist, DVec3::Y * height);
            Sample::Joints { positions }
        };
        let mut tremor = Tremor::default();
        let measured = [0.0, 0.1, 0.1, 0.1, 0.1, 0.1, 0.2, 0.2, 0.2];
        let shown = measured.map(|height| {
            let mut sample = at(height);
            tremor.add_to(&mut sample, 2.0);
            sample
        });
        let [low, high] = [0.1, 0.2].map(|height| height + SIZE_M);
        let expected = [0.0, 0.1, 0.1, low, 0.1, low, 0.2, 0.2, high];
        assert_eq!(shown, expected.map(at));
    }

    #[test]
    fn angles_do_not_tremble() {
        let mut angles = JointAngles::default();
        angles.set(Dof::ElbowFlexion, 0.3);
        let rest = Sample::Angles { angles };
        let mut tremor = Tremor::default();
        for _ in 0..3 {
            let mut sample = rest.clone();
            tremor.add_to(&mut sample, 5.0);
            assert_eq!(sample, rest);
        }
    }
}
