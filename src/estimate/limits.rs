//! What a human joint can do.

use crate::hand::Dof;

/// How far outside its range an angle may be and still be taken for a calibration error: a share of the range.
const GRACE: f64 = 0.1;

/// The range of every degree of freedom, in radians.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct JointLimits {
    ranges: [JointRange; Dof::COUNT],
}

/// The range of one degree of freedom, in radians.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct JointRange {
    low: f64,
    high: f64,
}

impl JointRange {
    /// Every finite angle.
    pub(super) const ANY: Self = Self {
        low: f64::MIN,
        high: f64::MAX,
    };

    pub(super) fn clamp(self, radians: f64) -> f64 {
        radians.clamp(self.low, self.high)
    }

    pub(super) fn admit(self, radians: f64) -> Option<f64> {
        let grace = GRACE * (self.high - self.low);
        (self.low - grace..=self.high + grace)
            .contains(&radians)
            .then(|| self.clamp(radians))
    }
}

impl JointLimits {
    /// Ranges of motion of a healthy adult.
    ///
    /// Elbow, wrist, thumb and finger flexion after the clinical table "Normal range of motion" of
    /// the Electronic Textbook of Hand Surgery; MCP extension and the PIP and DIP maxima at the wide
    /// end of the published figures, because a glove is never calibrated to the degree. Supination
    /// counts from the palm facing down, which is 70° pronated, so it reaches 70 + 85 = 155°.
    pub fn human() -> Self {
        let mut ranges = [JointRange::ANY; Dof::COUNT];
        for &dof in Dof::ALL {
            let (low, high) = human_degrees(dof);
            ranges[dof.index()] = JointRange {
                low: f64::to_radians(low),
                high: f64::to_radians(high),
            };
        }
        Self { ranges }
    }

    /// The range of `dof` in radians, lowest first.
    pub fn range(&self, dof: Dof) -> (f64, f64) {
        let range = self.joint(dof);
        (range.low, range.high)
    }

    pub(super) fn joint(&self, dof: Dof) -> JointRange {
        self.ranges[dof.index()]
    }

    /// The angle brought into the range of `dof`; radians.
    pub fn clamp(&self, dof: Dof, radians: f64) -> f64 {
        self.joint(dof).clamp(radians)
    }

    /// The angle as far as it can be true: brought into the range when it is outside by at most a
    /// tenth of the range, `None` when it is further out or not a number.
    pub fn admit(&self, dof: Dof, radians: f64) -> Option<f64> {
        self.joint(dof).admit(radians)
    }
}

fn human_degrees(dof: Dof) -> (f64, f64) {
    match dof {
        Dof::ShoulderZ | Dof::ShoulderY | Dof::ShoulderX => (-180.0, 180.0),
        // It carries nothing, and the glove's table turns it more than twice as far as the forearm.
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
    fn a_little_outside_is_brought_in_and_far_outside_is_refused() {
        let limits = JointLimits::human();
        let degrees = |value: f64| limits.admit(Dof::ElbowFlexion, value.to_radians());
        assert_eq!(degrees(-10.0), Some(0.0));
        assert_eq!(degrees(90.0), Some(90_f64.to_radians()));
        assert_eq!(degrees(-15.0), None);
        assert_eq!(degrees(160.0), None);
        assert_eq!(degrees(f64::NAN), None);
        assert_eq!(degrees(f64::INFINITY), None);
    }
}
