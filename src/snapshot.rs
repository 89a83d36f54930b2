//! The view of an observer: a copy of the results of all stages for one step.

use serde::Serialize;

use crate::capture::{CaptureError, Reading, SourceStats};
use crate::command::CommandOrigin;
use crate::contact::{TargetNames, Touches};
use crate::device::{Events, TimedCommand, TimedCommands};
use crate::estimate::{JointAngles, Rejection};
use crate::hand::Side;
use crate::kinematics::HandPose;
use crate::pipeline::{PipelineState, Suppressed};

/// The results of all stages for one step of the pipeline.
#[derive(Clone, Debug)]
pub struct Snapshot {
    /// State of the pipeline after the step.
    pub state: PipelineState,
    /// Origin of a requested pause. A pipeline that waits for the hand is `Paused` too.
    pub paused_by: Option<CommandOrigin>,
    /// Index of the profile that the touches and events belong to.
    pub profile: usize,
    /// Names of the targets of this profile.
    pub target_names: TargetNames,
    /// The reading; `None` for a step without one, such as a stall, a command or the end.
    pub reading: Option<Reading>,
    /// Reason why readings of a live source were interrupted.
    pub source_error: Option<CaptureError>,
    /// Joint angles; `None` if the reading was rejected.
    pub angles: Option<JointAngles>,
    /// Pose of the hand.
    pub pose: Option<HandPose>,
    /// Touches of the fingertips.
    pub touches: Touches,
    /// Events sent to the output.
    pub events: Events,
    /// Commands that the devices issued.
    pub commands: TimedCommands,
    /// Command from outside the layout that the pipeline executed in this step.
    pub executed: Option<TimedCommand>,
    /// Hands that are not tracked while the session goes on, by side; see [`Pipeline::lost_hands`](crate::pipeline::Pipeline).
    pub lost_hands: [bool; Side::COUNT],
    /// Statistics of all readings so far.
    pub stats: Stats,
}

/// Statistics of all readings: received = accepted + rejected + dropped.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize)]
pub struct Stats {
    /// Counters of the source, including received and dropped readings.
    pub source: SourceStats,
    /// Readings that gave a pose.
    pub accepted: u64,
    /// Readings that gave no joint angles, by reason, in the order of [`Rejection::ALL`].
    pub rejected: [u64; Rejection::COUNT],
    /// Gaps between readings longer than the stall timeout.
    pub stalls: u64,
    /// Suppressed events.
    pub suppressed: Suppressed,
    /// Presses and characters that the output did not deliver (see
    /// [`Sink::dropped_presses`](crate::output::Sink::dropped_presses)).
    pub dropped_presses: u64,
}
