//! Actions of a simulated hand. Texts and scripts are translated to lists of actions.

use std::time::Duration;

use parry3d::math::{Vec2, Vec3};

use crate::contact::TargetId;
use crate::hand::{BodyAngle, Dof, Input};
use crate::layout::Fit;

/// One action of a simulated hand.
///
/// Without a duration, a movement takes as long as a person needs for it.
#[derive(Clone, Debug, PartialEq)]
pub enum HandAction {
    /// Presses a point of a target and lifts the fingertip again.
    Tap(TargetPoint),
    /// Bends the fingers of targets that are pressed by bending, together, and straightens them again.
    Chord(Vec<TargetId>),
    /// Moves the index fingertip above a point and down to the end of the target's travel. It stays there.
    Press(TargetPoint),
    /// Presses a target to this fraction of its travel, 0..=1. If the fingertip presses the target already, only the
    /// depth changes.
    Push(TargetId, f32),
    /// Moves the pressed fingertip along the X and Y of the target (metres) at the same depth.
    Slide(Vec2, Option<Duration>),
    /// Moves the pressed fingertip around the center of the target at the same depth, in radians, counter-clockwise
    /// seen from the front.
    Arc(f32, Option<Duration>),
    /// Lifts the fingertip. A fingertip that is not pressed does not move.
    Lift,
    /// Keeps the posture.
    Wait(Duration),
    /// Moves joints to these angles (radians), where they stay. A pressed fingertip keeps its position.
    SetAngles(Vec<(Dof, f64)>, Option<Duration>),
    /// Brings the tips of thumb and index finger together. They stay together.
    Pinch(Option<Duration>),
    /// Ends the pinch.
    Unpinch(Option<Duration>),
    /// Sets a stick, trigger or button of the glove, −1..=1. It stays there.
    SetInput(Input, f64),
    /// Turns the head, a foot or a knee to this angle (radians). It stays there.
    SetBody(BodyAngle, f64),
    /// Moves the index fingertip to a position relative to the elbow, along the axes of the world (metres). A pressed
    /// fingertip is lifted first.
    Point(Vec3, Option<Duration>),
}

/// A point on the front of a target.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct TargetPoint {
    /// The target.
    pub target: TargetId,
    /// Offset from the center of the front along X and Y, in metres. It may lead outside the target.
    pub offset: Vec2,
}

impl HandAction {
    /// Creates a tap on the center of a target.
    pub fn tap(target: TargetId) -> Self {
        Self::Tap(TargetPoint::center(target))
    }

    /// Returns the action with its position in space fitted to the hand, as targets in space are.
    pub fn placed(self, fit: &Fit) -> Self {
        match self {
            Self::Point(position, time) => Self::Point(fit.position_from_elbow(position), time),
            other => other,
        }
    }

    /// Returns the target that the action presses, the first one of a chord, if any.
    pub fn target(&self) -> Option<TargetId> {
        match self {
            Self::Chord(targets) => targets.first().copied(),
            other => other.target_point().map(|point| point.target),
        }
    }

    /// Returns the point that the action presses, if any.
    pub fn target_point(&self) -> Option<TargetPoint> {
        match *self {
            Self::Tap(point) | Self::Press(point) => Some(point),
            Self::Push(target, _) => Some(TargetPoint::center(target)),
            _ => None,
        }
    }
}

impl TargetPoint {
    /// Creates the center of a target's front.
    pub fn center(target: TargetId) -> Self {
        Self {
            target,
            offset: Vec2::ZERO,
        }
    }
}
