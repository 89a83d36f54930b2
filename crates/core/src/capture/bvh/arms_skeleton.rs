//! A BVH skeleton of a body that follows the joints of its arms and hands.
//!
//! Every frame turns the bones into the directions of its positions, so that rigid bones are reproduced exactly. The text
//! is in centimetres with +Y up and the person looking along +Z. It has the joint names of Mixamo, which most programs know,
//! and is at rest in the T pose.

use glam::{DMat3, DVec3};

use super::arm_shape::ArmShape;
use super::hand_joints::title;
use super::skeleton::{Channel, Node, Skeleton};
use crate::geometry::{EulerOrder, rotation_between};
use crate::hand::{Finger, Joint, JointPositions, Side};

/// Units of the file per metre.
const CENTIMETRES: f64 = 100.0;

/// Smallest sine of the angle between two bones that determine a rotation.
const MIN_SINE: f64 = 0.05;

/// Shortest bone in the unit of the file. The direction of a shorter one is rounding.
const MIN_LENGTH: f64 = 1e-4;

/// Half of the distance of the shoulders of a body of which only one is known, in the unit of the file.
const HALF_WIDTH: f64 = 18.0;

/// Half distances of the shoulders of a person, in the unit of the file.
const HALF_WIDTHS: std::ops::RangeInclusive<f64> = 8.0..=40.0;

/// Spine from the hips on: the names of its joints and their offsets.
const SPINE: [(&str, f64); 3] = [("Spine", 10.0), ("Spine1", 12.0), ("Spine2", 12.0)];

/// Height of the collar bones over the last joint of the spine, and of the shoulders.
const COLLAR_HEIGHT: f64 = 10.0;

/// Distance of the collar bones from the middle of the body.
const COLLAR: f64 = 3.0;

/// Neck, head and its end over the last joint of the spine.
const HEAD: [(&str, f64); 2] = [("Neck", 14.0), ("Head", 10.0)];

/// Height of the end of the head.
const HEAD_HEIGHT: f64 = 18.0;

/// The skeleton of a body with one or two arms.
#[derive(Debug)]
pub struct ArmsSkeleton {
    skeleton: Skeleton,
    order: EulerOrder,
    /// The joint of each node, depth first.
    joints: Vec<Option<(Side, Joint)>>,
    /// Position of each node in the T pose.
    rest: Vec<DVec3>,
    rotations: Vec<DMat3>,
    half_width: f64,
    /// `true` if the body turns with the line of the shoulders. Otherwise it is upright.
    is_turned: bool,
    /// `true` if arms begin at the shoulders of the body. Otherwise they have positions of their own.
    is_joined: bool,
}

impl ArmsSkeleton {
    /// Creates the skeleton of a body with the given arms, with rotation channels in the order of `order`, one of three different
    /// axes. `width` is the distance of the shoulders in metres, if both are known. Shoulders that do not belong to a person, as of
    /// a source that measures each arm from its own shoulder, are set apart.
    pub fn new(arms: &[ArmShape], width: Option<f64>, order: EulerOrder) -> Self {
        let half_width = width
            .map(|width| width * CENTIMETRES / 2.0)
            .filter(|half| HALF_WIDTHS.contains(half));
        let has_shoulder = |arm: &ArmShape| arm.rest(Joint::Shoulder).is_some();
        let mut new = Self {
            skeleton: Skeleton::default(),
            order,
            joints: Vec::new(),
            rest: Vec::new(),
            rotations: Vec::new(),
            half_width: half_width.unwrap_or(HALF_WIDTH),
            is_turned: half_width.is_some(),
            is_joined: arms.iter().all(has_shoulder),
        };
        let mut top = new.add(Some("Hips"), None, DVec3::ZERO, true);
        for (name, height) in SPINE {
            top = new.add(Some(name), Some(top), DVec3::Y * height, false);
        }
        let mut head = top;
        for (name, height) in HEAD {
            head = new.add(Some(name), Some(head), DVec3::Y * height, false);
        }
        new.add(None, Some(head), DVec3::Y * HEAD_HEIGHT, false);
        for arm in arms {
            new.add_arm(arm, top);
        }
        new
    }

