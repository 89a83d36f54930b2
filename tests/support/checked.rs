//! A pipeline that is checked by the oracle after every step: a broken invariant is a panic.

use std::ops::Deref;
use std::time::Duration;

use ademan::capture::Reading;
use ademan::command::{Command, CommandOrigin};
use ademan::device::Events;
use ademan::estimate::Rejection;
use ademan::hand::{HandPart, Side};
use ademan::layout::Layout;
use ademan::pipeline::{
    CommandError, LayoutInstance, Pipeline, PipelineSettings, PipelineState, StepOutput,
};
use ademan::setup::LoadedSetup;
use ademan::text;
use parry3d::math::Vec3;

use super::oracle::{Cause, Observation, Oracle, OutputRules};

/// A pipeline with an oracle. Methods that only read pass through to the pipeline.
pub struct CheckedPipeline {
    pipeline: Pipeline,
    oracle: Oracle,
    output: Option<StepOutput>,
    /// `true` if the text decoder of the setup types accents; `None` if there is none.
    accents: Option<bool>,
}

impl Deref for CheckedPipeline {
    type Target = Pipeline;

    fn deref(&self) -> &Pipeline {
        &self.pipeline
    }
}

impl CheckedPipeline {
    /// Creates the pipeline of a setup, and an oracle for it.
    pub fn new(setup: &LoadedSetup) -> Self {
        let settings = PipelineSettings {
            arm_immediately: setup.setup.arm_immediately,
            allow_system_keys: setup.setup.allow_system_keys,
            ..PipelineSettings::default()
        };
        Self {
            pipeline: setup.pipeline(),
            oracle: Oracle::new(
                setup.layouts().map(|layout| {
                    OutputRules::from_layout(layout).with(&setup.capabilities_of(layout))
                }),
                settings,
            ),
            output: None,
            accents: setup.setup.text.as_ref().map(|text| text.accents),
        }
    }

    /// Raises the stall timeout for a source with this packet period, as a session does.
    pub fn tolerate_packet_period(&mut self, period: Duration) {
        let limit = self.pipeline.stall_timeout().max(3 * period);
        self.pipeline.set_stall_timeout(limit);
    }

    /// Returns `true` if a key is pressed or an axis is off zero.
    pub fn has_pressed(&self) -> bool {
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
        self.output = outcome.ok();
        self.check(Cause::Reading(reading.time), profile, events, first);
        match (&self.output, rejection) {
            (Some(output), _) => Ok(output),
            (None, rejection) => Err(rejection.expect("an output or a rejection")),
        }
    }

    #[track_caller]
    pub fn stall(&mut self, events: &mut Events) {
        // A stopped pipeline keeps the touches that it follows.
        let is_stopped = self.pipeline.state() == PipelineState::Stopped;
        let releases = self.pipeline.expects_readings() && !is_stopped;
        self.command(releases, events, Pipeline::stall);
    }

    #[track_caller]
    pub fn lose(&mut self, side: Option<Side>, part: Option<HandPart>, events: &mut Events) {
        self.command(false, events, |pipeline, events| {
            pipeline.lose(side, part, events);
        });
    }

    #[track_caller]
    pub fn pause(&mut self, origin: CommandOrigin, events: &mut Events) {
        let releases = !self.is_paused() && self.state() != PipelineState::Stopped;
        self.command(releases, events, |pipeline, events| {
            pipeline.pause(origin, events);
        });
    }

    #[track_caller]
    pub fn resume(&mut self, origin: CommandOrigin) {
        self.command(false, &mut Events::new(), |pipeline, _| {
            pipeline.resume(origin);
        });
    }

    /// Executes a command that releases nothing.
    #[track_caller]
    pub fn execute(
        &mut self,
        command: &Command,
        origin: CommandOrigin,
        events: &mut Events,
    ) -> Result<(), CommandError> {
        let mut outcome = Ok(());
        self.command(false, events, |pipeline, events| {
            outcome = pipeline.execute(command, origin, events);
        });
        outcome
    }

