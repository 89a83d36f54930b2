//! What no program can do for itself: its guardian lets go when it is killed, stopped or broken.

use std::fs;
use std::path::{Path, PathBuf};
use std::time::{Duration, Instant};

use super::ends::{Typing, held_keys};
use super::{hold, wait_for_release};
use crate::support::glove::Glove;
use crate::support::press::{Press, x11_code};
use crate::support::program::Program;
use crate::support::x11::{InputWindow, XServer, wait_for};

impl Typing {
    /// The process that the program has started.
    fn guardian(&self) -> u32 {
        let mut found = None;
        let is_there = || {
            found = self
                .program
                .children()
                .into_iter()
                .find(|child| is_alive(*child));
            found.is_some()
        };
        assert!(wait_for(is_there), "there is no guardian");
        found.expect("it is there")
    }

    /// Ends the program so that it can do nothing any more.
    fn dies_by(mut self, signal: &str) {
        let start = Instant::now();
        self.program.signal(&[signal]);
        wait_for_release(&self.server, start, signal);
        assert_eq!(self.program.wait_for_exit().code(), None, "it was killed");
        self.program.wait_for_line("released its keys (2)", 1);
    }
}

/// The default layout with a text of characters that no keymap has in the place of H.
fn layout_that_writes(folder: &Path) -> PathBuf {
    let path = folder.join("writes.ron");
    let board = include_str!("../../../layouts/keyboards/qwerty-flat.ron");
    let row = "(at_mm: (-90.25, 0), keys: \"A S D F G H J K L Semicolon Quote Backslash\")";
    let rows = "(at_mm: (-90.25, 0), keys: \"A S D F G\"), (at_mm: (23.75, 0), keys: \"J K L\")";
    let text: String = ('ἀ'..).take(32).collect();
    let key = format!("keys: [(action: Text(\"{text}\"), at_mm: (4.75, 0)),");
    let writes = board.replace(row, rows).replace("keys: [", &key);
    assert!(writes.contains(rows) && writes.contains(&key));
    fs::write(&path, writes).expect("room on the disk");
    path
}

#[test]
fn no_character_stays_down_that_was_being_written_when_it_was_killed() {
    let Some(server) = XServer::start() else {
        return;
    };
    let window = InputWindow::open(&server);
    let press = Press::for_text("h");
    for round in 0..8 {
        let folder = tempfile::tempdir().expect("a folder");
        let port = folder.path().join("glove");
        let layout = layout_that_writes(folder.path()).display().to_string();
        let glove = Glove::plug_in(&port, press.clear());
        let source = format!("serial:{}", port.display());
        let run = [
            "run", "--output", "desktop", "--source", &source, "--layout", &layout,
        ];
        let mut program = Program::start(&server, run);
        program.wait_for_line("armed", 1);
        glove.play(&press.approach);
        assert!(window.receives_a_key(), "it writes nothing");
        program.signal(&["KILL"]);
        assert_eq!(program.wait_for_exit().code(), None);
        assert!(
            server.wait_for_keys(&[]),
            "{round}: {:?}",
            server.pressed_keys()
        );
        // The server may still be busy with what it was sent.
        std::thread::sleep(Duration::from_millis(200));
        assert_eq!(server.pressed_keys(), [0; 0], "{round}");
    }
}

fn is_alive(process: u32) -> bool {
    let state = fs::read_to_string(format!("/proc/{process}/stat")).unwrap_or_default();
    !state.is_empty() && !state.contains(") Z")
}

#[test]
fn nothing_is_down_after_it_was_killed() {
    let Some(typing) = Typing::start() else {
        return;
    };
    let guardian = typing.guardian();
    typing.dies_by("KILL");
    assert!(wait_for(|| !is_alive(guardian)), "the guardian stays");
}

#[test]
fn nothing_is_down_after_it_aborted() {
    if let Some(typing) = Typing::start() {
        typing.dies_by("ABRT");
    }
}

#[test]
fn nothing_is_down_after_it_crashed() {
    if let Some(typing) = Typing::start() {
        typing.dies_by("ILL");
    }
}

