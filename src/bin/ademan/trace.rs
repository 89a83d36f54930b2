//! `ademan trace`: what a stage makes of a source, one JSON object per line.

use std::io::{self, BufWriter, Write};

use ademan::output;
use ademan::session::run_pipeline;
use ademan::snapshot::Snapshot;
use ademan::trace::Stage;

use crate::args::TraceArgs;
use crate::failure::Failure;
use crate::{setup, signals};

pub fn run(args: &TraceArgs) -> Result<(), Failure> {
    let mut setup = setup::read(args.setup.as_deref(), args.parts.clone())?;
    // What a stage would do is shown from the first reading on; nothing is typed here.
    setup.start_armed = true;
    let name = setup::source_name(&setup)?;
    let assembly = setup.load_files()?;
    let source = assembly.open_source(&name)?;
    let mut nowhere = output::open("none", &assembly.required_capabilities())?;
    let (stopper, stop) = signals::stopper()?;
    let mut lines = Lines {
        stage: args.stage,
        out: BufWriter::new(io::stdout().lock()),
        flush: source.is_live(),
        buffer: Vec::new(),
    };
    let mut written = Ok(());
    let ended = run_pipeline(
        source,
        &mut assembly.pipeline(),
        &mut *nowhere,
        &stop,
        &mut |frame| {
            if written.is_ok() {
                written = lines.write(frame);
                if written.is_err() {
                    stopper.ask();
                }
            }
        },
    );
    written?;
    lines.out.flush()?;
    ended?;
    Ok(())
}

struct Lines<W: Write> {
    stage: Stage,
    out: BufWriter<W>,
    flush: bool,
    buffer: Vec<u8>,
}

impl<W: Write> Lines<W> {
    fn write(&mut self, frame: &Snapshot) -> io::Result<()> {
        let (out, flush) = (&mut self.out, self.flush);
        self.stage
            .for_each_json(frame, &mut self.buffer, |_, json| {
                out.write_all(json)?;
                out.write_all(b"\n")?;
                if flush { out.flush() } else { Ok(()) }
            })
    }
}
