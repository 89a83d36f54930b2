//! `ademan replay`: a recording through the pipeline again.

use std::path::PathBuf;

use ademan::capture::recording::Replay;
use ademan::command::Command;
use ademan::session::{Session, SessionOptions};
use ademan::setup::LoadedSetup;

use crate::failure::Failure;
use crate::output_list::OutputList;
use crate::setup_args::number_in;
use crate::{signals, stats, watchdog};

/// Play a recording through the pipeline again
#[derive(clap::Args)]
#[command(
    after_help = "Examples:\n  ademan replay session.mcap\n  ademan replay session.mcap --layout my-board.ron --speed 1"
)]
pub struct Args {
    /// Recording
    file: PathBuf,
    /// Glove that replaces the recorded one
    #[arg(long)]
    glove: Option<String>,
    /// Layout that replaces the recorded one
    #[arg(long)]
    layout: Option<String>,
    /// Outputs, as for `ademan run`
    #[arg(long, value_name = "OUTPUTS", default_value = "transcript", value_parser = OutputList)]
    output: String,
    /// Playback speed, 1 for real time. The default is as fast as possible
    #[arg(long, value_parser = speed, allow_negative_numbers = true)]
    speed: Option<f64>,
}

pub fn run(args: Args) -> Result<(), Failure> {
    let replay = Replay::open(&args.file)?;
    let (glove, layout) = (args.glove.as_deref(), args.layout.as_deref());
    let mut setup = LoadedSetup::from_recording(replay.setup(), glove, layout)?;
    setup.setup.output = args.output;
    let cut = replay.shared_truncation();
    signals::install()?;
    let options = SessionOptions {
        source: Some(Box::new(replay)),
        speed: args.speed,
        watchdog: Some(watchdog::program(Command::Stop)?),
        on_notice: Some(Box::new(|notice| say!("{notice}"))),
        ..SessionOptions::default()
    };
    let session = Session::start(setup, options)?;
    let commands = session.commands().clone();
    signals::on_stop(move || _ = commands.send(Command::Stop));
    stats::report(session.join()?)?;
    match cut.get() {
        None => Ok(()),
        Some(cut) => Err(Failure::damaged(format!(
            "{} is cut off at byte {}: everything before it was played, and everything is released",
            args.file.display(),
            cut.offset
        ))),
    }
}

fn speed(text: &str) -> Result<f64, String> {
    number_in(text, 0.01, 1000.0, "times")
}