    fn add(
        &mut self,
        name: Option<&str>,
        parent: Option<usize>,
        offset: DVec3,
        has_position: bool,
    ) -> usize {
        let mut channels = Vec::new();
        if has_position {
            channels.extend([Channel::XPosition, Channel::YPosition, Channel::ZPosition]);
        }
        if name.is_some() {
            channels.extend(rotation_channels(self.order));
        }
        let origin = parent.map_or(DVec3::ZERO, |parent| self.rest[parent]);
        self.joints.push(None);
        self.rest.push(origin + offset);
        self.rotations.push(DMat3::IDENTITY);
        self.skeleton.push(Node {
            name: name.map(str::to_owned),
            parent,
            offset,
            channels,
        })
    }

    fn add_arm(&mut self, arm: &ArmShape, top: usize) {
        let side = arm.side();
        let outwards = match side {
            Side::Left => DVec3::X,
            Side::Right => DVec3::NEG_X,
        };
        let mut root = 0;
        let mut start = DVec3::ZERO;
        if self.is_joined {
            let collar = outwards * COLLAR + DVec3::Y * COLLAR_HEIGHT;
            root = self.add(
                Some(&format!("{}Shoulder", title(side))),
                Some(top),
                collar,
                false,
            );
            start = outwards * (self.half_width - COLLAR);
        }
        let mut nodes = [None; Joint::COUNT];
        for (joint, parent) in arm.joints() {
            let known = parent.and_then(|parent| nodes[parent.index()]);
            let place = |point| arm.rest(point).unwrap_or_default() * CENTIMETRES;
            let offset = match parent {
                Some(parent) => place(joint) - place(parent),
                // Readers differ in what an offset beside position channels means.
                None => start,
            };
            let is_end = is_tip(joint) && parent.is_some_and(is_finger);
            let name = (!is_end).then(|| name(joint, side));
            let has_position = known.is_none() && !self.is_joined;
            let node = self.add(
                name.as_deref(),
                Some(known.unwrap_or(root)),
                offset,
                has_position,
            );
            self.joints[node] = Some((side, joint));
            nodes[joint.index()] = Some(node);
        }
    }

    /// Returns the skeleton.
    pub fn skeleton(&self) -> &Skeleton {
        &self.skeleton
    }

    /// Computes the channel values of a frame from the positions of each arm by side (world, metres), whose bones have the lengths of
    /// their shapes. An unknown joint keeps the direction of its bone.
    pub fn frame(&mut self, arms: &[JointPositions; Side::COUNT], values: &mut Vec<f64>) {
        values.clear();
        let body = self.is_joined.then(|| self.body_rotation(arms));
        for index in 0..self.joints.len() {
            let node = &self.skeleton.nodes()[index];
            let (parent, is_end) = (node.parent, node.name.is_none());
            let has_position = node.channels.first() == Some(&Channel::XPosition);
            let before = parent.map_or(DMat3::IDENTITY, |parent| self.rotations[parent]);
            if is_end {
                continue;
            }
            if has_position {
                let place = match self.joints[index] {
                    Some((side, joint)) => position(&arms[side.index()], joint),
                    None => body.map(|rotation| self.hips(arms, &rotation)),
                };
                values.extend(place.unwrap_or_default().to_array());
            }
            let rotation = match (parent, self.joints[index]) {
                (None, _) => body.unwrap_or(DMat3::IDENTITY),
                (_, None) => before,
                (_, Some((side, _))) => self.rotation(index, &arms[side.index()], &before),
            };
            self.rotations[index] = rotation;
            let local = before.transpose() * rotation;
            let angles = self.order.angles(&local).unwrap_or_default();
            values.extend(angles.map(f64::to_degrees));
        }
    }

    /// Returns the rotation of the upright body that aligns its shoulders with the shoulders of the arms.
    fn body_rotation(&self, arms: &[JointPositions; Side::COUNT]) -> DMat3 {
        let shoulder = |side: Side| position(&arms[side.index()], Joint::Shoulder);
        if !self.is_turned {
            return DMat3::IDENTITY;
        }
        let (Some(left), Some(right)) = (shoulder(Side::Left), shoulder(Side::Right)) else {
            return DMat3::IDENTITY;
        };
        let x = (left - right).normalize_or(DVec3::X);
        let Some(z) = x.cross(DVec3::Y).try_normalize() else {
            return DMat3::IDENTITY;
        };
        DMat3::from_cols(x, z.cross(x), z)
    }

