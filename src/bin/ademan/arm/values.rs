//! The attributes of a pose as JSON.

use ademan::estimate::arm_attributes::{
    ArmAttributes, ArmAttributesError, ArmLandmarks, FullRotation, HalfPose, Trunk, hand_basis,
    shoulder_basis,
};
use ademan::hand::Side;
use glam::DVec3;
use serde::{Deserialize, Serialize};

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
    /// Describes a pose. With `is_signed`, the shoulder rotation is negative past the full rotation.
    pub fn new(time_us: Option<u64>, pose: &HalfPose, is_signed: bool) -> Self {
        let arm = |side| {
            let attributes = if is_signed {
                ArmAttributes::signed_from_landmarks(pose, side)
            } else {
                ArmAttributes::from_landmarks(pose, side)
            };
            attributes.map_or_else(|_| ArmValues::partial(pose, side), ArmValues::from)
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
                .map_err(|name| format!("`{name}` of the {side} arm is null"))
        });
        let trunk = self.trunk.into();
        HalfPose::from_attributes(&trunk, &[left?, right?]).map_err(|error| error.to_string())
    }
}

impl ArmValues {
    /// Returns the attributes that incomplete landmarks determine: all but those that need the missing ones.
    fn partial(pose: &HalfPose, side: Side) -> Self {
        let arm = pose.arm(side);
        let length = |from: DVec3, to: DVec3| Some(from.distance(to)).filter(|it| it.is_finite());
        let (upper_arm, forearm) = (arm.elbow - arm.shoulder, arm.wrist - arm.elbow);
        let angle = std::f64::consts::PI - upper_arm.angle_between(forearm);
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
            let from_wrist = |point: DVec3| {
                let vector = image_from_hand.transpose() * (point - arm.wrist);
                Some(vector.to_array()).filter(|_| vector.is_finite())
            };
            values.little_vector = from_wrist(arm.little);
            values.index_vector = from_wrist(arm.index);
            values.thumb_vector = from_wrist(arm.thumb);
        }
        let Ok(image_from_shoulder) = shoulder_basis(&pose.trunk(), side) else {
            return values;
        };
        let Some(direction) = (image_from_shoulder.transpose() * upper_arm).try_normalize() else {
            return values;
        };
        values.shoulder_direction = Some(direction.to_array());
        let normal = image_from_shoulder.transpose() * upper_arm.cross(forearm);
        let full = FullRotation::new(side, direction);
        let rotation = full.map(|full| normal.angle_between(full.normal));
        values.shoulder_rotation = rotation.filter(|rotation| rotation.is_finite());
        values
    }

    /// Returns all attributes, or the name of one that is missing.
    fn attributes(&self) -> Result<ArmAttributes, &'static str> {
        fn number(value: Option<f64>, name: &'static str) -> Result<f64, &'static str> {
            value.ok_or(name)
        }
        fn vector(value: Option<[f64; 3]>, name: &'static str) -> Result<DVec3, &'static str> {
            value.map(DVec3::from_array).ok_or(name)
        }
        Ok(ArmAttributes {
            shoulder_direction: vector(self.shoulder_direction, "shoulder_direction")?,
            upper_arm_length: number(self.upper_arm_length, "upper_arm_length")?,
            shoulder_rotation: number(self.shoulder_rotation, "shoulder_rotation")?,
            elbow_angle: number(self.elbow_angle, "elbow_angle")?,
            forearm_length: number(self.forearm_length, "forearm_length")?,
            elbow_rotation: number(self.elbow_rotation, "elbow_rotation")?,
            wrist_rotation: number(self.wrist_rotation, "wrist_rotation")?,
            wrist_inclination: number(self.wrist_inclination, "wrist_inclination")?,
            little_vector: vector(self.little_vector, "little_vector")?,
            index_vector: vector(self.index_vector, "index_vector")?,
            thumb_vector: vector(self.thumb_vector, "thumb_vector")?,
        })
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
