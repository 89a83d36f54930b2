//! The joints of one arm and hand in a skeleton.

use arrayvec::ArrayVec;

use super::joint_names::joint_of;
use super::skeleton::{Node, Skeleton};
use crate::hand::{Finger, Joint, Side};

/// The nodes of a skeleton that are joints of one arm and hand.
#[derive(Clone, Debug, PartialEq)]
pub struct HandJoints {
    nodes: ArrayVec<(Joint, usize), { Joint::COUNT }>,
}

impl HandJoints {
    /// Finds the joints of an arm and hand by [their names](joint_of). Names without a side count if no name has one.
    /// `None` if there is no wrist.
    ///
    /// A fingertip without a joint of its own is the End Site of the last joint of its finger. In a hand without fingers,
    /// the End Site of the hand is the tip of the index finger, with which layouts are operated.
    pub fn find(skeleton: &Skeleton, side: Side) -> Option<Self> {
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
        // A name that may be the collar bone counts only if nothing else names the shoulder.
        for may_be_clavicle in [false, true] {
            for (index, node) in nodes.iter().enumerate() {
                match named(node) {
                    Some(named)
                        if named.side == wanted && named.may_be_clavicle == may_be_clavicle =>
                    {
                        joints.add(named.joint, index);
                    }
                    _ => {}
                }
            }
        }
        let wrist = joints.node(Joint::Wrist)?;
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
        Some(joints)
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

/// Returns the index of the first End Site of a node.
fn end_site_of(nodes: &[Node], node: usize) -> Option<usize> {
    let is_end_site = |other: &Node| other.parent == Some(node) && other.name.is_none();
    nodes.iter().position(is_end_site)
}

#[cfg(test)]
mod tests {
    use glam::DVec3;

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
        let Some(joints) = HandJoints::find(skeleton, side) else {
            return "none".to_owned();
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
