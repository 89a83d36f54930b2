//! A watchdog that is lost: the program releases its keys, pauses and replaces it.

use std::fs;
use std::path::Path;
use std::process::Command;
use std::time::{Duration, Instant};

use super::ends::{Typing, held_keys};
use super::watchdog::is_alive;
use super::{hold, wait_for_release};
use crate::support::binary::{ademan, copy_binary};
use crate::support::glove::Glove;
use crate::support::press::Press;
use crate::support::process::signal;
use crate::support::program::Program;
use crate::support::x11::{XServer, wait_at_most, wait_for};

/// Longest time for the notice of a stopped watchdog on a busy machine. Without replies to heartbeats it is noticed when
/// its socket is full, after 14 s.
const NOTICE_TIMEOUT: Duration = Duration::from_secs(12);

#[test]
fn a_killed_watchdog_is_restarted_once_and_the_run_pauses() {
    let Some(mut typing) = Typing::start() else {
        return;
    };
    let first = typing.watchdog();
    let log = typing.log();
    let start = Instant::now();
    signal("KILL", first);
    wait_for_release(&typing.server, start, "watchdog killed");
    typing.program.wait_for_line("paused", 2);
    assert!(
        wait_for(|| !is_alive(first)),
        "the first watchdog still runs"
    );
    let second = typing.watchdog();
    std::thread::sleep(Duration::from_millis(500));
    signal("KILL", second);
    let status = typing.program.wait_for_exit();
    assert_eq!(status.code(), Some(1));
    // On a busy machine the second watchdog is killed before it is ready.
    let (again, early) = (
        "the watchdog was lost a second time",
        "cannot start the watchdog",
    );
    let lines = typing.program.stderr_lines();
    let is_reported = lines
        .iter()
        .any(|line| line.contains(again) || line.contains(early));
    assert!(is_reported, "{lines:#?}");
    assert_eq!(typing.server.pressed_keys(), [0; 0]);
    log.assert_no_press();
}

#[test]
fn a_stopped_watchdog_is_noticed_and_replaced() {
    let Some(mut typing) = Typing::start() else {
        return;
    };
    let first = typing.watchdog();
    let log = typing.log();
    let start = Instant::now();
    signal("STOP", first);
    let is_released = || typing.server.pressed_keys().is_empty();
    assert!(wait_at_most(NOTICE_TIMEOUT, is_released));
    println!(
        "released {:.1?} after the watchdog was stopped",
        start.elapsed()
    );
    typing.program.wait_for_line("paused", 2);
    assert!(wait_for(|| !is_alive(first)), "the first watchdog exists");
    assert_ne!(typing.watchdog(), first);
    typing.program.signal(&["TERM"]);
    assert_eq!(typing.program.wait_for_exit().code(), Some(0));
    assert_eq!(typing.server.pressed_keys(), [0; 0]);
    log.assert_no_press();
}

/// Returns the command of a copy of the program.
pub fn copied(program: &Path, arguments: &[&str]) -> Command {
    let original = ademan(arguments);
    copy_binary(program);
    let mut command = Command::new(program);
    command.args(original.get_args());
    command
}

#[test]
fn the_watchdog_is_replaced_when_the_file_of_the_program_has_changed() {
    let Some(server) = XServer::start() else {
        return;
    };
    let press = Press::for_text("H");
    let (folder, glove, source) = Glove::in_new_folder(press.clear());
    let file = folder.path().join("ademan");
    let run = [
        "run",
        "--output",
        "desktop",
        "--source",
        &source,
        "--control",
    ];
    let socket = folder.path().join("control").display().to_string();
    let mut command = copied(&file, &[&run[..], &[&socket]].concat());
    command
        .env("DISPLAY", server.display())
        .env_remove("WAYLAND_DISPLAY");
    let mut program = Program::from_command(command);
    program.wait_for_line("armed", 1);
    hold(&server, &program, &glove, &press, &held_keys());
    fs::remove_file(&file).expect("the file exists");
    fs::write(&file, "#!/bin/sh\nexit 1\n").expect("space on the disk");
    let first = *program.children().first().expect("a watchdog");
    signal("KILL", first);
    assert!(server.wait_for_keys(&[]));
    program.wait_for_line("paused", 2);
    let is_replaced = || {
        let mut children = program.children().into_iter();
        children.any(|child| child != first && is_alive(child))
    };
    assert!(wait_for(is_replaced), "{:#?}", program.stderr_lines());
    glove.play(&press.lift);
    let mut ctl = ademan(["ctl", "--socket", &socket, "resume"]);
    assert!(ctl.status().expect("the program starts").success());
    program.wait_for_line("armed", 2);
    hold(&server, &program, &glove, &press, &held_keys());
    program.signal(&["KILL"]);
    assert!(server.wait_for_keys(&[]));
    assert_eq!(program.wait_for_exit().code(), None);
}
