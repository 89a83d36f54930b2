//! Measured and displaced joints of the arm: they move what lies beyond them.

use glam::Quat;
use parry3d::math::{Pose, Vec3};

use super::link::{Link, MAX_LINKS};
use crate::estimate::MeasuredJoints;
use crate::hand::{Displacement, Joint};

/// The joints of an arm from the root to the hand.
const CHAIN: [Joint; 3] = [Joint::Shoulder, Joint::Elbow, Joint::Wrist];

/// The length below which two joints show no direction, in metres.
const MIN_LENGTH: f32 = 1e-3;

// Links are members of a 64-bit set.
const _: () = assert!(MAX_LINKS <= 64);

/// Moves the arm to its measured joints: each joint takes the links beyond it along to its measured position, and a bone between two
/// measured joints turns into their direction by the shortest rotation.
///
/// `poses` are the results of forward kinematics, `world_from_link` in metres, in the order of `links`.
pub(super) fn follow_measured_arm(links: &[Link], poses: &mut [Pose], measured: &MeasuredJoints) {
    for (index, &joint) in CHAIN.iter().enumerate() {
        let (Some(position), Some(link)) = (measured.get(joint), link_at(links, joint)) else {
            continue;
        };
        let next = CHAIN.get(index + 1);
        let rotation = next.and_then(|&next| {
            let end = poses.get(link_at(links, next)?)?.translation;
            let computed = end - poses[link].translation;
            shortest_rotation(computed, measured.get(next)? - position)
        });
        let rotation = rotation.unwrap_or(Quat::IDENTITY);
        let pivot = poses[link].translation;
        for beyond in links_from(links, link) {
            let pose = &mut poses[beyond];
            pose.translation = position + rotation * (pose.translation - pivot);
            pose.rotation = rotation * pose.rotation;
        }
    }
}

/// Turns a joint and the links beyond it about the joint, then moves them; parameters as for [`follow_measured_arm`].
pub(super) fn displace(links: &[Link], poses: &mut [Pose], displacement: &Displacement) {
    let (Some(link), Some(rotation)) =
        (link_at(links, displacement.joint), displacement.rotation())
    else {
        return;
    };
    let pivot = poses[link].translation;
    for beyond in links_from(links, link) {
        let pose = &mut poses[beyond];
        let turned = rotation * (pose.translation - pivot);
        pose.translation = pivot + turned + displacement.translation();
        pose.rotation = rotation * pose.rotation;
    }
}

fn link_at(links: &[Link], joint: Joint) -> Option<usize> {
    links.iter().position(|link| link.joint == Some(joint))
}

/// Returns the shortest rotation between two directions, unless one of them is too short to show any.
fn shortest_rotation(from: Vec3, to: Vec3) -> Option<Quat> {
    let has_direction = |bone: Vec3| bone.length() >= MIN_LENGTH;
    (has_direction(from) && has_direction(to))
        .then(|| Quat::from_rotation_arc(from.normalize(), to.normalize()))
}

/// Iterates over a link and everything beyond it.
fn links_from(links: &[Link], first: usize) -> impl Iterator<Item = usize> + '_ {
    let mut beyond = 1_u64 << first;
    (first..links.len()).filter(move |&index| {
        let parent = links[index].parent;
        if parent.is_some_and(|parent| beyond & (1 << parent) != 0) {
            beyond |= 1 << index;
        }
        beyond & (1 << index) != 0
    })
}
