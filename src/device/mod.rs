//! 5 · [`HandPose`] + [`Touches`](crate::contact::Touches) → [`OutputEvent`].

use arrayvec::ArrayVec;

use crate::contact::{TargetId, Touch};
use crate::kinematics::HandPose;
use crate::time::Timestamp;

pub mod keyboard;
pub mod keycode;

pub use keycode::KeyCode;

/// Something for the operating system or a peer.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct OutputEvent {
    /// When it happened.
    pub time: Timestamp,
    /// What happened.
    pub action: Action,
}

/// What an output is to do.
#[derive(Clone, Copy, Debug, PartialEq)]
#[non_exhaustive]
pub enum Action {
    /// A key goes down.
    KeyDown(KeyCode),
    /// A key comes up.
    KeyUp(KeyCode),
    /// How far a control is pushed in, 0..=1; for outputs that know analogue controls.
    Depth(TargetId, f32),
}

/// The events of one frame: releases first, presses second.
///
/// Five fingers can each end one press and begin another in a frame, each with a modifier around
/// it, and tell a depth: 5 × (2 + 2 + 1), and as many again for letting go of everything.
pub type Events = ArrayVec<OutputEvent, 64>;

/// A virtual device: it hears of every touch and says what should go out.
pub trait VirtualDevice: Send {
    /// Takes the touches of one frame; `touches` are in order of time for each finger.
    fn update(&mut self, pose: &HandPose, touches: &[Touch], events: &mut Events);

    /// Lets go of everything at `time`: tracking lost, paused, layout changed, exit.
    fn release_all(&mut self, time: Timestamp, events: &mut Events);
}
