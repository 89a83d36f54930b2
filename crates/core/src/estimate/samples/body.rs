//! Samples of body landmarks: joint angles and positions of one arm.

use std::f64::consts::PI;

use glam::DVec3;
use parry3d::math::Vec3;

use super::body_angles::BodyAngles;
use super::body_points::SeenPoints;
use super::{LANDMARK_HOLD, MIN_CONFIDENCE};
use crate::capture::body::{BODY_LANDMARKS, BodyLandmarks};
use crate::estimate::arm_attributes::{
    ArmAttributes, ArmAttributesError, HALF_POSE_ROWS, HalfPose, shoulder_basis,
};
use crate::estimate::{Estimate, EstimatorSettings, JointLimits, Rejection};
use crate::hand::{BodyPoints, Dof, Finger, FingerSet, Joint, JointAngles, Side};
use crate::time::Timestamp;

/// The first landmark of a half pose: the left shoulder.
const FIRST_ROW: usize = 11;

/// The pairs of landmarks, from the shoulders on, without which an arm is not seen: all but the thumbs and hips. The
/// hips of a person at a desk are never visible, and models still place them well.
const REQUIRED_PAIRS: usize = 5;

/// The elbow flexion, in radians, below which the plane of the arm is mostly noise.
const MIN_CLEAR_FLEXION: f64 = 0.2;

/// The fingers without a landmark.
const UNSEEN: [Finger; 2] = [Finger::Middle, Finger::Ring];

/// The converter of the landmarks of one arm, with its last estimate.
#[derive(Clone, Debug, Default)]
pub(super) struct BodyConverter {
    held: Option<Held>,
    angles: BodyAngles,
    points: SeenPoints,
}

/// The last arm that was seen.
#[derive(Clone, Debug)]
struct Held {
    time: Timestamp,
    angles: JointAngles,
    joints: [(Joint, Vec3); JOINTS],
    /// `true` if it has not been seen for longer than the hold time.
    is_lost: bool,
}

/// The number of joints with a position.
const JOINTS: usize = 9;

impl BodyConverter {
    /// Returns head and hip, in the frame of the joints.
    pub(super) fn points(&self) -> &BodyPoints {
        self.points.points()
    }

    /// Returns `true` if the arm was seen, but not for longer than the hold time.
    pub(super) fn has_lost_arm(&self) -> bool {
        self.held.as_ref().is_some_and(|held| held.is_lost)
    }

    /// Writes the angles and positions of the arm of one side into `estimate`.
    ///
    /// An arm whose landmarks have a confidence below the limit keeps its last pose for the hold time. After that it is
    /// lost: its fingers are untrusted, so that they press nothing, until it is seen again. Head and legs do not need an arm.
    pub(super) fn convert(
        &mut self,
        body: &BodyLandmarks,
        side: Side,
        settings: &EstimatorSettings,
        estimate: &mut Estimate,
    ) -> Result<(), Rejection> {
        if body.points.len() != BODY_LANDMARKS {
            return Err(Rejection::WrongShape);
        }
        let (angles, inputs) = (&mut self.angles, &mut estimate.inputs);
        angles.write(body, settings, estimate.time, inputs);
        if confidence(body, side) >= MIN_CONFIDENCE {
            let was_lost = self.held.as_ref().is_some_and(|held| held.is_lost);
            let pose = half_pose(body);
            let frame = ArmFrame::new(&pose, side)?;
            let seen = self.see(&pose, &frame, settings.limits.as_ref(), estimate.time)?;
            estimate.jumped = was_lost;
            seen.write(estimate);
            let position = |landmark| frame.position(landmark);
            self.points
                .see(body, side, settings, estimate.time, position);
        } else {
            self.points.hold(settings, estimate.time);
            match &mut self.held {
                Some(held) => {
                    held.is_lost |= estimate.time.since(held.time) > LANDMARK_HOLD;
                    held.write(estimate);
                }
                None if estimate.inputs.has_angles() => {
                    estimate.untrusted = FingerSet::ALL;
                    estimate.is_placed = false;
                }
                None => return Err(Rejection::LowConfidence),
            }
        }
        Ok(())
    }

    fn see(
        &mut self,
        pose: &HalfPose,
        frame: &ArmFrame,
        limits: Option<&JointLimits>,
        time: Timestamp,
    ) -> Result<&Held, Rejection> {
        let side = frame.side;
        let attributes = ArmAttributes::from_landmarks(pose, side).map_err(rejection)?;
        let angles = attributes.joint_angles(side).ok_or(Rejection::Collapsed)?;
        let mut angles = steady_plane(angles, self.held.as_ref());
        if let Some(limits) = limits {
            limits.clamp_all(&mut angles);
        }
        let joints = joints(pose, frame);
        Ok(self.held.insert(Held {
            time,
            angles,
            joints,
            is_lost: false,
        }))
    }
}

