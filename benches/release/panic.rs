//! Release times after a panic of a thread. The panic happens in a child process of this benchmark that runs the library.

use std::io::Read;
use std::os::unix::net::{UnixListener, UnixStream};
use std::panic::{AssertUnwindSafe, catch_unwind};
use std::path::Path;
use std::process::Command;
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};
use std::thread;
use std::time::{Duration, Instant};

use ademan::capture::{CaptureError, Source, SourceEvent};
use ademan::output;
use ademan::session::{command_channel, run_pipeline};
use ademan::setup::Setup;
use ademan::snapshot::StepView;

use crate::panics;
use crate::signals;
use crate::support::hand::HoldingHand;
use crate::support::press::Press;
use crate::support::program::Program;
use crate::support::x11::wait_for;
use crate::target::InputTarget;

/// The first argument of the child process.
const COMMAND: &str = "panic";

/// The threads that panic: the threads of the source and of the loop, and a detached one, like the threads of the control socket,
/// of layout files and of signals.
pub const THREADS: [&str; 3] = ["capture thread", "loop", "detached thread"];

/// Returns the release time after a panic of this thread.
pub fn measure(target: &InputTarget, thread: &str) -> Duration {
    let folder = tempfile::tempdir().expect("a folder");
    let fuse = folder.path().join("fuse");
    let mut command = Command::new(std::env::current_exe().expect("the path of this program"));
    command.args([COMMAND, target.output(), thread]).arg(&fuse);
    target.configure(&mut command);
    let program = Program::from_command(command);
    program.wait_for_line("ready", 1);
    target.observe();
    assert!(
        wait_for(|| target.is_pressed()),
        "{:#?}",
        program.stderr_lines()
    );
    let start = Instant::now();
    UnixStream::connect(&fuse).expect("the child waits for a connection");
    while !target.is_released() {
        assert!(
            start.elapsed() < Duration::from_secs(20),
            "a key stays pressed"
        );
    }
    let release_time = start.elapsed();
    program.wait_for_line("panicked", 1);
    release_time
}

/// Runs the child process if the arguments are its own: it holds H until a thread panics, and then waits to be killed, so
/// that its exit does not release the key.
pub fn run_child(arguments: &[String]) {
    let [command, output, thread, fuse] = arguments else {
        return;
    };
    if command != COMMAND {
        return;
    }
    let (sender, commands) = command_channel();
    signals::on_stop(move || _ = sender.send(ademan::command::Command::Stop));
    panics::install_hook();
    let setup = Setup {
        arm_immediately: true,
        // A busy machine must not cause a stall.
        stall_timeout_ms: 10_000,
        ..Setup::default()
    };
    let setup = setup.load_files().expect("the default setup");
    let mut sink = output::open(output, &setup.required_capabilities()).expect("the output opens");
    let [source, loop_fuse, _] = THREADS.map(|name| arm_fuse(Path::new(fuse), name, thread));
    eprintln!("ready");
    let source = Fused(
        HoldingHand::new(&Press::for_text("h"), Duration::MAX),
        source,
    );
    let mut pipeline = setup.pipeline();
    let mut observe = |_: &StepView| check(&loop_fuse);
    let run = || run_pipeline(source, &mut pipeline, &mut *sink, &commands, &mut observe).map(drop);
    let _ = catch_unwind(AssertUnwindSafe(run));
    loop {
        thread::park();
    }
}

/// Returns a flag that is set when a client connects to `fuse`, if the thread `name` is the `chosen` one. The detached
/// thread panics itself.
fn arm_fuse(fuse: &Path, name: &'static str, chosen: &str) -> Arc<AtomicBool> {
    let is_blown = Arc::new(AtomicBool::new(false));
    if name == chosen {
        let listener = UnixListener::bind(fuse).expect("a new socket");
        let flag = is_blown.clone();
        thread::spawn(move || {
            let _ = listener.accept().map(|(mut line, _)| line.read(&mut [0]));
            flag.store(true, Ordering::Relaxed);
            if name == THREADS[2] {
                check(&flag);
            }
        });
    }
    is_blown
}

fn check(is_blown: &AtomicBool) {
    assert!(!is_blown.load(Ordering::Relaxed), "intended");
}

/// A source that panics when its fuse has blown.
struct Fused(HoldingHand, Arc<AtomicBool>);

impl Source for Fused {
    fn next(&mut self) -> Result<SourceEvent, CaptureError> {
        check(&self.1);
        self.0.next()
    }

    fn name(&self) -> &str {
        self.0.name()
    }
}
