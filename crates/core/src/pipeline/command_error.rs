//! Errors of commands.

use crate::command::ProfileName;
use crate::estimate::ZeroError;
use crate::hand::Side;
use crate::message::escape;

/// A command that the pipeline cannot execute. Nothing has changed.
#[derive(Clone, Copy, Debug, PartialEq, Eq, thiserror::Error)]
pub enum CommandError {
    /// No profile has the name.
    #[error("no profile is named `{}`; list it under `profiles` in the setup file", escape(.0))]
    UnknownProfile(ProfileName),
    /// No hand is tracked: readings stopped or have not started.
    #[error("no hand is tracked; hold it where the boards are to be and try again")]
    NoHand,
    /// The index fingertip of the tracked hand is not known.
    #[error("the index fingertip of the {0} hand is not known; check the sensors of the finger")]
    NoFingertip(Side),
    /// All boards belong to the other hand, or their anchor is not known.
    #[error("no board belongs to the {0} hand, which was tracked last")]
    NoBoard(Side),
    /// The active layout has no boards that could be moved.
    #[error("the active layout has no boards; nothing was moved")]
    NoBoards,
    /// The active layout has no boards that could be moved to the hand, and nothing that is placed at the hand.
    #[error(
        "the active layout has no boards; nothing was moved; a pointer or targets are placed at the hand with `pose: (anchor: start)`"
    )]
    NothingToRecenter,
    /// A position is outside the range of a layout file.
    #[error("board {0} would be more than 2000 mm from its anchor; no board was moved")]
    TooFar(usize),
    /// A tilt is outside the range of a layout file.
    #[error("the tilt of board {0} would be outside -90 to 90 degrees; no board was moved")]
    TooSteep(usize),
    /// A fingertip or a control presses something, which a change of the angles would release.
    #[error("a key is down; lift the fingers off all keys, hold the hand at rest and try again")]
    KeyDown,
    /// No range of a sensor was learned.
    #[error(
        "no range of a sensor was learned in this run; `--learn-ranges` of `ademan run` learns them"
    )]
    NothingLearned,
    /// The active layout has no text decoder.
    #[error(
        "the active layout has no text decoder; start the run with `--decoder literal` or `--decoder auto`, and a layout with letters"
    )]
    NoTextDecoder,
    /// No word is typed that has this many candidates.
    #[error(
        "there is no candidate {0}: a word has candidates while it is typed, unless the text mode is `literal`"
    )]
    NoCandidate(u8),
    /// A layout wants to change what its sources may cause.
    #[error(
        "a layout cannot allow or forbid keys; the person at the computer does: `ademan ctl allow-keys`"
    )]
    Permission,
    /// The hand cannot be zeroed.
    #[error(transparent)]
    Zero(#[from] ZeroError),
}
