//! Landmarks → attributes.

use std::f64::consts::{FRAC_PI_2, PI, TAU};

use glam::{DMat3, DVec3};

use super::bases::{MIN_RELATIVE_LENGTH, hand_basis, shoulder_basis, sided_cross, sign};
use super::full_rotation::azimuth;
use super::palm::wrist_turn;
use super::{
    ArmAttributes, ArmAttributesError, FullRotation, HalfPose, MIN_ELBOW_SINE, STRAIGHT_LANDMARKS,
};
use crate::geometry::{angle_between, unit};
use crate::hand::Side;

/// The largest inclination of the wrist, in radians, that is rounding: its azimuth means nothing.
const NO_INCLINATION: f64 = 1.5e-8;

impl ArmAttributes {
    /// Returns the attributes of the arm of one side.
    pub fn from_landmarks(pose: &HalfPose, side: Side) -> Result<Self, ArmAttributesError> {
        let (trunk, arm) = (pose.trunk(), pose.arm(side));
        let image_from_shoulder = shoulder_basis(&trunk, side)?;
        let image_from_hand = hand_basis(arm, side)?;
        let hand_from_image = image_from_hand.transpose();

        let smallest = MIN_RELATIVE_LENGTH * trunk.extent();
        let upper_arm =
            direction(arm.elbow - arm.shoulder, smallest).ok_or(ArmAttributesError::NoUpperArm)?;
        let forearm =
            direction(arm.wrist - arm.elbow, smallest).ok_or(ArmAttributesError::NoForearm)?;
        let shoulder_direction = image_from_shoulder.transpose() * upper_arm;
        let full =
            FullRotation::new(side, shoulder_direction).ok_or(ArmAttributesError::NoUpperArm)?;

        let (wrist_inclination, wrist_rotation) = wrist_angles(-(hand_from_image * forearm));
        let turns = Turns {
            side,
            // Without the inclination of the wrist the palm faces along the first axis of the forearm.
            palm: wrist_turn(wrist_inclination, wrist_rotation)
                .transpose()
                .x_axis,
            elbow_from_wrist: -(hand_from_image * forearm),
            hand_from_shoulder: hand_from_image * image_from_shoulder,
            full_normal: full.normal,
        };
        let flexion = angle_between(upper_arm, forearm);
        let (elbow_angle, [shoulder_rotation, elbow_rotation]) = if flexion <= STRAIGHT_LANDMARKS {
            (PI, turns.of_straight_elbow())
        } else if upper_arm.cross(forearm).length() < MIN_ELBOW_SINE {
            return Err(ArmAttributesError::FoldedElbow);
        } else {
            let normal = image_from_shoulder.transpose() * upper_arm.cross(forearm).normalize();
            (PI - flexion, turns.of_bent_elbow(normal))
        };

        let from_wrist = |finger: DVec3| hand_from_image * (finger - arm.wrist);
        Ok(Self {
            shoulder_direction,
            upper_arm_length: arm.elbow.distance(arm.shoulder),
            shoulder_rotation,
            elbow_angle,
            forearm_length: arm.wrist.distance(arm.elbow),
            elbow_rotation,
            wrist_rotation,
            wrist_inclination,
            little_vector: from_wrist(arm.little),
            index_vector: from_wrist(arm.index),
            thumb_vector: from_wrist(arm.thumb),
        })
    }
}

impl ArmAttributes {
    /// Returns the attributes with a shoulder rotation that has a sign: negative if the arm is turned past the
    /// [full rotation](FullRotation). Unlike without the sign, [`landmarks`](Self::landmarks) gives every pose back.
    pub fn signed_from_landmarks(pose: &HalfPose, side: Side) -> Result<Self, ArmAttributesError> {
        let attributes = Self::from_landmarks(pose, side)?;
        let turned_past = Self {
            shoulder_rotation: -attributes.shoulder_rotation,
            ..attributes
        };
        let arm = pose.arm(side);
        let error = |candidate: &Self| {
            let landmarks = candidate.landmarks(&pose.trunk(), side)?;
            Ok(landmarks.wrist.distance(arm.wrist) + landmarks.index.distance(arm.index))
        };
        if error(&turned_past)? < error(&attributes)? {
            Ok(turned_past)
        } else {
            Ok(attributes)
        }
    }
}

/// Returns the direction of a limb that is longer than `smallest`.
fn direction(limb: DVec3, smallest: f64) -> Option<DVec3> {
    (limb.length() > smallest).then(|| unit(limb)).flatten()
}

/// Returns inclination and rotation of the wrist. `elbow_from_wrist` is the unit direction from wrist to elbow in the
/// [basis of the hand](hand_basis).
pub fn wrist_angles(elbow_from_wrist: DVec3) -> (f64, f64) {
    let DVec3 { x, y, z } = elbow_from_wrist;
    let inclination = x.hypot(y).atan2(-z);
    if inclination <= NO_INCLINATION {
        (0.0, 0.0)
    } else {
        (inclination, azimuth(x, y))
    }
}

/// The directions from which the turns of shoulder and forearm are measured.
struct Turns {
    side: Side,
    /// The palm normal of a hand in line with the forearm, in the basis of the hand.
    palm: DVec3,
    /// The direction from wrist to elbow, in the basis of the hand.
    elbow_from_wrist: DVec3,
    hand_from_shoulder: DMat3,
    /// The normal of the arm at full rotation, in the basis of the shoulder.
    full_normal: DVec3,
}

impl Turns {
    /// Returns shoulder and elbow rotation of an arm whose plane has this normal in the basis of the shoulder.
    fn of_bent_elbow(&self, normal: DVec3) -> [f64; 2] {
        let shoulder_rotation = angle_between(normal, self.full_normal);
        // The palm normal of a forearm that is not turned.
        let neutral = self.hand_from_shoulder * normal * sign(self.side);
        let across = sided_cross(self.side, neutral, self.elbow_from_wrist).dot(self.palm);
        let elbow_rotation = if across == 0.0 {
            0.0
        } else {
            across.atan2(neutral.dot(self.palm))
        };
        [shoulder_rotation, elbow_rotation]
    }

    /// Returns equal halves of the total turn, as shoulder and elbow rotation.
    fn of_straight_elbow(&self) -> [f64; 2] {
        let full = self.hand_from_shoulder * self.full_normal;
        let across = self.elbow_from_wrist.cross(full);
        // Across is shorter than 1 if the elbow is not quite straight; the formula takes the cosine as it is.
        let turn = self.palm.dot(across).clamp(-1.0, 1.0).acos();
        let total = if sign(self.side) * self.palm.dot(full) >= 0.0 {
            turn
        } else {
            TAU - turn
        };
        [total / 2.0, total / 2.0 - FRAC_PI_2]
    }
}
