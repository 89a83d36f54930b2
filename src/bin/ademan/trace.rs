//! `ademan trace`: the results of a stage, one JSON object per line, or the jitter and lag of the hand.

use std::io::{self, BufWriter, Write};

use ademan::capture::Source;
use ademan::capture::recording::Replay;
use ademan::command::Command;
use ademan::message::{escape_json, escape_path};
use ademan::output;
use ademan::session::{SessionHandle, SessionOptions};
use ademan::setup::{LoadedSetup, PositionSmoothingSetup, Setup, SetupError, SmoothingSetup};
use ademan::trace::Stage;
use ademan::trace::hand_signals::HandSignals;
use clap::builder::{PossibleValuesParser, TypedValueParser};

use crate::failure::Failure;
use crate::setup_args::SetupArgs;
use crate::{complete, session, stats};

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
    /// Setup file. Without it, a recording has its own setup
    #[arg(long, add = complete::setup())]
    setup: Option<String>,
    #[command(flatten)]
    flags: SetupArgs,
}

pub fn run(args: Args) -> Result<(), Failure> {
    let traced = TracedSetup::open(&args)?;
    let signals = match args.stats {
        true => Some(HandSignals::new(traced.load(without_filters)?.pipeline())),
        false => None,
    };
    let setup = traced.load(|_| {})?;
    session::prepare()?;
    let options = SessionOptions {
        output: Some(output::open("none", &setup.required_capabilities())?),
        source: traced.into_source(),
        lossless_snapshots: true,
        ..SessionOptions::default()
    };
    let session = session::start(setup, options)?;
    let printed = match (args.stage, signals) {
        (Some(stage), _) => print(&session, stage),
        (None, Some(signals)) => print_stats(&session, signals),
        (None, None) => Ok(true),
    };
    session.commands().send(Command::Stop)?;
    let summary = session.join()?;
    match printed? {
        true => Ok(()),
        false => stats::report(summary),
    }
}

/// The setup of a trace, and the recording that has it.
enum TracedSetup<'a> {
    Own(Box<Setup>),
    /// A recording without a setup that replaces its own.
    Recorded(Box<Replay>, &'a SetupArgs),
}

impl<'a> TracedSetup<'a> {
    fn open(args: &'a Args) -> Result<Self, Failure> {
        match (args.flags.recording(), &args.setup) {
            (Some(path), None) => {
                say!("using the setup in {}", escape_path(path));
                Ok(Self::Recorded(Box::new(Replay::open(path)?), &args.flags))
            }
            (_, file) => Ok(Self::Own(Box::new(args.flags.read_setup(file.as_deref())?))),
        }
    }

    /// Loads the setup after a change to it.
    fn load(&self, change: fn(&mut Setup)) -> Result<LoadedSetup, SetupError> {
        let change = |setup: &mut Setup| {
            // Nothing is typed, so that the trace may begin with the first reading.
            setup.arm_immediately = true;
            change(setup);
        };
        match self {
            Self::Own(setup) => {
                let mut setup = (**setup).clone();
                change(&mut setup);
                setup.load_files()
            }
            Self::Recorded(replay, flags) => {
                let settings = flags.replay_settings();
                LoadedSetup::from_changed_recording(replay.setup(), &settings, |setup| {
                    flags.override_permissions(setup);
                    change(setup);
                })
            }
        }
    }

    /// Returns the source, unless the setup names it.
    fn into_source(self) -> Option<Box<dyn Source>> {
        match self {
            Self::Own(_) => None,
            Self::Recorded(replay, _) => Some(replay),
        }
    }
}

fn without_filters(setup: &mut Setup) {
    setup.smoothing = SmoothingSetup::Off;
    setup.position_smoothing = PositionSmoothingSetup::Off;
}

/// Bytes of a write to the standard output while more results are waiting: those of 40 poses.
const WRITE_BYTES: usize = 1 << 17;

/// Prints all results of a stage, without delay if no more are waiting. Returns `false` if there are none.
fn print(session: &SessionHandle, stage: Stage) -> io::Result<bool> {
    let mut is_any = false;
    let mut out = BufWriter::with_capacity(WRITE_BYTES, io::stdout().lock());
    let mut buffer = Vec::new();
    for snapshot in session.snapshots() {
        stage.for_each_json(&snapshot, &mut buffer, |_, json| {
            is_any = true;
            // It may contain names of a layout.
            let json = String::from_utf8_lossy(json);
            out.write_all(escape_json(&json).as_bytes())?;
            out.write_all(b"\n")
        })?;
        if session.snapshots().is_empty() {
            out.flush()?;
        }
    }
    out.flush()?;
    Ok(is_any)
}

/// Prints jitter and lag of each hand at the end of the source.
fn print_stats(session: &SessionHandle, mut signals: HandSignals) -> io::Result<bool> {
    for snapshot in session.snapshots() {
        signals.update(&snapshot);
    }
    write!(io::stdout().lock(), "{signals}")?;
    Ok(true)
}

fn stage() -> impl TypedValueParser<Value = Stage> {
    PossibleValuesParser::new(Stage::ALL.iter().map(|stage| stage.name())).map(|name| {
        name.parse()
            .expect("the parser accepts only names of stages")
    })
}
