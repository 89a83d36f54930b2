//! What an observer may see: a copy of what each stage made of one frame.

use serde::Serialize;

use crate::capture::{Reading, SourceStats};
use crate::contact::{TargetNames, Touches};
use crate::device::{Events, TimedCommands};
use crate::estimate::{JointAngles, Rejection};
use crate::kinematics::HandPose;
pub use crate::pipeline::{PipelineState, Suppressed};

/// One frame, as each stage saw it.
#[derive(Clone, Debug)]
pub struct Snapshot {
    /// What the engine was doing after the frame.
    pub state: PipelineState,
    /// The place of the layout that the frame's touches and events are of, in the setup.
    pub profile: usize,
    /// What its targets are called.
    pub target_names: TargetNames,
    /// Whether it is paused because somebody asked for it, and not because it waits for the hand.
    pub is_paused: bool,
    /// What came in; `None` when something else than a reading woke the engine (a stall, the end).
    pub reading: Option<Reading>,
    /// What the estimator made of it.
    pub angles: Option<JointAngles>,
    /// Where that puts the hand.
    pub pose: Option<HandPose>,
    /// What the fingertips did.
    pub touches: Touches,
    /// What went out.
    pub events: Events,
    /// The commands of the devices.
    pub commands: TimedCommands,
    /// The account so far.
    pub stats: Stats,
}

/// The account of all readings: received = accepted + rejected + superseded.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize)]
pub struct Stats {
    /// What the source counted.
    pub source: SourceStats,
    /// Readings that became a pose.
    pub accepted: u64,
    /// Readings that gave no angles, by reason, in the order of [`Rejection::ALL`].
    pub rejected: [u64; Rejection::COUNT],
    /// Times that readings stopped for longer than the limit.
    pub stalls: u64,
    /// What came of them and did not go out.
    pub suppressed: Suppressed,
}
