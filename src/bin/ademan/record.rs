//! `ademan record`: a session that is recorded and types nothing.

use std::path::PathBuf;

use ademan::output;
use ademan::session::{Notice, NoticeReceiver, SessionOptions};

use crate::failure::Failure;
use crate::setup_args::SetupArgs;
use crate::{complete, messages, recording_size, session, signals, stats};

/// Record a source and the results of every stage, without typing. A full disk ends it
#[derive(clap::Args)]
#[command(after_help = "Example: ademan record --source serial:/dev/ttyUSB0 session.mcap")]
pub struct Args {
    /// Recording to create; an existing file is not overwritten
    file: PathBuf,
    /// Setup file. The default is setup.ron in the configuration folder, if it exists
    #[arg(long, add = complete::setup())]
    setup: Option<String>,
    #[command(flatten)]
    flags: SetupArgs,
}

/// Returns a receiver that prints notices and ends the session when the recording is incomplete: it has no other purpose.
fn end_when_incomplete() -> NoticeReceiver {
    Box::new(|notice| match notice {
        // The end of the session reports the reason.
        Notice::FileIncomplete(_) => signals::request_stop(),
        notice => messages::print_notice(&notice),
    })
}

pub fn run(args: Args) -> Result<(), Failure> {
    let setup = args.flags.read_setup(args.setup.as_deref())?;
    let setup = setup.load_files()?;
    session::prepare()?;
    let options = SessionOptions {
        output: Some(output::open("none", &setup.required_capabilities())?),
        record_to: Some(args.file.clone()),
        report_status: true,
        on_notice: Some(end_when_incomplete()),
        ..SessionOptions::default()
    };
    let growth = recording_size::Growth::new(&setup);
    let session = session::start(setup, options)?;
    recording_size::announce(&session, &args.file, growth);
    stats::report(session.join()?)
}
