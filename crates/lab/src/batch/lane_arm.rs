//! Forward kinematics of eight hands to their fingertips.

use arrayvec::ArrayVec;
use parry3d::math::{Pose, Vec3};
use wide::f32x8;

use super::lane_vector::{
    LanePose, LaneRotation, LaneVector, add, rotated, rotated_x, splat, to_arrays, turned,
};
use super::{AllTips, BatchError, LANES, LaneAngles};
use crate::hand::{Dof, Finger, Joint};
use crate::kinematics::{ArmModel, Link, MAX_LINKS, PrincipalAxis, sin_cos, used_links};

/// The positions of the fingertips of eight hands in the world, in metres; NaN for a finger that the arm lacks.
#[derive(Clone, Copy, Debug)]
#[repr(align(32))]
pub struct LaneTips {
    pub(super) tips: AllTips,
}

impl Default for LaneTips {
    fn default() -> Self {
        Self {
            tips: [[[f32::NAN; LANES]; 3]; Finger::COUNT],
        }
    }
}

impl LaneTips {
    /// Returns a fingertip of the hand in a lane, 0 to 7, or `None` if the arm lacks the finger.
    ///
    /// # Panics
    ///
    /// Panics if there is no such lane.
    pub fn get(&self, lane: usize, finger: Finger) -> Option<Vec3> {
        let tip = self.tips[finger.index()].map(|lanes| lanes[lane]);
        Some(Vec3::from_array(tip)).filter(|tip| !tip.is_nan())
    }
}

/// Eight hands: their fingertips, and the positions of all joints that the arm has.
pub(super) struct LaneHands {
    pub tips: LaneTips,
    pub joints: [LaneVector; Joint::COUNT],
    /// The rotations of the links, by degree of freedom.
    turns: [Turn; Dof::COUNT],
}

/// A rotation by half an angle of each hand.
#[derive(Clone, Copy)]
struct Turn {
    sines: f32x8,
    cosines: f32x8,
    /// `true` if all angles are 0, as in a glove that does not measure them.
    is_none: bool,
}

impl LaneHands {
    pub fn new() -> Self {
        let none = Turn {
            sines: f32x8::ZERO,
            cosines: f32x8::ONE,
            is_none: true,
        };
        Self {
            tips: LaneTips::default(),
            joints: [[f32x8::splat(f32::NAN); 3]; Joint::COUNT],
            turns: [none; Dof::COUNT],
        }
    }
}

/// An arm model for eight hands: the links that a joint or fingertip depends on, parents before children.
pub(super) struct LaneArm {
    root: LanePose,
    links: Vec<LaneLink>,
    /// The degrees of freedom of the links, each once.
    dofs: Vec<usize>,
}

/// One link, for all hands.
struct LaneLink {
    parent: Parent,
    /// `None` if the link turns about the pivot of its parent.
    offset: Option<Offset>,
    /// The axis, the sense of the rotation, ±1, and the index of the angle.
    turn: Option<(PrincipalAxis, f32, usize)>,
    joint: Option<Joint>,
    tip: Option<(Finger, f32)>,
    /// `true` if a link that does not follow this one directly is attached to it.
    is_branch: bool,
}

#[derive(Clone, Copy)]
enum Parent {
    Root,
    Previous,
    /// A branch, by its number.
    Branch(usize),
}

/// The position of a pivot in the frame of the parent.
#[derive(Clone, Copy)]
enum Offset {
    AlongX(f32),
    Any([f32; 3]),
}

impl LaneArm {
    pub fn new(arm: &ArmModel) -> Result<Self, BatchError> {
        let links = &without_unused(arm.links())[..];
        let is_branch = |index: usize| {
            let mut children = (0..links.len()).filter(|at| links[*at].parent == Some(index));
            children.any(|child| child != index + 1)
        };
        let branches = |end: usize| (0..end).filter(|at| is_branch(*at)).count();
        let lane_link = |(index, link): (usize, &Link)| {
            let parent = match link.parent {
                None => Parent::Root,
                Some(parent) if parent + 1 == index => Parent::Previous,
                Some(parent) => Parent::Branch(branches(parent)),
            };
            LaneLink::new(link, parent, is_branch(index))
        };
        let links: Vec<_> = links
            .iter()
            .enumerate()
            .map(lane_link)
            .collect::<Result<_, _>>()?;
        let turns = links.iter().filter_map(|link| link.turn);
        let mut dofs: Vec<usize> = turns.map(|(.., dof)| dof).collect();
        dofs.sort_unstable();
        dofs.dedup();
        Ok(Self {
            root: splat_pose(&arm.world_from_root()),
            links,
            dofs,
        })
    }

