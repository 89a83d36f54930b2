//! A full disk and a closed log: typing continues, and nothing panics.

use std::fs;
use std::io::ErrorKind;
use std::process::{Command, Stdio};

use crossbeam_channel::RecvTimeoutError;

use crate::support::binary::ademan;
use crate::support::glove::Glove;
use crate::support::process::{Process, signal};
use crate::support::run::{TIMEOUT, line_receiver, postures};
use crate::{Ended, run_to_end};

const TEXT: &str = "typist:hola y adios";

/// Returns `ademan` in a shell that runs the commands `before` first.
fn in_shell(shell: &str, before: &str, arguments: &[&str]) -> Command {
    let program = ademan(arguments);
    let mut command = Command::new(shell);
    let script = format!("{before} exec \"$0\" \"$@\"");
    // The arguments before the last ones start the script.
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

/// Runs the program after the commands `before` of a shell.
fn run_after(before: &str, arguments: &[&str]) -> Ended {
    run_to_end(&mut in_shell("sh", before, arguments))
}

/// Returns the events of a run without faults.
fn events_without_faults() -> String {
    events(&run_after("", &["run", "--source", TEXT]).done())
}

/// Returns the transcript without its times.
fn events(ended: &Ended) -> String {
    let lines = ended.out.lines().filter_map(|line| line.get(13..));
    let lines: Vec<_> = lines.collect();
    assert!(!lines.is_empty(), "{}", ended.err);
    lines.join("\n")
}

#[test]
fn a_full_closed_or_missing_log_does_not_stop_a_session() {
    let expected = events_without_faults();
    for stderr in ["2>/dev/full", "2>&-", "2>/dev/null"] {
        let ended = run_after(&format!("exec {stderr};"), &["run", "--source", TEXT]);
        assert_eq!(ended.code, Some(0), "{stderr}");
        assert_eq!(events(&ended), expected, "{stderr}");
    }
}

#[test]
fn a_log_that_the_disk_has_no_room_for_is_reported_once_and_the_session_goes_on() {
    let folder = tempfile::tempdir().expect("a folder");
    let log = folder.path().join("ademan.log");
    let log = log.to_str().expect("a path");
    // As on a disk that is full.
    let before = "trap '' XFSZ; ulimit -f 0;";
    let ended = run_after(before, &["run", "--source", TEXT, "--log", log]).done();
    let err = &ended.err;
    assert_eq!(events(&ended), events_without_faults(), "{err}");
    let expected = format!("the log {log} is incomplete: File too large");
    assert_eq!(err.matches(&expected).count(), 1, "{err}");
}

#[test]
fn a_transcript_that_cannot_be_written_ends_the_session_with_the_reason() {
    let ended = run_after("exec >/dev/full;", &["run", "--source", TEXT]).exited(1);
    ended.reported("No space left");
    assert!(!ended.err.contains("panicked"), "{}", ended.err);
}

#[test]
fn a_standard_output_that_is_full_is_named() {
    let folder = tempfile::tempdir().expect("a folder");
    let file = folder.path().join("list");
    let limited = format!("trap '' XFSZ; ulimit -f 0; exec >'{}';", file.display());
    for before in ["exec >/dev/full;", &limited] {
        let ended = run_after(before, &["layout", "list"]).exited(1);
        ended.reported("cannot write to the standard output: ");
    }
}

#[test]
fn a_disk_that_fills_under_a_recording_ends_the_recording_and_not_the_typing() {
    let expected = events_without_faults();
    let folder = tempfile::tempdir().expect("a folder");
    let path = folder.path().display();
    // A file system that only the program and its children see.
    let before = format!("mount -t tmpfs -o size=96k none {path} || exit 77;");
    let recording = folder.path().join("run.mcap");
    let recording = recording.to_str().expect("a plain path");
    let arguments = ["run", "--source", TEXT, "--record", recording];
    let ended = match in_shell("unshare", &before, &arguments).output() {
        Err(error) if error.kind() == ErrorKind::NotFound => {
            println!("SKIPPED: no file system of its own: {error}");
            return;
        }
        output => Ended::from(output.expect("the program starts")),
    };
    if ended.code == Some(77) || ended.err.starts_with("unshare:") {
        println!("SKIPPED: no file system of its own: {}", ended.err);
        return;
    }
    assert_eq!(events(&ended), expected, "{}", ended.err);
    let ended = ended.exited(1);
    ended.reported("No space left");
    assert!(!ended.err.contains("panicked"), "{}", ended.err);
    assert!(
        fs::read_dir(folder.path())
            .expect("the folder")
            .next()
            .is_none()
    );
}

#[test]
fn a_disk_that_fills_is_reported_at_once_and_in_the_state_while_the_typing_goes_on() {
    let folder = tempfile::tempdir().expect("a folder");
    let disk = folder.path().join("disk");
    fs::create_dir(&disk).expect("a folder");
    let before = format!(
        "mount -t tmpfs -o size=256k none {} || exit 77;",
        disk.display()
    );
    let (recording, socket) = (disk.join("run.mcap"), folder.path().join("c.sock"));
    let (recording, socket) = (recording.to_str(), socket.to_str());
    let (recording, socket) = (recording.expect("a path"), socket.expect("a path"));
    // Typing continues until the test ends it.
    let text = format!("typist:{}", "hola y adios ".repeat(200));
    let arguments = [
        "run",
        "--source",
        &text,
        "--record",
        recording,
        "--control",
        socket,
    ];
    let mut command = in_shell("unshare", &before, &arguments);
    command.stdout(Stdio::piped()).stderr(Stdio::piped());
    let mut run = match Process::start(&mut command) {
        Err(error) => {
            println!("SKIPPED: no file system of its own: {error}");
            return;
        }
        Ok(run) => run,
    };
    let out = line_receiver(run.0.stdout.take().expect("it is piped"));
    let err = line_receiver(run.0.stderr.take().expect("it is piped"));
    let mut messages = Vec::new();
    let notice = loop {
        let line = match err.recv_timeout(TIMEOUT) {
            Ok(line) => line,
            Err(RecvTimeoutError::Timeout) => panic!("no notice: {messages:#?}"),
            Err(RecvTimeoutError::Disconnected) => {
                let code = run.0.wait().expect("it has ended").code();
                let is_refused = messages
                    .iter()
                    .any(|line: &String| line.starts_with("unshare:"));
                assert!(is_refused || code == Some(77), "no notice: {messages:#?}");
                println!("SKIPPED: no file system of its own: {messages:?}");
                return;
            }
        };
        if line.contains("incomplete") {
            break line;
        }
        messages.push(line);
    };
    assert!(notice.contains("No space left"), "{notice}");
    assert!(notice.contains("the session continues"), "{notice}");
    out.try_iter().for_each(drop);
    for _ in 0..4 {
        out.recv_timeout(TIMEOUT).expect("typing goes on");
    }
    let state = |request: &[&str]| {
        let state = ademan([&["ctl", "--socket", socket], request].concat()).output();
        String::from_utf8(state.expect("the program starts").stdout).expect("UTF-8")
    };
    let line = state(&["state"]);
    assert!(line.contains("\nfiles      the recording"), "{line}");
    let json = state(&["state", "--json"]);
    assert!(json.contains("\"incomplete\":[\"the recording"), "{json}");
    signal("INT", run.0.id());
    let mut last = notice;
    while let Ok(message) = err.recv_timeout(TIMEOUT) {
        last = message;
    }
    assert!(last.contains("No space left"), "{last}");
    assert_eq!(run.0.wait().expect("it ends").code(), Some(1));
}

#[test]
fn a_recording_that_cannot_be_started_leaves_no_file_that_refuses_the_next_one() {
    let folder = tempfile::tempdir().expect("a folder");
    let [recording, poses] = ["run.mcap", "run.bvh"].map(|name| folder.path().join(name));
    let path = recording.to_str().expect("a path");
    let refused = |before: &str, arguments: &[&str]| {
        let ended = run_after(before, arguments).exited(2);
        ended.reported("cannot create the recording");
        assert!(!recording.exists(), "{}", ended.err);
    };
    let record = ["record", path, "--source", "typist:h"];
    // As on a disk that is full.
    refused("trap '' XFSZ; ulimit -f 1;", &record);
    fs::write(&poses, "mine").expect("a file");
    let poses = ["--record-bvh", poses.to_str().expect("a path")];
    let run = ["run", "--source", "typist:h", "--record", path];
    refused("", &[&run[..], &poses].concat());
    // One file under one name, and under two.
    let name = folder.path().file_name().expect("a name");
    let again = folder.path().join("..").join(name).join("run.mcap");
    for same in [path, again.to_str().expect("a path")] {
        refused("", &[&run[..], &["--record-bvh", same]].concat());
    }
}

#[test]
fn a_recording_that_cannot_be_completed_is_reported_beside_the_failure_of_the_source() {
    let folder = tempfile::tempdir().expect("a folder");
    let [poses, recording] = ["hand.bvh", "run.mcap"].map(|name| folder.path().join(name));
    let (poses, path) = (poses.to_str(), recording.to_str());
    let (poses, path) = (poses.expect("a path"), path.expect("a path"));
    let typed = ["run", "--source", "typist:h", "--output", "none"];
    run_after("", &[&typed[..], &["--record-bvh", poses]].concat()).done();
    let text = fs::read_to_string(poses).expect("a file");
    let last = text.trim_end().rfind('\n').expect("lines");
    fs::write(poses, format!("{}\nno number\n", &text[..last])).expect("a file");
    let source = format!("file:{poses}?protocol=bvh");
    let damaged = ["run", "--source", &source, "--layout", "webcam-qwerty"];
    let recorded = [&damaged[..], &["--output", "none", "--record", path]].concat();
    run_after("", &recorded).exited(3);
    let bytes = fs::metadata(path).expect("a recording").len();
    fs::remove_file(path).expect("a recording");
    // As on a disk that is full when the recording is completed.
    let before = format!("trap '' XFSZ; ulimit -f {};", (bytes - 4096) / 512);
    let full = run_after(&before, &recorded).exited(3);
    full.reported("is incomplete: File too large");
}

#[test]
fn a_recording_that_cannot_be_written_ends_a_command_that_only_records() {
    let folder = tempfile::tempdir().expect("a folder");
    let [port, recording] = ["port", "run.mcap"].map(|name| folder.path().join(name));
    let (clear, _) = postures();
    let _glove = Glove::plug_in(&port, clear);
    let source = format!("serial:{}", port.display());
    let recording = recording.to_str().expect("a path");
    let short = ["record", recording, "--source", "typist:h"];
    let recorded = in_shell("sh", "", &short).status();
    assert!(recorded.expect("the program starts").success());
    let bytes = fs::metadata(recording).expect("a recording").len();
    fs::remove_file(recording).expect("a recording");
    // As on a disk that is full when the next recording is as long.
    let before = format!("trap '' XFSZ; ulimit -f {};", bytes / 512);
    let arguments = ["record", recording, "--source", &source];
    let mut command = in_shell("sh", &before, &arguments);
    command.stdout(Stdio::null()).stderr(Stdio::piped());
    let mut run = Process::start(&mut command).expect("the program starts");
    let err = line_receiver(run.0.stderr.take().expect("it is piped"));
    let mut messages = Vec::new();
    loop {
        match err.recv_timeout(TIMEOUT) {
            Ok(message) => messages.push(message),
            Err(RecvTimeoutError::Timeout) => panic!("it goes on: {messages:#?}"),
            Err(RecvTimeoutError::Disconnected) => break,
        }
    }
    assert_eq!(run.0.wait().expect("it ends").code(), Some(1));
    let last = messages.last().expect("a reason");
    assert!(last.starts_with("error: "), "{messages:#?}");
    assert!(last.contains("File too large"), "{messages:#?}");
    assert!(!last.contains("continues"), "{messages:#?}");
}

#[test]
fn an_export_that_the_disk_has_no_room_for_leaves_no_file_that_refuses_the_next_one() {
    let state = tempfile::tempdir().expect("a folder");
    let csv = state.path().join("progress.csv");
    let export = ["practice", "--csv", csv.to_str().expect("a path")];
    let practice = |before: &str, arguments: &[&str]| {
        let before = format!(
            "export XDG_STATE_HOME='{}'; {before}",
            state.path().display()
        );
        run_after(&before, arguments)
    };
    practice("", &["practice", "--text", "h"]).done();
    let history = state.path().join("ademan/practice/sessions.jsonl");
    let result = fs::read_to_string(&history).expect("a result");
    fs::write(&history, result.repeat(40)).expect("results");
    // As on a disk that is full.
    let full = practice("trap '' XFSZ; ulimit -f 1;", &export).exited(2);
    full.reported("File too large");
    assert!(!csv.exists(), "{}", full.err);
    practice("", &export).done();
}

#[test]
fn uinput_without_a_device_node_or_permission_is_refused_with_a_remedy() {
    if fs::metadata("/dev/uinput").is_ok() {
        println!("SKIPPED: /dev/uinput exists");
        return;
    }
    for output in ["uinput", "desktop,uinput"] {
        let arguments = ["run", "--source", TEXT, "--output", output];
        let Ended { out, err, .. } = run_after("", &arguments).exited(2);
        assert_eq!(out, "");
        assert_eq!(err.contains("modprobe uinput"), output == "uinput", "{err}");
    }
}
