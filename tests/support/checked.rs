//! An engine under an oracle: whatever it is asked for, a broken invariant is a panic.

use std::ops::Deref;
use std::time::Duration;

use ademan::capture::Reading;
use ademan::device::Events;
use ademan::estimate::Rejection;
use ademan::layout::Layout;
use ademan::pipeline::{CommandError, LayoutInstance, Pipeline, PipelineSettings, StepOutput};
use ademan::setup::LoadedSetup;

use ademan::pipeline::PipelineState;
use parry3d::math::Vec3;

use super::oracle::{Cause, Observation, Oracle, OutputRules};

/// A pipeline with an oracle beside it; what only asks goes to the pipeline itself.
pub struct Judged {
    pipeline: Pipeline,
    oracle: Oracle,
    frame: Option<StepOutput>,
}

impl Deref for Judged {
    type Target = Pipeline;

    fn deref(&self) -> &Pipeline {
        &self.pipeline
    }
}

#[allow(dead_code, reason = "not every test asks for everything")]
impl Judged {
    /// The pipeline of a setup, and an oracle for it.
    pub fn of(assembly: &LoadedSetup) -> Self {
        let arming = PipelineSettings {
            arm_immediately: assembly.setup.arm_immediately,
            ..PipelineSettings::default()
        };
        Self {
            pipeline: assembly.pipeline(),
            oracle: Oracle::new(assembly.layouts().map(OutputRules::from_layout), arming),
            frame: None,
        }
    }

    /// Gives a line that is slow the time that a run gives it before it counts as stalled.
    pub fn expect_frames_every(&mut self, period: Duration) {
        let limit = self.pipeline.stall_timeout().max(3 * period);
        self.pipeline.set_stall_timeout(limit);
    }

    /// Whether something is down, or off its rest.
    pub fn holds(&self) -> bool {
        self.oracle.has_pressed()
    }

    #[track_caller]
    pub fn step(
        &mut self,
        reading: &Reading,
        events: &mut Events,
    ) -> Result<&StepOutput, Rejection> {
        let (first, profile) = (events.len(), self.pipeline.active_profile());
        let outcome = self.pipeline.step(reading, events).cloned();
        let rejection = outcome.as_ref().err().copied();
        self.frame = outcome.ok();
        self.judge(Cause::Reading(reading.time), profile, events, first);
        match (&self.frame, rejection) {
            (Some(frame), _) => Ok(frame),
            (None, rejection) => Err(rejection.expect("a frame or a rejection")),
        }
    }

    #[track_caller]
    pub fn stall(&mut self, events: &mut Events) {
        let lets_go = self.pipeline.expects_readings();
        self.ask(lets_go, events, Pipeline::stall);
    }

    #[track_caller]
    pub fn pause(&mut self, events: &mut Events) {
        let lets_go = !self.is_paused() && self.state() != PipelineState::Stopped;
        self.ask(lets_go, events, Pipeline::pause);
    }

    #[track_caller]
    pub fn resume(&mut self) {
        self.ask(false, &mut Events::new(), |pipeline, _| pipeline.resume());
    }

    #[track_caller]
    pub fn stop(&mut self, events: &mut Events) {
        self.ask(true, events, Pipeline::stop);
    }

    #[track_caller]
    pub fn switch_to(&mut self, profile: usize, events: &mut Events) {
        let lets_go = profile != self.active_profile() && profile < self.profile_count();
        self.ask(lets_go, events, |pipeline, events| {
            pipeline.switch_profile(profile, events);
        });
    }

    /// Puts other controls, made of `layout`, in a place of the setup.
    #[track_caller]
    pub fn replace(
        &mut self,
        profile: usize,
        controls: &mut LayoutInstance,
        layout: &Layout,
        events: &mut Events,
    ) {
        let lets_go = profile == self.active_profile();
        self.ask(lets_go, events, |pipeline, events| {
            pipeline.replace_profile(profile, controls, events);
        });
        self.oracle
            .replace(profile, OutputRules::from_layout(layout));
    }

    #[track_caller]
    pub fn nudge(&mut self, by: Vec3, events: &mut Events) -> Result<(), CommandError> {
        self.shift(events, |pipeline, events| pipeline.nudge(by, events))
    }

    #[track_caller]
    pub fn tilt(&mut self, by: f32, events: &mut Events) -> Result<(), CommandError> {
        self.shift(events, |pipeline, events| pipeline.tilt(by, events))
    }

    #[track_caller]
    pub fn recentre(&mut self, events: &mut Events) -> Result<(), CommandError> {
        self.shift(events, Pipeline::recenter)
    }

    #[track_caller]
    fn shift(
        &mut self,
        events: &mut Events,
        shift: impl FnOnce(&mut Pipeline, &mut Events) -> Result<(), CommandError>,
    ) -> Result<(), CommandError> {
        let (first, profile) = (events.len(), self.pipeline.active_profile());
        let shifted = shift(&mut self.pipeline, events);
        self.frame = None;
        let cause = if shifted.is_ok() {
            Cause::ReleaseAll
        } else {
            Cause::Other
        };
        self.judge(cause, profile, events, first);
        shifted
    }

    #[track_caller]
    fn ask(
        &mut self,
        lets_go: bool,
        events: &mut Events,
        ask: impl FnOnce(&mut Pipeline, &mut Events),
    ) {
        let (first, profile) = (events.len(), self.pipeline.active_profile());
        ask(&mut self.pipeline, events);
        self.frame = None;
        let cause = if lets_go {
            Cause::ReleaseAll
        } else {
            Cause::Other
        };
        self.judge(cause, profile, events, first);
    }

    #[track_caller]
    fn judge(&mut self, cause: Cause, profile: usize, events: &Events, first: usize) {
        let judgement = self.oracle.check(Observation {
            cause,
            state: self.pipeline.state(),
            is_paused: self.pipeline.is_paused(),
            profile,
            output: self.frame.as_ref().map(Into::into),
            events: &events[first..],
            commands: self.frame.as_ref().map_or(&[], |frame| &frame.commands),
        });
        if let Err(violation) = judgement {
            panic!("{violation}, after {cause:?}: {:?}", &events[first..]);
        }
    }
}
