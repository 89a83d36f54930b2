//! A panic in a thread while a key is down. This program runs the library in another process, where there is
//! something to break.

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

use crate::panics;
use crate::place::Place;
use crate::signals;
use crate::support::hand::HoldingHand;
use crate::support::press::Press;
use crate::support::program::Program;
use crate::support::x11::wait_for;

/// The first argument of the other process.
const COMMAND: &str = "breaks";

/// The threads that panic: of the source, of the loop, and any that nobody waits for, as those of the control
/// socket, of layout files and of signals.
pub const THREADS: [&str; 3] = ["capture thread", "loop", "thread that nobody waits for"];

/// How long a key stays down after a panic of this thread.
pub fn release_after(place: &Place, thread: &str) -> Duration {
    let folder = tempfile::tempdir().expect("a folder");
    let fuse = folder.path().join("fuse");
    let mut this = Command::new(std::env::current_exe().expect("this program"));
    this.args([COMMAND, place.output(), thread]).arg(&fuse);
    place.show_to(&mut this);
    let program = Program::from_command(this);
    program.wait_for_line("ready", 1);
    place.watch();
    assert!(wait_for(|| place.holds()), "{:#?}", program.stderr_lines());
    let start = Instant::now();
    UnixStream::connect(&fuse).expect("it waits for this");
    while !place.is_free() {
        assert!(start.elapsed() < Duration::from_secs(20), "keys stay down");
    }
    let took = start.elapsed();
    program.wait_for_line("panicked", 1);
    took
}

/// The other process, if this is one: it holds H until something breaks, and then waits to be ended, so that it is not
/// its end that lets go.
pub fn run_if_asked(arguments: &[String]) {
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
        ..Setup::default()
    };
    let assembly = setup.load_files().expect("the default setup");
    let mut sink = output::open(output, &assembly.required_capabilities()).expect("it is there");
    let [source, of_loop, _] = THREADS.map(|name| light(Path::new(fuse), name, thread));
    eprintln!("ready");
    let source = Fused(
        HoldingHand::new(&Press::for_text("h"), Duration::MAX),
        source,
    );
    let mut pipeline = assembly.pipeline();
    let mut observe = |_: &_| check(&of_loop);
    let drive =
        || run_pipeline(source, &mut pipeline, &mut *sink, &commands, &mut observe).map(drop);
    let _ = catch_unwind(AssertUnwindSafe(drive));
    loop {
        thread::park();
    }
}

/// What is set when the thread `name` is to panic, if it is the `chosen` one.
fn light(fuse: &Path, name: &'static str, chosen: &str) -> Arc<AtomicBool> {
    let is_lit = Arc::new(AtomicBool::new(false));
    if name == chosen {
        let listener = UnixListener::bind(fuse).expect("a new socket");
        let of_thread = is_lit.clone();
        thread::spawn(move || {
            let _ = listener.accept().map(|(mut line, _)| line.read(&mut [0]));
            of_thread.store(true, Ordering::Relaxed);
            if name == THREADS[2] {
                check(&of_thread);
            }
        });
    }
    is_lit
}

fn check(is_lit: &AtomicBool) {
    assert!(!is_lit.load(Ordering::Relaxed), "meant to happen");
}

/// A hand whose thread panics when it is told to.
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
