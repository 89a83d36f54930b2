//! Attributes → joint angles of the arm models.

use std::f64::consts::{FRAC_PI_2, PI, TAU};

use glam::{DMat3, DVec3};

use super::{ArmAttributes, FullRotation};
use crate::geometry::EulerOrder;
use crate::hand::{Dof, JointAngles, Side};

impl ArmAttributes {
    /// Returns the joint angles of the arm; `None` without a direction of the upper arm.
    ///
    /// The angles of the shoulder turn an arm model whose forearm points forwards with the palm down (see
    /// `ArmModel::palm_down_pose`), so that upper arm and elbow axis have the measured directions. The forearm is supinated
    /// by 0 with the palm down if the elbow is bent upwards, and by a quarter turn with the thumb up. Not limited to
    /// ranges of motion.
    pub fn joint_angles(&self, side: Side) -> Option<JointAngles> {
        let [shoulder_z, shoulder_y, shoulder_x] = self.shoulder_angles(side)?;
        let [deviation, flexion] = self.wrist_angles(side);
        let mut angles = JointAngles::default();
        angles.set(Dof::ShoulderZ, shoulder_z);
        angles.set(Dof::ShoulderY, shoulder_y);
        angles.set(Dof::ShoulderX, shoulder_x);
        angles.set(Dof::ElbowFlexion, PI - self.elbow_angle);
        angles.set(Dof::ForearmSupination, FRAC_PI_2 - self.elbow_rotation);
        angles.set(Dof::WristDeviation, deviation);
        angles.set(Dof::WristFlexion, flexion);
        Some(angles)
    }

    /// Returns the angles of the shoulder about the axes Z, Y and X of the arm model.
    fn shoulder_angles(&self, side: Side) -> Option<[f64; 3]> {
        let full = FullRotation::new(side, self.shoulder_direction)?;
        let upper_arm = model_vector(side, self.shoulder_direction);
        // The mirror image of a normal is reversed.
        let normal = match side {
            Side::Left => -model_vector(side, self.plane_normal(&full, side)),
            Side::Right => model_vector(side, self.plane_normal(&full, side)),
        };
        let model_from_upper_arm = DMat3::from_cols(upper_arm, normal, upper_arm.cross(normal));
        let [z, y, x] = EulerOrder::Zyx.angles(&model_from_upper_arm)?;
        // A hanging arm whose elbow bends forwards has −π/2: the seam is on the other side.
        Some([z, y, if x > FRAC_PI_2 { x - TAU } else { x }])
    }

    /// Returns deviation (towards the little finger) and flexion (towards the palm) of the wrist.
    fn wrist_angles(&self, side: Side) -> [f64; 2] {
        let (sine, cosine) = self.wrist_inclination.sin_cos();
        let towards_palm = sine * self.wrist_rotation.cos();
        // The second axis of the hand points to the little finger on the left and to the thumb on the right.
        let towards_little = match side {
            Side::Left => sine * self.wrist_rotation.sin(),
            Side::Right => -sine * self.wrist_rotation.sin(),
        };
        [towards_little.asin(), towards_palm.atan2(cosine)]
    }
}

