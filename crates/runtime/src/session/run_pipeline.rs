//! A pipeline between a source and a sink, without the other parts of a session.

use std::time::Instant;

use super::command_channel::CommandReceiver;
use super::event_loop::run_observed;
use super::{SessionError, Summary};
use crate::capture::Source;
use crate::output::Sink;
use ademan_core::pipeline::Pipeline;
use ademan_core::snapshot::StepView;

/// Passes readings from `source` through `pipeline` to `sink` on the calling thread, until the source ends or a `Stop`
/// command arrives.
///
/// `observe` sees every step and must not block. The sink is closed in every case, even after a panic, which releases all
/// keys. A live source stalls the pipeline when no reading comes for longer than the stall timeout, but at least three
/// packet periods (2 s at most). A source that has a [clock](Source::clock), such as a replay in real time, does so when its
/// clock has passed the timeout.
pub fn run_pipeline(
    source: impl Source + 'static,
    pipeline: &mut Pipeline,
    sink: &mut dyn Sink,
    commands: &CommandReceiver,
    observe: &mut dyn FnMut(&StepView),
) -> Result<Summary, SessionError> {
    let mut observe = |step: &StepView, _: Instant, _: &Pipeline| observe(step);
    run_observed(source, pipeline, sink, commands, &mut observe)
}
