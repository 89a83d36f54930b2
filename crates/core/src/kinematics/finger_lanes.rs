//! Forward kinematics of four fingers at once: one finger in each lane of a vector register.
//!
//! The lanes are [`Vec4`]s, which have the operations of every machine with 128-bit vectors. The operations have the order
//! of a product of two `Quat`s and of a `Quat` and a vector, without the terms that are 0: the results are equal to the
//! results of [`ArmModel::link_poses`](super::ArmModel::link_poses).

use glam::{Mat4, Quat, Vec3, Vec4};
use parry3d::math::Pose;

use super::HandPose;
use super::joint_rotations::{JointRotations, NO_ROTATION};
use super::link::Link;
use super::principal_axis::PrincipalAxis;
use crate::hand::{Finger, Joint};

/// The fingers of the lanes.
const FINGERS: [Finger; LANES] = [Finger::Index, Finger::Middle, Finger::Ring, Finger::Little];

const LANES: usize = 4;

/// The most links of a finger: 2 of the knuckle, a metacarpal, 2 phalanges beyond the knuckle, and 1 for models that split a joint.
const MAX_ROWS: usize = 6;

/// Four fingers on one palm, prepared for forward kinematics.
#[derive(Clone, Debug)]
pub(super) struct FingerLanes {
    /// The index of the link that all fingers grow from.
    pub palm: usize,
    /// The links, from the palm to the fingertips. A finger with fewer links than another begins with rows that do not move it.
    rows: Vec<Row>,
    /// The distance of each fingertip from the pivot of its last link, in metres.
    tip_lengths: Vec4,
}

/// One link of each finger.
#[derive(Clone, Debug)]
struct Row {
    /// The positions of the pivots in the frames of the parents, in metres: x, y and z of all fingers.
    offset: [Vec4; 3],
    has_offset: bool,
    /// `true` if all offsets lie along X.
    is_straight: bool,
    axis: PrincipalAxis,
    /// The senses of rotation about the axis, ±1.
    senses: Vec4,
    /// The indices of the angles in [`JointRotations`].
    angles: [usize; LANES],
    joints: [Option<Joint>; LANES],
}

/// The poses of one link of each finger.
#[derive(Clone, Copy)]
struct LanePoses {
    /// The quaternions: x, y, z and w of all fingers.
    rotation: [Vec4; 4],
    /// The positions: x, y and z of all fingers.
    translation: [Vec4; 3],
}

impl FingerLanes {
    /// Prepares the fingers of an arm, and adds the indices of their links to `taken`. Returns `None` if they do not grow from
    /// one link without branches, or if a row turns about several axes.
    pub fn new(links: &[Link], taken: &mut [bool]) -> Option<Self> {
        let mut fingers = [const { Vec::new() }; LANES];
        for (links_of_finger, finger) in fingers.iter_mut().zip(FINGERS) {
            *links_of_finger = unbranched(links, finger)?;
        }
        let parent = |finger: &Vec<usize>| links[*finger.first()?].parent;
        let palm = parent(&fingers[0])?;
        if fingers.iter().any(|finger| parent(finger) != Some(palm)) {
            return None;
        }
        let count = fingers.iter().map(Vec::len).max()?;
        let link_of = |finger: &Vec<usize>, row: usize| {
            let index = (row + finger.len()).checked_sub(count)?;
            Some(&links[finger[index]])
        };
        let row = |row| Row::new(fingers.each_ref().map(|finger| link_of(finger, row)));
        let rows: Option<Vec<Row>> = (0..count).map(row).collect();
        let rows = rows.filter(|rows| rows.len() <= MAX_ROWS)?;
        for &index in fingers.iter().flatten() {
            taken[index] = true;
        }
        let tips = fingers
            .each_ref()
            .map(|finger| finger.last().map_or(0.0, |tip| links[*tip].length));
        Some(Self {
            palm,
            rows,
            tip_lengths: Vec4::from_array(tips),
        })
    }

    /// Writes the poses of the joints and the tips of the fingers into `hand`.
    pub fn forward(&self, world_from_palm: &Pose, rotations: &JointRotations, hand: &mut HandPose) {
        let mut poses = LanePoses::splat(world_from_palm);
        for row in &self.rows {
            if row.has_offset {
                poses.translate(&row.offset, row.is_straight);
            }
            let (sines, cosines) = rotations.lanes(row.angles);
            poses.rotate(row.axis, sines * row.senses, cosines);
            if row.joints != [None; LANES] {
                let poses = poses.to_poses();
                for (joint, pose) in row.joints.iter().zip(&poses) {
                    if let Some(joint) = *joint {
                        hand.set(joint, *pose);
                    }
                }
            }
        }
        poses.translate(&[self.tip_lengths, Vec4::ZERO, Vec4::ZERO], true);
        for (finger, pose) in FINGERS.into_iter().zip(&poses.to_poses()) {
            hand.set(Joint::tip(finger), *pose);
        }
    }
}

