//! An arm as a tree of links, and where each is for given angles.

use arrayvec::ArrayVec;
use glam::Quat;
use parry3d::math::{Mat3, Pose, Vec3};

use super::HandPose;
use super::joint_rotations::Turns;
use crate::estimate::JointAngles;
use crate::hand::{Dof, Finger, Joint, Side};

/// The most links of a model: 3 for the shoulder, 1 each for elbow and two forearm bones, 2 for the
/// wrist, 5 for each finger make 32; the rest is for models that split a joint.
pub const MAX_LINKS: usize = 48;

/// One rigid piece that turns about one axis at its near end.
///
/// `world_from_link = world_from_parent · translate(offset) · rotate(axis, angle)`; the body lies
/// along the link's own +X from its pivot to (length, 0, 0).
#[derive(Clone, Debug, PartialEq)]
pub struct Link {
    /// Its name in the model.
    pub name: String,
    /// The place of its parent, which comes earlier in the list; `None` for the root.
    pub parent: Option<usize>,
    /// Its pivot in the parent's frame, in metres.
    pub offset: Vec3,
    /// The unit axis it turns about, positive counter-clockwise.
    pub axis: Vec3,
    /// The angle that turns it; `None` for a fixed piece.
    pub dof: Option<Dof>,
    /// Its length in metres.
    pub length: f32,
    /// The joint that its pivot is.
    pub joint: Option<Joint>,
    /// The finger whose tip is its far end.
    pub fingertip: Option<Finger>,
}

/// A right or left arm from shoulder to fingertips.
#[derive(Clone, Debug)]
pub struct ArmModel {
    side: Side,
    links: Vec<Link>,
    world_from_root: Pose,
    tip_radius: f32,
}

/// Why a list of links is no arm.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
pub enum ArmModelError {
    /// Too many links.
    #[error("an arm model has at most {MAX_LINKS} links, this one has {0}")]
    TooManyLinks(usize),
    /// A parent that is not earlier in the list.
    #[error("link `{0}` has a parent that does not come before it")]
    ParentNotBefore(String),
    /// A number that is not finite, or an axis without direction.
    #[error("link `{0}` has a size or an axis that is not a finite, usable number")]
    NotFinite(String),
    /// A joint or fingertip that two links claim.
    #[error("link `{0}` is a joint or fingertip that another link is already")]
    Twice(String),
    /// No fingertip at all.
    #[error("no link is a fingertip, so nothing can be touched")]
    NoFingertip,
}

impl ArmModel {
    /// A model whose root has the pose `world_from_root`; `tip_radius` is that of the fingertip
    /// spheres, in metres.
    pub fn new(
        side: Side,
        links: Vec<Link>,
        world_from_root: Pose,
        tip_radius: f32,
    ) -> Result<Self, ArmModelError> {
        if links.len() > MAX_LINKS {
            return Err(ArmModelError::TooManyLinks(links.len()));
        }
        for (place, link) in links.iter().enumerate() {
            check(link, place, &links[..place])?;
        }
        if links.iter().all(|link| link.fingertip.is_none()) {
            return Err(ArmModelError::NoFingertip);
        }
        Ok(Self {
            side,
            links,
            world_from_root,
            tip_radius,
        })
    }

    /// The pose of a root whose forearm points straight forward with the palm down: the model's +X
    /// is the world's −Z, its +Y (palm side) the world's −Y, its +Z the world's −X.
    pub fn palm_down_pose() -> Pose {
        let axes = Mat3::from_cols(Vec3::NEG_Z, Vec3::NEG_Y, Vec3::NEG_X);
        Pose::from_parts(Vec3::ZERO, Quat::from_mat3(&axes))
    }

    /// The same arm where it is of that side, else its mirror image: the thumb is on the other side, and
    /// flexion still goes towards the palm.
    #[must_use]
    pub fn for_side(mut self, side: Side) -> Self {
        if self.side == side {
            return self;
        }
        self.side = side;
        for link in &mut self.links {
            link.offset.z = -link.offset.z;
            // A mirror turns the sense of a rotation round, and the axis itself as well as it lies in
            // the mirror's plane or not.
            link.axis = Vec3::new(-link.axis.x, -link.axis.y, link.axis.z);
        }
        self
    }

    /// Which arm it is.
    pub fn side(&self) -> Side {
        self.side
    }

    /// The links, parents before children.
    pub fn links(&self) -> &[Link] {
        &self.links
    }

    /// Where the root is in the world.
    pub fn world_from_root(&self) -> Pose {
        self.world_from_root
    }

    /// `world_from_link` of every link (metres), in the order of [`links`](Self::links).
    ///
    /// An angle that is not known counts as 0.
    pub fn link_poses(&self, angles: &JointAngles) -> ArrayVec<Pose, MAX_LINKS> {
        let turns = Turns::of(angles);
        let mut poses = ArrayVec::<Pose, MAX_LINKS>::new();
        for link in &self.links {
            let parent = match link.parent {
                Some(parent) => &poses[parent],
                None => &self.world_from_root,
            };
            let rotation = match link.dof {
                Some(dof) => parent.rotation * turns.about(link.axis, dof),
                None => parent.rotation,
            };
            let translation = parent.translation + parent.rotation * link.offset;
            poses.push(Pose::from_parts(translation, rotation));
        }
        poses
    }

    /// Where the arm and hand are for these angles.
    pub fn forward(&self, angles: &JointAngles) -> HandPose {
        let poses = self.link_poses(angles);
        let mut hand = HandPose::new(angles.time, self.side, self.tip_radius);
        hand.untrusted = angles.untrusted;
        hand.jumped = angles.jumped;
        for (link, pose) in self.links.iter().zip(&poses) {
            if let Some(joint) = link.joint {
                hand.set(joint, *pose);
            }
            if let Some(finger) = link.fingertip {
                hand.set(Joint::tip(finger), far_end(link, pose));
            }
        }
        hand
    }
}

/// The frame of a link, moved to its far end.
pub(super) fn far_end(link: &Link, pose: &Pose) -> Pose {
    Pose::from_parts(
        pose.translation + pose.rotation * Vec3::new(link.length, 0.0, 0.0),
        pose.rotation,
    )
}

fn check(link: &Link, place: usize, before: &[Link]) -> Result<(), ArmModelError> {
    if link.parent.is_some_and(|parent| parent >= place) {
        return Err(ArmModelError::ParentNotBefore(link.name.clone()));
    }
    let usable = link.offset.is_finite() && link.axis.is_normalized() && link.length.is_finite();
    if !usable {
        return Err(ArmModelError::NotFinite(link.name.clone()));
    }
    let twice = before.iter().any(|other| {
        (link.joint.is_some() && link.joint == other.joint)
            || (link.fingertip.is_some() && link.fingertip == other.fingertip)
    });
    if twice {
        return Err(ArmModelError::Twice(link.name.clone()));
    }
    Ok(())
}
