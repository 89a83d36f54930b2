//! `ademan run --learned`: what the text decoder knows of the person is read, shown, saved, forgotten and replayed.

use std::fs;
use std::os::unix::fs::PermissionsExt;
use std::process::Stdio;

use crossbeam_channel::Receiver;
use tempfile::TempDir;

use super::{Ended, ademan, run_in};
use crate::control::events_of;
use crate::support::process::Process;
use crate::support::run::{TIMEOUT, line_receiver};

const KNOWN: &str = "Learned(words: [\"Nuria\"], person: (taps: 100, offset_mm: (0.5, -0.25), scatter_mm: (3, 2), correlation: 0))";

/// A run of a simulated hand in a folder of its own, with a control socket.
struct Typing {
    folder: TempDir,
    _program: Process,
    events: Receiver<String>,
}

impl Typing {
    fn start(folder: TempDir, arguments: &[&str]) -> Self {
        let mut command = ademan(["run", "--layout", "qwerty-flat", "--decoder", "auto"]);
        command
            // Longer than the test takes. The person is learned once 60 taps are final.
            .args([
                "--source",
                &format!("typist:{}", "the cat and the dog ran ".repeat(10)),
            ])
            .args(["--control", "c.sock"])
            .args(arguments)
            .current_dir(folder.path())
            .stdout(Stdio::piped())
            .stderr(Stdio::null());
        let mut program = Process::start(&mut command).expect("it starts");
        let events = line_receiver(program.0.stdout.take().expect("it is piped"));
        let typing = Self {
            folder,
            _program: program,
            events,
        };
        while typing.next_line().starts_with('#') {}
        typing
    }

    fn next_line(&self) -> String {
        self.events.recv_timeout(TIMEOUT).expect("a line")
    }

    fn ctl(&self, command: &str) -> Ended {
        let ctl = ["ctl", "--socket", "c.sock", command];
        run_in(self.folder.path(), ctl)
    }

    fn file(&self) -> String {
        fs::read_to_string(self.folder.path().join("me.ron")).expect("the file")
    }
}

fn folder(learned: Option<&str>) -> TempDir {
    let folder = tempfile::tempdir().expect("a folder");
    if let Some(text) = learned {
        fs::write(folder.path().join("me.ron"), text).expect("a file");
    }
    folder
}

#[test]
fn what_was_learned_is_shown_saved_and_forgotten() {
    let typing = Typing::start(folder(Some(KNOWN)), &["--learned", "me.ron"]);
    let state = typing.ctl("state").done().out;
    let expected = "typing     100 taps learned: 0.5 mm right of and -0.3 mm below the centers of keys, scatter 3.0 and 2.0 mm; 1 word of your own";
    assert!(state.contains(expected), "{state}");

    assert_eq!(typing.ctl("save-learned").done().out, "me.ron: saved\n");
    let path = typing.folder.path().join("me.ron");
    let mode = fs::metadata(&path).expect("the file").permissions().mode();
    assert_eq!(mode & 0o777, 0o600);
    assert!(typing.file().contains("\"Nuria\","), "{}", typing.file());
    assert!(
        typing
            .file()
            .contains("taps: 100.0, offset_mm: (0.500, -0.250)")
    );

    typing.ctl("forget-learned").done();
    let forgotten = typing.ctl("state").done().out;
    assert!(
        forgotten.contains("typing     nothing learned yet"),
        "{forgotten}"
    );
    assert!(typing.file().contains("Nuria"), "the file stays");
    typing.ctl("save-learned").done();
    assert!(!typing.file().contains("Nuria"));

    fs::write(&path, KNOWN).expect("a file");
    let refused = typing.ctl("save-learned").exited(1);
    refused.reported("another program has changed the file");
    assert_eq!(typing.file(), KNOWN);
}

#[test]
fn nothing_is_saved_without_a_file_and_a_file_is_made_where_none_was() {
    let plain = Typing::start(folder(None), &[]);
    let refused = plain.ctl("save-learned").exited(1);
    refused.reported("start it with `--learned FILE`");
    drop(plain);

    let first = Typing::start(folder(None), &["--learned", "me.ron"]);
    assert!(!first.folder.path().join("me.ron").exists());
    first.ctl("save-learned").done();
    assert!(first.file().contains("words: []"));
}

#[test]
fn a_file_that_cannot_be_used_is_named_at_the_start() {
    let damaged = folder(Some("Learned(words: [\"Nuria\",\n  person: (taps: -1))"));
    let arguments = ["run", "--source", "typist:a", "--learned", "me.ron"];
    let ended = run_in(damaged.path(), arguments).exited(2);
    ended.reported("me.ron:2:");
    assert!(!ended.err.contains("Nuria"), "{}", ended.err);
    assert_eq!(ended.out, "");
}

#[test]
fn a_replay_reads_slips_to_the_same_words() {
    let folder = folder(Some(KNOWN));
    let setup = "Setup(layout: \"qwerty-flat\", text: (mode: Auto, learned: \"me.ron\"))";
    fs::write(folder.path().join("setup.ron"), setup).expect("a file");
    let source = ["--source", "typist:the cat and nuris of "];
    let arguments = ["run", "setup.ron", "--record", "r.mcap"];
    let run = run_in(folder.path(), [&arguments[..], &source].concat()).done();
    let typed_keys = events_of(&run.out);
    let corrected = typed_keys
        .iter()
        .any(|line| line.ends_with("down ShiftLeft"));
    assert!(corrected, "Nuria has a capital: {}", run.out);
    // The words are in the recording: the file is not read again.
    fs::remove_file(folder.path().join("me.ron")).expect("it is removed");
    let replay = run_in(folder.path(), ["replay", "r.mcap"]).done();
    assert_eq!(events_of(&replay.out), typed_keys);

    let plain = ["run", "--layout", "qwerty-flat", "--decoder", "auto"];
    let other = run_in(folder.path(), [&plain[..], &source].concat()).done();
    assert!(!other.out.contains("Shift"), "{}", other.out);
}
