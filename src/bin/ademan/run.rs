//! `ademan run`: the real thing.

use ademan::advice;
use ademan::doctor;
use ademan::output;
use ademan::session::control_socket::ControlServer;
use ademan::session::panic_keys;
use ademan::session::reload::LayoutManager;
use ademan::session::{self, Call, Commands, Order, run_pipeline};
use crossbeam_channel::bounded;

use crate::args::RunArgs;
use crate::failure::Failure;
use crate::recording::Recording;
use crate::reload::Growth;
use crate::status::{self, Status};
use crate::{control, reload, setup, signals, suspension, watchdog};

pub fn run(args: RunArgs) -> Result<(), Failure> {
    if doctor::is_running_as_root() && !args.allow_root {
        return Err(Failure::wrong_use(advice::running_as_root().to_string()));
    }
    let mut setup = setup::read(args.setup.as_deref(), args.parts)?;
    setup.output = args.output.unwrap_or(setup.output);
    setup.start_armed |= args.armed;
    let name = setup::source_name(&setup)?;
    let assembly = setup.load_files()?;
    let needs = assembly.required_capabilities();
    output::check(&assembly.setup.output, &needs)?;
    setup::tell_pointers(&assembly);
    let (stopper, stop) = signals::stopper()?;
    let (calls, called) = session::calls();
    let mut control = control::open(args.control.as_deref())?;
    let mut reporter = control.as_ref().map(ControlServer::notifier);
    let pause = {
        let (calls, (answer, _)) = (calls.clone(), bounded(1));
        move || {
            // Full only when the run stands still: then the watchdog lets go.
            let _ = calls.try_send(Call {
                order: Order::Pause,
                answer: answer.clone(),
            });
        }
    };
    panic_keys::watch(
        &panic_keys::parse_keys(&assembly.setup.panic_keys)?,
        pause.clone(),
    )?;
    suspension::watch(calls.clone())?;
    let (replace, replacements) = bounded(1);
    let is_recorded = args.record.is_some();
    let watchers = reload::watch(&assembly, is_recorded, &replace, reporter.as_ref())?;
    if let Some(control) = &mut control {
        let files = watchers.iter().map(LayoutManager::calls).collect();
        control.serve(control::desk(&assembly, calls, files, stopper))?;
    }
    let source = match args.wait {
        true => setup::wait_for(&assembly, &name, &stop)?,
        false => Some(setup::open_at_its_pace(&assembly, &name)?),
    };
    let Some(source) = source else {
        return Ok(());
    };
    let mut sink = watchdog::open_outputs(&assembly.setup.output, &needs, pause)?;
    let mut recording = match &args.record {
        Some(path) => Some(Recording::start(path, &assembly, &*source, false)?),
        None => None,
    };
    if source.is_live() {
        say!("listening to {name}, Ctrl-C ends");
    }
    if control.is_none() && args.control.is_none() {
        say!("{}", advice::no_runtime_dir());
    }
    let commands = Commands {
        stop,
        replace: replacements,
        calls: called,
    };
    let mut pipeline = assembly.pipeline();
    let mut status = Status::default();
    let growth = Growth::of(&watchers);
    let ended = run_pipeline(source, &mut pipeline, &mut *sink, commands, &mut |frame| {
        status.show(frame);
        growth.take(frame);
        if let Some(reporter) = &mut reporter {
            reporter.notify_snapshot(frame);
        }
        if let Some(recording) = &mut recording {
            recording.show(frame);
        }
    });
    let recorded = recording.map_or(Ok(()), Recording::finish);
    let summary = ended?;
    say!("{}", status::account(&summary.stats));
    recorded
}
