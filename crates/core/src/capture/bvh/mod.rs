//! BVH, the text format of motion capture: a skeleton, and the values of its channels in each frame.
//!
//! ```text
//! HIERARCHY
//! ROOT name { OFFSET x y z  CHANNELS n c1..cn  (JOINT name {...} | End Site { OFFSET x y z })* }
//! MOTION
//! Frames: n
//! Frame Time: seconds
//! n times all channel values, in file order
//! ```
//!
//! [`BvhParser`] reads a stream of any length in bounded memory, [`Bvh`] a whole file, and [`BvhWriter`] writes one;
//! [`ArmsSkeleton`] computes the frames of a body with [arms](ArmShape) of constant lengths.
//! [`Skeleton::world_poses`] is the forward kinematics. A BVH does not state its unit of length and its axes; most files
//! are in centimetres with +Y up.

mod arm_shape;
mod arms_skeleton;
mod error;
mod file;
mod hand_joints;
mod joint_names;
mod limits;
mod parser;
mod skeleton;
mod tokens;
mod writer;

pub use arm_shape::{ArmShape, parent_of};
pub use arms_skeleton::ArmsSkeleton;
pub use error::BvhError;
pub use file::Bvh;
pub use hand_joints::{HandJoints, HandJointsError};
pub use joint_names::{NamedJoint, joint_of};
pub use limits::{MAX_CHANNELS, MAX_DEPTH, MAX_FRAMES, MAX_NODES, MAX_TOKEN_BYTES};
pub use parser::{BvhParser, Motion};
pub use skeleton::{Channel, Node, NodePose, PositionChannels, Skeleton};
pub use writer::{BvhWriter, write_frame, write_header};
