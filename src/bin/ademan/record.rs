//! `ademan record`: a source, and what every stage makes of it, into a file.

use ademan::output;
use ademan::session::run_pipeline;

use crate::args::RecordArgs;
use crate::failure::Failure;
use crate::recording::Recording;
use crate::status::{self, Status};
use crate::{setup, signals};

pub fn run(args: RecordArgs) -> Result<(), Failure> {
    let setup = setup::read(args.setup.as_deref(), args.parts)?;
    let name = setup::source_name(&setup)?;
    let assembly = setup.load_files()?;
    setup::tell_pointers(&assembly);
    let stop = signals::stop_requests()?;
    let source = assembly.open_source(&name)?;
    let mut recording = Recording::start(&args.file, &assembly, &*source, !source.is_live())?;
    let mut nowhere = output::open("none", &assembly.required_capabilities())?;
    let mut status = Status::default();
    say!("recording to {}, Ctrl-C ends", args.file.display());
    let ended = run_pipeline(
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
    say!("{}", status::account(&ended?.stats));
    Ok(())
}
