//! From state to state.

use super::{Cause, Observation, ObservedStep, Violation};
use crate::contact::{Phase, Touch};
use crate::hand::Finger;
use crate::pipeline::PipelineSettings;
use crate::snapshot::PipelineState;
use crate::time::Timestamp;

/// The way of an engine through its states.
#[derive(Clone, Debug)]
pub(super) struct StateCheck {
    arming: PipelineSettings,
    state: PipelineState,
    is_paused: bool,
    /// The latest time of any hand.
    time: Timestamp,
    /// Since when every frame showed a hand that touches nothing.
    clear_since: Option<Timestamp>,
}

impl StateCheck {
    pub(super) fn new(arming: PipelineSettings) -> Self {
        Self {
            arming,
            state: PipelineState::Starting,
            is_paused: false,
            time: Timestamp::default(),
            clear_since: None,
        }
    }

    /// The state after the last step, and whether somebody had asked for a pause.
    pub(super) fn state(&self) -> (PipelineState, bool) {
        (self.state, self.is_paused)
    }

    /// Takes the next step.
    pub(super) fn check(&mut self, step: &Observation) -> Result<(), Violation> {
        let (before, after) = (self.state, step.state);
        if step.is_paused && !matches!(after, PipelineState::Paused | PipelineState::Stopped) {
            return Err(Violation::PauseNotKept(after));
        }
        if !may_follow(before, after) {
            return Err(Violation::StateChange(before, after));
        }
        let ends_pause = self.is_paused && !step.is_paused;
        if step.cause == Cause::ReleaseAll
            || ends_pause
            || (before != after && after != PipelineState::Running)
        {
            self.clear_since = None;
        }
        if let Some(frame) = step.output {
            self.take_frame(frame);
        }
        if before != PipelineState::Running && after == PipelineState::Running {
            self.arm(step, before)?;
        }
        if after == PipelineState::Running {
            self.clear_since = None;
        }
        (self.state, self.is_paused) = (after, step.is_paused);
        Ok(())
    }

    fn take_frame(&mut self, frame: ObservedStep) {
        self.time = self.time.max(frame.pose.time);
        match touches_nothing(frame.touches) {
            true => self.clear_since = self.clear_since.or(Some(self.time)),
            false => self.clear_since = None,
        }
    }

    fn arm(&self, step: &Observation, before: PipelineState) -> Result<(), Violation> {
        if step.output.is_none() {
            return Err(Violation::ArmedWithoutReading);
        }
        if before == PipelineState::Starting && self.arming.arm_immediately {
            return Ok(());
        }
        let clear_for = self.clear_since.map(|since| self.time.since(since));
        match clear_for.is_some_and(|clear_for| clear_for >= self.arming.arm_delay) {
            true => Ok(()),
            false => Err(Violation::ArmedTooSoon),
        }
    }
}

/// Whether the last that every fingertip did was to leave.
fn touches_nothing(touches: &[Touch]) -> bool {
    let is_off = |phase| matches!(phase, Phase::Left | Phase::Cancelled);
    let last_of = |finger| touches.iter().rfind(|touch| touch.finger == finger);
    let mut last = Finger::ALL.iter().filter_map(|&finger| last_of(finger));
    last.all(|touch| is_off(touch.phase))
}

fn may_follow(before: PipelineState, after: PipelineState) -> bool {
    match (before, after) {
        (PipelineState::Stopped, after) => after == PipelineState::Stopped,
        (_, PipelineState::Starting) => before == PipelineState::Starting,
        // An engine that never saw a hand has nothing to miss.
        (PipelineState::Starting, PipelineState::Stalled) => false,
        _ => true,
    }
}
