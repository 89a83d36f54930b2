//! `ademan trace`: the results of a stage, one JSON object per line, or the jitter and lag of the hand.

use std::io::{self, BufWriter, Write};

use ademan::command::Command;
use ademan::message::escape_json;
use ademan::output;
use ademan::pipeline::Pipeline;
use ademan::session::{SessionHandle, SessionOptions};
use ademan::setup::{PositionSmoothingSetup, Setup, SetupError, SmoothingSetup};
use ademan::trace::Stage;
use ademan::trace::hand_signals::HandSignals;
use clap::builder::{PossibleValuesParser, TypedValueParser};

use crate::complete;
use crate::failure::Failure;
use crate::session;
use crate::setup_args::SetupArgs;

/// Print the results of a stage, one JSON object per line
#[derive(clap::Args)]
#[command(
    after_help = "Examples:\n  ademan trace angles --source serial:/dev/ttyUSB0 | head\n  ademan trace touches --source 'typist:hello' --layout qwerty-arc\n  ademan trace --stats --source 'file:hands.jsonl?protocol=hand-landmarks'"
)]
pub struct Args {
    /// Stage
    #[arg(value_parser = stage(), required_unless_present = "stats")]
    stage: Option<Stage>,
    /// Print the jitter at rest and the lag of the filters at the end, in place of the results
    #[arg(long, conflicts_with = "stage")]
    stats: bool,
    /// Setup file
    #[arg(long, add = complete::setup())]
    setup: Option<String>,
    #[command(flatten)]
    flags: SetupArgs,
}

pub fn run(args: Args) -> Result<(), Failure> {
    let mut setup = args.flags.read_setup(args.setup.as_deref())?;
    // Nothing is typed, so that the trace may begin with the first reading.
    setup.arm_immediately = true;
    let signals = match args.stats {
        true => Some(HandSignals::new(unfiltered(&setup)?)),
        false => None,
    };
    let setup = setup.load_files()?;
    session::prepare()?;
    let options = SessionOptions {
        output: Some(output::open("none", &setup.required_capabilities())?),
        lossless_snapshots: true,
        ..SessionOptions::default()
    };
    let session = session::start(setup, options)?;
    let printed = match (args.stage, signals) {
        (Some(stage), _) => print(&session, stage),
        (None, Some(signals)) => print_stats(&session, signals),
        (None, None) => Ok(()),
    };
    session.commands().send(Command::Stop)?;
    session.join()?;
    Ok(printed?)
}

/// Bytes of a write to the standard output while more results are waiting: those of 40 poses.
const WRITE_BYTES: usize = 1 << 17;

/// Prints all results of a stage, without delay if no more are waiting.
fn print(session: &SessionHandle, stage: Stage) -> io::Result<()> {
    let mut out = BufWriter::with_capacity(WRITE_BYTES, io::stdout().lock());
    let mut buffer = Vec::new();
    for snapshot in session.snapshots() {
        stage.for_each_json(&snapshot, &mut buffer, |_, json| {
            // It may contain names of a layout.
            let json = String::from_utf8_lossy(json);
            out.write_all(escape_json(&json).as_bytes())?;
            out.write_all(b"\n")
        })?;
        if session.snapshots().is_empty() {
            out.flush()?;
        }
    }
    out.flush()
}

/// Returns the pipeline of a setup without filters.
fn unfiltered(setup: &Setup) -> Result<Pipeline, SetupError> {
    let setup = Setup {
        smoothing: SmoothingSetup::Off,
        position_smoothing: PositionSmoothingSetup::Off,
        ..setup.clone()
    };
    Ok(setup.load_files()?.pipeline())
}

/// Prints jitter and lag of each hand at the end of the source.
fn print_stats(session: &SessionHandle, mut signals: HandSignals) -> io::Result<()> {
    for snapshot in session.snapshots() {
        signals.update(&snapshot);
    }
    write!(io::stdout().lock(), "{signals}")
}

fn stage() -> impl TypedValueParser<Value = Stage> {
    PossibleValuesParser::new(Stage::ALL.iter().map(|stage| stage.name())).map(|name| {
        name.parse()
            .expect("the parser accepts only names of stages")
    })
}
