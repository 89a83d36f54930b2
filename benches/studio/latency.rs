//! The time from the last byte of a packet to the call of the output, in one session whose window opens and closes.

use std::process::Command;
use std::sync::atomic::{AtomicBool, Ordering};
use std::sync::{Arc, Mutex};
use std::thread;
use std::time::{Duration, Instant};

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

/// Time at the start of each part whose events do not count.
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
        .env("LIBGL_ALWAYS_SOFTWARE", "1");
    let mut session = Process::start(&mut command).expect("this program starts");
    let status = session.0.wait().expect("it exits");
    assert!(status.success(), "the session fails");
}

/// Runs the session and prints the table. A test has two short parts.
pub fn measure(is_test: bool) {
    let (parts, length) = match is_test {
        true => (2, Duration::from_millis(500)),
        false => (8, Duration::from_secs(8)),
    };
    let glove = Arc::new(Glove::start());
    let clock = Clock {
        glove: Arc::clone(&glove),
        part: Arc::default(),
        is_counting: Arc::default(),
        times: Arc::default(),
    };
    let session = start(&glove, clock.clone());
    for part in 0..parts {
        let has_window = part % 2 == 1;
        clock.part.store(has_window, Ordering::Relaxed);
        let counting = Arc::clone(&clock.is_counting);
        let time = WARM_UP.min(length) + length;
        thread::spawn(move || {
            thread::sleep(WARM_UP.min(length));
            counting.store(true, Ordering::Relaxed);
        });
        match has_window {
            true => show_window(&session, time),
            false => thread::sleep(time),
        }
        clock.is_counting.store(false, Ordering::Relaxed);
    }
    let stop = session.commands().send(SessionCommand::Stop);
    stop.expect("the session runs");
    session.join().expect("the session ends");
    report(&clock);
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
    open_window(app, is_over).expect("the server shows windows");
}

/// An output that notes the time of each call.
#[derive(Clone)]
struct Clock {
    glove: Arc<Glove>,
    /// There is a window.
    part: Arc<AtomicBool>,
    is_counting: Arc<AtomicBool>,
    /// Times without and with a window.
    times: Arc<Mutex<[Vec<Duration>; 2]>>,
}

impl Sink for Clock {
    fn send(&mut self, _: &[OutputEvent]) -> Result<(), OutputError> {
        let time = self.glove.since_packet();
        if self.is_counting.load(Ordering::Relaxed) {
            let part = usize::from(self.part.load(Ordering::Relaxed));
            self.times.lock().expect("no panic")[part].push(time);
        }
        Ok(())
    }

    fn close(&mut self) -> Result<(), OutputError> {
        Ok(())
    }
}

/// Prints the table.
fn report(clock: &Clock) {
    println!("\n| packet to output | events | p50 | p99 | of p99 without, goal 1.1 |");
    println!("|---|---|---|---|---|");
    let mut without = None;
    let mut times = clock.times.lock().expect("no panic");
    for (name, times) in ["without a window", "with a window"]
        .iter()
        .zip(&mut *times)
    {
        times.sort_unstable();
        let [p50, p99] = [50, 99].map(|percent| percentile(times, percent));
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
