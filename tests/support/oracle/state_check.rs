//! Invariant I6 of states: permitted transitions, and the delay before output is armed.

use ademan::command::CommandOrigin;
use ademan::contact::{Phase, Touch};
use ademan::hand::Finger;
use ademan::pipeline::PipelineSettings;
use ademan::pipeline::PipelineState;
use ademan::time::Timestamp;

use super::{Cause, Observation, ObservedStep, Violation};

/// The state of the pipeline after the last call.
#[derive(Clone, Debug)]
pub(super) struct StateCheck {
    settings: PipelineSettings,
    state: PipelineState,
    paused_by: Option<CommandOrigin>,
    /// Latest time of any hand.
    time: Timestamp,
    /// Start of the present series of steps without a touch.
    clear_since: Option<Timestamp>,
}

impl StateCheck {
    pub(super) fn new(settings: PipelineSettings) -> Self {
        Self {
            settings,
            state: PipelineState::Starting,
            paused_by: None,
            time: Timestamp::default(),
            clear_since: None,
        }
    }

    /// Returns the state after the last call, and whether a pause was requested.
    pub(super) fn state(&self) -> (PipelineState, bool) {
        (self.state, self.paused_by.is_some())
    }

    pub(super) fn check(&mut self, observation: &Observation) -> Result<(), Violation> {
        let running = PipelineState::Running;
        let (before, after) = (self.state, observation.state);
        let keeps_pause = matches!(after, PipelineState::Paused | PipelineState::Stopped);
        if observation.paused_by.is_some() && !keeps_pause {
            return Err(Violation::PauseNotKept(after));
        }
        if !is_permitted(before, after) {
            return Err(Violation::StateChange(before, after));
        }
        self.check_pause(observation)?;
        let ends_pause = self.paused_by.is_some() && observation.paused_by.is_none();
        let stops_running = before != after && after != running;
        if observation.cause == Cause::ReleaseAll || ends_pause || stops_running {
            self.clear_since = None;
        }
        if let Some(step) = observation.output {
            self.update_clear_time(step);
        }
        if before != running && after == running {
            self.check_arming(observation, before)?;
        }
        if after == running {
            self.clear_since = None;
        }
        (self.state, self.paused_by) = (after, observation.paused_by);
        Ok(())
    }

    /// Checks that a hand ends no pause that was requested from outside.
    fn check_pause(&self, observation: &Observation) -> Result<(), Violation> {
        let Some(pause) = self
            .paused_by
            .filter(|pause| *pause != CommandOrigin::Layout)
        else {
            return Ok(());
        };
        let is_hand = matches!(observation.cause, Cause::Reading(_));
        if is_hand && observation.paused_by != Some(pause) {
            Err(Violation::PauseEndedByHand(pause))
        } else {
            Ok(())
        }
    }

    fn update_clear_time(&mut self, step: ObservedStep) {
        self.time = self.time.max(step.pose.time);
        if is_clear(step.touches) {
            self.clear_since = self.clear_since.or(Some(self.time))
        } else {
            self.clear_since = None
        }
    }

    fn check_arming(
        &self,
        observation: &Observation,
        before: PipelineState,
    ) -> Result<(), Violation> {
        if observation.output.is_none() {
            return Err(Violation::ArmedWithoutReading);
        }
        if before == PipelineState::Starting && self.settings.arm_immediately {
            return Ok(());
        }
        let clear_for = self.clear_since.map(|since| self.time.since(since));
        if clear_for.is_some_and(|clear_for| clear_for >= self.settings.arm_delay) {
            Ok(())
        } else {
            Err(Violation::ArmedTooSoon)
        }
    }
}

/// Returns `true` if the last touch of each finger is its end.
fn is_clear(touches: &[Touch]) -> bool {
    let is_end = |phase| matches!(phase, Phase::Left | Phase::Cancelled);
    let last_of = |finger| touches.iter().rfind(|touch| touch.finger == finger);
    let mut last = Finger::ALL.iter().filter_map(|&finger| last_of(finger));
    last.all(|touch| is_end(touch.phase))
}

fn is_permitted(before: PipelineState, after: PipelineState) -> bool {
    match (before, after) {
        (PipelineState::Stopped, after) => after == PipelineState::Stopped,
        (_, PipelineState::Starting) => before == PipelineState::Starting,
        // Before the first reading no reading can be overdue.
        (PipelineState::Starting, PipelineState::Stalled) => false,
        _ => true,
    }
}
