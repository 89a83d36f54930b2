//! Hands: skin around bones.

use parry3d::math::Vec2;

use super::limbs::{arm_sections, finger_sections};
use super::{Canvas, SceneOptions, skin};
use crate::picture::capsule;
use ademan_core::hand::{Finger, Joint};
use ademan_core::kinematics::HandPose;

/// Sides of an arm.
const ARM_SIDES: usize = 36;

/// Sides of a finger.
const FINGER_SIDES: usize = 20;

/// Adds a hand with its forearm.
pub(super) fn add_hand(canvas: &mut Canvas, pose: &HandPose, options: SceneOptions) {
    add_skin(canvas, pose);
    if options.bones {
        add_bones(canvas, pose);
    }
}

fn add_skin(canvas: &mut Canvas, pose: &HandPose) {
    skin::add(canvas, &arm_sections(pose), ARM_SIDES);
    for &finger in Finger::ALL {
        skin::add(canvas, &finger_sections(pose, finger), FINGER_SIDES);
    }
}

/// Adds lines from joint to joint.
pub(super) fn add_bones(canvas: &mut Canvas, pose: &HandPose) {
    let arm = [Joint::Shoulder, Joint::Elbow, Joint::Wrist];
    let mut chains: Vec<Vec<Joint>> = vec![arm.to_vec()];
    for finger in Finger::ALL {
        let joints = finger.joints().iter().copied();
        chains.push(std::iter::once(Joint::Wrist).chain(joints).collect());
    }
    let color = canvas.colors.bone;
    for chain in chains {
        let points = chain.iter().filter_map(|&joint| pose.position(joint));
        let points: Vec<Vec2> = points
            .filter_map(|point| Some(canvas.project(point)?.position))
            .collect();
        let triangles = &mut canvas.picture.above;
        for bone in points.windows(2) {
            triangles.add_flat_polygon(&capsule((bone[0], 1.2), (bone[1], 1.2)), color);
        }
        for &joint in &points {
            triangles.add_flat_polygon(&capsule((joint, 3.0), (joint, 3.0)), color);
        }
    }
}
