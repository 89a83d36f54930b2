//! Replay of a recording without an output, for displays.

use std::sync::Arc;
use std::time::Instant;

use super::command_channel::CommandReceiver;
use super::event_loop::run_observed;
use super::view::{ReplayViews, SessionNames, View, ViewState, board_poses};
use super::{SessionError, Summary};
use crate::capture::Source;
use crate::output;
use crate::setup::LoadedSetup;
use ademan_core::pipeline::Pipeline;
use ademan_core::snapshot::StepView;

/// The output of a replay for displays.
const NO_OUTPUT: &str = "none";

/// Passes the readings of a recording through the pipeline of `setup` as fast as possible, until it ends or a `Stop` command
/// arrives. Nothing is sent to an output.
///
/// `observe` sees every step, the pipeline after it, and a view if one is due.
///
/// ```no_run
/// use std::path::Path;
///
/// use ademan_runtime::capture::recording::Replay;
/// use ademan_runtime::session::{CommandReceiver, replay};
/// use ademan_runtime::setup::{LoadedSetup, ReplaySettings};
///
/// let recording = Replay::open(Path::new("hand.mcap"))?;
/// let setup = LoadedSetup::from_recording(recording.setup(), &ReplaySettings::default())?;
/// replay(&setup, recording, &CommandReceiver::disconnected(), &mut |step, _, _| {
///     for press in step.presses {
///         let (seconds, target) = (press.time.seconds(), step.target_names.get(press.target));
///         println!("{seconds:.3} s {} {target}", press.finger);
///     }
/// })?;
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
pub fn replay(
    setup: &LoadedSetup,
    source: impl Source + 'static,
    commands: &CommandReceiver,
    observe: &mut dyn FnMut(&StepView, &Pipeline, Option<View>),
) -> Result<Summary, SessionError> {
    let names = SessionNames {
        session: String::new(),
        process: None,
        profiles: setup.profile_names().map(str::to_owned).collect(),
        source: source.name().to_owned(),
        output: NO_OUTPUT.to_owned(),
    };
    let mut views = ReplayViews::new(names, Arc::new(setup.layout.clone()));
    let mut pipeline = setup.pipeline();
    let mut sink = output::open(NO_OUTPUT, &setup.required_capabilities())?;
    let mut observe = |step: &StepView, _: Instant, replayed: &Pipeline| {
        let view = views.update(step, replayed);
        observe(step, replayed, view);
    };
    run_observed(source, &mut pipeline, &mut *sink, commands, &mut observe)
}

/// Returns the view of a replay before its first step.
pub fn first_view(setup: &LoadedSetup, source: &str) -> View {
    let profile = setup.profile_names().next().unwrap_or_default();
    let state = ViewState::starting(profile, source, NO_OUTPUT);
    View {
        boards: board_poses(&setup.layout.scene),
        layout: Arc::new(setup.layout.clone()),
        state: Arc::new(state),
        messages: Arc::default(),
        missed: 0,
    }
}
