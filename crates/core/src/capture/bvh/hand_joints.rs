//! The joints of one arm and hand in a skeleton.

use arrayvec::ArrayVec;
use glam::DVec3;

use super::error::shown;
use super::joint_names::{NamedJoint, joint_of};
use super::skeleton::{Node, Skeleton};
use crate::hand::{Finger, Joint, Side};

/// The nodes of a skeleton that are joints of one arm and hand.
#[derive(Clone, Debug, PartialEq)]
pub struct HandJoints {
    nodes: ArrayVec<(Joint, usize), { Joint::COUNT }>,
}

/// A reason why the joints of a hand are not known.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
pub enum HandJointsError {
    /// No joint is the wrist.
    #[error(
        "no joint is named as the wrist of the {side} hand; {}",
        advice(*side, *has_other)
    )]
    NoWrist {
        /// The hand.
        side: Side,
        /// `true` if a joint is named as the wrist of the other hand.
        has_other: bool,
    },
    /// Two joints at different positions have names of one joint, and neither is better.
    #[error(
        "{} and {} are both names of the {joint} of the {side} hand; rename the one that is another joint",
        shown(names[0].as_bytes()),
        shown(names[1].as_bytes())
    )]
    Ambiguous {
        /// The hand.
        side: Side,
        /// The joint.
        joint: Joint,
        /// Both names in file order.
        names: [String; 2],
    },
}

/// Returns what to do if the wrist of a hand is missing in a file that may have the other hand.
fn advice(side: Side, has_other: bool) -> String {
    let start = title(side);
    let name = format!("name it `{start}Hand` or `{start}Wrist`");
    if has_other {
        format!("use `hand={}`, or {name}", side.opposite())
    } else {
        name
    }
}

/// Returns the side as the names of joints begin with it.
pub(super) fn title(side: Side) -> &'static str {
    match side {
        Side::Left => "Left",
        Side::Right => "Right",
    }
}

impl HandJoints {
    /// Finds the joints of an arm and hand by [their names](joint_of). Names without a side count if no name has one, and
    /// [vague](super::NamedJoint::is_vague) ones if no other name states the joint.
    ///
    /// A fingertip without a joint of its own is the End Site of the last joint of its finger. In a hand without fingers,
    /// the End Site of the hand is the tip of the index finger, with which layouts are operated.
    pub fn find(skeleton: &Skeleton, side: Side) -> Result<Self, HandJointsError> {
        let nodes = skeleton.nodes();
        let named = |node: &Node| node.name.as_deref().and_then(joint_of);
        let has_sides = nodes
            .iter()
            .filter_map(named)
            .any(|named| named.side.is_some());
        let wanted = has_sides.then_some(side);
        let mut joints = Self {
            nodes: ArrayVec::new(),
        };
        for is_vague in [false, true] {
            let known = joints.clone();
            for (index, node) in nodes.iter().enumerate() {
                let Some(named) = named(node) else {
                    continue;
                };
                let is_known = known.node(named.joint).is_some();
                if named.side == wanted && named.is_vague == is_vague && !is_known {
                    joints.add_named(named.joint, index, nodes, side)?;
                }
            }
        }
        let is_other =
            |it: NamedJoint| it.joint == Joint::Wrist && it.side == Some(side.opposite());
        let wrist = joints
            .node(Joint::Wrist)
            .ok_or_else(|| HandJointsError::NoWrist {
                side,
                has_other: nodes.iter().filter_map(named).any(is_other),
            })?;
        for &finger in Finger::ALL {
            joints.add_tip(finger, nodes);
        }
        let has_finger = joints
            .iter()
            .any(|(joint, _)| joint.index() > Joint::Wrist.index());
        if let Some(end) = end_site_of(nodes, wrist)
            && !has_finger
        {
            joints.add(Joint::tip(Finger::Index), end);
        }
        Ok(joints)
    }

