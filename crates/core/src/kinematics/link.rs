//! The links of an arm model.

use parry3d::math::{Pose, Vec3};

use crate::hand::{Dof, Finger, Joint};

/// The most links of a model. 3 for the shoulder, 1 each for the elbow and two forearm bones, 2 for the wrist and 5 for
/// each finger make 33; the rest is for models that split a joint.
pub const MAX_LINKS: usize = 48;

/// A rigid body that turns about one axis at its near end.
///
/// `world_from_link = world_from_parent · translate(offset) · rotate(axis, angle)`; the body lies
/// along the link's own +X from its pivot to (length, 0, 0).
#[derive(Clone, Debug, PartialEq)]
pub struct Link {
    /// The name of the link in the model.
    pub name: String,
    /// The index of the parent, which precedes this link in the list; `None` for the root.
    pub parent: Option<usize>,
    /// The position of the pivot in the parent's frame, in metres.
    pub offset: Vec3,
    /// The unit axis of rotation; positive angles are counter-clockwise.
    pub axis: Vec3,
    /// The degree of freedom that turns the link; `None` for a fixed link.
    pub dof: Option<Dof>,
    /// The length in metres.
    pub length: f32,
    /// The joint at the pivot.
    pub joint: Option<Joint>,
    /// The finger whose tip is the far end of the link.
    pub fingertip: Option<Finger>,
}

/// Returns the frame of a link of this length, moved to its far end.
pub(super) fn far_end(length: f32, pose: &Pose) -> Pose {
    Pose::from_parts(
        pose.translation + pose.rotation * Vec3::new(length, 0.0, 0.0),
        pose.rotation,
    )
}
