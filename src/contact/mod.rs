//! 4 · [`HandPose`](crate::kinematics::HandPose) → [`Touches`].

pub mod board_pose;
pub mod surface;
pub mod sweep;
pub mod hit_test;
pub mod tracker;
pub mod volume;
mod target_names;

pub use target_names::{TargetName, TargetNames};
pub use tracker::ContactTracker;

use arrayvec::ArrayVec;
use parry3d::math::Vec2;
use serde::{Deserialize, Serialize};

use crate::hand::{Finger, Side};
use crate::names::named_enum;
use crate::time::Timestamp;

/// The place of a target in its [`Scene`](surface::Scene).
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash, Serialize, Deserialize)]
#[serde(transparent)]
pub struct TargetId(pub u32);

/// One step in the meeting of a fingertip and a target.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Touch {
    /// When it happened, between the frame before and this one.
    pub time: Timestamp,
    /// Of which hand.
    pub side: Side,
    /// Whose fingertip.
    pub finger: Finger,
    /// On what.
    pub target: TargetId,
    /// What happened.
    pub phase: Phase,
    /// How far this fingertip pushes the target in, as a share of its travel: 0..=1; 0 once it has
    /// left or was cancelled.
    pub depth: f32,
    /// Where on the target's front the fingertip is, in metres from its middle along the target's own X
    /// and Y; where it was last when it is no longer seen.
    pub position: Vec2,
}

named_enum! {
    /// What happened between a fingertip and a target. Each is latched to its target from
    /// `Touched` to `Left` or `Cancelled`; in between `Pressed` and `Released` alternate.
    pub enum Phase ("phase") {
        /// The fingertip came in through the front.
        Touched = "touched",
        /// It went past the press share of the travel.
        Pressed = "pressed",
        /// It stays on the target; only its place and depth are new. At most one a frame and finger.
        Moved = "held",
        /// It came back above the release share.
        Released = "released",
        /// It left through the front.
        Left = "left",
        /// It slid off sideways, was lost, or the hand jumped: what was down comes up, nothing fires.
        Cancelled = "cancelled",
    }
}

/// How many touches a frame can have, and some to spare.
pub const MAX_TOUCHES: usize = 32;

/// The touches of one frame, in order of time for each finger.
///
/// One frame can end a contact (released, left) and begin another (touched, pressed, and held or
/// cancelled): at most 5 for each of 5 fingers, and 5 more when everything is cancelled.
pub type Touches = ArrayVec<Touch, MAX_TOUCHES>;
