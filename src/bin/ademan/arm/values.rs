//! The attributes of a pose as JSON.

use std::f64::consts::PI;
use std::ops::RangeInclusive;

use ademan::estimate::arm_attributes::{
    ArmAttributes, ArmAttributesError, ArmLandmarks, FullRotation, HalfPose, MIN_ELBOW_SINE,
    STRAIGHT_LANDMARKS, Trunk, hand_basis, shoulder_basis, wrist_angles,
};
use ademan::geometry::angle_between;
use ademan::hand::Side;
use glam::DVec3;
use serde::{Deserialize, Serialize};

/// The largest error of a direction or an angle that rounding explains.
const ROUNDING: f64 = 1e-3;

/// The largest length, in any unit of the landmarks: far more than the pixels of an image.
const MAX_LENGTH: f64 = 1e6;

/// The name of a refused attribute, and the reason.
type Refused = (&'static str, String);

/// One line: the trunk and the attributes of both arms.
#[derive(Clone, Debug, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Line {
    /// Time in microseconds.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub time_us: Option<u64>,
    pub trunk: TrunkValues,
    pub left: ArmValues,
    pub right: ArmValues,
}

/// Shoulders and hips, left before right.
#[derive(Clone, Copy, Debug, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct TrunkValues {
    pub shoulders: [[f64; 3]; 2],
    pub hips: [[f64; 3]; 2],
}

/// The attributes of one arm. Those that the landmarks do not determine are `null`.
#[derive(Clone, Copy, Debug, Default, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct ArmValues {
    pub shoulder_direction: Option<[f64; 3]>,
    pub upper_arm_length: Option<f64>,
    pub shoulder_rotation: Option<f64>,
    pub elbow_angle: Option<f64>,
    pub forearm_length: Option<f64>,
    pub elbow_rotation: Option<f64>,
    pub wrist_rotation: Option<f64>,
    pub wrist_inclination: Option<f64>,
    pub little_vector: Option<[f64; 3]>,
    pub index_vector: Option<[f64; 3]>,
    pub thumb_vector: Option<[f64; 3]>,
}

impl Line {
    /// Creates the line of a pose. With `is_signed`, the shoulder rotation is negative past the full rotation.
    pub fn new(time_us: Option<u64>, pose: &HalfPose, is_signed: bool) -> Self {
        let arm = |side| {
            let attributes = if is_signed {
                ArmAttributes::signed_from_landmarks(pose, side)
            } else {
                ArmAttributes::from_landmarks(pose, side)
            };
            let partial = |_| ArmValues::partial(pose, side, is_signed);
            attributes.map_or_else(partial, ArmValues::from)
        };
        Self {
            time_us,
            trunk: pose.trunk().into(),
            left: arm(Side::Left),
            right: arm(Side::Right),
        }
    }

    /// Returns the line as JSON, without a line end.
    pub fn json(&self) -> String {
        serde_json::to_string(self).expect("every key is a string")
    }

    /// Returns the pose with these attributes.
    pub fn pose(&self) -> Result<HalfPose, String> {
        let arms = [(Side::Left, &self.left), (Side::Right, &self.right)];
        let [left, right] = arms.map(|(side, arm)| {
            arm.attributes()
                .map_err(|(name, reason)| format!("`{name}` of the {side} arm {reason}"))
        });
        let trunk = self.trunk.into();
        HalfPose::from_attributes(&trunk, &[left?, right?]).map_err(|error| error.to_string())
    }
}

impl ArmValues {
    /// Returns the attributes that incomplete landmarks determine: all but those that need the missing ones, and the elbow rotation.
    /// With `is_signed`, the shoulder rotation is negative past the full rotation.
    fn partial(pose: &HalfPose, side: Side, is_signed: bool) -> Self {
        let arm = pose.arm(side);
        let length = |from: DVec3, to: DVec3| Some(from.distance(to)).filter(|it| is_length(*it));
        let (upper_arm, forearm) = (arm.elbow - arm.shoulder, arm.wrist - arm.elbow);
        let has_lengths = upper_arm != DVec3::ZERO && forearm != DVec3::ZERO;
        let flexion = if has_lengths {
            angle_between(upper_arm, forearm)
        } else {
            f64::NAN
        };
        let is_straight = flexion <= STRAIGHT_LANDMARKS;
        let angle = if is_straight { PI } else { PI - flexion };
        let mut values = Self {
            upper_arm_length: length(arm.shoulder, arm.elbow),
            forearm_length: length(arm.elbow, arm.wrist),
            elbow_angle: Some(angle).filter(|angle| angle.is_finite()),
            ..Self::default()
        };
        // The hand does not need the rest of the arm.
        let hand = ArmLandmarks {
            shoulder: arm.wrist,
            elbow: arm.wrist,
            thumb: arm.wrist,
            ..*arm
        };
        if let Ok(image_from_hand) = hand_basis(&hand, side) {
            let hand_from_image = image_from_hand.transpose();
            let from_wrist = |point: DVec3| {
                let vector = hand_from_image * (point - arm.wrist);
                Some(vector.to_array()).filter(|_| vector.is_finite())
            };
            values.little_vector = from_wrist(arm.little);
            values.index_vector = from_wrist(arm.index);
            values.thumb_vector = from_wrist(arm.thumb);
            if let Some(elbow_from_wrist) = (hand_from_image * -forearm).try_normalize() {
                let (inclination, rotation) = wrist_angles(elbow_from_wrist);
                values.wrist_inclination = Some(inclination);
                values.wrist_rotation = Some(rotation);
            }
        }
        let Ok(image_from_shoulder) = shoulder_basis(&pose.trunk(), side) else {
            return values;
        };
        let Some(direction) = (image_from_shoulder.transpose() * upper_arm).try_normalize() else {
            return values;
        };
        values.shoulder_direction = Some(direction.to_array());
        // A straight or folded arm spans no plane.
        if is_straight || flexion.sin() < MIN_ELBOW_SINE {
            return values;
        }
        let normal = image_from_shoulder.transpose() * upper_arm.cross(forearm);
        let full = FullRotation::new(side, direction);
        let rotation = full.map(|full| {
            let apart = normal.angle_between(full.normal);
            // The rotation turns the normal from the full one to this side of it.
            let across = match side {
                Side::Left => direction.cross(full.normal),
                Side::Right => full.normal.cross(direction),
            };
            let is_past = is_signed && normal.dot(across) < 0.0;
            if is_past { -apart } else { apart }
        });
        values.shoulder_rotation = rotation.filter(|rotation| rotation.is_finite());
        values
    }

