//! `ademan run`: the real thing.

use ademan::output;
use ademan::reload::Watcher;
use ademan::runtime::{Commands, drive};
use crossbeam_channel::never;

use crate::args::RunArgs;
use crate::failure::Failure;
use crate::recording::Recording;
use crate::status::{self, Status};
use crate::{reload, setup, signals};

pub fn run(args: RunArgs) -> Result<(), Failure> {
    let mut setup = setup::read(args.setup.as_deref(), args.parts)?;
    setup.output = args.output.unwrap_or(setup.output);
    setup.armed |= args.armed;
    let name = setup::source_name(&setup)?;
    let assembly = setup.assemble()?;
    let stop = signals::stop_requests()?;
    let source = match args.wait {
        true => setup::wait_for(&assembly, &name, &stop)?,
        false => Some(setup::open_at_its_pace(&assembly, &name)?),
    };
    let Some(source) = source else {
        return Ok(());
    };
    let mut sink = output::open(&assembly.setup.output, &assembly.layout.codes())?;
    let mut recording = match &args.record {
        Some(path) => Some(Recording::start(path, &assembly, &*source, false)?),
        None => None,
    };
    if source.is_live() {
        say!("listening to {name}, Ctrl-C ends");
    }
    let watcher = reload::watch(&assembly, args.record.is_some())?;
    let commands = Commands {
        stop,
        replace: watcher.as_ref().map_or_else(never, Watcher::replacements),
    };
    let mut pipeline = assembly.pipeline();
    let mut status = Status::default();
    let ended = drive(source, &mut pipeline, &mut *sink, commands, &mut |frame| {
        status.show(frame);
        if let Some(recording) = &mut recording {
            recording.show(frame);
        }
    });
    let recorded = recording.map_or(Ok(()), Recording::finish);
    let summary = ended?;
    say!("{}", status::account(&summary.tally));
    recorded
}
