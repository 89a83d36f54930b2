//! Sensors of a simulated hand, and what they measure of its postures.

use glam::{Quat, Vec3};

use crate::capture::body::{BODY_LANDMARKS, BodyLandmarks, Landmark};
use crate::capture::{Sample, SampleKind};
use crate::estimate::{ChannelMap, Estimate, JointAngles, bones_from_angles};
use crate::hand::{
    BodyAngle, BodyPoint, BodyPoints, BoneRotations, Displacement, Finger, Joint, Side,
};
use crate::kinematics::{ArmModel, HandPose};
use crate::time::Timestamp;

/// The sensor of a simulated hand.
#[derive(Clone, Copy, Debug)]
pub enum Sensor<'a> {
    /// A glove with these channels.
    Glove(&'a ChannelMap),
    /// A sensor of the joints, without a glove.
    Joints(JointSensor),
}

/// A sensor of joints, by the kind of its samples.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum JointSensor {
    /// Joint angles.
    Angles,
    /// Positions of all joints.
    Positions,
    /// Landmarks of a body. The landmarks of thumb, index and little finger are the fingertips, because these touch the keys.
    Body,
    /// Rotations of the bones.
    Bones,
    /// The displacement of the wrist. The person moves a stiff hand, without turning it, so that the index fingertip takes
    /// the path that it takes when the fingers bend.
    Displacement,
}

impl<'a> Sensor<'a> {
    /// Returns the sensor whose samples are of `kind`; `None` if that is a glove and there is none.
    pub fn for_kind(kind: SampleKind, glove: Option<&'a ChannelMap>) -> Option<Self> {
        Some(Self::Joints(match kind {
            SampleKind::Channels => return glove.map(Self::Glove),
            SampleKind::Angles => JointSensor::Angles,
            SampleKind::Joints => JointSensor::Positions,
            SampleKind::Body => JointSensor::Body,
            SampleKind::Bones => JointSensor::Bones,
            SampleKind::Displacement => JointSensor::Displacement,
        }))
    }
}

impl JointSensor {
    /// Returns what the sensor measures of a hand with these angles.
    pub(super) fn measure(self, arm: &ArmModel, angles: &JointAngles) -> Sample {
        self.measure_with_body(arm, angles, &BodyPosture::default())
    }

    /// Returns what the sensor measures of a hand with these angles and of the body.
    pub(super) fn measure_with_body(
        self,
        arm: &ArmModel,
        angles: &JointAngles,
        posture: &BodyPosture,
    ) -> Sample {
        let pose_of = |joints| arm.forward(&Estimate::new(Timestamp(0), joints));
        match self {
            Self::Angles => Sample::Angles { angles: *angles },
            Self::Positions => Sample::Joints {
                positions: pose_of(*angles).positions(),
            },
            Self::Body => Sample::Body(body(&pose_of(*angles), posture)),
            Self::Bones => {
                let mut bones = BoneRotations::default();
                *bones.arm_mut(arm.side()) = bones_from_angles(angles, arm.side());
                Sample::Bones { bones }
            }
            Self::Displacement => {
                let tip = |joints| pose_of(joints).fingertip(Finger::Index).unwrap_or_default();
                let translation = tip(*angles) - tip(JointAngles::default());
                let displacement = Displacement::new(Joint::Wrist, translation, Quat::IDENTITY);
                Sample::Displacement { displacement }
            }
        }
    }
}

/// The angles of head and legs, in radians.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub(super) struct BodyPosture([f64; BodyAngle::COUNT]);

impl BodyPosture {
    /// Sets an angle, in radians.
    pub(super) fn set(&mut self, angle: BodyAngle, radians: f64) {
        self.0[angle.index()] = radians;
    }

    fn get(&self, angle: BodyAngle) -> f32 {
        self.0[angle.index()] as f32
    }

    /// Returns the landmarks of the head, from between the shoulders: index, and position to the right, up and backwards.
    fn head(&self) -> [(usize, Vec3); HEAD.len()] {
        let turn = Quat::from_rotation_y(-self.get(BodyAngle::HeadYaw))
            * Quat::from_rotation_x(self.get(BodyAngle::HeadPitch))
            * Quat::from_rotation_z(-self.get(BodyAngle::HeadRoll));
        HEAD.map(|(index, position)| (index, NECK + turn * Vec3::from_array(position)))
    }

    /// Returns the landmarks of one leg, from its hip: knee, ankle, heel and toes. The person sits.
    fn leg(&self, side: Side) -> [Vec3; 4] {
        let (knee, foot) = match side {
            Side::Left => (BodyAngle::LeftKneeFlexion, BodyAngle::LeftFootPitch),
            Side::Right => (BodyAngle::RightKneeFlexion, BodyAngle::RightFootPitch),
        };
        let knee_position = Vec3::NEG_Z * THIGH;
        let bend = Quat::from_rotation_x(-self.get(knee));
        let shank = bend * Vec3::NEG_Z * SHANK;
        let ankle = knee_position + shank;
        // The toes are upwards of a straight leg.
        let foot = bend * Quat::from_rotation_x(self.get(foot)) * Vec3::Y;
        let heel = ankle - foot * HEEL;
        [knee_position, ankle, heel, heel + foot * FOOT]
    }
}

