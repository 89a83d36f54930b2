//! Violations of the invariants.

use ademan::command::CommandOrigin;
use ademan::contact::TargetId;
use ademan::device::{Axis, Capability, EventKind, KeyCode};
use ademan::hand::{Dof, Finger, Joint, Side};
use ademan::pipeline::PipelineState;
use ademan::time::Timestamp;

/// A violation of an invariant. The text begins with the number of the invariant.
#[derive(Clone, Copy, Debug, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum Violation {
    /// An event that the active layout may not emit.
    #[error("I1: an event needs {0}, which the active layout does not have")]
    NotAllowed(Capability),
    /// A profile that the setup does not have.
    #[error("I1: the setup has no profile with the index {0}")]
    NoSuchProfile(usize),
    /// A press after which the pressed keys act on the system, without permission.
    #[error("I1: `{0}` was pressed, and the pressed keys act on the system")]
    SystemChord(KeyCode),
    /// A press of a pressed key.
    #[error("I2: `{0}` was pressed twice")]
    PressedTwice(KeyCode),
    /// A release of a released key.
    #[error("I2: `{0}` was released without a press")]
    ReleasedWithoutPress(KeyCode),
    /// More pressed keys than the oracle can follow.
    #[error("I2: `{0}` was pressed besides more keys than fingers and switches can hold")]
    TooManyPressed(KeyCode),
    /// A key that is still pressed after everything was released.
    #[error("I2, I4: `{0}` is still pressed in state {1}, after everything was released")]
    NotReleased(KeyCode, PipelineState),
    /// An axis that is off center after everything was released.
    #[error("I2, I4: `{0}` is off center in state {1}, after everything was released")]
    AxisNotCentered(Axis, PipelineState),
    /// An event that needs an accepted reading.
    #[error("I3: {0:?} was emitted without an accepted reading")]
    WithoutReading(EventKind),
    /// A pose with another time stamp than the reading.
    #[error("I3: the pose of {0:?} has another time stamp than its reading")]
    StalePose(Timestamp),
    /// A pose that is not later than the previous one of the same hand.
    #[error("I3: a pose of the {0} hand is not later than the previous one")]
    PoseNotNewer(Side),
    /// A joint angle outside its limits.
    #[error("I3: `{0}` at {1} rad is outside its limits")]
    AngleOutOfRange(Dof, f64),
    /// A pose that is not finite.
    #[error("I3: the pose of `{0}` is not finite")]
    PoseNotFinite(Joint),
    /// A release after a press in the same step.
    #[error("I4: `{0}` was released after a press of the same step")]
    LateRelease(KeyCode),
    /// A value outside its range, or not a number.
    #[error("I5: {0:?} is out of range")]
    OutOfRange(EventKind),
    /// Motion beyond the maximum distance per step.
    #[error("I5: the pointer moved {0} pixels in one step; the maximum is {1}")]
    PointerTooFast(f32, f32),
    /// An event with an earlier time stamp than the previous one.
    #[error("I5: {0:?} is earlier than the event before it")]
    EventTimeWentBack(EventKind),
    /// A transition that is not permitted.
    #[error("I6: the state changed from {0} to {1}")]
    StateChange(PipelineState, PipelineState),
    /// A start without an accepted reading.
    #[error("I6: output was armed without an accepted reading")]
    ArmedWithoutReading,
    /// A start before the hand was clear of all controls for the arming delay.
    #[error("I6: output was armed before the hand was clear of all controls for long enough")]
    ArmedTooSoon,
    /// A state other than paused during a requested pause.
    #[error("I6: a pause was requested, and the state is {0}")]
    PauseNotKept(PipelineState),
    /// A pause from outside that a reading of the hand ended or weakened.
    #[error("I6: the hand ended a pause of `{0}`")]
    PauseEndedByHand(CommandOrigin),
    /// An event after the pipeline was stopped.
    #[error("I6: {0:?} was emitted after the pipeline was stopped")]
    EventAfterStop(EventKind),
    /// An event between two states that suppress events.
    #[error("I6: {0:?} was emitted while the pipeline was not running")]
    EventWhileNotRunning(EventKind),
    /// A touch that continues and never began, or began before everything was released.
    #[error("I6: the {0} finger of the {1} hand continues a touch of {2:?} that did not begin")]
    TouchNeverBegan(Finger, Side, TargetId),
    /// A touch in the first step, before the finger was seen clear of the control.
    #[error("I6: the {0} finger of the {1} hand touches {2:?} in the first step")]
    TouchInFirstStep(Finger, Side, TargetId),
}
