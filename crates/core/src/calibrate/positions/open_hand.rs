//! An open hand that is held still for a second, so that its readings show where it is.

use std::time::Duration;

use parry3d::math::Vec3;

use super::MIN_READINGS;
use crate::hand::open_hand::{HOLD, StillTip, is_straight};
use crate::hand::{Finger, Joint, JointPositions};
use crate::time::Timestamp;

/// The longest gap between two readings.
const MAX_GAP: Duration = Duration::from_millis(500);

/// The most readings that are kept: one second of the fastest source.
const MAX_READINGS: usize = 400;

/// A request to the person.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum HoldAdvice {
    /// Show the hand.
    Show,
    /// Stretch the fingers.
    Open,
    /// Hold still.
    Hold,
}

/// Collects the readings of one hand while it is open and still.
#[derive(Clone, Debug, Default)]
pub struct OpenHand {
    /// The index fingertip, while it is still.
    tip: Option<StillTip>,
    readings: Vec<JointPositions>,
}

impl OpenHand {
    /// Processes a reading of the hand. A reading without a hand, with a bent finger or at another position starts the second again.
    pub fn update(&mut self, time: Timestamp, positions: &JointPositions) -> HoldAdvice {
        let at = match (positions.get(Joint::IndexTip), is_open(positions)) {
            (Some(at), Some(true)) => at.as_vec3(),
            (_, is_open) => {
                *self = Self::default();
                return match is_open {
                    Some(false) => HoldAdvice::Open,
                    _ => HoldAdvice::Show,
                };
            }
        };
        let still = self.tip.and_then(|tip| tip.at(time, at, MAX_GAP));
        if still.is_none() {
            self.readings.clear();
        }
        self.tip = Some(still.unwrap_or_else(|| StillTip::new(time, at)));
        if self.readings.len() < MAX_READINGS {
            self.readings.push(*positions);
        }
        HoldAdvice::Hold
    }

    /// Returns the fraction of the second that has passed, 0 to 1. A source with few readings per second needs longer.
    pub fn progress(&self) -> f32 {
        let passed = self.tip.map_or(Duration::ZERO, |tip| tip.duration());
        let counted = self.readings.len() as f32 / MIN_READINGS as f32;
        counted
            .min(passed.as_secs_f32() / HOLD.as_secs_f32())
            .min(1.0)
    }

    /// Returns the readings since the hand has been held still.
    pub fn readings(&self) -> &[JointPositions] {
        &self.readings
    }
}

/// Returns `true` if all fingers but the thumb are straight; `None` if one is not known.
fn is_open(positions: &JointPositions) -> Option<bool> {
    let fingers = Finger::ALL[1..].iter();
    let straight = fingers.map(|finger| {
        // Without the base of the metacarpal, which cameras do not see.
        let joints = finger.joints()[1..].iter();
        let joints = joints.map(|&joint| Some(positions.get(joint)?.as_vec3()));
        let joints: Option<Vec<Vec3>> = joints.collect();
        Some(is_straight(joints?))
    });
    let straight: Option<Vec<bool>> = straight.collect();
    Some(straight?.into_iter().all(|it| it))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::estimate::{Estimate, JointAngles};
    use crate::hand::{Dof, Side};
    use crate::kinematics::{ArmModel, BoneLengths};
    use glam::DVec3;

    /// The positions of a hand whose fingers are bent by an angle in radians at each joint.
    fn hand(bend: f64, at: DVec3) -> JointPositions {
        let bones = BoneLengths::from_hand_and_forearm(0.18, 0.25).unwrap();
        let arm = ArmModel::anthropometric(Side::Right, &bones).unwrap();
        let mut angles = JointAngles::default();
        for &dof in Dof::ALL
            .iter()
            .filter(|dof| dof.name().contains("ip-flexion"))
        {
            angles.set(dof, bend);
        }
        let mut positions = JointPositions::default();
        for (joint, pose) in arm.forward(&Estimate::new(Timestamp(0), angles)).known() {
            positions.set(joint, pose.translation.as_dvec3() + at);
        }
        positions
    }

    fn update(hold: &mut OpenHand, ms: u64, positions: &JointPositions) -> HoldAdvice {
        hold.update(Timestamp(ms * 1000), positions)
    }

    #[test]
    fn a_hand_that_is_open_and_still_for_a_second_is_held() {
        let mut hold = OpenHand::default();
        let open = hand(0.1, DVec3::ZERO);
        for ms in (0..1000).step_by(50) {
            assert_eq!(update(&mut hold, ms, &open), HoldAdvice::Hold);
            assert!(hold.progress() < 1.0);
        }
        update(&mut hold, 1000, &open);
        assert_eq!((hold.progress(), hold.readings().len()), (1.0, 21));
    }

    #[test]
    fn a_slow_source_needs_ten_readings() {
        let mut hold = OpenHand::default();
        let open = hand(0.1, DVec3::ZERO);
        for reading in 0..10 {
            assert!(hold.progress() < 1.0);
            update(&mut hold, 250 * reading, &open);
        }
        assert_eq!(hold.progress(), 1.0);
    }

    #[test]
    fn a_bent_a_moved_or_a_missing_hand_starts_again() {
        let open = hand(0.1, DVec3::ZERO);
        for (other, advice) in [
            (hand(1.2, DVec3::ZERO), HoldAdvice::Open),
            (hand(0.1, DVec3::X * 0.05), HoldAdvice::Hold),
            (JointPositions::default(), HoldAdvice::Show),
        ] {
            let mut hold = OpenHand::default();
            for ms in (0..900).step_by(50) {
                update(&mut hold, ms, &open);
            }
            assert_eq!(update(&mut hold, 900, &other), advice);
            assert!(hold.progress() < 0.1 && hold.readings().len() <= 1);
        }
    }
}
