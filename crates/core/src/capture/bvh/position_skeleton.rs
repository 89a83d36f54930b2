//! A BVH skeleton that follows the joints of an arm and hand.
//!
//! Every frame turns the bones into the directions of its positions, so that rigid bones are reproduced exactly. The text
//! is in centimetres with +Y up and the person looking along +Z, and has the joint names of Mixamo, which most programs know.

use glam::{DMat3, DVec3};

use super::skeleton::{Channel, Node, Skeleton};
use crate::geometry::{EulerOrder, rotation_between};
use crate::hand::{Finger, Joint, JointPositions, Side};

/// Units of the file per metre.
const CENTIMETRES: f64 = 100.0;

/// Smallest sine of the angle between two bones that determine a rotation.
const MIN_SINE: f64 = 0.05;

/// Shortest bone in the unit of the file. The direction of a shorter one is rounding.
const MIN_LENGTH: f64 = 1e-4;

const ROTATIONS: [Channel; 3] = [Channel::ZRotation, Channel::XRotation, Channel::YRotation];

/// The skeleton of an arm and hand, and the joints of its nodes, depth first.
#[derive(Debug)]
pub struct PositionSkeleton {
    skeleton: Skeleton,
    joints: Vec<Joint>,
    /// Index of each node's parent.
    parents: Vec<Option<usize>>,
    /// Position of each node in the first frame.
    rest: Vec<DVec3>,
    rotations: Vec<DMat3>,
}

impl PositionSkeleton {
    /// Creates the skeleton of the joints that `first` knows (world, metres). Their distances do not change.
    pub fn new(first: &JointPositions, side: Side) -> Self {
        let mut new = Self {
            skeleton: Skeleton::default(),
            joints: Vec::new(),
            parents: Vec::new(),
            rest: Vec::new(),
            rotations: Vec::new(),
        };
        let mut trunk = None;
        for joint in [Joint::Shoulder, Joint::Elbow, Joint::Wrist] {
            trunk = new.add(first, side, joint, trunk).or(trunk);
        }
        for &finger in Finger::ALL {
            let mut parent = trunk;
            for &joint in finger.joints() {
                parent = new.add(first, side, joint, parent).or(parent);
            }
        }
        new
    }

    /// Adds a joint if its position is known, and returns its index.
    fn add(
        &mut self,
        first: &JointPositions,
        side: Side,
        joint: Joint,
        parent: Option<usize>,
    ) -> Option<usize> {
        let position = position(first, joint)?;
        let origin = parent.map_or(DVec3::ZERO, |parent| self.rest[parent]);
        let is_end = is_tip(joint) && parent.is_some_and(|parent| is_finger(self.joints[parent]));
        let channels = match (is_end, parent) {
            (true, _) => Vec::new(),
            (false, Some(_)) => ROTATIONS.to_vec(),
            (false, None) => {
                let positions = [Channel::XPosition, Channel::YPosition, Channel::ZPosition];
                positions.into_iter().chain(ROTATIONS).collect()
            }
        };
        let offset = match parent {
            // Readers differ in what the offset of a root with position channels means.
            None => DVec3::ZERO,
            Some(_) => position - origin,
        };
        self.joints.push(joint);
        self.parents.push(parent);
        self.rest.push(position);
        self.rotations.push(DMat3::IDENTITY);
        Some(self.skeleton.push(Node {
            name: (!is_end).then(|| name(joint, side)),
            parent,
            offset,
            channels,
        }))
    }

    /// Returns the skeleton.
    pub fn skeleton(&self) -> &Skeleton {
        &self.skeleton
    }

    /// Computes the channel values of a frame. An unknown joint keeps the direction of its bone.
    pub fn frame(&mut self, joints: &JointPositions, values: &mut Vec<f64>) {
        values.clear();
        for index in 0..self.joints.len() {
            let parent = match self.parents[index] {
                Some(parent) => self.rotations[parent],
                None => {
                    let root = position(joints, self.joints[index]).unwrap_or(self.rest[index]);
                    values.extend(root.to_array());
                    DMat3::IDENTITY
                }
            };
            if self.skeleton.nodes()[index].name.is_none() {
                continue;
            }
            let rotation = self.rotation(index, joints, &parent);
            self.rotations[index] = rotation;
            let local = parent.transpose() * rotation;
            let angles = EulerOrder::Zxy.angles(&local).unwrap_or_default();
            values.extend(angles.map(f64::to_degrees));
        }
    }

    /// Returns the world rotation of a joint, which turns its bones from the first frame into this one: two bones determine
    /// it, and one determines it up to the twist, which is that of the parent.
    fn rotation(&self, index: usize, joints: &JointPositions, parent: &DMat3) -> DMat3 {
        let from_here = |joint: usize| {
            let now = position(joints, self.joints[joint])? - position(joints, self.joints[index])?;
            let rest = self.rest[joint] - self.rest[index];
            (rest.length() > MIN_LENGTH && now.length() > MIN_LENGTH).then_some((rest, now))
        };
        let children =
            (index + 1..self.joints.len()).filter(|&child| self.parents[child] == Some(index));
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
    let side = match side {
        Side::Left => "Left",
        Side::Right => "Right",
    };
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
