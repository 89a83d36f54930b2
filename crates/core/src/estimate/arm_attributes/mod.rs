//! Attributes of an arm: lengths, joint angles and finger vectors that do not depend on the position of the body and the
//! camera, from the landmarks of a pose and back.
//!
//! | angle | zero | sign |
//! |---|---|---|
//! | shoulder rotation, 0..=π | upper arm [turned as far as it goes](FullRotation) | none |
//! | elbow angle, 0..=π | folded; π is straight | none |
//! | elbow rotation | palm in the plane of the arm, towards the body | clockwise for the left forearm, counter-clockwise for the right, seen from the elbow |
//! | wrist inclination, 0..=π | hand in line with the forearm | none |
//! | wrist rotation, −π..π | hand bent towards the palm | about the axis of the hand |
//!
//! A straight elbow has no plane, so that the turns of shoulder and forearm cannot be told apart: each gets one half. The
//! shoulder rotation has no sign: a pose that is turned past the full rotation does not come back from its attributes.

mod bases;
mod between;
mod from_landmarks;
mod full_rotation;
mod half_pose;
mod joint_angles;
mod palm;
#[cfg(test)]
mod tests;
mod to_landmarks;

pub use bases::{hand_basis, shoulder_basis};
pub use from_landmarks::wrist_angles;
pub use full_rotation::FullRotation;
pub use half_pose::{ArmLandmarks, HALF_POSE_ROWS, HalfPose, ImageSize, Trunk};

use glam::DVec3;

/// The attributes of one arm. Lengths have the unit of the landmarks, angles are in radians.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ArmAttributes {
    /// The unit direction of the upper arm in the [basis of the shoulder](shoulder_basis).
    pub shoulder_direction: DVec3,
    /// The distance from shoulder to elbow.
    pub upper_arm_length: f64,
    /// The rotation of the upper arm about its axis, 0..=π.
    pub shoulder_rotation: f64,
    /// The angle between upper arm and forearm, 0..=π.
    pub elbow_angle: f64,
    /// The distance from elbow to wrist.
    pub forearm_length: f64,
    /// The rotation of the forearm about its axis.
    pub elbow_rotation: f64,
    /// The azimuth of the inclination of the hand, −π..π; 0 without an inclination.
    pub wrist_rotation: f64,
    /// The angle between hand and forearm, 0..=π.
    pub wrist_inclination: f64,
    /// The little finger from the wrist, in the [basis of the hand](hand_basis).
    pub little_vector: DVec3,
    /// The index finger from the wrist, in the basis of the hand.
    pub index_vector: DVec3,
    /// The thumb from the wrist, in the basis of the hand.
    pub thumb_vector: DVec3,
}

/// The reason why a pose has no attributes, or attributes have no pose.
#[derive(Clone, Copy, Debug, PartialEq, Eq, thiserror::Error)]
pub enum ArmAttributesError {
    /// A number is NaN or infinite.
    #[error("a coordinate or an attribute is not a finite number")]
    NotFinite,
    /// The shoulders coincide, or the hip is on their line.
    #[error("shoulders and hip span no plane")]
    NoTrunk,
    /// Shoulder and elbow coincide.
    #[error("the upper arm has no length")]
    NoUpperArm,
    /// Elbow and wrist coincide.
    #[error("the forearm has no length")]
    NoForearm,
    /// Upper arm and forearm lie on each other, so that their plane is unknown.
    #[error("the elbow is folded flat")]
    FoldedElbow,
    /// Wrist, index finger and little finger coincide or lie on a line.
    #[error("wrist, index finger and little finger span no plane")]
    NoHand,
}

/// The largest angle between upper arm and forearm of landmarks, in radians, that counts as a straight elbow:
/// 1e-3 + 1e-5 · π.
pub const STRAIGHT_LANDMARKS: f64 = 1e-3 + 1e-5 * std::f64::consts::PI;

/// The smallest sine of the elbow angle with which the arm spans a plane.
pub const MIN_ELBOW_SINE: f64 = 1e-6;
