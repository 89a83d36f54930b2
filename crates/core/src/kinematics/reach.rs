//! The reach of a hand: the position of its index fingertip in the typing posture.

use parry3d::math::Vec3;

use super::{ArmModel, HandPose};
use crate::estimate::{Estimate, JointAngles};
use crate::hand::{Dof, Finger, Joint};
use crate::time::Timestamp;

/// The size of an arm and hand as a board needs it, in metres.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct HandReach {
    /// The index fingertip in the typing posture relative to the elbow, with the forearm straight forward: right, up,
    /// towards the wearer.
    pub from_elbow: Vec3,
    /// The index fingertip in that posture relative to the wrist.
    pub from_wrist: Vec3,
    /// The distance from the wrist to the index fingertip of a flat hand.
    pub length: f32,
    /// The fingertips of a half bent hand relative to the wrist, thumb first. The index fingertip stands in for
    /// a finger that the model lacks.
    pub half_bent: [Vec3; 5],
}

impl ArmModel {
    /// Returns the reach, or `None` if the model lacks the elbow, the wrist or the index fingertip.
    pub fn reach(&self) -> Option<HandReach> {
        let typing = self.typing_pose();
        let tip = typing.fingertip(Finger::Index)?;
        let half_bent = self.half_bent();
        let index = half_bent.fingertip(Finger::Index)? - half_bent.position(Joint::Wrist)?;
        let flat = self.forward(&Estimate::new(Timestamp(0), JointAngles::default()));
        let reach = flat.fingertip(Finger::Index)? - flat.position(Joint::Wrist)?;
        Some(HandReach {
            from_elbow: tip - typing.position(Joint::Elbow)?,
            from_wrist: tip - typing.position(Joint::Wrist)?,
            length: reach.length(),
            half_bent: std::array::from_fn(|finger| {
                let bent_tip = half_bent.fingertip(Finger::ALL[finger]);
                let bent_tip = bent_tip.zip(half_bent.position(Joint::Wrist));
                bent_tip.map_or(index, |(bent_tip, wrist)| bent_tip - wrist)
            }),
        })
    }

    /// Returns the pose in the typing posture with the forearm straight forward, for which layouts are drawn.
    pub(crate) fn typing_pose(&self) -> HandPose {
        let mut angles = JointAngles::default();
        for &dof in Dof::ALL {
            angles.set(dof, typing_angle(dof));
        }
        angles.set(Dof::ElbowFlexion, 0.0);
        self.forward(&Estimate::new(Timestamp(0), angles))
    }

    fn half_bent(&self) -> HandPose {
        let mut angles = half_bent_fingers();
        for &dof in Dof::ALL.iter().filter(|dof| dof.finger().is_none()) {
            angles.set(dof, 0.0);
        }
        self.forward(&Estimate::new(Timestamp(0), angles))
    }
}

/// Returns the angles of the fingers of a half bent hand, as one hangs at rest.
pub fn half_bent_fingers() -> JointAngles {
    let mut angles = JointAngles::default();
    for &dof in Dof::ALL {
        if let Some(finger) = dof.finger() {
            angles.set(dof, half_bent_degrees(dof, finger).to_radians());
        }
    }
    angles
}

fn half_bent_degrees(dof: Dof, finger: Finger) -> f64 {
    match dof.name().rsplit_once('-') {
        Some((_, "flexion")) if finger == Finger::Thumb => 20.0,
        Some((joint, "flexion")) if joint.ends_with("mcp") => 20.0,
        Some((joint, "flexion")) if joint.ends_with("pip") => 30.0,
        Some((_, "flexion")) => 15.0,
        _ => 0.0,
    }
}

/// Returns an angle of the typing posture in radians: wrist straight, palm down, index finger half flexed above the
/// keys, the other fingers out of the way.
pub fn typing_angle(dof: Dof) -> f64 {
    match dof {
        Dof::ElbowFlexion => 0.6,
        Dof::WristFlexion => 0.05,
        Dof::IndexMcpFlexion => 0.45,
        Dof::IndexPipFlexion => 0.45,
        Dof::IndexDipFlexion => 0.45,
        Dof::MiddleMcpFlexion | Dof::RingMcpFlexion | Dof::LittleMcpFlexion => -0.5,
        Dof::ThumbCmcAbduction => -0.5,
        _ => 0.0,
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::hand::Side;
    use crate::kinematics::BoneLengths;

    fn reach(side: Side, hand: f64, forearm: f64) -> HandReach {
        let bones = BoneLengths::from_hand_and_forearm(hand, forearm).unwrap();
        let arm = ArmModel::anthropometric(side, &bones).unwrap();
        arm.reach().unwrap()
    }

    #[test]
    fn a_longer_forearm_reaches_farther_and_has_the_same_hand() {
        let (short, long) = (
            reach(Side::Right, 0.18, 0.24),
            reach(Side::Right, 0.18, 0.26),
        );
        let farther = long.from_elbow - short.from_elbow;
        assert!(farther.distance(Vec3::NEG_Z * 0.02) < 1e-6, "{farther}");
        assert!((long.from_wrist - short.from_wrist).length() < 1e-6);
        assert_eq!(long.length, short.length);
    }

    #[test]
    fn the_left_hand_is_the_mirror_image() {
        let (right, left) = (
            reach(Side::Right, 0.18, 0.24),
            reach(Side::Left, 0.18, 0.24),
        );
        let mirrored = right.from_elbow * Vec3::new(-1.0, 1.0, 1.0);
        assert!(mirrored.distance(left.from_elbow) < 1e-6);
    }
}