/// Returns a vector in the basis of a shoulder in the frame of the right arm model: X forwards, Y down, Z to the left.
/// Vectors of the left arm are mirrored.
fn model_vector(side: Side, vector: DVec3) -> DVec3 {
    let forwards = match side {
        Side::Left => -vector.z,
        Side::Right => vector.z,
    };
    DVec3::new(forwards, vector.y, -vector.x)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::estimate::arm_attributes::{ArmLandmarks, HalfPose};

    /// Returns the landmarks of a right arm that faces the camera: directions in the wearer's frame (right, up, back).
    fn pose(upper_arm: DVec3, forearm: DVec3, hand: DVec3, palm: DVec3) -> HalfPose {
        let image = |wearer: DVec3| DVec3::new(-wearer.x, -wearer.y, wearer.z);
        let shoulder = DVec3::new(0.18, 0.5, 0.0);
        let elbow = shoulder + upper_arm.normalize() * 0.3;
        let wrist = elbow + forearm.normalize() * 0.25;
        let hand = hand.normalize();
        // To the left of a right hand that points forwards with the palm down.
        let thumb_side = hand.cross(palm).normalize();
        let right = ArmLandmarks {
            shoulder: image(shoulder),
            elbow: image(elbow),
            wrist: image(wrist),
            little: image(wrist + hand * 0.08 - thumb_side * 0.03),
            index: image(wrist + hand * 0.09 + thumb_side * 0.03),
            thumb: image(wrist + hand * 0.05 + thumb_side * 0.05),
        };
        let mirrored = |point: DVec3| point.with_x(-point.x);
        let left = ArmLandmarks {
            shoulder: mirrored(right.shoulder),
            elbow: mirrored(right.elbow),
            wrist: mirrored(right.wrist),
            little: mirrored(right.little),
            index: mirrored(right.index),
            thumb: mirrored(right.thumb),
        };
        let hip = image(DVec3::new(0.12, 0.0, 0.0));
        HalfPose {
            arms: [left, right],
            hips: [mirrored(hip), hip],
        }
    }

    /// Returns angles in degrees, the same for both sides.
    fn degrees(pose: &HalfPose, dofs: &[Dof]) -> Vec<f64> {
        let [left, right] = [Side::Left, Side::Right].map(|side| {
            let attributes = ArmAttributes::from_landmarks(pose, side).expect("attributes");
            let angles = attributes.joint_angles(side).expect("a direction");
            let degrees = |&dof: &Dof| angles.get(dof).to_degrees();
            dofs.iter().map(degrees).collect::<Vec<_>>()
        });
        for (one, mirrored) in left.iter().zip(&right) {
            assert!((one - mirrored).abs() < 1e-6, "{one:?} {mirrored:?}");
        }
        right
    }

    fn assert_degrees(pose: &HalfPose, expected: &[(Dof, f64)]) {
        let dofs: Vec<Dof> = expected.iter().map(|(dof, _)| *dof).collect();
        for (ours, (dof, theirs)) in degrees(pose, &dofs).iter().zip(expected) {
            assert!((ours - theirs).abs() < 1e-6, "{dof}: {ours}, not {theirs}");
        }
    }

    const FORWARDS: DVec3 = DVec3::NEG_Z;
    const DOWN: DVec3 = DVec3::NEG_Y;

    #[test]
    fn a_hanging_arm_with_the_forearm_forwards_has_the_clinical_angles() {
        for (palm, supination) in [(DOWN, 0.0), (DVec3::NEG_X, 90.0), (DVec3::Y, 180.0)] {
            assert_degrees(
                &pose(DOWN, FORWARDS, FORWARDS, palm),
                &[
                    (Dof::ElbowFlexion, 90.0),
                    (Dof::ForearmSupination, supination),
                    (Dof::WristFlexion, 0.0),
                    (Dof::WristDeviation, 0.0),
                    (Dof::ShoulderZ, 90.0),
                    (Dof::ShoulderY, 0.0),
                    (Dof::ShoulderX, -90.0),
                ],
            );
        }
    }

    #[test]
    fn the_wrist_bends_towards_the_palm_and_the_little_finger() {
        let (sine, cosine) = 30_f64.to_radians().sin_cos();
        let flexed = FORWARDS * cosine + DOWN * sine;
        let palm = DOWN * cosine - FORWARDS * sine;
        assert_degrees(
            &pose(DOWN, FORWARDS, flexed, palm),
            &[(Dof::WristFlexion, 30.0), (Dof::WristDeviation, 0.0)],
        );
        // With the palm down, the little finger of the right hand is on the right.
        let deviated = FORWARDS * cosine + DVec3::X * sine;
        assert_degrees(
            &pose(DOWN, FORWARDS, deviated, DOWN),
            &[(Dof::WristFlexion, 0.0), (Dof::WristDeviation, 30.0)],
        );
    }

    #[test]
    fn the_angles_turn_the_arm_model_to_the_measured_directions() {
        let mut random = fastrand::Rng::with_seed(41);
        for _ in 0..300 {
            let mut direction = || DVec3::from_array(std::array::from_fn(|_| random.f64() - 0.5));
            let (upper_arm, forearm) = (direction().normalize(), direction().normalize());
            if upper_arm.cross(forearm).length() < 0.05 {
                continue;
            }
            let pose = pose(upper_arm, forearm, direction(), direction());
            let Ok(attributes) = ArmAttributes::from_landmarks(&pose, Side::Right) else {
                continue;
            };
            // A rotation past the full one has no sign.
            let arm = attributes
                .landmarks(&pose.trunk(), Side::Right)
                .expect("an arm");
            if arm.wrist.distance(pose.arm(Side::Right).wrist) > 1e-9 {
                continue;
            }
            let angles = attributes.joint_angles(Side::Right).expect("a direction");
            let [z, y, x] =
                [Dof::ShoulderZ, Dof::ShoulderY, Dof::ShoulderX].map(|dof| angles.get(dof));
            let upper = EulerOrder::Zyx.rotation([z, y, x]);
            let flexion = DMat3::from_rotation_y(angles.get(Dof::ElbowFlexion));
            // X of the model is forwards, Y down, Z to the left.
            let wearer = |model: DVec3| DVec3::new(-model.z, -model.y, -model.x);
            assert!(wearer(upper.x_axis).distance(upper_arm) < 1e-9);
            assert!(wearer((upper * flexion).x_axis).distance(forearm) < 1e-9);
        }
    }
}
