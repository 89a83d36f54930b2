//! What a simulated hand is told to do: typed texts and scripts both become a list of these.

use std::time::Duration;

use parry3d::math::{Vec2, Vec3};

use crate::contact::TargetId;
use crate::hand::Dof;

/// One order to a simulated hand.
///
/// Where a time is `None`, the movement takes as long as it takes a person.
#[derive(Clone, Debug, PartialEq)]
pub enum HandAction {
    /// Presses and lifts again.
    Tap(TargetPoint),
    /// The index fingertip goes over the place and down to the end of the target's travel. It stays
    /// there.
    Press(TargetPoint),
    /// The index fingertip goes down to this share of the target's travel, 0..=1. On the target that
    /// it is down on already, only the depth changes.
    Push(TargetId, f32),
    /// A fingertip that is down goes so far along the target's X and Y (metres), at the same depth.
    Slide(Vec2, Option<Duration>),
    /// A fingertip that is down goes so many radians around the middle of the target, at the same
    /// depth, counter-clockwise as seen from its front.
    Arc(f32, Option<Duration>),
    /// A fingertip that is down comes up; another one does nothing.
    Lift,
    /// Nothing moves for so long.
    Wait(Duration),
    /// These angles (radians) are reached at the same time, and stay. A fingertip that is down keeps
    /// its place.
    SetAngles(Vec<(Dof, f64)>, Option<Duration>),
    /// The tips of thumb and index finger meet, and stay together.
    Pinch(Option<Duration>),
    /// They part.
    Unpinch(Option<Duration>),
    /// The index fingertip goes to this place, in metres from the elbow along the world's axes. One
    /// that is down lifts first.
    Point(Vec3, Option<Duration>),
}

/// A place on the front of a target.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct TargetPoint {
    /// The target.
    pub target: TargetId,
    /// Metres from the middle of its front along its X and Y; may be beside it.
    pub offset: Vec2,
}

impl HandAction {
    /// A tap of the middle of a target.
    pub fn tap(target: TargetId) -> Self {
        Self::Tap(TargetPoint::center(target))
    }

    /// Where the fingertip is to go down, if it is to.
    pub fn target_point(&self) -> Option<TargetPoint> {
        match *self {
            Self::Tap(spot) | Self::Press(spot) => Some(spot),
            Self::Push(target, _) => Some(TargetPoint::center(target)),
            _ => None,
        }
    }
}

impl TargetPoint {
    /// The middle of a target's front.
    pub fn center(target: TargetId) -> Self {
        Self {
            target,
            offset: Vec2::ZERO,
        }
    }
}
