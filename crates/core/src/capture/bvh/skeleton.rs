//! A skeleton: joints with offsets and channels, and its forward kinematics.

use glam::{DMat3, DVec3};

use crate::names::named_enum;

named_enum! {
    /// A number that a joint has in every frame.
    pub enum Channel ("channel") {
        /// Displacement along X, in the unit of the file.
        XPosition = "Xposition",
        /// Displacement along Y.
        YPosition = "Yposition",
        /// Displacement along Z.
        ZPosition = "Zposition",
        /// Rotation about X, in degrees.
        XRotation = "Xrotation",
        /// Rotation about Y, in degrees.
        YRotation = "Yrotation",
        /// Rotation about Z, in degrees.
        ZRotation = "Zrotation",
    }
}

impl Channel {
    /// Returns the axis: 0 for X, 1 for Y, 2 for Z.
    pub const fn axis(self) -> usize {
        self.index() % 3
    }

    /// Returns `true` for a rotation.
    pub const fn is_rotation(self) -> bool {
        self.index() >= 3
    }
}

named_enum! {
    /// The meaning of position channels. Files differ where a joint has both an offset and position channels.
    pub enum PositionChannels ("meaning of position channels") {
        /// Position channels are added to the offset.
        Add = "add",
        /// Position channels replace the components of the offset, as in the files of Blender.
        Replace = "replace",
    }
}

/// A joint, or the end of a chain of joints.
#[derive(Clone, Debug, PartialEq)]
pub struct Node {
    /// The name. `None` for an End Site.
    pub name: Option<String>,
    /// The index of the parent, which precedes this node; `None` for the root.
    pub parent: Option<usize>,
    /// The position in the parent's frame, in the unit of the file.
    pub offset: DVec3,
    /// The channels in file order. An End Site has none.
    pub channels: Vec<Channel>,
}

/// The pose of a node in the axes and the unit of the file.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct NodePose {
    /// The rotation; columns are the axes of the node.
    pub rotation: DMat3,
    /// The position.
    pub position: DVec3,
}

/// A tree of joints.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Skeleton {
    nodes: Vec<Node>,
    channel_count: usize,
}

impl Skeleton {
    /// Adds a node and returns its index. Nodes are added depth first, the root first.
    ///
    /// # Panics
    /// If the parent does not precede the node, or if there is a second root.
    pub fn push(&mut self, node: Node) -> usize {
        let index = self.nodes.len();
        match node.parent {
            Some(parent) => assert!(parent < index, "a parent precedes its children"),
            None => assert_eq!(index, 0, "a skeleton has one root"),
        }
        self.channel_count += node.channels.len();
        self.nodes.push(node);
        index
    }

    /// Returns the joints and End Sites, depth first in file order.
    pub fn nodes(&self) -> &[Node] {
        &self.nodes
    }

    /// Returns the number of values in each frame.
    pub fn channel_count(&self) -> usize {
        self.channel_count
    }

    pub(super) fn set_offset(&mut self, node: usize, axis: usize, value: f64) {
        self.nodes[node].offset[axis] = value;
    }

    pub(super) fn add_channel(&mut self, node: usize, channel: Channel) {
        self.nodes[node].channels.push(channel);
        self.channel_count += 1;
    }

    /// Computes the world pose of every node: world = parent · translate(offset, positions) · the rotations in file order,
    /// as products of column-vector matrices, so that `Zrotation Xrotation Yrotation` is Rz · Rx · Ry. Position channels
    /// act before the rotations wherever they stand.
    ///
    /// `values` are the values of one frame. `poses` is overwritten.
    ///
    /// # Panics
    /// If there are fewer values than channels.
    pub fn world_poses(
        &self,
        values: &[f64],
        positions: PositionChannels,
        poses: &mut Vec<NodePose>,
    ) {
        poses.clear();
        let mut rest = values;
        for node in &self.nodes {
            let (own_values, later) = rest.split_at(node.channels.len());
            rest = later;
            let parent = match node.parent {
                Some(parent) => poses[parent],
                None => NodePose {
                    rotation: DMat3::IDENTITY,
                    position: DVec3::ZERO,
                },
            };
            let translation = node.translation(own_values, positions);
            poses.push(NodePose {
                rotation: node.rotated(parent.rotation, own_values),
                position: parent.position + parent.rotation * translation,
            });
        }
    }
}

impl Node {
    fn translation(&self, values: &[f64], positions: PositionChannels) -> DVec3 {
        let mut translation = self.offset;
        let mut is_replaced = [positions == PositionChannels::Add; 3];
        for (channel, value) in self.channels.iter().zip(values) {
            let axis = channel.axis();
            if channel.is_rotation() {
                continue;
            }
            if !std::mem::replace(&mut is_replaced[axis], true) {
                translation[axis] = 0.0;
            }
            translation[axis] += value;
        }
        translation
    }

    /// Returns `rotation` with the rotation channels multiplied to its right, in file order.
    fn rotated(&self, mut rotation: DMat3, values: &[f64]) -> DMat3 {
        for (channel, degrees) in self.channels.iter().zip(values) {
            if !channel.is_rotation() {
                continue;
            }
            let (sine, cosine) = degrees.to_radians().sin_cos();
            // A turn about one axis mixes the two columns that follow it in the order X, Y, Z, X.
            let (first, second) = ((channel.axis() + 1) % 3, (channel.axis() + 2) % 3);
            let (a, b) = (rotation.col(first), rotation.col(second));
            *rotation.col_mut(first) = a * cosine + b * sine;
            *rotation.col_mut(second) = b * cosine - a * sine;
        }
        rotation
    }
}

/// Returns the channel with this name, compared without case.
pub(super) fn channel_named(token: &[u8]) -> Option<Channel> {
    let mut channels = Channel::ALL.iter().copied();
    channels.find(|channel| token.eq_ignore_ascii_case(channel.name().as_bytes()))
}

/// Returns the number in a word: decimal, finite, with an optional sign, fraction and exponent.
pub(super) fn number(token: &[u8]) -> Option<f64> {
    let text = std::str::from_utf8(token).ok()?;
    text.parse().ok().filter(|number: &f64| number.is_finite())
}
