//! The hands of a view, as the control socket sends them.

use parry3d::math::{Pose, Rotation, Vec3};
use serde::{Deserialize, Serialize};

use ademan_core::hand::{Joint, Side};
use ademan_core::kinematics::{HandPose, StartPlace};
use ademan_core::time::Timestamp;

/// The largest coordinate of a position that is accepted from a session, in metres.
const MAX_COORDINATE: f32 = 100.0;

/// A pose as seven numbers: the position in metres, and the orientation as a quaternion x, y, z, w.
pub(in crate::session) type PoseNumbers = [f32; 7];

/// The pose of a hand.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct ViewHand {
    /// The hand.
    side: Side,
    /// Time of its last reading.
    time_us: Timestamp,
    /// The radius of the fingertips.
    tip_radius_mm: f32,
    /// The index fingertip of the hand at the start, in metres.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    start: Option<[f32; 3]>,
    /// The index knuckle of the hand at the start, in metres.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    start_knuckle: Option<[f32; 3]>,
    /// The wrist of the hand at the start, in metres.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    start_wrist: Option<[f32; 3]>,
    /// The index fingertip at the start of the hand that was placed first, in metres.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    shared_start: Option<[f32; 3]>,
    /// The position of the wrist of the other hand, in metres.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    other_wrist: Option<[f32; 3]>,
    /// The poses in the world of the joints that are known.
    joints: Vec<(Joint, PoseNumbers)>,
}

impl From<&HandPose> for ViewHand {
    fn from(pose: &HandPose) -> Self {
        let known = pose.known();
        Self {
            side: pose.side,
            time_us: pose.time,
            tip_radius_mm: pose.tip_radius * 1e3,
            start: pose.start.own.map(|place| place.to_array()),
            start_knuckle: pose.start.knuckle.map(|place| place.to_array()),
            start_wrist: pose.start.wrist.map(|place| place.to_array()),
            shared_start: pose.start.shared.map(|place| place.to_array()),
            other_wrist: pose.other_wrist.map(|place| place.to_array()),
            joints: known
                .map(|(joint, world_from_joint)| (joint, pose_numbers(world_from_joint)))
                .collect(),
        }
    }
}

impl ViewHand {
    /// Returns the pose. A joint whose numbers are not a pose is not known.
    pub fn pose(&self) -> HandPose {
        let place = |numbers: Option<[f32; 3]>| numbers.and_then(position);
        let mut pose = HandPose::new(self.time_us, self.side, self.tip_radius_mm / 1e3);
        pose.start = StartPlace {
            own: place(self.start),
            shared: place(self.shared_start),
            knuckle: place(self.start_knuckle),
            wrist: place(self.start_wrist),
        };
        pose.other_wrist = place(self.other_wrist);
        for (joint, numbers) in &self.joints {
            if let Some(world_from_joint) = pose_from(*numbers) {
                pose.set(*joint, world_from_joint);
            }
        }
        pose
    }
}

/// Returns the numbers of a pose.
pub(in crate::session) fn pose_numbers(pose: &Pose) -> PoseNumbers {
    let ([x, y, z], [i, j, k, w]) = (pose.translation.to_array(), pose.rotation.to_array());
    [x, y, z, i, j, k, w]
}

/// Returns the pose of numbers from another process; `None` if they are none.
pub(in crate::session) fn pose_from([x, y, z, i, j, k, w]: PoseNumbers) -> Option<Pose> {
    let rotation = Rotation::from_xyzw(i, j, k, w);
    let is_rotation = (rotation.length() - 1.0).abs() < 1e-3;
    let translation = position([x, y, z])?;
    is_rotation.then(|| Pose::from_parts(translation, rotation.normalize()))
}

fn position(numbers: [f32; 3]) -> Option<Vec3> {
    // A number that is not finite is in no range.
    let is_near = numbers.iter().all(|it| it.abs() <= MAX_COORDINATE);
    is_near.then(|| Vec3::from_array(numbers))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_hand_is_the_same_after_the_socket() {
        let mut pose = HandPose::new(Timestamp(12_400), Side::Left, 0.008);
        let at = Pose::from_parts(Vec3::new(0.1, -0.2, 0.3), Rotation::from_rotation_x(0.5));
        pose.set(Joint::Wrist, at);
        pose.start.own = Some(Vec3::new(0.0, 0.1, 0.2));
        pose.start.knuckle = Some(Vec3::new(0.0, 0.1, 0.3));
        pose.start.wrist = Some(Vec3::new(0.0, 0.1, 0.4));
        let line = serde_json::to_string(&ViewHand::from(&pose)).unwrap();
        let hand: ViewHand = serde_json::from_str(&line).unwrap();
        let received = hand.pose();
        let difference = received.get(Joint::Wrist).unwrap().translation - at.translation;
        assert!(difference.length() < 1e-6, "{difference}");
        assert_eq!(received.start, pose.start);
        assert_eq!((received.side, received.time), (pose.side, pose.time));
        assert_eq!(received.known().count(), 1);
    }

    #[test]
    fn numbers_that_are_no_pose_are_left_out() {
        let identity = [0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 1.0];
        assert_eq!(pose_from(identity), Some(Pose::IDENTITY));
        for (index, number) in [(0, f32::INFINITY), (2, 1e3), (3, f32::NAN), (6, 0.0)] {
            let mut numbers = identity;
            numbers[index] = number;
            assert_eq!(pose_from(numbers), None, "{numbers:?}");
        }
    }
}
