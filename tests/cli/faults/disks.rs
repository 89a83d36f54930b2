//! A disk that is full and a log that nobody takes: typing goes on, and nobody panics.

use std::fs;
use std::io::ErrorKind;
use std::process::{Command, Output, Stdio};

use crate::support::binary::ademan;

const TEXT: &str = "typist:hola y adios";

/// `ademan` in a shell that does something with its files first.
fn in_shell(shell: &str, before: &str, arguments: &[&str]) -> Command {
    let program = ademan(arguments);
    let mut command = Command::new(shell);
    let script = format!("{before} exec \"$0\" \"$@\"");
    // What stands before the last words is how to start the script.
    match shell {
        "sh" => command.args(["-c", &script]),
        _ => command.args(["--mount", "sh", "-c", &script]),
    };
    command
        .arg(program.get_program())
        .args(program.get_args())
        .env_remove("XDG_RUNTIME_DIR")
        .env_remove("DISPLAY")
        .stdin(Stdio::null());
    command
}

/// What a run writes that has all it needs.
fn undisturbed() -> String {
    let output = in_shell("sh", "", &["run", "--source", TEXT]).output();
    let output = output.expect("it starts");
    assert_eq!(output.status.code(), Some(0));
    events(&output)
}

/// The transcript without its times.
fn events(output: &Output) -> String {
    let text = String::from_utf8_lossy(&output.stdout);
    let lines: Vec<_> = text.lines().filter_map(|line| line.get(13..)).collect();
    assert!(!lines.is_empty(), "{output:?}");
    lines.join("\n")
}

#[test]
fn a_log_that_is_full_closed_or_never_was_stops_nobody() {
    let expected = undisturbed();
    for stderr in ["2>/dev/full", "2>&-", "2>/dev/null"] {
        let before = format!("exec {stderr};");
        let output = in_shell("sh", &before, &["run", "--source", TEXT]).output();
        let output = output.expect("it starts");
        assert_eq!(output.status.code(), Some(0), "{stderr}");
        assert_eq!(events(&output), expected, "{stderr}");
    }
}

#[test]
fn a_transcript_that_cannot_be_written_ends_the_run_with_the_reason() {
    let output = in_shell("sh", "exec >/dev/full;", &["run", "--source", TEXT]).output();
    let output = output.expect("it starts");
    let err = String::from_utf8_lossy(&output.stderr);
    assert_eq!(output.status.code(), Some(1), "{err}");
    assert!(err.contains("No space left"), "{err}");
    assert!(!err.contains("panicked"), "{err}");
}

#[test]
fn a_disk_that_fills_under_a_recording_ends_the_recording_and_not_the_typing() {
    let expected = undisturbed();
    let folder = tempfile::tempdir().expect("a folder");
    let path = folder.path().display();
    // A disk of its own, which only the program and its children see.
    let before = format!("mount -t tmpfs -o size=64k none {path} || exit 77;");
    let recording = folder.path().join("run.mcap");
    let recording = recording.to_str().expect("a plain path");
    let arguments = ["run", "--source", TEXT, "--record", recording];
    let output = match in_shell("unshare", &before, &arguments).output() {
        Err(error) if error.kind() == ErrorKind::NotFound => {
            println!("SKIPPED: no disk of its own: {error}");
            return;
        }
        output => output.expect("it starts"),
    };
    if output.status.code() == Some(77) || output.stderr.starts_with(b"unshare:") {
        let err = String::from_utf8_lossy(&output.stderr);
        println!("SKIPPED: no disk of its own: {err}");
        return;
    }
    let err = String::from_utf8_lossy(&output.stderr);
    assert_eq!(events(&output), expected, "{err}");
    assert_eq!(output.status.code(), Some(1), "{err}");
    assert!(err.contains("No space left"), "{err}");
    assert!(!err.contains("panicked"), "{err}");
    assert!(
        fs::read_dir(folder.path())
            .expect("the folder")
            .next()
            .is_none()
    );
}

#[test]
fn without_a_node_or_the_right_to_it_uinput_is_refused_with_the_way_to_get_it() {
    if fs::metadata("/dev/uinput").is_ok() {
        println!("SKIPPED: /dev/uinput is there");
        return;
    }
    for output in ["uinput", "desktop,uinput"] {
        let arguments = ["run", "--source", TEXT, "--output", output];
        let ended = in_shell("sh", "", &arguments).output().expect("it starts");
        let err = String::from_utf8_lossy(&ended.stderr);
        assert_eq!(ended.status.code(), Some(2), "{err}");
        assert!(ended.stdout.is_empty());
        assert_eq!(err.contains("modprobe uinput"), output == "uinput", "{err}");
    }
}