/// The vector from the middle of the shoulders to the middle of the ears, to the right, up and backwards, in metres.
const NECK: Vec3 = Vec3::new(0.0, 0.22, 0.0);

/// Nose, both eyes and both ears from the middle of the ears: the nose is as far below the level of the ears as the eyes are above.
const HEAD: [(usize, [f32; 3]); 5] = [
    (0, [0.0, -0.03, -0.12]),
    (2, [-0.032, 0.03, -0.1]),
    (5, [0.032, 0.03, -0.1]),
    (7, [-0.075, 0.0, 0.0]),
    (8, [0.075, 0.0, 0.0]),
];

/// Length of the thigh of a person of 1.75 m, in metres (Winter 2009, table 4.1).
const THIGH: f32 = 0.43;
/// Length of the shank, in metres; from the same table.
const SHANK: f32 = 0.43;
/// Length of the foot, in metres; from the same table.
const FOOT: f32 = 0.26;
/// Distance from the ankle to the heel, in metres.
const HEEL: f32 = 0.06;

/// Index of the landmark of the left knee. Ankles, heels and toes follow, left before right.
const FIRST_LEG: usize = 25;

/// Half of the distance between the shoulders, in metres.
const HALF_SHOULDERS: f32 = 0.18;
/// Distance from a shoulder down to the hip, in metres.
const TRUNK: f32 = 0.5;
/// Distance from a shoulder to the elbow of an arm model without a shoulder, in metres.
const UPPER_ARM: f32 = 0.3;

/// Index of the landmark of the left shoulder. Pairs of landmarks, left before right, follow.
const FIRST_PAIR: usize = 11;

/// Returns the shoulder, head and hip of a person who stands upright with the arm in this pose. They match the landmarks from [`body`].
pub(super) fn body_points(pose: &HandPose) -> BodyPoints {
    let elbow = || Some(pose.position(Joint::Elbow)? + Vec3::Y * UPPER_ARM);
    let shoulder = pose.position(Joint::Shoulder).or_else(elbow);
    let inwards = match pose.side {
        Side::Left => Vec3::X * HALF_SHOULDERS,
        Side::Right => Vec3::NEG_X * HALF_SHOULDERS,
    };
    let mut points = BodyPoints::default();
    points.set(BodyPoint::Shoulder, shoulder);
    let head = shoulder.map(|shoulder| shoulder + inwards + NECK);
    points.set(BodyPoint::Head, head);
    points.set(
        BodyPoint::Hip,
        shoulder.map(|shoulder| shoulder - Vec3::Y * TRUNK),
    );
    points
}

/// Returns the landmarks of an upright person who faces the camera. The landmarks of the other arm are not visible.
fn body(pose: &HandPose, posture: &BodyPosture) -> BodyLandmarks {
    let get = |joint| pose.position(joint).unwrap_or_default();
    let shoulder = pose.position(Joint::Shoulder);
    let shoulder = shoulder.unwrap_or_else(|| get(Joint::Elbow) + Vec3::Y * UPPER_ARM);
    let outwards = |side| match side {
        Side::Left => Vec3::NEG_X * HALF_SHOULDERS,
        Side::Right => Vec3::X * HALF_SHOULDERS,
    };
    let arm = [
        shoulder,
        get(Joint::Elbow),
        get(Joint::Wrist),
        get(Joint::tip(Finger::Little)),
        get(Joint::tip(Finger::Index)),
        get(Joint::tip(Finger::Thumb)),
        shoulder - Vec3::Y * TRUNK,
    ];
    // To the right, up and backwards, from between the shoulders.
    let from_neck = |position: Vec3| position - shoulder + outwards(pose.side);
    let hidden = Landmark {
        position: [0.0; 3],
        confidence: 0.0,
    };
    let mut points = [hidden; BODY_LANDMARKS];
    let mut set = |index: usize, position: Vec3| {
        points[index] = Landmark {
            // To the right of the image, down, away from the camera.
            position: [-position.x, -position.y, position.z],
            confidence: 1.0,
        };
    };
    let index = |pair: usize, side: Side| FIRST_PAIR + Side::COUNT * pair + side.index();
    for (pair, position) in arm.into_iter().enumerate() {
        set(index(pair, pose.side), from_neck(position));
    }
    let other = pose.side.opposite();
    for pair in [0, arm.len() - 1] {
        let position = from_neck(arm[pair]);
        set(index(pair, other), position.with_x(-position.x));
    }
    for (landmark, position) in posture.head() {
        set(landmark, position);
    }
    for side in [Side::Left, Side::Right] {
        let hip = outwards(side) - Vec3::Y * TRUNK;
        for (row, position) in posture.leg(side).into_iter().enumerate() {
            set(FIRST_LEG + Side::COUNT * row + side.index(), hip + position);
        }
    }
    BodyLandmarks {
        points: points.into(),
    }
}
