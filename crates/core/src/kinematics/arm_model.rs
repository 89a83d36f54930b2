//! An arm as a tree of links, and its forward kinematics.

use arrayvec::ArrayVec;
use glam::Quat;
use parry3d::math::{Mat3, Pose, Vec3};

use super::HandPose;
use super::joint_rotations::JointRotations;
use super::link::{Link, MAX_LINKS, far_end};
use super::measured::{displace, follow_measured_arm};
use super::prepared_arm::PreparedArm;
use crate::estimate::{Estimate, JointAngles};
use crate::hand::{Joint, Side};
use crate::message::escape;

/// A right or left arm from the shoulder to the fingertips.
#[derive(Clone, Debug)]
pub struct ArmModel {
    side: Side,
    links: Vec<Link>,
    /// Follows from `links`.
    prepared: PreparedArm,
    world_from_root: Pose,
    tip_radius: f32,
}

/// The reason why a list of links is not a valid arm model.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
pub enum ArmModelError {
    /// There are more than [`MAX_LINKS`] links.
    #[error("an arm model has at most {MAX_LINKS} links, this one has {0}")]
    TooManyLinks(usize),
    /// A parent does not precede its child in the list.
    #[error("link `{}` has a parent that does not come before it", escape(.0))]
    ParentNotBefore(String),
    /// A number is not finite, or an axis is not a unit vector.
    #[error("link `{}` has a size or an axis that is not a finite, usable number", escape(.0))]
    NotFinite(String),
    /// Two links have the same joint or fingertip.
    #[error("link `{}` is a joint or fingertip that another link is already", escape(.0))]
    Duplicate(String),
    /// No link has a fingertip.
    #[error("no link is a fingertip, so nothing can be touched")]
    NoFingertip,
}

impl ArmModel {
    /// Creates a model whose root has the pose `world_from_root`. `tip_radius` is the radius of the fingertip spheres,
    /// in metres.
    pub fn new(
        side: Side,
        links: Vec<Link>,
        world_from_root: Pose,
        tip_radius: f32,
    ) -> Result<Self, ArmModelError> {
        if links.len() > MAX_LINKS {
            return Err(ArmModelError::TooManyLinks(links.len()));
        }
        for (index, link) in links.iter().enumerate() {
            check(link, index, &links[..index])?;
        }
        if links.iter().all(|link| link.fingertip.is_none()) {
            return Err(ArmModelError::NoFingertip);
        }
        Ok(Self {
            side,
            prepared: PreparedArm::new(&links),
            links,
            world_from_root,
            tip_radius,
        })
    }

    /// Returns the root pose of an arm whose forearm points straight forward with the palm down: the model's +X
    /// is the world's −Z, its +Y (palm side) the world's −Y, its +Z the world's −X.
    pub fn palm_down_pose() -> Pose {
        let axes = Mat3::from_cols(Vec3::NEG_Z, Vec3::NEG_Y, Vec3::NEG_X);
        Pose::from_parts(Vec3::ZERO, Quat::from_mat3(&axes))
    }

    /// Returns the model for an arm of `side`: the mirror image if the model is of the other side. Flexion still
    /// turns towards the palm.
    #[must_use]
    pub fn for_side(mut self, side: Side) -> Self {
        if self.side == side {
            return self;
        }
        self.side = side;
        for link in &mut self.links {
            link.offset.z = -link.offset.z;
            // A mirror reverses the sense of every rotation, and also the component of the axis along its normal.
            link.axis = Vec3::new(-link.axis.x, -link.axis.y, link.axis.z);
        }
        self.prepared = PreparedArm::new(&self.links);
        self
    }

    /// Returns the side of the body.
    pub fn side(&self) -> Side {
        self.side
    }

    /// Returns the links, parents before children.
    pub fn links(&self) -> &[Link] {
        &self.links
    }

    /// Returns the pose of the root in the world.
    pub fn world_from_root(&self) -> Pose {
        self.world_from_root
    }

    /// Returns `world_from_link` of every link (metres), in the order of [`links`](Self::links).
    ///
    /// Angles that are not known count as 0.
    pub fn link_poses(&self, angles: &JointAngles) -> ArrayVec<Pose, MAX_LINKS> {
        self.link_poses_from(&self.world_from_root, angles)
    }

    fn link_poses_from(
        &self,
        world_from_root: &Pose,
        angles: &JointAngles,
    ) -> ArrayVec<Pose, MAX_LINKS> {
        let rotations = JointRotations::from_angles(angles);
        let mut poses = ArrayVec::<Pose, MAX_LINKS>::new();
        for link in &self.links {
            let parent = match link.parent {
                Some(parent) => &poses[parent],
                None => world_from_root,
            };
            let rotation = match link.dof {
                Some(dof) => parent.rotation * rotations.about(link.axis, dof),
                None => parent.rotation,
            };
            let translation = parent.translation + parent.rotation * link.offset;
            poses.push(Pose::from_parts(translation, rotation));
        }
        poses
    }

    /// Computes the pose of the arm and hand by forward kinematics. A measured root pose replaces the root pose of the
    /// model, a displaced joint takes what lies beyond it along, and measured joint positions replace the computed ones; measured
    /// positions of shoulder, elbow and wrist move what lies beyond them.
    /// No joint of a hand that is [nowhere](Estimate::is_placed) is known.
    pub fn forward(&self, estimate: &Estimate) -> HandPose {
        let mut hand = HandPose::new(estimate.time, self.side, self.tip_radius);
        self.forward_into(estimate, &mut hand);
        hand
    }

