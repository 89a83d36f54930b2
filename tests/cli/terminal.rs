//! The demo in a terminal, which `script` of util-linux provides.
#![cfg(target_os = "linux")]

use std::fs;
use std::io::{ErrorKind, Read, Write};
use std::path::{Path, PathBuf};
use std::process::{Child, ChildStdout, Command, Stdio};
use std::sync::mpsc;
use std::thread;
use std::time::{Duration, Instant};

use crate::support::process::signal;
use crate::support::x11::wait_for;

const ENTER_ALTERNATE_SCREEN: &str = "\x1b[?1049h";
const LEAVE_ALTERNATE_SCREEN: &str = "\x1b[?1049l";
const SHOW_CURSOR: &str = "\x1b[?25h";
const CTRL_C: &[u8] = b"\x03";

/// Runs a demo in a terminal, optionally until Ctrl-C, and returns its output and exit code.
fn demo_in_a_terminal(arguments: &str, interrupt: bool) -> Option<(String, Option<i32>)> {
    // The pseudo-terminal of `script` has no size.
    let demo = format!(
        "stty rows 30 columns 100; exec {} demo {arguments}",
        env!("CARGO_BIN_EXE_ademan")
    );
    let spawned = Command::new("script")
        .args(["--quiet", "--return", "--command", &demo, "/dev/null"])
        .env("TERM", "xterm-256color")
        .env("LC_ALL", "C.UTF-8")
        .env("SHELL", "/bin/sh")
        .stdin(Stdio::piped())
        .stdout(Stdio::piped())
        .spawn();
    let mut script = match spawned {
        Err(error) if error.kind() == ErrorKind::NotFound => {
            println!("SKIPPED: `script` of util-linux is not installed");
            return None;
        }
        spawned => spawned.unwrap(),
    };
    let mut keyboard = script.stdin.take().unwrap();
    let mut screen = script.stdout.take().unwrap();
    let (shown, pieces) = mpsc::channel();
    std::thread::spawn(move || {
        let mut buffer = [0; 4096];
        while let Ok(length @ 1..) = screen.read(&mut buffer) {
            let _ = shown.send(buffer[..length].to_vec());
        }
    });
    let mut all = Vec::new();
    let mut is_interrupted = !interrupt;
    for piece in pieces {
        all.extend(piece);
        let draws = String::from_utf8_lossy(&all).contains("running");
        if draws && !is_interrupted {
            keyboard.write_all(CTRL_C).unwrap();
            keyboard.flush().unwrap();
            is_interrupted = true;
        }
    }
    let status = script.wait().unwrap();
    Some((String::from_utf8_lossy(&all).into_owned(), status.code()))
}

/// Returns the output after the pictures; asserts that there were some.
fn after_pictures(shown: &str) -> &str {
    assert!(shown.contains(ENTER_ALTERNATE_SCREEN), "{shown:?}");
    let (pictures, after) = shown
        .rsplit_once(LEAVE_ALTERNATE_SCREEN)
        .expect("the terminal is restored");
    assert!(pictures.contains('┌'), "{pictures:?}");
    assert!(
        shown.rfind(SHOW_CURSOR) > shown.rfind("\x1b[?25l"),
        "{shown:?}"
    );
    after
}

#[test]
fn the_demo_draws_and_restores_the_terminal() {
    let Some((shown, code)) = demo_in_a_terminal("--text a", false) else {
        return;
    };
    assert_eq!(code, Some(0), "{shown}");
    assert!(
        after_pictures(&shown).contains("typed      \"a\""),
        "{shown}"
    );
}

#[test]
fn ctrl_c_ends_the_demo_and_restores_the_terminal() {
    let Some((shown, code)) = demo_in_a_terminal("", true) else {
        return;
    };
    assert_eq!(code, Some(1), "{shown}");
    assert!(
        after_pictures(&shown).contains("interrupted before the end"),
        "{shown}"
    );
}

#[test]
fn a_transcript_on_the_terminal_is_not_drawn_over() {
    let Some((shown, code)) = demo_in_a_terminal("--text a --output transcript", false) else {
        return;
    };
    assert_eq!(code, Some(0), "{shown}");
    assert!(shown.contains("down A"), "{shown}");
    assert!(!shown.contains(ENTER_ALTERNATE_SCREEN), "{shown}");
}

