//! Links prepared for forward kinematics.

use arrayvec::ArrayVec;
use parry3d::math::Vec3;

use super::joint_rotations::NO_ROTATION;
use super::link::{Link, MAX_LINKS};
use super::link_pose::{Axis, LinkPose, Offset};
use crate::hand::{Dof, Joint};

/// The links of an arm that a joint or fingertip depends on, prepared for one hand or for a hand in each lane.
#[derive(Clone, Debug)]
pub struct PreparedLinks {
    /// Parents come before their children.
    links: Vec<PlacedLink>,
}

/// A link and its place in the tree.
#[derive(Clone, Debug)]
struct PlacedLink {
    parent: Parent,
    link: PreparedLink<f32, 1>,
    /// `true` if a link that does not follow this one directly is attached to it.
    is_branch: bool,
}

/// The parent of a link among the prepared ones.
#[derive(Clone, Copy, Debug)]
enum Parent {
    Root,
    Previous,
    /// A branch, by its number.
    Branch(usize),
}

/// A link with everything that does not depend on the angles: one for all lanes, or one for each of `COUNT` lanes. `N` has the
/// numbers of these links.
#[derive(Clone, Debug)]
pub(super) struct PreparedLink<N, const COUNT: usize> {
    offset: Offset<N>,
    axis: Axis<N>,
    /// The indices of the angles in [`Dof::ALL`].
    angles: [usize; COUNT],
    joints: Option<[Option<Joint>; COUNT]>,
    /// The fingertips, and their distances from the pivots, in metres.
    tips: Option<([Option<Joint>; COUNT], N)>,
}

impl PreparedLinks {
    /// Prepares links, parents before children. Leaves out links that no joint or fingertip depends on, and links for which
    /// `is_done` returns `true`, as it does for all of their children.
    pub fn new(links: &[Link], is_done: impl Fn(usize) -> bool) -> Self {
        let is_used = used_links(links);
        let kept: Vec<usize> = (0..links.len())
            .filter(|&index| is_used[index] && !is_done(index))
            .collect();
        let previous = |at: usize| kept[..at].last().copied();
        let branch_of = |at: usize| {
            let parent = links[kept[at]].parent;
            parent.filter(|_| parent != previous(at))
        };
        let mut branches: Vec<usize> = (0..kept.len()).filter_map(branch_of).collect();
        branches.sort_unstable();
        branches.dedup();
        let placed = |at: usize| {
            let link = &links[kept[at]];
            PlacedLink {
                parent: match (link.parent, branch_of(at)) {
                    (None, _) => Parent::Root,
                    (_, None) => Parent::Previous,
                    (_, Some(parent)) => {
                        Parent::Branch(branches.partition_point(|branch| *branch < parent))
                    }
                },
                link: PreparedLink::new([Some(link)], |[number]| number),
                is_branch: branches.contains(&kept[at]),
            }
        };
        Self {
            links: (0..kept.len()).map(placed).collect(),
        }
    }

    /// Iterates over the indices in [`Dof::ALL`] of the angles by which links turn.
    pub fn angles(&self) -> impl Iterator<Item = usize> + '_ {
        let links = self.links.iter().map(|placed| &placed.link);
        let turning = links.filter(|link| link.axis.is_some());
        turning.flat_map(|link| link.angles)
    }

    /// Computes the poses of the joints and fingertips, and passes them to `emit`. `half_angle` returns the sine and cosine of half
    /// the angle with an index in [`Dof::ALL`], or `None` if this angle is 0.
    ///
    /// The results are equal to the results of [`ArmModel::link_poses`](super::ArmModel::link_poses).
    #[inline]
    pub fn forward<P: LinkPose<f32>>(
        &self,
        root: &P,
        half_angle: impl Fn(usize) -> Option<(P::Number, P::Number)>,
        mut emit: impl FnMut(Joint, &P),
    ) {
        let mut branches = ArrayVec::<P, MAX_LINKS>::new();
        let mut pose = *root;
        for placed in &self.links {
            match placed.parent {
                Parent::Previous => {}
                Parent::Root => pose = *root,
                Parent::Branch(number) => pose = branches[number],
            }
            placed.link.forward(
                &mut pose,
                |[angle]| half_angle(angle),
                |[joint], pose| joint.into_iter().for_each(|joint| emit(joint, pose)),
            );
            if placed.is_branch {
                branches.push(pose);
            }
        }
    }
}

impl<N: Copy, const COUNT: usize> PreparedLink<N, COUNT> {
    /// Prepares the links of the lanes. A lane without a link does not move. `join` makes one number of the numbers of the lanes.
    pub fn new(links: [Option<&Link>; COUNT], join: impl Fn([f32; COUNT]) -> N) -> Self {
        let dof = |link: Option<&Link>| link?.dof;
        let axis = |link: &Link| link.dof.map_or(Vec3::ZERO, |_| link.axis);
        let offsets = links.map(|link| link.map_or(Vec3::ZERO, |link| link.offset));
        let lengths = links.map(|link| link.map_or(0.0, |link| link.length));
        let tips = known(links.map(|link| link?.fingertip.map(Joint::tip)));
        Self {
            offset: Offset::new(offsets, &join),
            axis: Axis::new(links.map(|link| link.map_or(Vec3::ZERO, axis)), &join),
            angles: links.map(|link| dof(link).map_or(NO_ROTATION, Dof::index)),
            joints: known(links.map(|link| link?.joint)),
            tips: tips.map(|tips| (tips, join(lengths))),
        }
    }

    /// Moves the pose of the parents to the links. Passes it to `emit` for joints and, moved to the far ends, for fingertips.
    /// `half_angles` returns the sines and cosines of half the angles with the given indices, or `None` if these angles are 0.
    #[inline]
    pub fn forward<P: LinkPose<N>>(
        &self,
        pose: &mut P,
        half_angles: impl Fn([usize; COUNT]) -> Option<(P::Number, P::Number)>,
        mut emit: impl FnMut([Option<Joint>; COUNT], &P),
    ) {
        pose.translate(&self.offset);
        if self.axis.is_some()
            && let Some((sines, cosines)) = half_angles(self.angles)
        {
            pose.turn(&self.axis, sines, cosines);
        }
        if let Some(joints) = self.joints {
            emit(joints, pose);
        }
        if let Some((tips, lengths)) = self.tips {
            let mut tip = *pose;
            tip.advance(lengths);
            emit(tips, &tip);
        }
    }
}

/// Returns the joints of the lanes if there are any.
fn known<const COUNT: usize>(joints: [Option<Joint>; COUNT]) -> Option<[Option<Joint>; COUNT]> {
    Some(joints).filter(|joints| *joints != [None; COUNT])
}

/// Returns, for each link, `true` if the pose of a joint or fingertip depends on it.
fn used_links(links: &[Link]) -> Vec<bool> {
    let mut is_used = vec![false; links.len()];
    for (index, link) in links.iter().enumerate().rev() {
        is_used[index] |= link.joint.is_some() || link.fingertip.is_some();
        if let Some(parent) = link.parent {
            is_used[parent] |= is_used[index];
        }
    }
    is_used
}