    /// Returns all attributes, or the name of one that is missing or out of its range, with the reason.
    fn attributes(&self) -> Result<ArmAttributes, Refused> {
        let turn = |value, name| angle(value, name, -PI..=PI);
        let bend = |value, name| angle(value, name, 0.0..=PI);
        Ok(ArmAttributes {
            shoulder_direction: direction(self.shoulder_direction, "shoulder_direction")?,
            upper_arm_length: length(self.upper_arm_length, "upper_arm_length")?,
            shoulder_rotation: turn(self.shoulder_rotation, "shoulder_rotation")?,
            elbow_angle: bend(self.elbow_angle, "elbow_angle")?,
            forearm_length: length(self.forearm_length, "forearm_length")?,
            elbow_rotation: turn(self.elbow_rotation, "elbow_rotation")?,
            wrist_rotation: turn(self.wrist_rotation, "wrist_rotation")?,
            wrist_inclination: bend(self.wrist_inclination, "wrist_inclination")?,
            little_vector: vector(self.little_vector, "little_vector")?,
            index_vector: vector(self.index_vector, "index_vector")?,
            thumb_vector: vector(self.thumb_vector, "thumb_vector")?,
        })
    }
}

/// Returns a value that is not null.
fn known<T>(value: Option<T>, name: &'static str) -> Result<T, Refused> {
    value.ok_or_else(|| (name, "is null".to_owned()))
}

fn vector(value: Option<[f64; 3]>, name: &'static str) -> Result<DVec3, Refused> {
    known(value, name).map(DVec3::from_array)
}

fn direction(value: Option<[f64; 3]>, name: &'static str) -> Result<DVec3, Refused> {
    let direction = vector(value, name)?;
    let length = direction.length();
    if (length - 1.0).abs() <= ROUNDING {
        Ok(direction)
    } else {
        let reason = format!("has the length {length}; a direction has the length 1");
        Err((name, reason))
    }
}

fn length(value: Option<f64>, name: &'static str) -> Result<f64, Refused> {
    let length = known(value, name)?;
    if is_length(length) {
        Ok(length)
    } else {
        let reason = format!("is {length}; a length is more than 0 and at most {MAX_LENGTH}");
        Err((name, reason))
    }
}

fn is_length(length: f64) -> bool {
    length > 0.0 && length <= MAX_LENGTH
}

fn angle(
    value: Option<f64>,
    name: &'static str,
    range: RangeInclusive<f64>,
) -> Result<f64, Refused> {
    let angle = known(value, name)?;
    let (least, most) = range.into_inner();
    if (least - ROUNDING..=most + ROUNDING).contains(&angle) {
        Ok(angle)
    } else {
        let reason = format!("is {angle}; it is in radians, {least:.4} to {most:.4}");
        Err((name, reason))
    }
}

impl From<ArmAttributes> for ArmValues {
    fn from(arm: ArmAttributes) -> Self {
        Self {
            shoulder_direction: Some(arm.shoulder_direction.to_array()),
            upper_arm_length: Some(arm.upper_arm_length),
            shoulder_rotation: Some(arm.shoulder_rotation),
            elbow_angle: Some(arm.elbow_angle),
            forearm_length: Some(arm.forearm_length),
            elbow_rotation: Some(arm.elbow_rotation),
            wrist_rotation: Some(arm.wrist_rotation),
            wrist_inclination: Some(arm.wrist_inclination),
            little_vector: Some(arm.little_vector.to_array()),
            index_vector: Some(arm.index_vector.to_array()),
            thumb_vector: Some(arm.thumb_vector.to_array()),
        }
    }
}

impl From<Trunk> for TrunkValues {
    fn from(trunk: Trunk) -> Self {
        Self {
            shoulders: trunk.shoulders.map(|point| point.to_array()),
            hips: trunk.hips.map(|point| point.to_array()),
        }
    }
}

impl From<TrunkValues> for Trunk {
    fn from(trunk: TrunkValues) -> Self {
        Self {
            shoulders: trunk.shoulders.map(DVec3::from_array),
            hips: trunk.hips.map(DVec3::from_array),
        }
    }
}

/// Returns the attributes of both arms of a pose, left before right.
pub fn both(pose: &HalfPose) -> Result<[ArmAttributes; Side::COUNT], (Side, ArmAttributesError)> {
    let arm =
        |side| ArmAttributes::signed_from_landmarks(pose, side).map_err(|error| (side, error));
    Ok([arm(Side::Left)?, arm(Side::Right)?])
}