#[test]
fn nothing_is_down_while_it_is_stopped_and_it_has_to_be_armed_again() {
    let Some(mut typing) = Typing::start() else {
        return;
    };
    let start = Instant::now();
    typing.program.signal(&["STOP"]);
    wait_for_release(&typing.server, start, "STOP");
    typing.program.wait_for_line("does not respond", 1);
    std::thread::sleep(Duration::from_secs(1));
    typing.program.signal(&["CONT"]);
    typing.program.wait_for_line("stalled", 1);
    // The finger is still on the key: that arms nothing, and presses nothing.
    std::thread::sleep(Duration::from_millis(700));
    assert_eq!(typing.server.pressed_keys(), [0; 0]);
    let press = Press::for_text("H");
    typing.glove.play(&press.lift);
    typing.program.wait_for_line("armed", 2);
    hold(&typing.server, &typing.glove, &press, &held_keys());
    typing.program.signal(&["TERM"]);
    assert_eq!(typing.program.wait_for_exit().code(), Some(0));
    assert_eq!(typing.server.pressed_keys(), [0; 0]);
}

#[test]
fn a_guardian_that_is_killed_is_replaced_once_and_the_run_pauses() {
    let Some(mut typing) = Typing::start() else {
        return;
    };
    let first = typing.guardian();
    let start = Instant::now();
    kill(first);
    wait_for_release(&typing.server, start, "guardian killed");
    typing.program.wait_for_line("paused", 2);
    assert!(wait_for(|| !is_alive(first)), "the first one is gone");
    let second = typing.guardian();
    std::thread::sleep(Duration::from_millis(500));
    kill(second);
    let status = typing.program.wait_for_exit();
    assert_eq!(status.code(), Some(1));
    // A busy machine: the second one was killed before it was ready.
    let (again, early) = (
        "the watchdog exited a second time",
        "cannot start the watchdog",
    );
    let said = typing.program.stderr_lines();
    let tells = said
        .iter()
        .any(|line| line.contains(again) || line.contains(early));
    assert!(tells, "{said:#?}");
    assert_eq!(typing.server.pressed_keys(), [0; 0]);
}

#[test]
fn ctrl_z_lets_go_before_it_stops_and_the_hand_has_to_leave_after_it_is_continued() {
    let Some(mut typing) = Typing::start() else {
        return;
    };
    let start = Instant::now();
    typing.program.signal(&["TSTP"]);
    wait_for_release(&typing.server, start, "TSTP");
    let stat = format!("/proc/{}/stat", typing.program.id());
    let is_stopped = || {
        fs::read_to_string(&stat)
            .expect("it is there")
            .contains(") T ")
    };
    assert!(wait_for(is_stopped), "it does not stop");
    assert_eq!(typing.program.count_lines("does not respond"), 0);
    typing.program.signal(&["CONT"]);
    typing.glove.play(&Press::for_text("H").lift);
    typing.program.wait_for_line("armed", 2);
    typing.program.signal(&["TERM"]);
    assert_eq!(typing.program.wait_for_exit().code(), Some(0));
}

#[test]
fn a_signal_pauses_until_somebody_resumes() {
    let Some(mut typing) = Typing::start() else {
        return;
    };
    let start = Instant::now();
    typing.program.signal(&["USR1"]);
    wait_for_release(&typing.server, start, "USR1");
    typing
        .program
        .wait_for_line("paused: everything is released", 1);
    typing.glove.play(&Press::for_text("H").lift);
    std::thread::sleep(Duration::from_millis(800));
    assert_eq!(typing.program.count_lines("armed"), 1);
    typing.program.signal(&["TERM"]);
    assert_eq!(typing.program.wait_for_exit().code(), Some(0));
}

fn kill(process: u32) {
    send("-KILL", process);
}

fn send(signal: &str, process: u32) {
    let status = std::process::Command::new("kill")
        .args([signal, &process.to_string()])
        .status();
    assert!(status.expect("kill is there").success());
}

#[test]
fn requests_to_end_that_reach_the_guardian_too_do_not_end_it_first() {
    let Some(mut typing) = Typing::start() else {
        return;
    };
    let guardian = typing.guardian();
    send("-TERM", guardian);
    std::thread::sleep(Duration::from_millis(200));
    assert!(is_alive(guardian));
    assert_eq!(
        typing.server.pressed_keys(),
        [x11_code("H"), x11_code("ShiftLeft")],
        "{:#?}",
        typing.program.stderr_lines()
    );
    typing.program.signal(&["KILL"]);
    assert!(typing.server.wait_for_keys(&[]));
    assert_eq!(typing.program.wait_for_exit().code(), None);
}
