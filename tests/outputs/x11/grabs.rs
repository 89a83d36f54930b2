//! Another client grabs the server, or the server hangs.

use std::thread::sleep;
use std::time::{Duration, Instant};

use tempfile::TempDir;

use super::ends::Typing;
use super::{repeat, wait_for_release};
use crate::support::glove::Glove;
use crate::support::key_log::KeyLog;
use crate::support::press::Press;
use crate::support::program::{Program, WATCHDOG_LOST};
use crate::support::x11::{InputWindow, XServer, wait_for};

/// Number of presses while the server hangs.
const PRESSES: usize = 3;

/// A part of the report of dropped presses.
const DROPPED: &str = "dropped: the output did not accept them within 250 ms";

/// An armed run with the hand clear of all keys.
struct Armed {
    program: Program,
    glove: Glove,
    press: Press,
    _folder: TempDir,
}

impl Armed {
    fn start(server: &XServer) -> Self {
        let press = Press::for_text("h");
        let (folder, glove, source) = Glove::in_new_folder(press.clear());
        let run = ["run", "--output", "desktop", "--source", &source];
        let program = Program::start(server, run);
        program.wait_for_line("armed", 1);
        Self {
            program,
            glove,
            press,
            _folder: folder,
        }
    }

    /// Presses a key and waits until the watchdog has noticed that the program is silent.
    fn press_and_wait(&self) {
        self.glove.play_to_end(&self.press.approach);
        sleep(Duration::from_millis(600));
    }

    /// Presses and releases a key while the server hangs, and waits until these presses are too old for it.
    fn type_and_wait(&self) {
        let tap = [&self.press.approach[..], &self.press.lift].concat();
        self.glove.play_to_end(&tap.repeat(PRESSES));
        sleep(Duration::from_millis(500));
    }

    /// Waits until the run reports that presses were dropped. Returns `false` if a busy machine has released everything before
    /// them, or in between.
    fn reports_dropped_presses(&self) -> bool {
        let has_said = |part: &str| self.program.count_lines(part) > 0;
        let is_spoiled = || ["stalled:", WATCHDOG_LOST].into_iter().any(has_said);
        assert!(
            wait_for(|| has_said(DROPPED) || is_spoiled()),
            "{:#?}",
            self.program.stderr_lines()
        );
        !is_spoiled()
    }

    /// Kills the program when the server has executed all requests so far, and checks that no key is pressed.
    fn kill(mut self, server: &XServer, round: usize) {
        sleep(Duration::from_millis(300));
        self.program.signal(&["KILL"]);
        assert_all_keys_are_released(server, round);
        self.program.wait_for_exit();
    }
}

#[test]
fn a_release_passes_the_grab_of_another_client() {
    let Some(mut typing) = Typing::start() else {
        return;
    };
    typing.server.grab();
    let start = Instant::now();
    typing.glove.unplug();
    wait_for_release(&typing.server, start, "unplugged during a grab");
    typing.server.ungrab();
    typing.program.signal(&["TERM"]);
    assert_eq!(typing.program.wait_for_exit().code(), Some(0));
}

#[test]
fn no_key_stays_pressed_if_the_program_is_killed_after_a_press_during_a_grab() {
    let Some(server) = XServer::start() else {
        return;
    };
    let log = KeyLog::start(&server);
    for round in 0..6 {
        let run = Armed::start(&server);
        server.grab();
        run.press_and_wait();
        server.ungrab();
        run.kill(&server, round);
    }
    assert!(log.wait_for_press(0), "no press passed the grab");
}

#[test]
fn no_key_stays_pressed_if_the_program_is_killed_after_a_press_while_the_server_hangs() {
    let Some(server) = XServer::start() else {
        return;
    };
    for round in 0..6 {
        let run = Armed::start(&server);
        server.freeze();
        run.press_and_wait();
        server.thaw();
        run.kill(&server, round);
    }
}

/// Checks that no key is pressed, also after the server has executed all requests of a dead client.
fn assert_all_keys_are_released(server: &XServer, round: usize) {
    assert!(server.wait_for_keys(&[]), "{round}");
    sleep(Duration::from_millis(500));
    assert_eq!(server.pressed_keys(), [0; 0], "{round}");
}

#[test]
fn presses_that_wait_for_a_server_that_hangs_are_not_sent_after_a_pause() {
    repeat(|| {
        let Some(server) = XServer::start() else {
            return true;
        };
        let window = InputWindow::open(&server);
        let mut run = Armed::start(&server);
        window.pressed_keys();
        server.freeze();
        run.type_and_wait();
        run.program.signal(&["USR1"]);
        run.program.wait_for_line("paused by a signal", 1);
        server.thaw();
        let have_waited = run.reports_dropped_presses();
        run.program.signal(&["TERM"]);
        assert_eq!(run.program.wait_for_exit().code(), Some(0));
        assert_eq!(window.pressed_keys(), [0; 0]);
        assert_eq!(server.pressed_keys(), [0; 0]);
        have_waited
    });
}

#[test]
fn presses_that_a_server_accepts_too_late_are_dropped_and_reported_once() {
    repeat(|| {
        let Some(server) = XServer::start() else {
            return true;
        };
        let mut run = Armed::start(&server);
        let log = KeyLog::start(&server);
        server.freeze();
        run.type_and_wait();
        let sent = log.len();
        server.thaw();
        run.reports_dropped_presses();
        run.program.signal(&["TERM"]);
        assert_eq!(run.program.wait_for_exit().code(), Some(0));
        // The first press was on its way.
        assert!(log.presses_after(sent) <= 1, "{:?}", log.events());
        let reports = run.program.count_lines(DROPPED);
        let is_shown = run.reports_dropped_presses();
        assert!(reports == 1 || !is_shown, "{reports} reports");
        is_shown
    });
}
