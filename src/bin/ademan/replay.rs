//! `ademan replay`: a recording through the pipeline again.

use std::path::PathBuf;

use ademan::capture::recording::Replay;
use ademan::command::Command;
use ademan::output;
use ademan::session::SessionOptions;
use ademan::setup::{LoadedSetup, ReplaySettings, Setup};

use crate::failure::Failure;
use crate::output_list::OutputList;
use crate::root_args::RootArgs;
use crate::setup_args::number_in;
use crate::{complete, pause_signals, session, stats, watchdog};

/// Play a recording through the pipeline again
#[derive(clap::Args)]
#[command(
    after_help = "Examples:\n  ademan replay session.mcap\n  ademan replay session.mcap --layout my-board.ron --speed 1"
)]
pub struct Args {
    /// Recording
    #[arg(add = complete::recording())]
    file: PathBuf,
    /// Glove that replaces the recorded one
    #[arg(long, add = complete::glove())]
    glove: Option<String>,
    /// Layout that replaces the recorded one
    #[arg(long, add = complete::layout())]
    layout: Option<String>,
    /// Setup whose permissions apply: role, press rate limit, stall timeout, arming, system keys and panic keys. Without it,
    /// an output that types has the default permissions, and a transcript the permissions of the recording
    #[arg(long, value_name = "FILE", add = complete::setup())]
    setup: Option<String>,
    /// Outputs, as for `ademan run`
    #[arg(long, value_name = "OUTPUTS", default_value = "transcript", add = complete::outputs(), value_parser = OutputList)]
    output: String,
    /// Playback speed, 1 for real time. The default is 1 for an output that types, and as fast as possible for a transcript
    #[arg(long, value_parser = speed, allow_negative_numbers = true)]
    speed: Option<f64>,
    #[command(flatten)]
    root: RootArgs,
}

pub fn run(args: Args) -> Result<(), Failure> {
    let has_effect = output::has_effect(&args.output);
    args.root.check(has_effect)?;
    let mut replay = Replay::open(&args.file)?;
    if has_effect {
        replay = replay.without_packet_period();
    }
    if args.setup.is_some() {
        replay = replay.without_permissions();
    }
    let setup = load_setup(&args, &replay, has_effect)?;
    session::prepare()?;
    let options = SessionOptions {
        source: Some(Box::new(replay)),
        // The rate limit counts in the time of the recording, which is the time of the receiver only at speed 1.
        speed: args.speed.or(has_effect.then_some(1.0)),
        use_panic_keys: has_effect,
        watchdog: Some(watchdog::program(Command::Stop)?),
        on_notice: Some(session::print_notices()),
        ..SessionOptions::default()
    };
    let session = session::start(setup, options)?;
    pause_signals::install_for(&session, &args.output)?;
    stats::report(session.join()?)
}

/// Loads the setup of a recording. The permissions for an output with an effect are the person's own; a recording may come
/// from anybody.
fn load_setup(args: &Args, replay: &Replay, has_effect: bool) -> Result<LoadedSetup, Failure> {
    let own = match &args.setup {
        Some(path) => Some(Setup::load(path)?),
        None => has_effect.then(Setup::default),
    };
    let settings = ReplaySettings {
        glove: args.glove.as_deref(),
        layout: args.layout.as_deref(),
        person: None,
        permissions: own.as_ref(),
    };
    let mut setup = LoadedSetup::from_recording(replay.setup(), &settings)?;
    if !setup.ignored_permissions.is_empty() {
        let names = setup.ignored_permissions.iter();
        let fields: Vec<_> = names.map(|name| format!("`{name}`")).collect();
        say!(
            "ignored in the setup of the recording: {}; a setup of your own after --setup sets them",
            fields.join(", ")
        );
    }
    setup.setup.output.clone_from(&args.output);
    Ok(setup)
}

fn speed(text: &str) -> Result<f64, String> {
    number_in(text, 0.01, 1000.0, "times")
}
