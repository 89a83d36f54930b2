//! Guided calibrations on a terminal that are interrupted: nothing is overwritten, and the terminal is as it was.

use std::fs;
use std::io::Read;
use std::process::{Command, Stdio};
use std::thread;
use std::time::Duration;

use tempfile::TempDir;

use crate::support::glove::Glove;
use crate::support::process::{Process, signal};
use crate::support::run::postures;
use crate::terminal::ends;
use crate::view::{screen::Screen, set_terminal};
use crate::{ademan, text};

/// The content of the file that a calibration would replace.
const PRECIOUS: &str = "precious";

/// Starts a calibration of a simulated person that would replace an existing file.
fn start() -> (TempDir, Screen) {
    let folder = tempfile::tempdir().expect("a folder");
    fs::write(folder.path().join("mine.ron"), PRECIOUS).expect("a file");
    let mut command = ademan(["calibrate", "--demo", "--countdown", "0.5", "--out", "mine"]);
    command.current_dir(folder.path());
    set_terminal(&mut command);
    let screen = Screen::start(&command, 80, 24);
    (folder, screen)
}

/// Returns the number of the pose that is shown.
fn pose(shown: &str) -> Option<u32> {
    let (before, _) = shown.split_once(" of 13")?;
    before.rsplit_once("pose ")?.1.parse().ok()
}

/// Asserts that the folder has only the file that was there before.
fn assert_unchanged(folder: &TempDir) {
    let text = fs::read_to_string(folder.path().join("mine.ron"));
    assert_eq!(text.expect("a file"), PRECIOUS);
    assert_eq!(fs::read_dir(folder.path()).expect("a folder").count(), 1);
}

#[test]
fn ctrl_z_gives_the_terminal_back_and_the_calibration_continues() {
    let (folder, mut screen) = start();
    screen.wait_for_text("pose 3 of 13  ●●▶");
    signal("TSTP", screen.program.0.id());
    screen.wait_for("restored terminal", |screen| {
        !screen.text().contains("pose")
    });
    screen.assert_restored();
    // A calibration that went on would be some poses further.
    thread::sleep(Duration::from_secs(8));
    assert!(!screen.text().contains("pose"), "{}", screen.text());
    signal("CONT", screen.program.0.id());
    let continued = screen.wait_until("all is drawn again", |shown| {
        pose(shown).is_some() && shown.contains("from the side")
    });
    println!("{continued}");
    // A slow machine may have stopped it late.
    assert!(matches!(pose(&continued), Some(3..=5)), "{continued}");
    screen.wait_for_text("replace mine.ron? [y/N]");
    screen.assert_restored();
    screen.type_keys("n\r");
    assert!(screen.wait().success());
    assert!(screen.text().contains("mine.ron is unchanged"));
    let text = fs::read_to_string(folder.path().join("mine.ron"));
    assert_eq!(text.expect("a file"), PRECIOUS);
    // Minutes of poses are not thrown away with the answer.
    assert!(screen.text().contains("kept the readings: mine.mcap"));
    assert!(folder.path().join("mine.mcap").is_file());
}

#[test]
fn a_calibration_whose_terminal_is_full_continues_after_ctrl_z() {
    let folder = tempfile::tempdir().expect("a folder");
    let mut command = ademan(["calibrate", "--demo", "--countdown", "0.5", "--out", "mine"]);
    command.current_dir(folder.path());
    set_terminal(&mut command);
    let mut screen = Screen::start_unread(&command, 200, 60);
    screen.wait_for("full terminal", Screen::is_full);
    signal("TSTP", screen.program.0.id());
    screen.wait_for("stopped program", |stopped| {
        let status = format!("/proc/{}/status", stopped.program.0.id());
        let status = fs::read_to_string(status).expect("a process");
        status.contains("State:\tT")
    });
    screen.read();
    signal("CONT", screen.program.0.id());
    screen.wait_until("all is drawn again", |shown| {
        pose(shown).is_some() && shown.contains("from the side")
    });
    screen.type_keys("q");
    assert_eq!(screen.wait().code(), Some(1));
    screen.assert_restored();
    let shown = screen.text();
    assert!(shown.contains("was ended early"), "{shown}");
}

#[test]
fn a_signal_ends_a_calibration_and_nothing_is_overwritten() {
    for name in ["INT", "TERM", "HUP"] {
        let (folder, mut screen) = start();
        screen.wait_for_text("pose 2 of 13");
        signal(name, screen.program.0.id());
        assert_eq!(screen.wait().code(), Some(1), "{name}");
        screen.assert_restored();
        assert!(screen.text().contains("no file was written"), "{name}");
        assert_unchanged(&folder);
    }
}

