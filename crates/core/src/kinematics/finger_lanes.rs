//! Forward kinematics of four fingers at once: one finger in each lane of a vector register.
//!
//! The lanes are [`Vec4`]s, which have the operations of every machine with 128-bit vectors.

use glam::{Mat4, Quat, Vec4};
use parry3d::math::Pose;

use super::HandPose;
use super::joint_rotations::JointRotations;
use super::lane_pose::LanePose;
use super::link::Link;
use super::prepared_links::PreparedLink;
use crate::hand::{Finger, Joint};

/// The fingers of the lanes.
const FINGERS: [Finger; LANES] = [Finger::Index, Finger::Middle, Finger::Ring, Finger::Little];

const LANES: usize = 4;

/// Four fingers on one palm, prepared for forward kinematics.
#[derive(Clone, Debug)]
pub(super) struct FingerLanes {
    /// The joint of the link that all fingers grow from.
    palm: Joint,
    /// The links side by side, from the palm to the fingertips. A finger with fewer links than another begins with rows that do not
    /// move it.
    rows: Vec<PreparedLink<Vec4, LANES>>,
}

impl FingerLanes {
    /// Prepares the fingers of an arm, and marks their links as done. Returns `None` if they do not grow from one link without
    /// branches, or if this link is no joint.
    pub fn new(links: &[Link], is_done: &mut [bool]) -> Option<Self> {
        let mut fingers = [const { Vec::new() }; LANES];
        for (links_of_finger, finger) in fingers.iter_mut().zip(FINGERS) {
            *links_of_finger = unbranched(links, finger)?;
        }
        let parent = |finger: &Vec<usize>| links[*finger.first()?].parent;
        let palm = parent(&fingers[0])?;
        if fingers.iter().any(|finger| parent(finger) != Some(palm)) {
            return None;
        }
        let palm = links[palm].joint?;
        for &index in fingers.iter().flatten() {
            is_done[index] = true;
        }
        let count = fingers.iter().map(Vec::len).max()?;
        let link_of = |finger: &Vec<usize>, row: usize| {
            let index = (row + finger.len()).checked_sub(count)?;
            Some(&links[finger[index]])
        };
        let row = |row| {
            let row_links = fingers.each_ref().map(|finger| link_of(finger, row));
            PreparedLink::new(row_links, Vec4::from_array)
        };
        Some(Self {
            palm,
            rows: (0..count).map(row).collect(),
        })
    }

    /// Writes the poses of the joints and the tips of the fingers into `hand`, which has the pose of the palm.
    pub fn forward(&self, rotations: &JointRotations, hand: &mut HandPose) {
        let Some(palm) = hand.get(self.palm) else {
            return;
        };
        let mut poses = LanePose::splat(palm, Vec4::splat);
        let half_angles = |angles| {
            let (sines, cosines) = rotations.half_angles(angles);
            Some((Vec4::from_array(sines), Vec4::from_array(cosines)))
        };
        for row in &self.rows {
            row.forward(&mut poses, half_angles, |joints, poses| {
                for (joint, pose) in joints.into_iter().zip(to_poses(poses)) {
                    if let Some(joint) = joint {
                        hand.set(joint, pose);
                    }
                }
            });
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

fn to_poses(poses: &LanePose<Vec4>) -> [Pose; LANES] {
    let [x, y, z, w] = poses.rotation;
    let rotations = Mat4::from_cols(x, y, z, w).transpose();
    let [along_x, along_y, along_z] = poses.translation;
    let translations = Mat4::from_cols(along_x, along_y, along_z, Vec4::ZERO).transpose();
    std::array::from_fn(|lane| {
        let rotation = Quat::from_vec4(rotations.col(lane));
        Pose::from_parts(translations.col(lane).truncate(), rotation)
    })
}
