//! The view of an observer: the results of all stages for one step, by reference or as a copy.

use std::time::Duration;

use serde::Serialize;

use crate::capture::{CaptureError, Reading, SourceStats};
use crate::command::CommandOrigin;
use crate::contact::{Press, Presses, TargetNames, Touch, Touches};
use crate::device::{Events, OutputEvent, TimedCommand, TimedCommands};
use crate::estimate::{JointAngles, Rejection};
use crate::hand::Side;
use crate::kinematics::HandPose;
use crate::pipeline::{PipelineState, Suppressed, TextState};

/// The results of all stages for one step of the pipeline, by reference: nothing is copied for an observer that only looks.
#[derive(Clone, Copy, Debug)]
pub struct StepView<'a> {
    /// State of the pipeline after the step.
    pub state: PipelineState,
    /// Origin of a requested pause. A pipeline that waits for the hand is `Paused` too.
    pub paused_by: Option<CommandOrigin>,
    /// Index of the profile that the touches and events belong to.
    pub profile: usize,
    /// Names of the targets of this profile.
    pub target_names: &'a TargetNames,
    /// The reading; `None` for a step without one, such as a stall, a command or the end.
    pub reading: Option<&'a Reading>,
    /// Reason why readings of a live source were interrupted.
    pub source_error: Option<&'a CaptureError>,
    /// Joint angles; `None` if the reading was rejected.
    pub angles: Option<&'a JointAngles>,
    /// Pose of the hand.
    pub pose: Option<&'a HandPose>,
    /// Touches of the fingertips.
    pub touches: &'a [Touch],
    /// Presses among the touches, with their evidence.
    pub presses: &'a [Press],
    /// Events sent to the output.
    pub events: &'a [OutputEvent],
    /// Commands that the devices issued.
    pub commands: &'a [TimedCommand],
    /// Command from outside the layout that the pipeline executed in this step.
    pub executed: Option<&'a TimedCommand>,
    /// Hands that are not tracked while the session continues, by side; see [`Pipeline::lost_hands`](crate::pipeline::Pipeline).
    pub lost_hands: [bool; Side::COUNT],
    /// The text decoder of the active layout; `None` without one.
    pub text: Option<&'a TextState>,
    /// Statistics of all readings so far.
    pub stats: &'a Stats,
    /// Time from the arrival of the reading to the call of the output; `None` for a step without events.
    pub latency: Option<Duration>,
}

impl StepView<'_> {
    /// Copies the results.
    pub fn to_snapshot(&self) -> Snapshot {
        Snapshot {
            state: self.state,
            paused_by: self.paused_by,
            profile: self.profile,
            target_names: self.target_names.clone(),
            reading: self.reading.cloned(),
            source_error: self.source_error.cloned(),
            angles: self.angles.copied(),
            pose: self.pose.copied(),
            touches: self.touches.iter().copied().collect(),
            presses: self.presses.iter().cloned().collect(),
            events: self.events.iter().copied().collect(),
            commands: self.commands.iter().copied().collect(),
            executed: self.executed.copied(),
            lost_hands: self.lost_hands,
            text: self.text.cloned(),
            stats: *self.stats,
            latency: self.latency,
        }
    }
}

/// A copy of a [`StepView`], for another thread.
#[derive(Clone, Debug, Default)]
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
    /// Presses among the touches, with their evidence.
    pub presses: Presses,
    /// Events sent to the output.
    pub events: Events,
    /// Commands that the devices issued.
    pub commands: TimedCommands,
    /// Command from outside the layout that the pipeline executed in this step.
    pub executed: Option<TimedCommand>,
    /// Hands that are not tracked while the session continues, by side; see [`Pipeline::lost_hands`](crate::pipeline::Pipeline).
    pub lost_hands: [bool; Side::COUNT],
    /// The text decoder of the active layout; `None` without one.
    pub text: Option<TextState>,
    /// Statistics of all readings so far.
    pub stats: Stats,
    /// Time from the arrival of the reading to the call of the output; `None` for a step without events.
    pub latency: Option<Duration>,
}

impl Snapshot {
    /// Returns the results by reference.
    pub fn view(&self) -> StepView<'_> {
        StepView {
            state: self.state,
            paused_by: self.paused_by,
            profile: self.profile,
            target_names: &self.target_names,
            reading: self.reading.as_ref(),
            source_error: self.source_error.as_ref(),
            angles: self.angles.as_ref(),
            pose: self.pose.as_ref(),
            touches: &self.touches,
            presses: &self.presses,
            events: &self.events,
            commands: &self.commands,
            executed: self.executed.as_ref(),
            lost_hands: self.lost_hands,
            text: self.text.as_ref(),
            stats: &self.stats,
            latency: self.latency,
        }
    }
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
    /// `Sink::dropped_presses`).
    pub dropped_presses: u64,
    /// Stalls of the output (see `Sink::has_stalled`) that disarmed it.
    pub output_stalls: u64,
}