#[test]
fn a_glove_that_falls_silent_is_named_until_it_sends_again() {
    let folder = tempfile::tempdir().expect("a folder");
    let port = folder.path().join("port");
    let (clear, _) = postures();
    let glove = Glove::plug_in(&port, clear);
    let source = format!("serial:{}", text(&port));
    let mut command = ademan(["calibrate", "--countdown", "30", "--source", &source]);
    command.args(["--out", "mine"]).current_dir(folder.path());
    set_terminal(&mut command);
    let mut screen = Screen::start(&command, 80, 24);
    screen.wait_for_text("get ready");
    glove.stop_sending();
    screen.wait_for_text("no readings arrive");
    glove.play(&[clear]);
    screen.wait_until("the message is gone", |shown| {
        shown.contains("get ready") && !shown.contains("no readings arrive")
    });
    screen.type_keys("q");
    assert_eq!(screen.wait().code(), Some(1));
    screen.assert_restored();
}

#[test]
fn the_question_is_on_the_terminal_although_the_report_goes_to_a_file() {
    let folder = tempfile::tempdir().expect("a folder");
    fs::write(folder.path().join("mine.ron"), PRECIOUS).expect("a file");
    let calibrate = ademan(["calibrate", "--demo", "--out", "mine"]);
    let mut shell = Command::new("sh");
    shell
        .args(["-c", "\"$@\" > report.txt", "sh"])
        .arg(calibrate.get_program())
        .args(calibrate.get_args())
        .current_dir(folder.path());
    for (name, value) in calibrate.get_envs() {
        match value {
            Some(value) => shell.env(name, value),
            None => shell.env_remove(name),
        };
    }
    let mut screen = Screen::start(&shell, 80, 24);
    screen.wait_for_text("replace mine.ron? [y/N]");
    screen.type_keys("n\r");
    assert!(screen.wait().success());
    let report = fs::read_to_string(folder.path().join("report.txt")).expect("a report");
    assert!(report.contains("mine.ron is unchanged"), "{report}");
    assert!(!report.contains("[y/N]"), "{report}");
    let text = fs::read_to_string(folder.path().join("mine.ron"));
    assert_eq!(text.expect("a file"), PRECIOUS);
}

#[test]
fn ctrl_c_at_the_question_is_a_no() {
    let (folder, mut screen) = start();
    screen.wait_for_text("replace mine.ron? [y/N]");
    screen.type_keys("\x03");
    screen.wait();
    screen.assert_restored();
    assert_unchanged(&folder);
}

#[test]
fn a_window_that_is_too_small_shows_the_calibration_again_once_it_is_enlarged() {
    let (folder, mut screen) = start();
    screen.wait_for_text("pose 2 of 13");
    for (columns, rows) in [(20, 5), (1, 1), (200, 60), (80, 24)] {
        screen.resize(columns, rows);
        thread::sleep(Duration::from_millis(300));
    }
    let shown = screen.wait_for_text("from the side");
    assert!(shown.contains("q quit"), "{shown}");
    screen.type_keys("q");
    assert_eq!(screen.wait().code(), Some(1));
    screen.assert_restored();
    assert_unchanged(&folder);
}

#[test]
fn a_calibration_ends_with_its_terminal() {
    let folder = tempfile::tempdir().expect("a folder");
    fs::write(folder.path().join("mine.ron"), PRECIOUS).expect("a file");
    let id = tempfile::NamedTempFile::new().expect("a file");
    let calibrate = format!(
        "stty rows 24 columns 80; echo $$ > {}; exec {} calibrate --demo --out mine",
        id.path().display(),
        env!("CARGO_BIN_EXE_ademan")
    );
    let mut script = Command::new("script");
    script
        .args(["--quiet", "--command", &calibrate, "/dev/null"])
        .envs([
            ("TERM", "xterm-256color"),
            ("LC_ALL", "C.UTF-8"),
            ("SHELL", "/bin/sh"),
        ])
        .current_dir(folder.path())
        .stdin(Stdio::piped())
        .stdout(Stdio::piped());
    let Ok(mut script) = Process::start(&mut script) else {
        println!("SKIPPED: `script` of util-linux is not installed");
        return;
    };
    let mut screen = script.0.stdout.take().expect("a pipe");
    let mut shown = Vec::new();
    while !String::from_utf8_lossy(&shown).contains("from above") {
        let mut buffer = [0; 4096];
        let length = screen.read(&mut buffer).expect("a pipe");
        assert!(length > 0, "{}", String::from_utf8_lossy(&shown));
        shown.extend(&buffer[..length]);
    }
    let program = fs::read_to_string(id.path()).expect("a file");
    // The window is closed.
    script.0.kill().expect("it runs");
    script.0.wait().expect("it ends");
    assert!(ends(program.trim()), "it goes on without a terminal");
    assert_unchanged(&folder);
}