    /// Does the same as [`forward`](Self::forward) in place of an earlier pose.
    pub fn forward_into(&self, estimate: &Estimate, hand: &mut HandPose) {
        hand.reset(estimate.time, self.side, self.tip_radius);
        hand.untrusted = estimate.untrusted;
        hand.jumped = estimate.jumped;
        hand.is_after_gap = estimate.is_after_gap;
        hand.misses_bends = estimate.misses_bends;
        if !estimate.is_placed {
            return;
        }
        let world_from_root = estimate.root.unwrap_or(self.world_from_root);
        if estimate.displacement.is_some() || !estimate.measured.is_empty() {
            self.forward_measured(&world_from_root, estimate, hand);
        } else {
            self.prepared
                .forward(&world_from_root, &estimate.angles, hand);
        }
    }

    /// Computes the poses of the joints for an estimate with measured or displaced ones.
    fn forward_measured(&self, world_from_root: &Pose, estimate: &Estimate, hand: &mut HandPose) {
        let mut poses = self.link_poses_from(world_from_root, &estimate.angles);
        if let Some(displacement) = &estimate.displacement {
            displace(&self.links, &mut poses, displacement);
        }
        if !estimate.measured.is_empty() {
            follow_measured_arm(&self.links, &mut poses, &estimate.measured);
        }
        for (link, pose) in self.links.iter().zip(&poses) {
            if let Some(joint) = link.joint {
                hand.set(joint, *pose);
            }
            if let Some(finger) = link.fingertip {
                hand.set(Joint::tip(finger), far_end(link.length, pose));
            }
        }
        for (joint, position) in estimate.measured.iter() {
            // Models lack the bones of the palm, which turn with the wrist.
            let wrist = hand.get(Joint::Wrist).filter(|_| joint > Joint::Wrist);
            let turned = hand.get(joint).or(wrist);
            let rotation = turned.map_or(Quat::IDENTITY, |pose| pose.rotation);
            hand.set(joint, Pose::from_parts(position, rotation));
        }
    }
}

fn check(link: &Link, index: usize, preceding: &[Link]) -> Result<(), ArmModelError> {
    if link.parent.is_some_and(|parent| parent >= index) {
        return Err(ArmModelError::ParentNotBefore(link.name.clone()));
    }
    let is_finite = link.offset.is_finite() && link.axis.is_normalized() && link.length.is_finite();
    if !is_finite {
        return Err(ArmModelError::NotFinite(link.name.clone()));
    }
    let is_duplicate = preceding.iter().any(|other| {
        (link.joint.is_some() && link.joint == other.joint)
            || (link.fingertip.is_some() && link.fingertip == other.fingertip)
    });
    if is_duplicate {
        return Err(ArmModelError::Duplicate(link.name.clone()));
    }
    Ok(())
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::hand::{Dof, Finger};
    use crate::time::Timestamp;

    /// A link of 1 m from the origin along +X, with an elbow at its pivot.
    fn rod() -> ArmModel {
        let link = Link {
            name: "rod".to_owned(),
            parent: None,
            offset: Vec3::ZERO,
            axis: Vec3::Z,
            dof: Some(Dof::ElbowFlexion),
            length: 1.0,
            joint: Some(Joint::Elbow),
            fingertip: Some(Finger::Index),
        };
        ArmModel::new(Side::Right, vec![link], Pose::IDENTITY, 0.005).unwrap()
    }

    #[test]
    fn measured_root_and_joints_override_the_model() {
        let mut estimate = Estimate::new(Timestamp(0), JointAngles::default());
        assert_eq!(
            rod().forward(&estimate).fingertip(Finger::Index),
            Some(Vec3::X)
        );
        estimate.root = Some(Pose::from_translation(Vec3::Y));
        let pose = rod().forward(&estimate);
        assert_eq!(pose.position(Joint::Elbow), Some(Vec3::Y));
        assert_eq!(pose.fingertip(Finger::Index), Some(Vec3::X + Vec3::Y));
        estimate.measured.set(Joint::IndexTip, Vec3::Z);
        let measured_pose = rod().forward(&estimate);
        assert_eq!(measured_pose.position(Joint::Elbow), Some(Vec3::Y));
        assert_eq!(measured_pose.fingertip(Finger::Index), Some(Vec3::Z));
    }

    #[test]
    fn a_measured_bone_of_the_palm_that_the_model_lacks_turns_with_the_wrist() {
        let mut link = rod().links()[0].clone();
        link.joint = Some(Joint::Wrist);
        let model = ArmModel::new(Side::Right, vec![link], Pose::IDENTITY, 0.005).unwrap();
        let mut angles = JointAngles::default();
        angles.set(Dof::ElbowFlexion, 1.0);
        let mut estimate = Estimate::new(Timestamp(0), angles);
        estimate.measured.set(Joint::IndexMetacarpal, Vec3::X);
        estimate.measured.set(Joint::Shoulder, Vec3::Y);
        let pose = model.forward(&estimate);
        let rotation = |joint: Joint| pose.get(joint).expect("it is known").rotation;
        assert!(rotation(Joint::Wrist).angle_between(Quat::IDENTITY) > 0.9);
        assert_eq!(rotation(Joint::IndexMetacarpal), rotation(Joint::Wrist));
        assert_eq!(rotation(Joint::Shoulder), Quat::IDENTITY);
    }
}
