//! The room of a person who carries a board with one hand and uses it with the other.

use glam::{DVec3, Quat, Vec3};
use parry3d::math::Pose;

use super::sensed_hand::SensedHand;
use super::typing_hand::TypingHand;
use crate::capture::Sample;
use crate::contact::surface::{Anchor, Scene};
use crate::hand::{Finger, Joint, Side};
use crate::kinematics::HandPose;

/// Amplitudes of the sway of a person who stands, to the right, up and backwards, in metres, and the time of each in seconds. No two
/// times are multiples, so that the carried board comes to each key at another place.
const SWAY: [(f64, f64); 3] = [(0.02, 4.1), (0.008, 2.3), (0.012, 5.3)];

/// Height of the fingertip of a hand that rests above a carried board, over the wrist of the hand that carries it, in metres: half of a
/// wrist and the board.
const CARRIED_BELOW: f32 = 0.04;
/// Distance of that fingertip from that wrist, away from the elbow, in metres: a finger has more room to bend than to stretch.
const CARRIED_NEARER: f32 = 0.035;

/// Returns the wrist of the hand that carries a board for a hand in the pose `rest` (world, metres); `None` if a joint is not known.
pub(super) fn place_of_carrier(rest: &HandPose) -> Option<Vec3> {
    let tip = rest.fingertip(Finger::Index)?;
    Some(tip - Vec3::Y * CARRIED_BELOW - forearm(rest)? * CARRIED_NEARER)
}

/// Returns the horizontal direction from the elbow to the wrist; `None` if a joint is not known.
fn forearm(pose: &HandPose) -> Option<Vec3> {
    let along = pose.position(Joint::Wrist)? - pose.position(Joint::Elbow)?;
    (along * Vec3::new(1.0, 0.0, 1.0)).try_normalize()
}

/// The place of both hands of a person in one room, whose frame is the frame of the hand that types.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Room {
    carrier: Side,
    room_from_carrier: Pose,
}

impl Room {
    /// Returns the room of two hands, or `None` if neither carries a board of the other.
    pub(super) fn new(scene: &Scene, hands: &[SensedHand]) -> Option<Self> {
        let mut surfaces = scene.surfaces().iter();
        let carried = surfaces.find(|surface| surface.anchor() == Anchor::OtherHand)?;
        let typing = hands.iter().find(|it| carried.side() == Some(it.side))?;
        let carrier = hands.iter().find(|it| it.side != typing.side)?;
        Some(Self {
            carrier: carrier.side,
            room_from_carrier: carrier.hand.hand().carried_to(typing.hand.hand())?,
        })
    }

    /// Moves what a sensor measured of a hand in the frame of its arm to the room, `seconds` after the start. Both hands sway
    /// together: the person keeps the finger at the board.
    pub(super) fn place(&self, side: Side, seconds: f64, sample: &mut Sample) {
        let Sample::Joints { positions } = sample else {
            return;
        };
        let room_from_arm = if side == self.carrier {
            self.room_from_carrier
        } else {
            Pose::IDENTITY
        };
        let rotation = room_from_arm.rotation.as_dquat();
        let sway = SWAY.map(|(metres, period)| {
            let turns = seconds / period;
            metres * (turns * std::f64::consts::TAU).sin()
        });
        let translation = room_from_arm.translation.as_dvec3() + DVec3::from_array(sway);
        for (joint, position) in positions.clone().known() {
            positions.set(joint, rotation * position + translation);
        }
    }
}

impl TypingHand {
    /// Returns the pose of this arm in the frame of the arm that types on what this hand carries: the forearm lies across the forearm
    /// that types, and the wrist is at its [place](place_of_carrier). `None` if a joint is not known.
    fn carried_to(&self, typing: &Self) -> Option<Pose> {
        let own = forearm(&self.resting_pose)?;
        let forward = forearm(&typing.resting_pose)?;
        let to_the_right = forward.cross(Vec3::Y);
        let across = match typing.side() {
            Side::Right => to_the_right,
            Side::Left => -to_the_right,
        };
        let rotation = Quat::from_rotation_y(own.cross(across).y.atan2(own.dot(across)));
        let wrist = self.resting_pose.position(Joint::Wrist)?;
        let translation = typing.resting_pose.other_wrist? - rotation * wrist;
        Some(Pose::from_parts(translation, rotation))
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::kinematics::{ArmModel, BoneLengths};

    /// Returns the hand of an arm with lengths in metres.
    fn hand(side: Side, hand: f64, forearm: f64) -> TypingHand {
        let bones = BoneLengths::from_hand_and_forearm(hand, forearm).expect("lengths");
        let arm = ArmModel::anthropometric(side, &bones).expect("an arm");
        TypingHand::without_glove(&arm)
    }

    #[test]
    fn a_carried_wrist_is_below_the_fingertip_that_rests_and_its_forearm_lies_across() {
        for side in [Side::Right, Side::Left] {
            let (typing, carrier) = (hand(side, 0.16, 0.22), hand(side.opposite(), 0.2, 0.27));
            let room_from_carrier = carrier.carried_to(&typing).expect("a place");
            let at = |joint| {
                let own = carrier.resting_pose.position(joint).expect("a joint");
                room_from_carrier.transform_point(own)
            };
            let tip = typing.resting_pose.fingertip(Finger::Index);
            let from_tip = at(Joint::Wrist) - tip.expect("a fingertip");
            assert!((from_tip.y + CARRIED_BELOW).abs() < 1e-5, "{from_tip}");
            assert!(from_tip.length() < 0.06, "{from_tip}");
            let along = at(Joint::Wrist) - at(Joint::Elbow);
            let forward = forearm(&typing.resting_pose).expect("a forearm");
            assert!(along.dot(forward).abs() < 1e-3, "{along}");
            let to_the_right = along.dot(forward.cross(Vec3::Y));
            assert_eq!(to_the_right > 0.0, side == Side::Right, "{along}");
            let up = room_from_carrier.rotation * Vec3::Y;
            assert!(up.abs_diff_eq(Vec3::Y, 1e-6), "{up}");
        }
    }
}
