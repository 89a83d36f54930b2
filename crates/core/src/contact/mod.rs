//! Stage 4: [`HandPose`](crate::kinematics::HandPose) → [`Touches`].

mod bend_tracker;
pub mod board_pose;
pub mod finger_taps;
pub mod hit_test;
pub mod press;
pub mod ray;
pub mod surface;
pub mod sweep;
pub mod tracker;
pub mod volume;
mod fingertip_positions;
mod flexion;
mod front_grid;
mod front_index;
mod strike;
mod stroke;
mod target;
mod target_names;
mod tip_noise;

pub use bend_tracker::{BendTracker, bent_fingers};
pub use fingertip_positions::trusted_fingertip;
pub use press::{Neighbor, Press, Presses};
pub use target_names::{TargetName, TargetNames};
pub use tracker::{ContactTracker, PlacedHand};

use arrayvec::ArrayVec;
use parry3d::math::Vec2;
use serde::{Deserialize, Serialize};

use crate::hand::{Finger, Side};
use crate::names::named_enum;
use crate::time::Timestamp;

/// The index of a target in its [`Scene`](surface::Scene).
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash, Serialize, Deserialize)]
#[serde(transparent)]
pub struct TargetId(pub u32);

/// A change in the contact between a fingertip and a target.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Touch {
    /// The time of the change, interpolated between the previous and the current pose.
    pub time: Timestamp,
    /// The hand.
    pub side: Side,
    /// The finger.
    pub finger: Finger,
    /// The target.
    pub target: TargetId,
    /// The kind of change.
    pub phase: Phase,
    /// The penetration by this fingertip as a fraction of the target's travel, 0..=1; 0 after `Left` and `Cancelled`.
    pub depth: f32,
    /// The position of the fingertip on the target's front, in metres from its center along the target's X and Y axes;
    /// the last known position if the fingertip is no longer tracked.
    pub position: Vec2,
}

named_enum! {
    /// A phase of the contact between a fingertip and a target. A fingertip stays on its target from
    /// `Touched` to `Left` or `Cancelled`; in between `Pressed` and `Released` alternate.
    pub enum Phase ("phase") {
        /// The fingertip entered through the front.
        Touched = "touched",
        /// The fingertip passed the press depth.
        Pressed = "pressed",
        /// The fingertip moved on the target: position and depth are new. At most once per step and finger.
        Moved = "moved",
        /// The fingertip returned above the release depth.
        Released = "released",
        /// The fingertip left through the front.
        Left = "left",
        /// The fingertip slid off sideways, was lost, or the hand jumped. Pressed keys are released; nothing fires.
        Cancelled = "cancelled",
    }
}

/// The most touches of one step.
///
/// In one step a finger can end a contact (released, left) and begin another (touched, pressed, and moved or
/// cancelled): 5 for each of 5 fingers, plus 5 if everything is cancelled, rounded up.
pub const MAX_TOUCHES: usize = 32;

/// The touches of one step, in order of time for each finger.
pub type Touches = ArrayVec<Touch, MAX_TOUCHES>;
