//! Errors of actions that a simulated hand cannot perform.

use crate::contact::TargetId;
use crate::hand::{BodyAngle, Dof, Finger, Input};
use crate::message::escape;
use crate::names::UnknownName;

/// An action that cannot be performed.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[error("{kind}")]
pub struct ActionError {
    /// Index of the action in the list.
    pub index: usize,
    /// Reason.
    pub kind: ActionErrorKind,
}

/// Reason why an action cannot be performed.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum ActionErrorKind {
    /// A target or a position is too far away.
    #[error("{} is {:.0} mm out of reach of the simulated hand", describe(.target), .metres * 1e3)]
    OutOfReach {
        /// The target; `None` for a position in space.
        target: Option<TargetId>,
        /// Remaining distance of the fingertip in metres.
        metres: f64,
    },
    /// A trigger or a target in space.
    #[error(
        "it is on no board, so it cannot be tapped; move the fingertip there with `point X Y Z`, or move the joint \
         that it measures"
    )]
    NotOnBoard,
    /// A press in which a finger would press another target, in addition or instead.
    #[error("the {finger} would press another target; move the targets apart, or let another finger press", finger = .finger.in_words())]
    WouldPress {
        /// The finger.
        finger: Finger,
        /// The target that it would press.
        target: TargetId,
    },
    /// A press that would not press the target.
    #[error(
        "the fingertip would not press it; another control is in front of it, or its travel is too long"
    )]
    WouldMiss(TargetId),
    /// A target to which every path touches another target.
    #[error("every path to it touches another control; move the controls apart")]
    NoWay,
    /// A chord of a key that is pressed by touch.
    #[error("the simulated hand can play only chords of bent fingers (`contact: Bend`)")]
    NotBent,
    /// An action that needs a pressed fingertip.
    #[error("the fingertip presses nothing; put a `press` or a `push` before this")]
    NotPressed,
    /// An arc around the point at which the fingertip is.
    #[error(
        "the fingertip is at the center of the arc; press beside it, such as `press NAME 10 0`"
    )]
    AtCenter,
    /// An angle that the glove does not measure.
    #[error("the glove has no sensor for `{}`{}", escape(&.0.text), suggestion(.0))]
    NoSensor(UnknownName),
    /// A stick, trigger or button that the glove does not have.
    #[error("the glove has no input `{0}`; use a glove with inputs, such as `lucidgloves`")]
    NoInput(Input),
    /// An angle of the body that the sensor does not show.
    #[error("only body landmarks show `{0}`; choose a layout that uses the head or the feet")]
    NoBody(BodyAngle),
    /// An angle outside the range of the joint or of its sensor.
    #[error(
        "`{dof}` ranges from {low:.0}° to {high:.0}° with this glove, and {wanted:.0}° is outside"
    )]
    AngleOutOfRange {
        /// The angle.
        dof: Dof,
        /// Requested angle in degrees.
        wanted: f64,
        /// Smallest angle in degrees.
        low: f64,
        /// Largest angle in degrees.
        high: f64,
    },
    /// A pinch in a posture in which the fingertips cannot meet. The value is their distance in metres.
    #[error("thumb and index finger stay {:.0} mm apart in this posture; move the hand closer to the body before the pinch", .0 * 1e3)]
    PinchFailed(f64),
}

impl ActionErrorKind {
    /// Returns `true` if the action is possible in itself, but the hand does not reach the target or has no free path to it.
    pub(crate) fn is_out_of_reach(&self) -> bool {
        matches!(
            self,
            Self::OutOfReach { .. }
                | Self::WouldPress { .. }
                | Self::WouldMiss(_)
                | Self::NoWay
                | Self::PinchFailed(_)
        )
    }
}

fn describe(target: &Option<TargetId>) -> String {
    match target {
        Some(TargetId(id)) => format!("target {id}"),
        None => "this position".to_owned(),
    }
}

fn suggestion(name: &UnknownName) -> String {
    match &name.nearest {
        Some(name) => format!(", did you mean `{name}`?"),
        None => String::new(),
    }
}
