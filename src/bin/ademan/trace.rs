//! `ademan trace`: the results of a stage, one JSON object per line.

use std::io::{self, BufWriter, Write};

use ademan::command::Command;
use ademan::output;
use ademan::session::{SessionHandle, SessionOptions};
use ademan::trace::Stage;
use clap::builder::{PossibleValuesParser, TypedValueParser};

use crate::complete;
use crate::failure::Failure;
use crate::session;
use crate::setup_args::SetupArgs;

/// Print the results of a stage, one JSON object per line
#[derive(clap::Args)]
#[command(
    after_help = "Examples:\n  ademan trace angles --source serial:/dev/ttyUSB0 | head\n  ademan trace touches --source 'typist:hello' --layout qwerty-arc"
)]
pub struct Args {
    /// Stage
    #[arg(value_parser = stage())]
    stage: Stage,
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
    let setup = setup.load_files()?;
    session::prepare()?;
    let options = SessionOptions {
        output: Some(output::open("none", &setup.required_capabilities())?),
        lossless_snapshots: true,
        ..SessionOptions::default()
    };
    let session = session::start(setup, options)?;
    let printed = print(&session, args.stage);
    session.commands().send(Command::Stop)?;
    session.join()?;
    Ok(printed?)
}

/// Prints all results of a stage, without delay if no more are waiting.
fn print(session: &SessionHandle, stage: Stage) -> io::Result<()> {
    let mut out = BufWriter::new(io::stdout().lock());
    let mut buffer = Vec::new();
    for snapshot in session.snapshots() {
        stage.for_each_json(&snapshot, &mut buffer, |_, json| {
            out.write_all(json)?;
            out.write_all(b"\n")
        })?;
        if session.snapshots().is_empty() {
            out.flush()?;
        }
    }
    out.flush()
}

fn stage() -> impl TypedValueParser<Value = Stage> {
    PossibleValuesParser::new(Stage::ALL.iter().map(|stage| stage.name())).map(|name| {
        name.parse()
            .expect("the parser accepts only names of stages")
    })
}
