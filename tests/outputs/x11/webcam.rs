//! A hand in front of a webcam: `ademan webcam` with the bridge, on recorded results of a real hand.

use std::fs;
use std::path::Path;
use std::process::Command;
use std::time::Duration;

use tempfile::TempDir;

use crate::support::key_log::{Action, Input, KeyLog};
use crate::support::program::Program;
use crate::support::x11::{TerminalWindow, XServer, wait_at_most, wait_for};

/// Attempts: a machine that is busy for a second stalls the session, which releases everything.
const ATTEMPTS: usize = 3;

/// Writes the results of the hand of `tests/support/webcam_hand.py`; prints SKIPPED without Python.
fn film(folder: &TempDir, arguments: &[&str]) -> Option<String> {
    let script = concat!(env!("CARGO_MANIFEST_DIR"), "/tests/support/webcam_hand.py");
    let film = Command::new("python3").arg(script).args(arguments).output();
    let Ok(film) = film else {
        println!("SKIPPED: there is no python3");
        return None;
    };
    assert!(film.status.success(), "{film:?}");
    let path = folder.path().join("film.json");
    fs::write(&path, film.stdout).expect("a new file");
    Some(path.to_str().expect("a path in UTF-8").to_owned())
}

/// Starts `ademan webcam` with a film. A busy machine must not cause a stall.
fn start(server: &XServer, folder: &Path, film: &str, arguments: &[&str]) -> Program {
    let setup = folder.join("setup.ron");
    fs::write(&setup, "Setup(stall_timeout_ms: 5000)").expect("a new file");
    let setup = setup.to_str().expect("a path in UTF-8");
    let fixed = ["webcam", setup, "--results", film, "--output", "desktop"];
    Program::start(server, fixed.iter().chain(arguments))
}

#[test]
fn a_hand_in_front_of_a_webcam_moves_clicks_and_drags_and_rests_as_a_fist() {
    let folder = tempfile::tempdir().expect("a folder");
    let Some(film) = film(&folder, &["mouse"]) else {
        return;
    };
    let mut last = Vec::new();
    for _ in 0..ATTEMPTS {
        let Some(server) = XServer::start() else {
            return;
        };
        let log = KeyLog::start(&server);
        let before = server.pointer();
        let layout = ["--layout", "webcam-mouse"];
        let mut program = start(&server, folder.path(), &film, &layout);
        wait_for(|| log.len() >= 6 || !program.is_running());
        let clicked = server.pointer();
        wait_for(|| !program.is_running());
        let after = server.pointer();
        let events: Vec<_> = log
            .events()
            .iter()
            .map(|it| (it.input, it.action))
            .collect();
        let press = |action| (Input::Button(1), action);
        let expected = [press(Action::Press), press(Action::Release)].repeat(3);
        last = program.stderr_lines();
        last.push(format!("{before:?} {clicked:?} {after:?} {events:?}"));
        // To the right, a drag down, and nothing of the way back.
        let is_moved = clicked.0 > before.0 + 60 && clicked.1 > before.1 + 40;
        if events == expected && is_moved && after == clicked {
            assert!(
                last.iter().any(|line| line.contains("hold your hand open")),
                "{last:#?}"
            );
            return;
        }
    }
    panic!("{last:#?}");
}

#[test]
fn a_hand_in_front_of_a_webcam_types_into_a_terminal() {
    let folder = tempfile::tempdir().expect("a folder");
    // H and I on the board.
    let Some(film) = film(&folder, &["type", "12,0", "60,24"]) else {
        return;
    };
    let mut last = Vec::new();
    for _ in 0..ATTEMPTS {
        let Some(server) = XServer::start() else {
            return;
        };
        let Some(terminal) = TerminalWindow::start(&server) else {
            return;
        };
        let layout = ["--layout", "webcam-qwerty"];
        let mut program = start(&server, folder.path(), &film, &layout);
        wait_for(|| !program.is_running());
        // The terminal may be late with what it received.
        let is_typed = wait_at_most(Duration::from_secs(5), || terminal.typed("") == "hi");
        last = program.stderr_lines();
        last.push(terminal.typed(""));
        if is_typed {
            assert_eq!(server.pressed_keys(), [0; 0]);
            return;
        }
    }
    panic!("{last:#?}");
}
