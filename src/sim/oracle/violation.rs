//! What an engine must never do.

use crate::contact::TargetId;
use crate::device::{Axis, Capability, EventKind, KeyCode};
use crate::hand::{Dof, Finger, Joint, Side};
use crate::snapshot::PipelineState;
use crate::time::Timestamp;

/// What an engine did that it must never do; the text begins with the invariant.
#[derive(Clone, Copy, Debug, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum Violation {
    /// Something went out that the layout in force may not send.
    #[error("I1: {0} went out, which the layout in force may not send")]
    NotAllowed(Capability),
    /// There is no layout in this place of the setup.
    #[error("I1: the setup has no layout number {0}")]
    NoSuchProfile(usize),
    /// It was down already.
    #[error("I2: `{0}` went down twice")]
    PressedTwice(KeyCode),
    /// It was not down.
    #[error("I2: `{0}` came up, and was not down")]
    ReleasedWithoutPress(KeyCode),
    /// Too many are down to follow.
    #[error("I2: `{0}` went down beside more codes than fingers and switches can hold")]
    TooManyPressed(KeyCode),
    /// It is down where nothing may be.
    #[error("I2, I4: `{0}` is still down in state {1}, after everything was let go of")]
    NotReleased(KeyCode, PipelineState),
    /// It is off its rest where it may not be.
    #[error("I2, I4: `{0}` is not at rest in state {1}, after everything was let go of")]
    AxisNotCentered(Axis, PipelineState),
    /// Something happened without a frame that only a frame may do.
    #[error("I3: {0:?} went out without an accepted frame")]
    WithoutReading(EventKind),
    /// A frame is not of the moment of its reading.
    #[error("I3: the frame of {0:?} is not of the moment of its reading")]
    StalePose(Timestamp),
    /// A frame is not later than the one before of the same hand.
    #[error("I3: a frame of the {0} hand is not later than the one before")]
    PoseNotNewer(Side),
    /// An angle that a joint cannot have.
    #[error("I3: `{0}` at {1} rad is not within its range")]
    AngleOutOfRange(Dof, f64),
    /// A place that is not a number.
    #[error("I3: the place of `{0}` is not finite")]
    PoseNotFinite(Joint),
    /// It was down before, and came up after something else went down.
    #[error("I4: `{0}` came up behind a press in the same frame")]
    LateRelease(KeyCode),
    /// A number out of its range, or none at all.
    #[error("I5: {0:?} is out of its range")]
    OutOfRange(EventKind),
    /// The pointer went further in a frame than it may.
    #[error("I5: the pointer went {0} pixels in a frame, it may go {1}")]
    PointerTooFast(f32, f32),
    /// An event is earlier than the one before it.
    #[error("I5: {0:?} is earlier than what went out before it")]
    EventTimeWentBack(EventKind),
    /// A change of state that there is not.
    #[error("I6: it went from {0} to {1}")]
    StateChange(PipelineState, PipelineState),
    /// It began to run without a frame.
    #[error("I6: it began to run without an accepted frame")]
    ArmedWithoutReading,
    /// It began to run before the hand had been off all controls for long enough.
    #[error("I6: it began to run before the hand was off all controls for long enough")]
    ArmedTooSoon,
    /// Somebody asked for a pause, and it is in another state.
    #[error("I6: a pause was asked for, and it is in state {0}")]
    PauseNotKept(PipelineState),
    /// Something went out after the end.
    #[error("I6: {0:?} went out after the end")]
    EventAfterStop(EventKind),
    /// Something went out from one state to another that both let nothing out.
    #[error("I6: {0:?} went out while nothing may")]
    EventWhileNotRunning(EventKind),
    /// A touch goes on that never began, or began before everything was let go of.
    #[error("I6: the {0} finger of the {1} hand goes on with a touch of {2:?} that did not begin")]
    TouchNeverBegan(Finger, Side, TargetId),
    /// A touch began with the first frame: nobody saw the fingertip off the control.
    #[error(
        "I6: the {0} finger of the {1} hand touches {2:?} in the first frame, it was not seen off it"
    )]
    TouchInFirstStep(Finger, Side, TargetId),
}
