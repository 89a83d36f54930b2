//! Release of keys and buttons at the end of a run, however it ends.

use std::io::Write;
use std::path::{Path, PathBuf};
use std::thread;
use std::time::{Duration, Instant};

use ademan::capture::hc11::{Framing, encode};
use tempfile::TempDir;

use super::{is_held_at_last, start_until, wait_for_release};
use crate::support::glove::Glove;
use crate::support::key_log::KeyLog;
use crate::support::press::{Press, x11_code};
use crate::support::program::Program;
use crate::support::x11::{XServer, wait_at_most, wait_for};

/// A run with a glove whose wearer holds Shift and H.
pub struct Typing {
    pub server: XServer,
    pub program: Program,
    pub glove: Glove,
    _folder: TempDir,
}

/// Returns the codes of these keys.
pub fn held_keys() -> [u16; 2] {
    [x11_code("H"), x11_code("ShiftLeft")]
}

/// Presses these keys. Returns `false` if the run loses its watchdog.
pub fn are_held(server: &XServer, program: &Program, glove: &Glove) -> bool {
    is_held_at_last(server, program, glove, &Press::for_text("H"), &held_keys())
}

impl Typing {
    /// Starts a run and waits until the keys are pressed. Returns `None` without an X server.
    pub fn start() -> Option<Self> {
        start_until(Self::start_armed, |run| {
            are_held(&run.server, &run.program, &run.glove)
        })
    }

    /// Starts a run and waits until it is armed.
    fn start_armed() -> Option<Self> {
        let server = XServer::start()?;
        let press = Press::for_text("H");
        let (folder, glove, source) = Glove::in_new_folder(press.clear());
        let program = run(&server, &source);
        program.wait_for_line("armed", 1);
        Some(Self {
            server,
            program,
            glove,
            _folder: folder,
        })
    }

    /// Starts a log while the keys are pressed. It has no press as long as the finger does not leave its key.
    pub fn log(&self) -> KeyLog {
        KeyLog::start_while_pressed(&self.server, &held_keys())
    }

    /// Ends the run with these signals and returns its exit code.
    fn end_by(mut self, signals: &[&str]) -> Option<i32> {
        let log = self.log();
        let start = Instant::now();
        self.program.signal(signals);
        wait_for_release(&self.server, start, &signals.join(" "));
        let status = self.program.wait_for_exit();
        assert_eq!(self.server.pressed_keys(), [0; 0]);
        log.assert_no_press();
        status.code()
    }

    /// Checks that a fault of the glove releases all keys and presses none, and that the program reports it and waits for the glove.
    fn check_stall(mut self, fault: fn(&mut Glove), message: &str) {
        let log = self.log();
        let start = Instant::now();
        fault(&mut self.glove);
        wait_for_release(&self.server, start, message);
        self.program.wait_for_line(message, 1);
        self.program.wait_for_line("stalled", 1);
        // Noise continues.
        thread::sleep(Duration::from_millis(500));
        assert!(
            self.program.is_running(),
            "{:#?}",
            self.program.stderr_lines()
        );
        self.program.signal(&["TERM"]);
        assert_eq!(self.program.wait_for_exit().code(), Some(0));
        assert_eq!(self.server.pressed_keys(), [0; 0]);
        log.assert_no_press();
    }
}

fn run(server: &XServer, source: &str) -> Program {
    Program::start(server, ["run", "--output", "desktop", "--source", source])
}

/// Creates a file with the bytes of a glove until the key has been pressed for 1 s.
fn file_that_ends_in_a_press() -> (TempDir, PathBuf) {
    let press = Press::for_text("H");
    let folder = tempfile::tempdir().expect("a folder");
    let path = folder.path().join("glove.bytes");
    let mut file = std::fs::File::create(&path).expect("a file");
    let still = std::iter::repeat_n(press.pressed(), 175);
    for posture in press.approach.iter().copied().chain(still) {
        file.write_all(&encode(Framing::Double06, &posture))
            .expect("space on the disk");
    }
    (folder, path)
}

