//! Ranges of motion of human joints.

use super::JointAngles;
use crate::hand::Dof;

/// The largest excess over a range that a calibration error explains, as a fraction of the range.
const TOLERANCE: f64 = 0.1;

/// The smallest excess that is tolerated, in radians: 12°, for joints with a small range. Calibrated joints are up to 8° off in 95
/// of 100 cases, and more at the ends of their range for people who do not reach as far as most.
const MIN_TOLERANCE: f64 = 0.21;

/// The range of motion of every degree of freedom, in radians.
// Aligned to vector registers, as the angles are.
#[derive(Clone, Copy, Debug, PartialEq)]
#[repr(C, align(16))]
pub struct JointLimits {
    /// Two lists, so that the clamping of all angles is vectorised.
    lows: [f64; Dof::COUNT],
    highs: [f64; Dof::COUNT],
}

/// The range of motion of one degree of freedom, in radians.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct JointRange {
    low: f64,
    high: f64,
}

impl JointRange {
    /// The range of all finite angles.
    pub(super) const ANY: Self = Self {
        low: f64::MIN,
        high: f64::MAX,
    };

    pub(super) const fn new(low: f64, high: f64) -> Self {
        Self { low, high }
    }

    /// Returns the lower and the upper end.
    pub(super) const fn ends(self) -> [f64; 2] {
        [self.low, self.high]
    }

    /// Clamps an angle. Unlike `f64::clamp` it checks nothing, so that a loop over all angles is vectorised.
    pub(super) fn clamp(self, radians: f64) -> f64 {
        let radians = if radians < self.low {
            self.low
        } else {
            radians
        };
        if radians > self.high {
            self.high
        } else {
            radians
        }
    }

    /// Returns the range with the excess that a calibration error explains.
    pub(super) fn with_tolerance(self) -> Self {
        let tolerance = (TOLERANCE * (self.high - self.low)).max(MIN_TOLERANCE);
        Self {
            low: (self.low - tolerance).max(f64::MIN),
            high: (self.high + tolerance).min(f64::MAX),
        }
    }

    pub(super) fn checked_clamp(self, radians: f64) -> Option<f64> {
        let [low, high] = self.with_tolerance().ends();
        (low..=high).contains(&radians).then(|| self.clamp(radians))
    }
}

impl JointLimits {
    /// Returns the ranges of motion of a healthy adult.
    ///
    /// Elbow, wrist, thumb and finger flexion after the clinical table "Normal range of motion" of
    /// the Electronic Textbook of Hand Surgery; MCP extension and the PIP and DIP maxima at the wide
    /// end of the published figures, because a glove is never calibrated to the degree. Supination
    /// counts from the palm facing down, which is 70° pronated, so it reaches 70 + 85 = 155°.
    pub fn human() -> Self {
        let mut limits = Self {
            lows: [0.0; Dof::COUNT],
            highs: [0.0; Dof::COUNT],
        };
        for &dof in Dof::ALL {
            let (low, high) = human_degrees(dof);
            limits.lows[dof.index()] = f64::to_radians(low);
            limits.highs[dof.index()] = f64::to_radians(high);
        }
        limits
    }

    /// Returns the lower and upper limit of `dof` in radians.
    pub fn range(&self, dof: Dof) -> (f64, f64) {
        (self.lows[dof.index()], self.highs[dof.index()])
    }

    /// Sets the lower and upper limit of `dof` in radians.
    pub fn set_range(&mut self, dof: Dof, low: f64, high: f64) {
        self.lows[dof.index()] = low;
        self.highs[dof.index()] = high;
    }

    pub(super) fn joint_range(&self, dof: Dof) -> JointRange {
        let (low, high) = self.range(dof);
        JointRange { low, high }
    }

    /// Clamps an angle to the range of `dof`; radians.
    pub fn clamp(&self, dof: Dof, radians: f64) -> f64 {
        self.joint_range(dof).clamp(radians)
    }

    /// Clamps all angles in place. Angles that are not known stay 0.
    pub(super) fn clamp_all(&self, angles: &mut JointAngles) {
        let ends = self.lows.iter().zip(&self.highs);
        for (radians, (&low, &high)) in angles.radians_mut().iter_mut().zip(ends) {
            *radians = JointRange { low, high }.clamp(*radians);
        }
    }

    /// Clamps an angle to the range of `dof`; radians. Returns `None` if it is NaN or outside the range by more than a
    /// tenth of the range and more than 12°, which no calibration error explains.
    pub fn checked_clamp(&self, dof: Dof, radians: f64) -> Option<f64> {
        self.joint_range(dof).checked_clamp(radians)
    }
}

fn human_degrees(dof: Dof) -> (f64, f64) {
    match dof {
        Dof::ShoulderZ | Dof::ShoulderY | Dof::ShoulderX => (-180.0, 180.0),
        // It has no children, and the glove's table turns it more than twice as far as the forearm.
        Dof::ForearmSecondBone => (-360.0, 360.0),
        Dof::ElbowFlexion => (0.0, 145.0),
        Dof::ForearmSupination => (-20.0, 155.0),
        Dof::WristDeviation => (-20.0, 35.0),
        Dof::WristFlexion => (-70.0, 75.0),
        Dof::ThumbCmcAbduction => (-60.0, 15.0),
        Dof::ThumbCmcFlexion => (-15.0, 45.0),
        Dof::ThumbMcpFlexion => (-10.0, 55.0),
        Dof::ThumbIpFlexion => (-15.0, 80.0),
        Dof::IndexMcpAbduction
        | Dof::MiddleMcpAbduction
        | Dof::RingMcpAbduction
        | Dof::LittleMcpAbduction => (-20.0, 20.0),
        Dof::IndexMcpFlexion
        | Dof::MiddleMcpFlexion
        | Dof::RingMcpFlexion
        | Dof::LittleMcpFlexion => (-45.0, 90.0),
        Dof::IndexPipFlexion
        | Dof::MiddlePipFlexion
        | Dof::RingPipFlexion
        | Dof::LittlePipFlexion => (0.0, 105.0),
        Dof::IndexDipFlexion
        | Dof::MiddleDipFlexion
        | Dof::RingDipFlexion
        | Dof::LittleDipFlexion => (0.0, 90.0),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn an_angle_slightly_outside_is_clamped_and_one_far_outside_is_rejected() {
        let limits = JointLimits::human();
        let degrees = |value: f64| limits.checked_clamp(Dof::ElbowFlexion, value.to_radians());
        assert_eq!(degrees(-10.0), Some(0.0));
        assert_eq!(degrees(90.0), Some(90_f64.to_radians()));
        assert_eq!(degrees(-15.0), None);
        assert_eq!(degrees(160.0), None);
        assert_eq!(degrees(f64::NAN), None);
        assert_eq!(degrees(f64::INFINITY), None);
    }

    #[test]
    fn an_error_of_the_calibration_is_clamped_for_joints_with_a_small_range_too() {
        let limits = JointLimits::human();
        let degrees = |value: f64| limits.checked_clamp(Dof::WristDeviation, value.to_radians());
        assert_eq!(degrees(-29.0), Some((-20_f64).to_radians()));
        assert_eq!(degrees(-33.0), None);
    }
}
