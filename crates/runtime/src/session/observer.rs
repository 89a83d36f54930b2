//! The interface to the steps of a session.

use std::time::Instant;

use crate::share::ShareHub;
use ademan_core::pipeline::Pipeline;
use ademan_core::snapshot::StepView;

/// A part of a session that sees each step, after its events were sent.
///
/// It is called on the thread of the loop, so it passes what it needs to a thread of its own and does not wait. Only the parts of
/// a session without effect outside, such as `record` and `replay`, may wait.
pub(in crate::session) trait Observer {
    /// Observes a step at the time of the loop, and the pipeline after it.
    fn observe(&mut self, step: &StepView, now: Instant, pipeline: &Pipeline);
}

impl<F: FnMut(&StepView, Instant, &Pipeline)> Observer for F {
    fn observe(&mut self, step: &StepView, now: Instant, pipeline: &Pipeline) {
        self(step, now, pipeline);
    }
}

/// Observers in the order in which they see a step.
impl Observer for Vec<&mut dyn Observer> {
    fn observe(&mut self, step: &StepView, now: Instant, pipeline: &Pipeline) {
        for observer in self {
            observer.observe(step, now, pipeline);
        }
    }
}

/// A part that not every session has.
impl<T: Observer> Observer for Option<T> {
    fn observe(&mut self, step: &StepView, now: Instant, pipeline: &Pipeline) {
        if let Some(observer) = self {
            observer.observe(step, now, pipeline);
        }
    }
}

impl Observer for ShareHub {
    fn observe(&mut self, step: &StepView, _: Instant, pipeline: &Pipeline) {
        self.push(step, pipeline);
    }
}
