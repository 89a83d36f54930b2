//! `ademan replay`: a recording through the same way again.

use ademan::capture::recording::Replay;
use ademan::capture::{PacedSource, Source};
use ademan::session::run_pipeline;
use ademan::setup::LoadedSetup;

use crate::args::ReplayArgs;
use crate::failure::Failure;
use crate::signals;
use crate::status;
use crate::watchdog;

pub fn run(args: &ReplayArgs) -> Result<(), Failure> {
    let replay = Replay::open(&args.file)?;
    let assembly = LoadedSetup::from_recording(
        replay.setup(),
        args.glove.as_deref(),
        args.layout.as_deref(),
    )?;
    let (stopper, stop) = signals::stopper()?;
    let needs = assembly.required_capabilities();
    let cut = replay.shared_truncation();
    let mut sink = watchdog::open_outputs(&args.output, &needs, move || stopper.ask_once())?;
    let source: Box<dyn Source> = match args.speed {
        Some(speed) => Box::new(PacedSource::new(replay, speed)),
        None => Box::new(replay),
    };
    let summary = run_pipeline(
        source,
        &mut assembly.pipeline(),
        &mut *sink,
        &stop,
        &mut |_| {},
    )?;
    say!("{}", status::account(&summary.stats));
    match cut.get() {
        None => Ok(()),
        Some(cut) => Err(Failure::damaged(format!(
            "{} is cut off at byte {}: what came before was played, everything is released",
            args.file.display(),
            cut.offset
        ))),
    }
}
