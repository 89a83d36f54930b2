//! `ademan record`: a source, and what every stage makes of it, into a file.

use ademan::output;
use ademan::runtime::drive;

use crate::args::RecordArgs;
use crate::failure::Failure;
use crate::recording::Recording;
use crate::status::{self, Status};
use crate::{setup, signals};

pub fn run(args: RecordArgs) -> Result<(), Failure> {
    let setup = setup::read(args.setup.as_deref(), args.parts)?;
    let name = setup::source_name(&setup)?;
    let assembly = setup.assemble()?;
    setup::tell_pointers(&assembly);
    let stop = signals::stop_requests()?;
    let source = assembly.open(&name)?;
    let mut recording = Recording::start(&args.file, &assembly, &*source, !source.is_live())?;
    let mut nowhere = output::open("none", &assembly.needs())?;
    let mut status = Status::default();
    say!("recording to {}, Ctrl-C ends", args.file.display());
    let ended = drive(
        source,
        &mut assembly.pipeline(),
        &mut *nowhere,
        &stop,
        &mut |frame| {
            status.show(frame);
            recording.show(frame);
        },
    );
    recording.finish()?;
    say!("{}", status::account(&ended?.tally));
    Ok(())
}
