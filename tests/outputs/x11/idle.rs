//! Faults while nothing is pressed: the watchdog is stopped, the server dies.

use std::thread::sleep;
use std::time::{Duration, Instant};

use tempfile::TempDir;

use super::repeat;
use super::watchdog::is_alive;
use crate::support::glove::Glove;
use crate::support::key_log::KeyLog;
use crate::support::press::{Press, glove_format};
use crate::support::process::signal;
use crate::support::program::Program;
use crate::support::x11::{XServer, wait_at_most, wait_for};

/// Longer than the time after a press for which the program still asks the watchdog often.
const IDLE_TIME: Duration = Duration::from_millis(1500);

/// An armed run with the hand clear of all keys.
struct Idle {
    server: XServer,
    program: Program,
    glove: Glove,
    press: Press,
    _folder: TempDir,
}

impl Idle {
    fn start() -> Option<Self> {
        let server = XServer::start()?;
        let press = Press::for_text("H");
        let (folder, glove, source) = Glove::in_new_folder(press.clear());
        let run = ["run", "--output", "desktop", "--source", &source];
        let program = Program::start(&server, run);
        program.wait_for_line("armed", 1);
        sleep(IDLE_TIME);
        Some(Self {
            server,
            program,
            glove,
            press,
            _folder: folder,
        })
    }

    /// Returns the process id of the watchdog. One that replaces another takes a moment to start.
    fn watchdog(&self) -> u32 {
        let find = || {
            let mut children = self.program.children().into_iter();
            children.find(|child| is_alive(*child))
        };
        assert!(wait_for(|| find().is_some()), "no watchdog");
        find().expect("a watchdog")
    }

    /// Waits until the program has ended because the server is gone.
    fn check_end(mut self, start: Instant) {
        assert_eq!(self.program.wait_for_exit().code(), Some(1));
        println!("ended {:.1?} after the server", start.elapsed());
        let lines = self.program.stderr_lines();
        let is_reported = |line: &String| line.contains("the connection to the X server failed");
        assert!(lines.iter().any(is_reported), "{lines:#?}");
    }
}

#[test]
fn a_watchdog_that_is_stopped_while_nothing_is_pressed_is_noticed_and_replaced() {
    let Some(mut idle) = Idle::start() else {
        return;
    };
    let first = idle.watchdog();
    let start = Instant::now();
    signal("STOP", first);
    idle.program.wait_for_line("paused", 2);
    println!("noticed after {:.1?}", start.elapsed());
    assert!(wait_for(|| !is_alive(first)), "the first watchdog exists");
    assert_ne!(idle.watchdog(), first);
    idle.program.signal(&["TERM"]);
    assert_eq!(idle.program.wait_for_exit().code(), Some(0));
}

#[test]
fn no_key_is_pressed_while_the_watchdog_is_stopped() {
    // On a busy machine the key may be pressed before the watchdog is stopped.
    repeat(|| {
        let Some(mut idle) = Idle::start() else {
            return true;
        };
        let log = KeyLog::start(&idle.server);
        let watchdog = idle.watchdog();
        let approach = glove_format().packet_period() * idle.press.approach.len() as u32;
        idle.glove.play(&idle.press.approach);
        // The key follows soon, before the loss of an idle watchdog is noticed.
        sleep(approach.saturating_sub(Duration::from_millis(400)));
        signal("STOP", watchdog);
        let is_late = !idle.server.pressed_keys().is_empty() || log.presses_after(0) > 0;
        if !is_late {
            let is_pressed = || log.presses_after(0) > 0;
            if wait_at_most(Duration::from_secs(2), is_pressed) {
                sleep(Duration::from_millis(280));
            }
        }
        idle.program.signal(&["KILL"]);
        // Unless the program has replaced it, it would keep the standard error open.
        if is_alive(watchdog) {
            signal("KILL", watchdog);
        }
        assert_eq!(idle.program.wait_for_exit().code(), None);
        if !is_late {
            sleep(Duration::from_millis(500));
            assert_eq!(idle.server.pressed_keys(), [0; 0], "{:?}", log.events());
        }
        !is_late
    });
}

#[test]
fn the_death_of_the_server_while_nothing_is_pressed_ends_the_run() {
    let Some(mut idle) = Idle::start() else {
        return;
    };
    let start = Instant::now();
    idle.server.kill();
    idle.check_end(start);
}

#[test]
fn the_death_of_the_server_while_no_reading_arrives_ends_the_run() {
    let Some(mut idle) = Idle::start() else {
        return;
    };
    idle.glove.stop_sending();
    idle.program.wait_for_line("stalled", 1);
    let start = Instant::now();
    idle.server.kill();
    idle.check_end(start);
}
