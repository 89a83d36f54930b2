//! Clicks of a run on a real sound server.
//!
//! `cargo test --features sound --test outputs sound::`; on Debian, install `pulseaudio pulseaudio-utils`.

pub mod server;

use std::fs;
use std::path::PathBuf;

use ademan::sound::click::Click;

use self::server::{SoundServer, address};
use crate::support::binary::ademan;
use crate::support::process::signal;
use crate::support::program::Program;
use crate::support::x11::wait_for;

/// A run whose hand types capitals, which need Shift, into a transcript.
struct Run {
    program: Program,
    transcript: PathBuf,
}

impl Run {
    fn start(sound: &SoundServer, arguments: &[&str]) -> Self {
        let source = format!("typist:{}", "Hh".repeat(200));
        let transcript = sound.folder.path().join("transcript");
        let _ = fs::remove_file(&transcript);
        let output = format!("transcript:{}", transcript.display());
        let mut command = ademan(["run", "--source", &source, "--output", &output]);
        command
            .args(["--control", "off"])
            .args(arguments)
            .env("PULSE_SERVER", address(sound.folder.path()));
        Self {
            program: Program::from_command(command),
            transcript,
        }
    }

    /// Waits for two further keys.
    fn types_on(&self) -> bool {
        let read = || fs::read_to_string(&self.transcript).unwrap_or_default();
        let before = read().lines().count();
        wait_for(|| read().lines().count() >= before + 4)
    }

    fn end(mut self) {
        self.program.signal(&["TERM"]);
        assert_eq!(self.program.wait_for_exit().code(), Some(0));
    }
}

#[test]
fn a_typing_hand_is_silent_until_sound_is_asked_for() {
    let Some(sound) = SoundServer::start() else {
        return;
    };
    let silent = Run::start(&sound, &[]);
    assert!(silent.types_on(), "{:#?}", silent.program.stderr_lines());
    silent.end();
    assert!(sound.recording().iter().all(|it| *it == 0), "off at first");

    let run = Run::start(&sound, &["--sound=1"]);
    for click in [Click::Key, Click::Modifier] {
        let is_heard = wait_for(|| sound.count(click) >= 2);
        assert!(is_heard, "{click}: {:#?}", run.program.stderr_lines());
    }
    assert_eq!(sound.count(Click::Suppressed), 0);
    run.end();
}

#[test]
fn a_run_types_on_while_the_sound_server_hangs_and_says_once_that_it_is_gone() {
    let Some(mut sound) = SoundServer::start() else {
        return;
    };
    let run = Run::start(&sound, &["--sound=1"]);
    let is_heard = wait_for(|| sound.count(Click::Key) >= 1);
    assert!(is_heard, "{:#?}", run.program.stderr_lines());
    signal("STOP", sound.server.0.id());
    assert!(run.types_on());
    sound.server.0.kill().expect("the server runs");
    run.program.wait_for_line("no clicks are heard: ", 1);
    assert!(run.types_on() && run.types_on());
    assert_eq!(run.program.count_lines("no clicks are heard"), 1);
    run.end();
}
