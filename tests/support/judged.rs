//! An engine under an oracle: whatever it is asked for, a broken invariant is a panic.

use std::ops::Deref;
use std::time::Duration;

use ademan::capture::Reading;
use ademan::device::Events;
use ademan::estimate::Rejection;
use ademan::lab::{Cause, Oracle, Rules, Step};
use ademan::layout::Layout;
use ademan::monitor::State;
use ademan::pipeline::{Arming, Controls, Frame, Pipeline, Refusal};
use ademan::settings::Assembly;
use parry3d::math::Vec3;

/// A pipeline with an oracle beside it; what only asks goes to the pipeline itself.
pub struct Judged {
    pipeline: Pipeline,
    oracle: Oracle,
    frame: Option<Frame>,
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
    pub fn of(assembly: &Assembly) -> Self {
        let arming = Arming {
            at_once: assembly.setup.armed,
            ..Arming::default()
        };
        Self {
            pipeline: assembly.pipeline(),
            oracle: Oracle::new(assembly.layouts().map(Rules::of), arming),
            frame: None,
        }
    }

    /// Gives a line that is slow the time that a run gives it before it counts as stalled.
    pub fn expect_frames_every(&mut self, period: Duration) {
        let limit = self.pipeline.stall_limit().max(3 * period);
        self.pipeline.set_stall_limit(limit);
    }

    /// Whether something is down, or off its rest.
    pub fn holds(&self) -> bool {
        self.oracle.holds()
    }

    #[track_caller]
    pub fn step(&mut self, reading: &Reading, events: &mut Events) -> Result<&Frame, Rejection> {
        let (first, profile) = (events.len(), self.pipeline.profile());
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
        let lets_go = self.pipeline.is_fed();
        self.ask(lets_go, events, Pipeline::stall);
    }

    #[track_caller]
    pub fn pause(&mut self, events: &mut Events) {
        let lets_go = !self.is_paused() && self.state() != State::Stopped;
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
        let lets_go = profile != self.profile() && profile < self.profiles();
        self.ask(lets_go, events, |pipeline, events| {
            pipeline.switch_to(profile, events);
        });
    }

    /// Puts other controls, made of `layout`, in a place of the setup.
    #[track_caller]
    pub fn replace(
        &mut self,
        profile: usize,
        controls: &mut Controls,
        layout: &Layout,
        events: &mut Events,
    ) {
        let lets_go = profile == self.profile();
        self.ask(lets_go, events, |pipeline, events| {
            pipeline.replace(profile, controls, events);
        });
        self.oracle.replace(profile, Rules::of(layout));
    }

    #[track_caller]
    pub fn nudge(&mut self, by: Vec3, events: &mut Events) -> Result<(), Refusal> {
        self.shift(events, |pipeline, events| pipeline.nudge(by, events))
    }

    #[track_caller]
    pub fn tilt(&mut self, by: f32, events: &mut Events) -> Result<(), Refusal> {
        self.shift(events, |pipeline, events| pipeline.tilt(by, events))
    }

    #[track_caller]
    pub fn recentre(&mut self, events: &mut Events) -> Result<(), Refusal> {
        self.shift(events, Pipeline::recentre)
    }

    #[track_caller]
    fn shift(
        &mut self,
        events: &mut Events,
        shift: impl FnOnce(&mut Pipeline, &mut Events) -> Result<(), Refusal>,
    ) -> Result<(), Refusal> {
        let (first, profile) = (events.len(), self.pipeline.profile());
        let shifted = shift(&mut self.pipeline, events);
        self.frame = None;
        let cause = if shifted.is_ok() {
            Cause::LetGo
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
        let (first, profile) = (events.len(), self.pipeline.profile());
        ask(&mut self.pipeline, events);
        self.frame = None;
        let cause = if lets_go { Cause::LetGo } else { Cause::Other };
        self.judge(cause, profile, events, first);
    }

    #[track_caller]
    fn judge(&mut self, cause: Cause, profile: usize, events: &Events, first: usize) {
        let judgement = self.oracle.judge(Step {
            cause,
            state: self.pipeline.state(),
            is_paused: self.pipeline.is_paused(),
            profile,
            frame: self.frame.as_ref().map(Into::into),
            events: &events[first..],
        });
        if let Err(violation) = judgement {
            panic!("{violation}, after {cause:?}: {:?}", &events[first..]);
        }
    }
}