    /// Adds a joint that a name states. An error if another name as good states it at another position.
    fn add_named(
        &mut self,
        joint: Joint,
        node: usize,
        nodes: &[Node],
        side: Side,
    ) -> Result<(), HandJointsError> {
        if let Some(other) = self.node(joint)
            && !coincide(nodes, other, node)
        {
            let name = |index: usize| nodes[index].name.clone().unwrap_or_default();
            return Err(HandJointsError::Ambiguous {
                side,
                joint,
                names: [name(other), name(node)],
            });
        }
        self.add(joint, node);
        Ok(())
    }

    /// Iterates over the joints and the indices of their nodes.
    pub fn iter(&self) -> impl Iterator<Item = (Joint, usize)> + '_ {
        self.nodes.iter().copied()
    }

    /// Returns the index of the node of a joint.
    pub fn node(&self, joint: Joint) -> Option<usize> {
        let found = self.nodes.iter().find(|(other, _)| *other == joint);
        found.map(|(_, node)| *node)
    }

    /// Adds a joint unless it is there already.
    fn add(&mut self, joint: Joint, node: usize) {
        if self.node(joint).is_none() {
            self.nodes.push((joint, node));
        }
    }

    fn add_tip(&mut self, finger: Finger, nodes: &[Node]) {
        let last = finger
            .joints()
            .iter()
            .rev()
            .find_map(|&joint| self.node(joint));
        let end = last.and_then(|last| end_site_of(nodes, last));
        if let Some(end) = end {
            self.add(Joint::tip(finger), end);
        }
    }
}

/// Returns `true` if a node has the position of an earlier one in every pose without position channels.
fn coincide(nodes: &[Node], earlier: usize, later: usize) -> bool {
    let (earlier_node, later_node) = (&nodes[earlier], &nodes[later]);
    match later_node.parent {
        Some(parent) if parent == earlier => later_node.offset == DVec3::ZERO,
        parent => parent == earlier_node.parent && later_node.offset == earlier_node.offset,
    }
}