    /// Returns the position of the hips under the shoulders.
    fn hips(&self, arms: &[JointPositions; Side::COUNT], rotation: &DMat3) -> DVec3 {
        let shoulders =
            self.joints
                .iter()
                .zip(&self.rest)
                .filter_map(|(joint, rest)| match joint {
                    Some((side, Joint::Shoulder)) => {
                        let place = position(&arms[side.index()], Joint::Shoulder)?;
                        Some(place - *rotation * *rest)
                    }
                    _ => None,
                });
        let places: Vec<DVec3> = shoulders.collect();
        let sum: DVec3 = places.iter().sum();
        sum / places.len().max(1) as f64
    }

    /// Returns the world rotation of a joint, which turns its bones from the T pose into this one: two bones determine it, and
    /// one determines it up to the twist, which it takes from the parent.
    fn rotation(&self, index: usize, arm: &JointPositions, parent: &DMat3) -> DMat3 {
        let joint_at = |node: usize| self.joints[node].map(|(_, joint)| joint);
        let from_here = |child: usize| {
            let now = position(arm, joint_at(child)?)? - position(arm, joint_at(index)?)?;
            let rest = self.rest[child] - self.rest[index];
            (rest.length() > MIN_LENGTH && now.length() > MIN_LENGTH).then_some((rest, now))
        };
        let nodes = self.skeleton.nodes();
        let children = (index + 1..nodes.len()).filter(|&child| nodes[child].parent == Some(index));
        let mut bones = children.filter_map(from_here);
        let Some((rest, now)) = bones.next() else {
            return *parent;
        };
        let is_apart = |(other, _): &(DVec3, DVec3)| {
            rest.cross(*other).length() > MIN_SINE * rest.length() * other.length()
        };
        if let Some((other_rest, other_now)) = bones.rfind(is_apart)
            && let (Some(from), Some(to)) = (frame(rest, other_rest), frame(now, other_now))
        {
            return to * from.transpose();
        }
        match rotation_between(*parent * rest, now) {
            Some(turn) => turn * *parent,
            None => *parent,
        }
    }
}

/// Returns a frame with its X axis along the first direction and its Z axis across both.
fn frame(first: DVec3, second: DVec3) -> Option<DMat3> {
    let x = first.try_normalize()?;
    let z = first.cross(second).try_normalize()?;
    Some(DMat3::from_cols(x, z.cross(x), z))
}

/// Returns the position of a joint in the axes and the unit of the file.
fn position(joints: &JointPositions, joint: Joint) -> Option<DVec3> {
    let position = joints.get(joint)? * CENTIMETRES;
    Some(DVec3::new(-position.x, position.y, -position.z))
}

fn rotation_channels(order: EulerOrder) -> impl Iterator<Item = Channel> {
    order.name().chars().map(|axis| match axis {
        'X' => Channel::XRotation,
        'Y' => Channel::YRotation,
        _ => Channel::ZRotation,
    })
}

fn is_finger(joint: Joint) -> bool {
    joint.index() > Joint::Wrist.index()
}

fn is_tip(joint: Joint) -> bool {
    Finger::ALL
        .iter()
        .any(|&finger| Joint::tip(finger) == joint)
}

/// Returns the name of a joint in the convention of Mixamo, without its name space.
fn name(joint: Joint, side: Side) -> String {
    let side = title(side);
    let arm = match joint {
        Joint::Shoulder => "Arm",
        Joint::Elbow => "ForeArm",
        Joint::Wrist => "Hand",
        _ => return format!("{side}{}", finger_name(joint)),
    };
    format!("{side}{arm}")
}

fn finger_name(joint: Joint) -> String {
    let names = ["Thumb", "Index", "Middle", "Ring", "Pinky"];
    let found = Finger::ALL.iter().zip(names).find_map(|(&finger, name)| {
        let joints = finger.joints();
        let number = joints.iter().position(|&other| other == joint)?;
        let has_metacarpal_bone = finger != Finger::Thumb;
        Some(match (has_metacarpal_bone, number) {
            (true, 0) => format!("InHand{name}"),
            (true, number) => format!("Hand{name}{number}"),
            (false, number) => format!("Hand{name}{}", number + 1),
        })
    });
    found.unwrap_or_default()
}
