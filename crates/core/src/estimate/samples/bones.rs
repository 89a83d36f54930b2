//! Samples of the rotations of bones: joint angles of one arm.

use std::time::Duration;

use crate::estimate::{Estimate, JointLimits, Rejection, angles_from_bones};
use crate::hand::{ArmBone, ArmRotations, BoneRotations, FingerSet, Side};
use crate::time::Timestamp;

/// The time for which a bone that is not sent keeps its last rotation: each lost datagram contains some bones of one frame.
const HOLD: Duration = Duration::from_millis(200);

/// The converter of one arm.
#[derive(Clone, Debug, Default)]
pub(super) struct BoneConverter {
    /// The last rotation of every bone seen so far.
    last: ArmRotations,
    seen_at: [Timestamp; ArmBone::COUNT],
    has_lost_arm: bool,
}

impl BoneConverter {
    /// Returns `true` if a bone of the arm was not sent for longer than the hold time.
    pub(super) fn has_lost_arm(&self) -> bool {
        self.has_lost_arm
    }

    /// Writes the angles of the arm of one side into `estimate`, within the joint limits.
    ///
    /// A bone that is not sent keeps its last rotation for the hold time. After that, its finger is untrusted, or the whole
    /// hand if it is a bone of the arm. A finger with a bone that was never sent is untrusted too.
    pub(super) fn convert(
        &mut self,
        bones: &BoneRotations,
        side: Side,
        limits: Option<&JointLimits>,
        estimate: &mut Estimate,
    ) -> Result<(), Rejection> {
        let arm = bones.arm(side);
        if arm.is_empty() {
            return Err(Rejection::WrongShape);
        }
        for (bone, rotation) in arm.known() {
            if !rotation.is_finite() {
                return Err(Rejection::NotFinite);
            }
            if rotation.length_squared() < 1e-6 {
                return Err(Rejection::Collapsed);
            }
            self.last.set(bone, rotation);
            self.seen_at[bone.index()] = estimate.time;
        }
        estimate.angles = angles_from_bones(&self.last, side);
        if let Some(limits) = limits {
            limits.clamp_all(&mut estimate.angles);
        }
        let time = estimate.time;
        let is_lost = |bone: ArmBone| bone.finger().is_none() && !self.is_held(bone, time);
        let has_lost_arm = self.last.known().any(|(bone, _)| is_lost(bone));
        self.has_lost_arm = has_lost_arm;
        estimate.untrusted = self.untrusted(time);
        Ok(())
    }

    /// Returns `true` if a bone was sent within the hold time before `time`.
    fn is_held(&self, bone: ArmBone, time: Timestamp) -> bool {
        self.last.is_known(bone) && time.since(self.seen_at[bone.index()]) <= HOLD
    }

    fn untrusted(&self, time: Timestamp) -> FingerSet {
        if self.has_lost_arm {
            return FingerSet::ALL;
        }
        let lost = ArmBone::ALL
            .iter()
            .filter(|bone| !self.is_held(**bone, time));
        let fingers = lost.filter_map(|bone| bone.finger());
        fingers.fold(FingerSet::NONE, FingerSet::with)
    }
}

#[cfg(test)]
mod tests {
    use glam::Quat;

    use super::*;
    use crate::hand::{Dof, Finger, JointAngles};

    fn frame(bones: &[ArmBone]) -> BoneRotations {
        let mut frame = BoneRotations::default();
        for &bone in bones {
            frame.right.set(bone, Quat::from_rotation_y(0.5));
        }
        frame
    }

    #[test]
    fn a_bone_that_is_not_sent_is_held_then_its_finger_or_the_hand_is_untrusted() {
        let mut converter = BoneConverter::default();
        let mut convert = |milliseconds: u64, bones: &[ArmBone]| {
            let time = Timestamp(1000 * milliseconds);
            let mut estimate = Estimate::new(time, JointAngles::default());
            let converted = converter.convert(&frame(bones), Side::Right, None, &mut estimate);
            assert_eq!(converted, Ok(()));
            estimate
        };
        let index = [
            ArmBone::IndexFirst,
            ArmBone::IndexSecond,
            ArmBone::IndexThird,
        ];
        let all = [&index[..], &[ArmBone::LowerArm]].concat();
        let is_trusted = |estimate: &Estimate| !estimate.untrusted.contains(Finger::Index);
        let whole = convert(0, &all);
        assert!(is_trusted(&whole));
        assert!(whole.untrusted.contains(Finger::Middle));
        let cut = convert(100, &index);
        assert!(is_trusted(&cut));
        assert_eq!(
            cut.angles.get(Dof::ElbowFlexion),
            whole.angles.get(Dof::ElbowFlexion)
        );
        assert!(is_trusted(&convert(150, &[ArmBone::LowerArm])));
        let no_tip = convert(310, &all[1..]);
        assert!(!is_trusted(&no_tip), "the first bone came 210 ms ago");
        assert!(is_trusted(&convert(320, &all)));
        assert_eq!(convert(521, &index).untrusted, FingerSet::ALL);
        assert!(converter.has_lost_arm());
    }

    #[test]
    fn an_arm_without_bones_and_rotations_without_length_are_rejected() {
        let mut converter = BoneConverter::default();
        let mut reject = |frame: &BoneRotations| {
            let mut estimate = Estimate::new(Timestamp(1), JointAngles::default());
            converter
                .convert(frame, Side::Right, None, &mut estimate)
                .unwrap_err()
        };
        let mut bones = BoneRotations::default();
        bones.left.set(ArmBone::Hand, Quat::IDENTITY);
        assert_eq!(reject(&bones), Rejection::WrongShape);
        for (rotation, rejection) in [
            (Quat::from_xyzw(0.0, 0.0, 0.0, 0.0), Rejection::Collapsed),
            (
                Quat::from_xyzw(f32::NAN, 0.0, 0.0, 1.0),
                Rejection::NotFinite,
            ),
        ] {
            bones.right.set(ArmBone::Hand, rotation);
            assert_eq!(reject(&bones), rejection);
        }
    }
}