#[test]
fn all_keys_are_released_at_the_end_of_the_stream() {
    let Some(server) = XServer::start() else {
        return;
    };
    let log = KeyLog::start(&server);
    let (_folder, path) = file_that_ends_in_a_press();
    // A busy machine may drop the presses; then the file is read again.
    let is_pressed = (0..5).any(|_| {
        let before = log.len();
        let mut program = run(&server, &format!("file:{}", path.display()));
        let status = program.wait_for_exit();
        assert_eq!(server.pressed_keys(), [0; 0]);
        assert_eq!(status.code(), Some(0), "{:#?}", program.stderr_lines());
        wait_at_most(Duration::from_secs(5), || log.presses_after(before) == 2)
    });
    assert!(is_pressed, "{:?}", log.events());
}

#[test]
fn all_keys_are_released_after_ctrl_c() {
    let Some(typing) = Typing::start() else {
        return;
    };
    assert_eq!(typing.end_by(&["INT"]), Some(0));
}

#[test]
fn all_keys_are_released_after_sigterm() {
    let Some(typing) = Typing::start() else {
        return;
    };
    assert_eq!(typing.end_by(&["TERM"]), Some(0));
}

#[test]
fn all_keys_are_released_after_the_terminal_is_closed() {
    let Some(typing) = Typing::start() else {
        return;
    };
    assert_eq!(typing.end_by(&["HUP"]), Some(0));
}

#[test]
fn all_keys_are_released_after_ctrl_c_twice() {
    let Some(typing) = Typing::start() else {
        return;
    };
    let code = typing.end_by(&["INT", "INT"]);
    assert!(matches!(code, Some(0 | 130)), "{code:?}");
}

#[test]
fn all_keys_are_released_after_two_signals_at_once() {
    let Some(typing) = Typing::start() else {
        return;
    };
    // Both signals are pending while the program is stopped.
    let code = typing.end_by(&["STOP", "INT", "TERM", "CONT"]);
    assert!(matches!(code, Some(0 | 130)), "{code:?}");
}

#[test]
fn all_keys_are_released_after_the_cable_is_pulled() {
    if let Some(typing) = Typing::start() {
        typing.check_stall(Glove::unplug, "; reconnecting");
    }
}

#[test]
fn all_keys_are_released_after_the_glove_stops_sending() {
    if let Some(typing) = Typing::start() {
        typing.check_stall(|glove| glove.stop_sending(), "stalled: no readings");
    }
}

#[test]
fn all_keys_are_released_when_the_glove_sends_noise() {
    if let Some(typing) = Typing::start() {
        typing.check_stall(|glove| glove.send_noise(), "stalled");
    }
}

#[test]
fn a_dead_display_ends_the_run_with_an_error_at_the_next_key() {
    let Some(mut typing) = Typing::start() else {
        return;
    };
    typing.server.kill();
    typing.glove.play(&Press::for_text("H").lift);
    let status = typing.program.wait_for_exit();
    assert_eq!(status.code(), Some(1));
    typing
        .program
        .wait_for_line("error: the output `desktop` failed", 1);
}

/// Writes the default layout with the left mouse button instead of H.
pub fn layout_with_a_button(folder: &Path) -> PathBuf {
    let path = folder.join("button.ron");
    let board = include_str!("../../../layouts/keyboards/qwerty-flat.ron");
    let with_button = board.replace(" G H J ", " G MouseLeft J ");
    assert_ne!(board, with_button);
    std::fs::write(&path, with_button).expect("space on the disk");
    path
}

#[test]
fn all_buttons_are_released_after_sigterm() {
    let Some(server) = XServer::start() else {
        return;
    };
    let press = Press::for_text("h");
    let (folder, glove, source) = Glove::in_new_folder(press.clear());
    let layout = layout_with_a_button(folder.path()).display().to_string();
    let outputs = format!("transcript:{}/record,desktop", folder.path().display());
    let arguments = [
        "run", "--output", &outputs, "--source", &source, "--layout", &layout,
    ];
    let mut program = Program::start(&server, arguments);
    program.wait_for_line("armed", 1);
    let is_held = || {
        glove.play(&press.approach);
        wait_at_most(Duration::from_secs(5), || server.pressed_buttons() == [1])
    };
    assert!(wait_for(is_held), "{:#?}", program.stderr_lines());
    program.signal(&["TERM"]);
    assert_eq!(program.wait_for_exit().code(), Some(0));
    assert_eq!(server.pressed_buttons(), [0; 0]);
    let record = std::fs::read_to_string(folder.path().join("record")).expect("a transcript");
    let events: Vec<_> = record.lines().map(|line| &line[13..]).collect();
    assert_eq!(events.last(), Some(&"up   MouseLeft"), "{events:?}");
}