/// Returns the links of a finger from the first one after the last branch of the arm. `None` if there is no such finger.
fn unbranched(links: &[Link], finger: Finger) -> Option<Vec<usize>> {
    let children = |index: usize| {
        links
            .iter()
            .filter(|link| link.parent == Some(index))
            .count()
    };
    let tip = links
        .iter()
        .position(|link| link.fingertip == Some(finger))?;
    let mut chain = Vec::new();
    let mut next = Some(tip).filter(|tip| children(*tip) == 0);
    while let Some(index) = next {
        chain.push(index);
        next = links[index].parent.filter(|parent| children(*parent) == 1);
    }
    chain.reverse();
    (!chain.is_empty()).then_some(chain)
}

impl Row {
    /// Creates a row of one link of each finger; a finger without one does not move.
    fn new(links: [Option<&Link>; LANES]) -> Option<Self> {
        let mut axes = [None; LANES];
        for (axis, link) in axes.iter_mut().zip(links) {
            if let Some(link) = link.filter(|link| link.dof.is_some()) {
                *axis = Some(PrincipalAxis::from_vector(link.axis)?);
            }
        }
        let mut known = axes.iter().flatten().map(|(axis, _)| *axis);
        let axis = known.next().unwrap_or(PrincipalAxis::Z);
        if known.any(|other| other != axis) {
            return None;
        }
        let offsets = links.map(|link| link.map_or(Vec3::ZERO, |link| link.offset));
        let dof = |link: Option<&Link>| Some(link?.dof?.index());
        let lanes =
            |component: fn(&Vec3) -> f32| Vec4::from_array(offsets.each_ref().map(component));
        Some(Self {
            offset: [lanes(|it| it.x), lanes(|it| it.y), lanes(|it| it.z)],
            has_offset: offsets.iter().any(|offset| *offset != Vec3::ZERO),
            is_straight: offsets
                .iter()
                .all(|offset| offset.y == 0.0 && offset.z == 0.0),
            axis,
            senses: Vec4::from_array(
                axes.map(|lane_axis| lane_axis.map_or(1.0, |(_, sense)| sense)),
            ),
            angles: links.map(|link| dof(link).unwrap_or(NO_ROTATION)),
            joints: links.map(|link| link?.joint),
        })
    }
}

impl LanePoses {
    fn splat(pose: &Pose) -> Self {
        Self {
            rotation: pose.rotation.to_array().map(Vec4::splat),
            translation: pose.translation.to_array().map(Vec4::splat),
        }
    }

    /// Moves the poses by offsets in their own frames.
    fn translate(&mut self, offset: &[Vec4; 3], is_straight: bool) {
        let [x, y, z, w] = self.rotation;
        let scale = w * w - (x * x + y * y + z * z);
        let twice_w = w * Vec4::splat(2.0);
        let [along, up, across] = *offset;
        let moved = if is_straight {
            let twice_dot = along * x * Vec4::splat(2.0);
            [
                along * scale + x * twice_dot,
                y * twice_dot + z * along * twice_w,
                z * twice_dot - y * along * twice_w,
            ]
        } else {
            let twice_dot = (along * x + up * y + across * z) * Vec4::splat(2.0);
            [
                along * scale + x * twice_dot + (y * across - up * z) * twice_w,
                up * scale + y * twice_dot + (z * along - across * x) * twice_w,
                across * scale + z * twice_dot + (x * up - along * y) * twice_w,
            ]
        };
        for (translation, shift) in self.translation.iter_mut().zip(moved) {
            *translation += shift;
        }
    }

    /// Turns the poses about an axis of their own frames, by the sines and cosines of half the angles.
    fn rotate(&mut self, axis: PrincipalAxis, sines: Vec4, cosines: Vec4) {
        let [x, y, z, w] = self.rotation;
        let (s, c) = (sines, cosines);
        self.rotation = match axis {
            PrincipalAxis::X => [x * c + w * s, y * c + z * s, z * c - y * s, w * c - x * s],
            PrincipalAxis::Y => [x * c - z * s, y * c + w * s, z * c + x * s, w * c - y * s],
            PrincipalAxis::Z => [x * c + y * s, y * c - x * s, z * c + w * s, w * c - z * s],
        };
    }

    fn to_poses(self) -> [Pose; LANES] {
        let [x, y, z, w] = self.rotation;
        let rotations = Mat4::from_cols(x, y, z, w).transpose();
        let [along_x, along_y, along_z] = self.translation;
        let translations = Mat4::from_cols(along_x, along_y, along_z, Vec4::ZERO).transpose();
        std::array::from_fn(|lane| {
            let rotation = Quat::from_vec4(rotations.col(lane));
            Pose::from_parts(translations.col(lane).truncate(), rotation)
        })
    }
}
