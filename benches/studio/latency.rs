//! The time from the last byte of a packet to the call of the output, in one session whose window opens and closes.
//!
//! On a virtual machine the host may take the processors away for longer than anything that is measured here. Of the parts with
//! a window, and of those without, only the quarter counts from which it took least.

use std::process::Command;
use std::sync::{Arc, Mutex};
use std::time::{Duration, Instant};
use std::{fs, mem, thread};

use ademan::command::Command as SessionCommand;
use ademan::device::OutputEvent;
use ademan::output::{OutputError, Sink};
use ademan::session::{Session, SessionHandle, SessionOptions};
use ademan::setup::Setup;
use ademan::studio::{StudioApp, open_window};

use super::glove::Glove;
use super::support::process::Process;
use super::support::x11::XServer;

/// The argument with which this program starts itself, with the display of its X server.
pub const ARGUMENT: &str = "--latency";

/// A layout on which each movement of the wrist moves the pointer: nearly every packet has an event.
const LAYOUT: &str = "joint";

/// Time before each part, in which the window opens.
const WARM_UP: Duration = Duration::from_secs(1);

/// Time at which the window closes.
static END: Mutex<Option<Instant>> = Mutex::new(None);

/// Prints the table of a session in a process of its own.
pub fn print(server: &XServer, is_test: bool) {
    let program = std::env::current_exe().expect("this program has a path");
    let mut command = Command::new(program);
    command
        .arg(ARGUMENT)
        .args((!is_test).then_some("--bench"))
        .env("DISPLAY", server.display())
        .env_remove("WAYLAND_DISPLAY")
        .env("LIBGL_ALWAYS_SOFTWARE", "1")
        // `ademan studio` sets it too.
        .env("LP_NUM_THREADS", "0");
    let mut session = Process::start(&mut command).expect("this program starts");
    let status = session.0.wait().expect("it exits");
    assert!(status.success(), "the session fails");
}

/// Runs the session and prints the table. A test has two short parts.
pub fn measure(is_test: bool) {
    let (count, length) = if is_test {
        (2, Duration::from_millis(500))
    } else {
        (60, Duration::from_secs(2))
    };
    let glove = Arc::new(Glove::start());
    let clock = Clock {
        glove: Arc::clone(&glove),
        times: Arc::default(),
    };
    let session = start(&glove, clock.clone());
    let mut parts = [const { Vec::new() }; 2];
    for number in 0..count {
        let has_window = number % 2 == 1;
        let clock = clock.clone();
        let part = thread::spawn(move || clock.record(length));
        if has_window {
            show_window(&session, WARM_UP + length);
        }
        let part = part.join().expect("no panic");
        parts[usize::from(has_window)].push(part);
    }
    let stop = session.commands().send(SessionCommand::Stop);
    stop.expect("the session runs");
    session.join().expect("the session ends");
    report(parts);
}

fn start(glove: &Glove, clock: Clock) -> SessionHandle {
    let setup = Setup {
        source: Some(glove.source.parse().expect("a source")),
        layout: LAYOUT.into(),
        ..Setup::default()
    };
    let setup = setup.load_files().expect("the files of the program");
    let options = SessionOptions {
        output: Some(Box::new(clock)),
        ..SessionOptions::default()
    };
    let session = Session::start(setup, options).expect("a session");
    session.wait_until_started();
    session
}

/// Shows the window of the session for a time.
fn show_window(session: &SessionHandle, time: Duration) {
    let app = StudioApp::new(session).expect("the session runs");
    *END.lock().expect("no panic") = Some(Instant::now() + time);
    let is_over = || {
        let end = *END.lock().expect("no panic");
        end.is_none_or(|end| Instant::now() > end)
    };
    open_window(app.into(), is_over).expect("the server shows windows");
}

/// Events of some seconds.
struct Part {
    /// Time that the host took from the processors, in clock ticks.
    stolen: u64,
    times: Vec<Duration>,
}

/// An output that notes the time of each call.
#[derive(Clone)]
struct Clock {
    glove: Arc<Glove>,
    /// The times of the part that is recorded.
    times: Arc<Mutex<Option<Vec<Duration>>>>,
}

impl Clock {
    /// Records the events of a time that begins after the warm-up.
    fn record(&self, length: Duration) -> Part {
        let set = |times| mem::replace(&mut *self.times.lock().expect("no panic"), times);
        thread::sleep(WARM_UP);
        let before = stolen_ticks();
        set(Some(Vec::new()));
        thread::sleep(length);
        Part {
            times: set(None).expect("it was recorded"),
            stolen: stolen_ticks() - before,
        }
    }
}

/// Returns the time that the host of this virtual machine has taken from all its processors, in clock ticks.
fn stolen_ticks() -> u64 {
    let stat = fs::read_to_string("/proc/stat").expect("Linux");
    let ticks = stat.split_whitespace().nth(8);
    let ticks = ticks.and_then(|ticks| ticks.parse().ok());
    ticks.expect("a number of ticks")
}

impl Sink for Clock {
    fn send(&mut self, _: &[OutputEvent]) -> Result<(), OutputError> {
        let time = self.glove.since_packet();
        if let Some(times) = &mut *self.times.lock().expect("no panic") {
            times.push(time);
        }
        Ok(())
    }

    fn close(&mut self) -> Result<(), OutputError> {
        Ok(())
    }
}

/// Prints the table.
fn report(parts: [Vec<Part>; 2]) {
    println!("\n| packet to output | events | p50 | p99 | of p99 without, goal 1.3 |");
    println!("|---|---|---|---|---|");
    let mut without = None;
    for (name, mut run_parts) in ["without a window", "with a window"].iter().zip(parts) {
        run_parts.sort_by_key(|part| part.stolen);
        run_parts.truncate(run_parts.len().div_ceil(4));
        let times = run_parts.iter().flat_map(|part| &part.times);
        let mut times: Vec<Duration> = times.copied().collect();
        times.sort_unstable();
        let [p50, p99] = [50, 99].map(|percent| percentile(&times, percent));
        let ratio = p99 / *without.get_or_insert(p99);
        let count = times.len();
        println!("| {name} | {count} | {p50:.0} µs | {p99:.0} µs | {ratio:.2} |");
    }
}

/// Returns a percentile in microseconds.
fn percentile(sorted: &[Duration], percent: usize) -> f64 {
    let index = (sorted.len() * percent / 100).min(sorted.len().saturating_sub(1));
    let time = sorted.get(index);
    time.map_or(f64::NAN, |time| time.as_secs_f64() * 1e6)
}