    #[track_caller]
    pub fn stop(&mut self, events: &mut Events) {
        self.command(true, events, Pipeline::stop);
    }

    #[track_caller]
    pub fn switch_profile(&mut self, profile: usize, events: &mut Events) {
        let releases = profile != self.active_profile() && profile < self.profile_count();
        self.command(releases, events, |pipeline, events| {
            pipeline.switch_profile(profile, events);
        });
    }

    /// Replaces a layout of the setup by an instance of `layout`.
    #[track_caller]
    pub fn replace_profile(
        &mut self,
        profile: usize,
        instance: &mut LayoutInstance,
        layout: &Layout,
        events: &mut Events,
    ) {
        let releases = profile == self.active_profile();
        self.command(releases, events, |pipeline, events| {
            pipeline.replace_profile(profile, instance, events);
        });
        let text = self
            .accents
            .map(|accents| text::capabilities(layout, accents));
        let rules = OutputRules::from_layout(layout).with(&text.unwrap_or_default());
        self.oracle.replace(profile, rules);
    }

    #[track_caller]
    pub fn nudge(&mut self, by: Vec3, events: &mut Events) -> Result<(), CommandError> {
        self.move_boards(events, |pipeline, events| pipeline.nudge(by, events))
    }

    #[track_caller]
    pub fn tilt(&mut self, by: f32, events: &mut Events) -> Result<(), CommandError> {
        self.move_boards(events, |pipeline, events| pipeline.tilt(by, events))
    }

    #[track_caller]
    pub fn recenter(&mut self, events: &mut Events) -> Result<(), CommandError> {
        self.move_boards(events, Pipeline::recenter)
    }

    #[track_caller]
    pub fn zero(&mut self, events: &mut Events) -> Result<(), CommandError> {
        self.move_boards(events, Pipeline::zero)
    }

    #[track_caller]
    pub fn undo_zero(&mut self, events: &mut Events) -> Result<(), CommandError> {
        self.move_boards(events, Pipeline::undo_zero)
    }

    #[track_caller]
    pub fn undo_learning(&mut self, events: &mut Events) -> Result<(), CommandError> {
        self.move_boards(events, Pipeline::undo_learning)
    }

    #[track_caller]
    fn move_boards(
        &mut self,
        events: &mut Events,
        command: impl FnOnce(&mut Pipeline, &mut Events) -> Result<(), CommandError>,
    ) -> Result<(), CommandError> {
        let (first, profile) = (events.len(), self.pipeline.active_profile());
        let outcome = command(&mut self.pipeline, events);
        self.output = None;
        let cause = if outcome.is_ok() {
            Cause::ReleaseAll
        } else {
            Cause::Other
        };
        self.check(cause, profile, events, first);
        outcome
    }

    #[track_caller]
    fn command(
        &mut self,
        releases: bool,
        events: &mut Events,
        command: impl FnOnce(&mut Pipeline, &mut Events),
    ) {
        let (first, profile) = (events.len(), self.pipeline.active_profile());
        command(&mut self.pipeline, events);
        self.output = None;
        let cause = if releases {
            Cause::ReleaseAll
        } else {
            Cause::Other
        };
        self.check(cause, profile, events, first);
    }

    #[track_caller]
    fn check(&mut self, cause: Cause, profile: usize, events: &Events, first: usize) {
        let outcome = self.oracle.check(Observation {
            cause,
            state: self.pipeline.state(),
            paused_by: self.pipeline.paused_by(),
            profile,
            output: self.output.as_ref().map(Into::into),
            events: &events[first..],
            commands: self.output.as_ref().map_or(&[], |output| &output.commands),
        });
        if let Err(violation) = outcome {
            panic!("{violation}, after {cause:?}: {:?}", &events[first..]);
        }
    }
}