/// A demo in a terminal of its own, from the moment at which it draws.
struct RunningDemo {
    script: Child,
    /// The terminal is not read any more.
    _screen: ChildStdout,
    /// The id of the process of the demo.
    process: String,
}

/// Starts a demo with these arguments. Returns `None` without the program `script`.
fn start_demo(folder: &Path, arguments: &str) -> Option<RunningDemo> {
    let process_id = folder.join("id");
    let demo = format!(
        "stty rows 30 columns 100; echo $$ > {}; exec {} demo {arguments}",
        process_id.display(),
        env!("CARGO_BIN_EXE_ademan")
    );
    let spawned = Command::new("script")
        .args(["--quiet", "--command", &demo, "/dev/null"])
        .env("TERM", "xterm-256color")
        .env("LC_ALL", "C.UTF-8")
        .env("SHELL", "/bin/sh")
        .env("TMPDIR", folder)
        .stdin(Stdio::piped())
        .stdout(Stdio::piped())
        .spawn();
    let mut script = match spawned {
        Err(error) if error.kind() == ErrorKind::NotFound => {
            println!("SKIPPED: `script` of util-linux is not installed");
            return None;
        }
        spawned => spawned.unwrap(),
    };
    let mut screen = script.stdout.take().unwrap();
    let mut shown = Vec::new();
    while !String::from_utf8_lossy(&shown).contains("running") {
        let mut buffer = [0; 4096];
        let length = screen.read(&mut buffer).unwrap();
        assert!(length > 0, "{}", String::from_utf8_lossy(&shown));
        shown.extend(&buffer[..length]);
    }
    let process = fs::read_to_string(&process_id).unwrap();
    fs::remove_file(process_id).unwrap();
    Some(RunningDemo {
        script,
        _screen: screen,
        process: process.trim().to_owned(),
    })
}

#[test]
fn closing_the_terminal_ends_the_demo_and_removes_its_serial_port() {
    let folder = tempfile::tempdir().unwrap();
    let ports = || fs::read_dir(&folder).unwrap().count();
    let Some(mut demo) = start_demo(folder.path(), "") else {
        return;
    };
    assert_eq!(ports(), 1);
    demo.script.kill().unwrap();
    demo.script.wait().unwrap();
    assert!(ends(&demo.process), "the demo goes on without a terminal");
    assert_eq!(ports(), 0);
}

/// Waits until a process has ended. Returns `false` after 60 s.
pub fn ends(process: &str) -> bool {
    let status = format!("/proc/{process}/stat");
    // An ended process whose parent is gone may stay as a zombie.
    let has_ended = || fs::read_to_string(&status).map_or(true, |status| status.contains(") Z "));
    wait_for(has_ended)
}

/// Waits until the thread that draws has written nothing for 1 s.
fn wait_until_blocked(process: &str) {
    let threads = fs::read_dir(format!("/proc/{process}/task")).unwrap();
    let is_screen = |folder: &PathBuf| {
        let name = fs::read_to_string(folder.join("comm"));
        name.is_ok_and(|name| name == "view\n")
    };
    let mut folders = threads.map(|thread| thread.unwrap().path());
    let io = folders
        .find(is_screen)
        .expect("a thread that draws")
        .join("io");
    let written = || {
        let counters = fs::read_to_string(&io).unwrap();
        let mut lines = counters.lines().map(str::to_owned);
        // Attempts that write nothing are counted elsewhere.
        lines.find(|line| line.starts_with("wchar:")).unwrap()
    };
    let start = Instant::now();
    let mut before = String::new();
    while start.elapsed() < Duration::from_secs(60) {
        let now = written();
        if now == before {
            return;
        }
        before = now;
        thread::sleep(Duration::from_secs(1));
    }
    panic!("the view is still drawn: {before}");
}

#[test]
fn one_signal_ends_the_demo_in_a_terminal_that_accepts_nothing() {
    let folder = tempfile::tempdir().unwrap();
    let text = format!("--text '{}'", "a long text ".repeat(40));
    let Some(mut demo) = start_demo(folder.path(), &text) else {
        return;
    };
    // After Ctrl-S the terminal passes on nothing more, and fills.
    signal("STOP", demo.script.id());
    wait_until_blocked(&demo.process);
    signal("INT", demo.process.parse().unwrap());
    let has_ended = ends(&demo.process);
    demo.script.kill().unwrap();
    demo.script.wait().unwrap();
    assert!(has_ended, "the demo waits for its terminal");
}
