//! Attributes → landmarks.

use std::f64::consts::{FRAC_PI_2, PI};

use glam::{DMat3, DVec3};

use super::bases::{shoulder_basis, sided_cross, sign};
use super::full_rotation::is_close;
use super::palm::wrist_turn;
use super::{
    ArmAttributes, ArmAttributesError, ArmLandmarks, FullRotation, HalfPose, MIN_ELBOW_SINE, Trunk,
};
use crate::hand::Side;

impl HalfPose {
    /// Returns the pose of a trunk whose arms have these attributes, in the order of [`Side::ALL`].
    pub fn from_attributes(
        trunk: &Trunk,
        attributes: &[ArmAttributes; Side::COUNT],
    ) -> Result<Self, ArmAttributesError> {
        let [left, right] = attributes;
        Ok(Self {
            arms: [
                left.landmarks(trunk, Side::Left)?,
                right.landmarks(trunk, Side::Right)?,
            ],
            hips: trunk.hips,
        })
    }
}

impl ArmAttributes {
    /// Returns the landmarks of an arm with these attributes at the shoulder of `trunk`.
    pub fn landmarks(&self, trunk: &Trunk, side: Side) -> Result<ArmLandmarks, ArmAttributesError> {
        if !self.is_finite() {
            return Err(ArmAttributesError::NotFinite);
        }
        if self.upper_arm_length <= 0.0 {
            return Err(ArmAttributesError::NoUpperArm);
        }
        if self.forearm_length <= 0.0 {
            return Err(ArmAttributesError::NoForearm);
        }
        let image_from_shoulder = shoulder_basis(trunk, side)?;
        let (forearm, palm) = self.forearm_and_palm(side)?;
        // The axes of a hand in line with the forearm.
        let straight_hand = DMat3::from_cols(palm, forearm.cross(palm), forearm);
        let image_from_hand = image_from_shoulder
            * straight_hand
            * wrist_turn(self.wrist_inclination, self.wrist_rotation);

        let shoulder = trunk.shoulders[side.index()];
        let elbow =
            shoulder + image_from_shoulder * self.shoulder_direction * self.upper_arm_length;
        let wrist = elbow + image_from_shoulder * forearm * self.forearm_length;
        Ok(ArmLandmarks {
            shoulder,
            elbow,
            wrist,
            little: wrist + image_from_hand * self.little_vector,
            index: wrist + image_from_hand * self.index_vector,
            thumb: wrist + image_from_hand * self.thumb_vector,
        })
    }

    /// Returns the direction of the forearm, and the palm normal of a hand in line with it, in the basis of the shoulder.
    fn forearm_and_palm(&self, side: Side) -> Result<(DVec3, DVec3), ArmAttributesError> {
        let upper_arm = self.shoulder_direction;
        let full = FullRotation::new(side, upper_arm).ok_or(ArmAttributesError::NoUpperArm)?;
        if is_close(self.elbow_angle, PI) {
            let (sine, cosine) =
                (self.shoulder_rotation + self.elbow_rotation + FRAC_PI_2).sin_cos();
            let across = full.normal.cross(upper_arm);
            let palm = across * cosine + full.normal * sine * sign(side);
            return Ok((upper_arm, palm));
        }
        if self.elbow_angle.sin().abs() < MIN_ELBOW_SINE {
            return Err(ArmAttributesError::FoldedElbow);
        }
        let normal = self.plane_normal(&full, side);
        let (sine, cosine) = self.elbow_angle.sin_cos();
        let forearm = upper_arm * -cosine + normal.cross(upper_arm) * sine;
        let (turn_sine, turn_cosine) = self.elbow_rotation.sin_cos();
        let neutral = normal * sign(side);
        let palm = neutral * turn_cosine + sided_cross(side, forearm, neutral) * turn_sine;
        Ok((forearm, palm))
    }

    /// Returns the normal of the plane of the arm, upper arm × forearm, in the basis of the shoulder.
    pub(super) fn plane_normal(&self, full: &FullRotation, side: Side) -> DVec3 {
        let (sine, cosine) = self.shoulder_rotation.sin_cos();
        let across = sided_cross(side, self.shoulder_direction, full.normal);
        full.normal * cosine + across * sine
    }

    fn is_finite(&self) -> bool {
        let scalars = [
            self.upper_arm_length,
            self.shoulder_rotation,
            self.elbow_angle,
            self.forearm_length,
            self.elbow_rotation,
            self.wrist_rotation,
            self.wrist_inclination,
        ];
        let vectors = [
            self.shoulder_direction,
            self.little_vector,
            self.index_vector,
            self.thumb_vector,
        ];
        scalars.iter().all(|value| value.is_finite())
            && vectors.iter().all(|vector| vector.is_finite())
    }
}
