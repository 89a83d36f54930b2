//! Replies to commands.

use crossbeam_channel::Sender;

use ademan_core::command::{CommandOrigin, InvalidCommand};
use ademan_core::device::CursorPosition;
use ademan_core::estimate::{LearnedRange, Zeroed};
use ademan_core::hand::Side;
use ademan_core::message::escape_line;
use ademan_core::pipeline::{CommandError, PipelineState};
use ademan_core::snapshot::Stats;
use ademan_text::filter::LearnedSummary;

/// Result of a command that succeeded.
#[derive(Clone, Debug, PartialEq)]
// A box would be an allocation in the session loop.
#[allow(clippy::large_enum_variant)]
pub enum Reply {
    /// The command has no result.
    Done,
    /// A sentence for the user.
    Text(String),
    /// The answer to [`Command::State`](ademan_core::command::Command::State).
    State(SessionStatus),
}

impl Reply {
    /// Describes the hands that were zeroed.
    pub(super) fn zeroed(hands: impl Iterator<Item = (Side, Zeroed)>) -> Self {
        let hands = hands.map(|(side, zeroed)| format!("{side} hand: {zeroed}; "));
        Self::Text(hands.collect::<String>() + "`ademan ctl undo-zero` undoes it")
    }
}

/// Reason why a command failed.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum RequestError {
    /// A field of the command is out of range.
    #[error(transparent)]
    Invalid(#[from] InvalidCommand),
    /// No profile has the name.
    #[error("{}", escape_line(.0))]
    UnknownProfile(String),
    /// The pipeline cannot execute the command.
    #[error(transparent)]
    Pipeline(#[from] CommandError),
    /// The layout cannot be scaled, saved or read.
    #[error("{0}")]
    Layout(String),
    /// The session cannot make this change.
    #[error("{0}")]
    Refused(String),
    /// The queue is full.
    #[error("too many commands are waiting; try again later")]
    QueueFull,
    /// The loop or the layout manager did not reply.
    #[error("timed out: the session waits for its source or its output; the command stays queued")]
    TimedOut,
    /// The session has ended.
    #[error("the session has ended")]
    Ended,
}

/// The sending end for the reply to one command.
pub(crate) type ReplySender = Sender<Result<Reply, RequestError>>;

/// The state of a session between two readings.
#[derive(Clone, Debug, PartialEq)]
pub struct SessionStatus {
    /// State of the pipeline.
    pub state: PipelineState,
    /// Origin of a requested pause.
    pub paused_by: Option<CommandOrigin>,
    /// Index of the active profile.
    pub profile: usize,
    /// Statistics of all readings so far.
    pub stats: Stats,
    /// Position of the cursor; `None` for a layout without a pointer and targets in space.
    pub cursor: Option<CursorPosition>,
    /// Ranges of sensors that were learned; `None` if none was.
    pub learned: Option<LearnedRanges>,
    /// Knowledge of the text decoder about the person; `None` without a decoder.
    pub typing: Option<LearnedSummary>,
}

/// Summary of the ranges of sensors that were learned.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct LearnedRanges {
    /// The number of channels whose range has widened.
    pub channels: usize,
    /// The channel whose range has widened most.
    pub largest: LearnedRange,
}

impl LearnedRanges {
    /// Summarizes ranges; `None` if there are none.
    pub(crate) fn new(ranges: impl Iterator<Item = LearnedRange>) -> Option<Self> {
        ranges.fold(None, |summary: Option<Self>, range| {
            let earlier = summary.map_or((0, range), |summary| (summary.channels, summary.largest));
            let is_larger = range.largest() > earlier.1.largest();
            Some(Self {
                channels: earlier.0 + 1,
                largest: if is_larger { range } else { earlier.1 },
            })
        })
    }
}

#[cfg(test)]
mod tests {
    use ademan_core::hand::Dof;

    use super::*;

    #[test]
    fn two_zeroed_hands_have_one_hint_about_undo() {
        let zeroed = Zeroed {
            count: 1,
            largest: Dof::IndexMcpFlexion,
            radians: 0.0,
        };
        let reply = Reply::zeroed(
            [Side::Left, Side::Right]
                .map(|side| (side, zeroed))
                .into_iter(),
        );
        let hand = "hand: 1 joint zeroed, the largest change is +0.0° (index-mcp-flexion);";
        let text = format!("left {hand} right {hand} `ademan ctl undo-zero` undoes it");
        assert_eq!(reply, Reply::Text(text));
    }
}