    /// Computes the fingertips and joints in place of earlier ones of the same arm.
    pub fn forward_into(&self, angles: &LaneAngles, hands: &mut LaneHands) {
        for &dof in &self.dofs {
            hands.turns[dof].set(angles.dof(dof));
        }
        let mut branches = ArrayVec::<LanePose, MAX_LINKS>::new();
        let mut pose = self.root;
        for link in &self.links {
            match link.parent {
                Parent::Previous => {}
                Parent::Root => pose = self.root,
                Parent::Branch(index) => pose = branches[index],
            }
            match link.offset {
                None => {}
                Some(Offset::AlongX(along)) => pose.advance(f32x8::splat(along)),
                Some(Offset::Any(offset)) => {
                    let moved = rotated(&pose.rotation, splat(offset));
                    pose.translation = add(pose.translation, moved);
                }
            }
            if let Some((axis, sense, dof)) = link.turn {
                let turn = &hands.turns[dof];
                if !turn.is_none {
                    let sines = turn.sines * f32x8::splat(sense);
                    pose.rotation = turned(&pose.rotation, axis, sines, turn.cosines);
                }
            }
            if let Some(joint) = link.joint {
                hands.joints[joint.index()] = pose.translation;
            }
            if let Some((finger, length)) = link.tip {
                let mut tip = pose;
                tip.advance(f32x8::splat(length));
                hands.joints[Joint::tip(finger).index()] = tip.translation;
                hands.tips.tips[finger.index()] = to_arrays(tip.translation);
            }
            if link.is_branch {
                branches.push(pose);
            }
        }
    }
}

impl LanePose {
    /// Moves the poses along X of their own frames.
    fn advance(&mut self, along: f32x8) {
        self.translation = add(self.translation, rotated_x(&self.rotation, along));
    }
}

impl LaneLink {
    fn new(link: &Link, parent: Parent, is_branch: bool) -> Result<Self, BatchError> {
        let turn = match link.dof {
            None => None,
            Some(dof) => {
                let axis = PrincipalAxis::from_vector(link.axis);
                let tilted = || BatchError::TiltedAxis(link.name.clone());
                let (axis, sense) = axis.ok_or_else(tilted)?;
                Some((axis, sense, dof.index()))
            }
        };
        let offset = match link.offset.to_array() {
            [0.0, 0.0, 0.0] => None,
            [along, 0.0, 0.0] => Some(Offset::AlongX(along)),
            offset => Some(Offset::Any(offset)),
        };
        Ok(Self {
            parent,
            offset,
            turn,
            joint: link.joint,
            tip: link.fingertip.map(|finger| (finger, link.length)),
            is_branch,
        })
    }
}

/// Returns the links that a joint or fingertip depends on.
fn without_unused(links: &[Link]) -> Vec<Link> {
    let is_used = used_links(links);
    let number = |index: usize| is_used[..index].iter().filter(|is_used| **is_used).count();
    let used = links.iter().zip(&is_used).filter(|(_, is_used)| **is_used);
    used.map(|(link, _)| Link {
        parent: link.parent.map(number),
        ..link.clone()
    })
    .collect()
}

fn splat_pose(pose: &Pose) -> LanePose {
    let rotation: LaneRotation = splat(pose.rotation.to_array());
    LanePose {
        rotation,
        translation: splat(pose.translation.to_array()),
    }
}

impl Turn {
    fn set(&mut self, radians: &[f32; LANES]) {
        self.is_none = radians.iter().all(|radians| radians.to_bits() == 0);
        if self.is_none {
            return;
        }
        let (mut sines, mut cosines) = ([0.0; LANES], [0.0; LANES]);
        for lane in 0..LANES {
            (sines[lane], cosines[lane]) = sin_cos(radians[lane] * 0.5);
        }
        (self.sines, self.cosines) = (f32x8::new(sines), f32x8::new(cosines));
    }
}
