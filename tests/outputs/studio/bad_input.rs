//! Desktops and files that Studio cannot use: a message in plain words, and an exit code.

use std::fs;
use std::path::Path;
use std::process::Command;

use super::{is_drawn, is_typing, start_screen, studio};
use crate::support::binary::ademan;
use crate::support::program::Program;

/// Checks that a command exits with code 2 and prints these words, without messages of its libraries.
fn check_refusal(mut command: Command, words: &[&str]) {
    let output = command.output().expect("the program starts");
    let message = String::from_utf8_lossy(&output.stderr);
    assert_eq!(output.status.code(), Some(2), "{message}");
    for word in words {
        assert!(message.contains(word), "{word:?} is missing: {message}");
    }
    for foreign in ["winit", "cargo", "glutin", "EventLoop"] {
        assert!(!message.contains(foreign), "{foreign:?}: {message}");
    }
}

#[test]
fn without_a_desktop_the_reason_and_a_remedy_are_printed() {
    let mut command = ademan(["studio"]);
    command.env_remove("DISPLAY").env_remove("WAYLAND_DISPLAY");
    check_refusal(command, &["there is no desktop", "--view board"]);
}

#[test]
fn a_desktop_that_does_not_answer_is_named() {
    let mut command = ademan(["studio"]);
    command
        .env("DISPLAY", ":9876")
        .env_remove("WAYLAND_DISPLAY");
    check_refusal(command, &["DISPLAY=:9876 does not answer", "--view board"]);
}

#[test]
fn without_opengl_the_reason_and_a_remedy_are_printed() {
    let Some(server) = start_screen() else {
        return;
    };
    let mut command = studio(&server, &["--layout", "qwerty-flat"]);
    command.env("LIBGL_DRIVERS_PATH", "/nowhere");
    check_refusal(command, &["OpenGL", "LIBGL_ALWAYS_SOFTWARE=1"]);
}

/// Copies a part of a recording.
fn cut_recording(folder: &Path) -> String {
    let whole = Path::new(env!("CARGO_MANIFEST_DIR")).join("tests/recordings/hc11.mcap");
    let bytes = fs::read(whole).expect("a recording");
    let path = folder.join("cut.mcap");
    fs::write(&path, &bytes[..bytes.len() / 2]).expect("space on the disk");
    path.display().to_string()
}

#[test]
fn a_recording_that_is_cut_is_shown_up_to_the_cut() {
    let Some(server) = start_screen() else {
        return;
    };
    let folder = tempfile::tempdir().expect("a folder");
    let path = cut_recording(folder.path());
    let mut program = Program::from_command(studio(&server, &["--recording", &path]));
    program.wait_for_line("is truncated at byte", 1);
    assert!(is_drawn(&server), "{:#?}", program.stderr_lines());
    assert!(program.is_running(), "{:#?}", program.stderr_lines());
}

#[test]
fn a_layout_that_breaks_while_it_is_open_stays_active() {
    let Some(server) = start_screen() else {
        return;
    };
    let folder = tempfile::tempdir().expect("a folder");
    let path = folder.path().join("board.ron");
    fs::write(
        &path,
        include_str!("../../../layouts/keyboards/qwerty-flat.ron"),
    )
    .expect("space on the disk");
    let name = path.display().to_string();
    let mut program = Program::from_command(studio(&server, &["--layout", &name]));
    program.wait_for_line("armed", 1);
    assert!(is_drawn(&server), "{:#?}", program.stderr_lines());
    fs::write(&path, "Layout(keys: nonsense").expect("space on the disk");
    program.wait_for_line("board.ron", 1);
    assert!(is_typing(&server), "the hand still types on the old layout");
    assert!(program.is_running(), "{:#?}", program.stderr_lines());
}

/// Keys under the hand, and one that no arm reaches.
const FAR_KEY: &str = r#"Layout(name: "far", boards: [(
    pose: (anchor: elbow, bearing_deg: 35, forward_mm: 300, height_mm: -45),
    keys: [
        (code: "A", at_mm: (-12, 0), size_mm: Box(20, 20)),
        (code: "S", at_mm: (12, 0), size_mm: Box(20, 20)),
        (code: "D", at_mm: (0, 900), size_mm: Box(20, 20)),
    ],
)])"#;

#[test]
fn the_simulated_hand_leaves_out_a_key_beyond_its_reach() {
    let Some(server) = start_screen() else {
        return;
    };
    let folder = tempfile::tempdir().expect("a folder");
    let path = folder.path().join("far.ron");
    fs::write(&path, FAR_KEY).expect("space on the disk");
    let name = path.display().to_string();
    let program = Program::from_command(studio(&server, &["--layout", &name]));
    program.wait_for_line("the simulated hand leaves out `tap D`", 1);
    assert!(is_typing(&server), "{:#?}", program.stderr_lines());
}