/// Returns the index of the first End Site of a node.
fn end_site_of(nodes: &[Node], node: usize) -> Option<usize> {
    let is_end_site = |other: &Node| other.parent == Some(node) && other.name.is_none();
    nodes.iter().position(is_end_site)
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Builds a skeleton from names and parents; `-` is an End Site.
    fn skeleton(nodes: &[(&str, Option<usize>)]) -> Skeleton {
        let mut skeleton = Skeleton::default();
        for &(name, parent) in nodes {
            skeleton.push(Node {
                name: (name != "-").then(|| name.to_owned()),
                parent,
                offset: DVec3::X,
                channels: Vec::new(),
            });
        }
        skeleton
    }

    fn found(skeleton: &Skeleton, side: Side) -> String {
        let joints = match HandJoints::find(skeleton, side) {
            Ok(joints) => joints,
            Err(HandJointsError::NoWrist { .. }) => return "none".to_owned(),
            Err(error) => return error.to_string(),
        };
        let mut found: Vec<_> = joints.iter().collect();
        found.sort();
        let texts: Vec<String> = found
            .iter()
            .map(|(joint, node)| format!("{joint}={node}"))
            .collect();
        texts.join(" ")
    }

    #[test]
    fn a_shoulder_is_the_collar_bone_only_beside_an_upper_arm() {
        let with_arm = skeleton(&[
            ("RightShoulder", None),
            ("RightArm", Some(0)),
            ("RightForeArm", Some(1)),
            ("RightHand", Some(2)),
        ]);
        assert_eq!(found(&with_arm, Side::Right), "shoulder=1 elbow=2 wrist=3");
        assert_eq!(found(&with_arm, Side::Left), "none");
        let without = skeleton(&[
            ("RightCollar", None),
            ("RightShoulder", Some(0)),
            ("RightElbow", Some(1)),
            ("RightWrist", Some(2)),
            ("-", Some(3)),
        ]);
        assert_eq!(
            found(&without, Side::Right),
            "shoulder=1 elbow=2 wrist=3 index-finger-tip=4"
        );
    }

    #[test]
    fn the_other_hand_is_recommended_only_if_the_file_has_it() {
        let message = |name: &str| {
            let found = HandJoints::find(&skeleton(&[(name, None)]), Side::Right);
            found.unwrap_err().to_string()
        };
        assert_eq!(
            message("LeftHand"),
            "no joint is named as the wrist of the right hand; use `hand=left`, or name it `RightHand` or `RightWrist`"
        );
        assert_eq!(
            message("Hips"),
            "no joint is named as the wrist of the right hand; name it `RightHand` or `RightWrist`"
        );
    }

    #[test]
    fn a_finger_without_a_segment_is_its_first_joint_only_without_a_better_name() {
        // Vicon: the first joint of a finger is in the carpus.
        let vicon = skeleton(&[
            ("RightHand", None),
            ("RightHandIndex", Some(0)),
            ("RightHandIndex1", Some(1)),
            ("RightHandIndex2", Some(2)),
        ]);
        assert_eq!(
            found(&vicon, Side::Right),
            "wrist=0 index-finger-phalanx-proximal=2 index-finger-phalanx-intermediate=3"
        );
        // MakeHuman: the end of the hand, from which the finger is apart.
        let dummy = skeleton(&[
            ("Hand_R", None),
            ("__Index1_R", Some(0)),
            ("Index1_R", Some(1)),
        ]);
        assert_eq!(
            found(&dummy, Side::Right),
            "wrist=0 index-finger-phalanx-proximal=2"
        );
    }

    #[test]
    fn the_only_finger_beside_a_thumb_is_the_index_finger_and_numbered_fingers_are_not_guessed() {
        let nodes = [
            ("RightHand", None),
            ("RThumb", Some(0)),
            ("RightHandFinger1", Some(0)),
            ("RightHandFinger2", Some(0)),
        ];
        let mitten = skeleton(&nodes[..3]);
        assert_eq!(
            found(&mitten, Side::Right),
            "wrist=0 thumb-metacarpal=1 index-finger-phalanx-proximal=2"
        );
        let mut numbered = skeleton(&nodes[..3]);
        numbered.push(Node {
            name: Some(nodes[3].0.to_owned()),
            parent: Some(0),
            offset: DVec3::Y,
            channels: Vec::new(),
        });
        let message = found(&numbered, Side::Right);
        assert!(
            message.contains("`RightHandFinger2` are both names"),
            "{message}"
        );
    }

    #[test]
    fn two_names_of_one_joint_are_an_error_unless_they_are_at_one_place() {
        let twice = |offset: DVec3| {
            let mut skeleton = skeleton(&[("wrist.R", None), ("Index1_R", Some(0))]);
            skeleton.push(Node {
                name: Some("RightHandIndex1\u{1b}".to_owned()),
                parent: Some(1),
                offset,
                channels: Vec::new(),
            });
            found(&skeleton, Side::Right)
        };
        let message = twice(DVec3::Y);
        assert!(
            message.starts_with(
                r"`Index1_R` and `RightHandIndex1\u{1b}` are both names of the index-finger-phalanx-proximal of the right"
            ),
            "{message}"
        );
        assert_eq!(
            twice(DVec3::ZERO),
            "wrist=0 index-finger-phalanx-proximal=1"
        );
    }

    #[test]
    fn fingertips_are_end_sites_or_joints() {
        let hand = skeleton(&[
            ("LeftHand", None),
            ("LThumb", Some(0)),
            ("-", Some(1)),
            ("LeftHandIndex1", Some(0)),
            ("LeftHandIndex4", Some(3)),
            ("-", Some(4)),
            ("-", Some(0)),
        ]);
        assert_eq!(
            found(&hand, Side::Left),
            "wrist=0 thumb-metacarpal=1 thumb-tip=2 index-finger-phalanx-proximal=3 index-finger-tip=4"
        );
    }

    #[test]
    fn names_without_sides_are_those_of_either_hand() {
        let hand = skeleton(&[("wrist", None), ("index1", Some(0)), ("-", Some(1))]);
        let joints = "wrist=0 index-finger-phalanx-proximal=1 index-finger-tip=2";
        assert_eq!(found(&hand, Side::Left), joints);
        assert_eq!(found(&hand, Side::Right), joints);
    }
}
