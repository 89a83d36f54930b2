//! Why a simulated hand does not do what it is told.

use crate::contact::TargetId;
use crate::hand::Dof;
use crate::names::UnknownName;

/// An order that cannot be carried out.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[error("{kind}")]
pub struct ActionError {
    /// The place of the order in the list.
    pub index: usize,
    /// What is the matter.
    pub kind: ActionErrorKind,
}

/// Why an order cannot be carried out.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum ActionErrorKind {
    /// A target, or a place in space, is too far away.
    #[error("{} is {:.0} mm out of reach of the simulated hand", thing(.target), .metres * 1e3)]
    OutOfReach {
        /// The target, where there is one.
        target: Option<TargetId>,
        /// How far the fingertip stays away, in metres.
        metres: f64,
    },
    /// A trigger, or a target in space.
    #[error(
        "it is on no board, so nothing taps it: go there with `point X Y Z`, or move what it measures"
    )]
    NotOnBoard,
    /// Only a fingertip that is down can do this.
    #[error("the fingertip is not down: put a `press` or a `push` before it")]
    NotDown,
    /// A way around the middle, from the middle.
    #[error(
        "the fingertip is in the middle that it would go around: press beside it, as in `press NAME 10 0`"
    )]
    AtCenter,
    /// An angle that the glove has no sensor for.
    #[error("the glove has no sensor for `{}`{}", .0.text, instead(.0))]
    NoSensor(UnknownName),
    /// An angle that the joint or its sensor does not get to.
    #[error("`{dof}` goes from {low:.0}° to {high:.0}° with this glove, not to {wanted:.0}°")]
    AngleOutOfRange {
        /// The angle.
        dof: Dof,
        /// What was wanted, in degrees.
        wanted: f64,
        /// The least that can be had, in degrees.
        low: f64,
        /// The most that can be had, in degrees.
        high: f64,
    },
    /// Thumb and index finger do not meet.
    #[error("thumb and index finger stay {:.0} mm apart in this posture", .0 * 1e3)]
    PinchFailed(f64),
}

fn thing(target: &Option<TargetId>) -> String {
    match target {
        Some(TargetId(number)) => format!("target {number}"),
        None => "this place".to_owned(),
    }
}

fn instead(name: &UnknownName) -> String {
    match &name.nearest {
        Some(name) => format!(", did you mean `{name}`?"),
        None => String::new(),
    }
}
