//! `ademan run`: the real thing.

use ademan::access;
use ademan::control::Control;
use ademan::doctor;
use ademan::emergency;
use ademan::output;
use ademan::reload::Watcher;
use ademan::runtime::{self, Call, Commands, Order, drive};
use crossbeam_channel::bounded;

use crate::args::RunArgs;
use crate::failure::Failure;
use crate::recording::Recording;
use crate::reload::Growth;
use crate::status::{self, Status};
use crate::{control, guardian, reload, setup, signals, suspension};

pub fn run(args: RunArgs) -> Result<(), Failure> {
    if doctor::is_root() && !args.allow_root {
        return Err(Failure::wrong_use(access::is_root().to_string()));
    }
    let mut setup = setup::read(args.setup.as_deref(), args.parts)?;
    setup.output = args.output.unwrap_or(setup.output);
    setup.armed |= args.armed;
    let name = setup::source_name(&setup)?;
    let assembly = setup.assemble()?;
    let needs = assembly.needs();
    output::check(&assembly.setup.output, &needs)?;
    setup::tell_pointers(&assembly);
    let (stopper, stop) = signals::stopper()?;
    let (calls, called) = runtime::calls();
    let mut control = control::open(args.control.as_deref())?;
    let mut reporter = control.as_ref().map(Control::reporter);
    let pause = {
        let (calls, (answer, _)) = (calls.clone(), bounded(1));
        move || {
            // Full only when the run stands still: then the guardian lets go.
            let _ = calls.try_send(Call {
                order: Order::Pause,
                answer: answer.clone(),
            });
        }
    };
    emergency::watch(&emergency::keys(&assembly.setup.stop_keys)?, pause.clone())?;
    suspension::watch(calls.clone())?;
    let (replace, replacements) = bounded(1);
    let is_recorded = args.record.is_some();
    let watchers = reload::watch(&assembly, is_recorded, &replace, reporter.as_ref())?;
    if let Some(control) = &mut control {
        let files = watchers.iter().map(Watcher::calls).collect();
        control.serve(control::desk(&assembly, calls, files, stopper))?;
    }
    let source = match args.wait {
        true => setup::wait_for(&assembly, &name, &stop)?,
        false => Some(setup::open_at_its_pace(&assembly, &name)?),
    };
    let Some(source) = source else {
        return Ok(());
    };
    let mut sink = guardian::open_outputs(&assembly.setup.output, &needs, pause)?;
    let mut recording = match &args.record {
        Some(path) => Some(Recording::start(path, &assembly, &*source, false)?),
        None => None,
    };
    if source.is_live() {
        say!("listening to {name}, Ctrl-C ends");
    }
    if control.is_none() && args.control.is_none() {
        say!("{}", access::no_runtime_folder());
    }
    let commands = Commands {
        stop,
        replace: replacements,
        calls: called,
    };
    let mut pipeline = assembly.pipeline();
    let mut status = Status::default();
    let growth = Growth::of(&watchers);
    let ended = drive(source, &mut pipeline, &mut *sink, commands, &mut |frame| {
        status.show(frame);
        growth.take(frame);
        if let Some(reporter) = &mut reporter {
            reporter.show(frame);
        }
        if let Some(recording) = &mut recording {
            recording.show(frame);
        }
    });
    let recorded = recording.map_or(Ok(()), Recording::finish);
    let summary = ended?;
    say!("{}", status::account(&summary.tally));
    recorded
}