impl Held {
    fn write(&self, estimate: &mut Estimate) {
        estimate.angles = self.angles;
        for (joint, position) in self.joints {
            estimate.measured.set(joint, position);
        }
        estimate.untrusted = if self.is_lost {
            FingerSet::ALL
        } else {
            UNSEEN.into_iter().fold(FingerSet::NONE, FingerSet::with)
        };
    }
}

/// Returns the lowest confidence of the landmarks that show an arm: its own without the thumb, and the other shoulder.
/// NaN counts as 0.
fn confidence(body: &BodyLandmarks, side: Side) -> f32 {
    let at = |pair: usize, arm: Side| {
        body.points[FIRST_ROW + Side::COUNT * pair + arm.index()].confidence
    };
    let own = (0..REQUIRED_PAIRS).map(|pair| at(pair, side));
    own.chain([at(0, side.opposite())])
        .map(|confidence| if confidence.is_nan() { 0.0 } else { confidence })
        .fold(1.0, f32::min)
}

fn half_pose(body: &BodyLandmarks) -> HalfPose {
    let rows: [DVec3; HALF_POSE_ROWS] = std::array::from_fn(|row| {
        let [x, y, z] = body.points[FIRST_ROW + row].position;
        DVec3::new(f64::from(x), f64::from(y), f64::from(z))
    });
    HalfPose::from_rows(&rows)
}

fn rejection(error: ArmAttributesError) -> Rejection {
    match error {
        ArmAttributesError::NotFinite => Rejection::NotFinite,
        _ => Rejection::Collapsed,
    }
}

/// Replaces the plane of an almost straight arm by the last one: the upper arm is not turned about its axis, and the forearm
/// gets the whole turn.
fn steady_plane(mut angles: JointAngles, last: Option<&Held>) -> JointAngles {
    if let Some(last) = last
        && angles.get(Dof::ElbowFlexion) < MIN_CLEAR_FLEXION
    {
        let turn = last.angles.get(Dof::ShoulderX) - angles.get(Dof::ShoulderX);
        let supination = angles.get(Dof::ForearmSupination) - turn;
        angles.set(Dof::ShoulderX, last.angles.get(Dof::ShoulderX));
        angles.set(Dof::ForearmSupination, nearest_turn(supination));
    }
    angles
}

/// Returns the equal angle around the middle of the supination range, −π/2..3π/2.
fn nearest_turn(radians: f64) -> f64 {
    (radians + PI / 2.0).rem_euclid(2.0 * PI) - PI / 2.0
}

/// The frame of an arm, which moves with the body: the origin is the shoulder, X points to the right, Y up the trunk and Z backwards.
struct ArmFrame {
    side: Side,
    shoulder: DVec3,
    right: DVec3,
    down: DVec3,
    back: DVec3,
}

impl ArmFrame {
    fn new(pose: &HalfPose, side: Side) -> Result<Self, Rejection> {
        let basis = shoulder_basis(&pose.trunk(), side).map_err(rejection)?;
        // The first axis points outwards, the third backwards for the left arm and forwards for the right.
        let (right, back) = match side {
            Side::Left => (-basis.x_axis, basis.z_axis),
            Side::Right => (basis.x_axis, -basis.z_axis),
        };
        Ok(Self {
            side,
            shoulder: pose.arm(side).shoulder,
            right,
            down: basis.y_axis,
            back,
        })
    }

    /// Returns the position of a landmark, in metres.
    fn position(&self, landmark: DVec3) -> Vec3 {
        let offset = landmark - self.shoulder;
        DVec3::new(
            offset.dot(self.right),
            -offset.dot(self.down),
            offset.dot(self.back),
        )
        .as_vec3()
    }
}

/// Returns the positions of the joints of an arm in its frame, in metres.
///
/// The landmark of a finger is its knuckle, or the last joint of the thumb. It is also the point that touches, because no
/// landmark is closer to the tip.
fn joints(pose: &HalfPose, frame: &ArmFrame) -> [(Joint, Vec3); JOINTS] {
    let arm = pose.arm(frame.side);
    let position = |landmark| frame.position(landmark);
    let [index, little, thumb] = [arm.index, arm.little, arm.thumb].map(position);
    [
        (Joint::Shoulder, position(arm.shoulder)),
        (Joint::Elbow, position(arm.elbow)),
        (Joint::Wrist, position(arm.wrist)),
        (Joint::IndexPhalanxProximal, index),
        (Joint::IndexTip, index),
        (Joint::LittlePhalanxProximal, little),
        (Joint::LittleTip, little),
        (Joint::ThumbPhalanxDistal, thumb),
        (Joint::ThumbTip, thumb),
    ]
}
