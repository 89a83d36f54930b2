//! Clicks on a real sound server, whose output is recorded.

use std::fs::{self, File};
use std::io::ErrorKind;
use std::path::Path;
use std::process::{Command, Stdio};

use ademan::studio::sound::click::Click;
use ademan::studio::sound::waveform::samples;
use tempfile::TempDir;

use super::safety::{Session, TRANSCRIPT};
use super::{is_typing, studio};
use crate::support::process::{Process, signal};
use crate::support::program::Program;
use crate::support::x11::{XServer, wait_for};

/// Largest difference between a sample that is played and the one that is recorded. The server may round.
const TOLERANCE: i32 = 2;

/// PulseAudio with a sound device that plays into a file.
struct SoundServer {
    folder: TempDir,
    server: Process,
    _recorder: Process,
}

impl SoundServer {
    /// Starts a server and a recorder. Returns `None` with a message if they are not installed.
    fn start() -> Option<Self> {
        let folder = tempfile::tempdir().expect("a folder");
        let socket = folder.path().join("socket");
        let mut command = Command::new("pulseaudio");
        command
            .args(["-n", "--daemonize=no", "--exit-idle-time=-1"])
            .args(["--use-pid-file=no", "--disallow-exit"])
            .arg("--load=module-null-sink sink_name=file norewinds=1 format=s16le rate=48000 channels=1")
            .arg(format!(
                "--load=module-native-protocol-unix auth-anonymous=1 socket={}",
                socket.display()
            ));
        let server = quiet(&mut command, folder.path())?;
        assert!(wait_for(|| socket.exists()), "pulseaudio listens");
        let recording = File::create(folder.path().join("recording")).expect("a file");
        let mut command = Command::new("parec");
        command
            .arg(format!("--server={}", address(folder.path())))
            .args(["--device=file.monitor", "--raw", "--format=s16le"])
            .args(["--rate=48000", "--channels=1", "--latency-msec=50"])
            .stdout(recording);
        let recorder = quiet(&mut command, folder.path())?;
        let started = Self {
            folder,
            server,
            _recorder: recorder,
        };
        assert!(
            wait_for(|| !started.recording().is_empty()),
            "parec records"
        );
        Some(started)
    }

    /// Returns what was played so far.
    fn recording(&self) -> Vec<i16> {
        let bytes = fs::read(self.folder.path().join("recording")).expect("the recording");
        let samples = bytes.chunks_exact(2);
        samples
            .map(|it| i16::from_le_bytes([it[0], it[1]]))
            .collect()
    }

    /// Returns the number of clicks of this kind that were played so far.
    fn count(&self, click: Click) -> usize {
        let expected = samples(click);
        let recording = self.recording();
        let mut windows = recording.windows(expected.len());
        let is_equal = |window: &[i16]| {
            let mut pairs = window.iter().zip(&expected);
            pairs.all(|(a, b)| (i32::from(*a) - i32::from(*b)).abs() <= TOLERANCE)
        };
        let mut count = 0;
        while windows.any(is_equal) {
            count += 1;
        }
        count
    }
}

/// Returns the address of the server.
fn address(folder: &Path) -> String {
    format!("unix:{}/socket", folder.display())
}

/// Starts a command whose files are in a folder. Returns `None` with a message if it is not installed.
fn quiet(command: &mut Command, folder: &Path) -> Option<Process> {
    command
        .env("HOME", folder)
        .env("XDG_RUNTIME_DIR", folder)
        .env_remove("PULSE_SERVER")
        .stderr(Stdio::null());
    match Process::start(command) {
        Err(error) if error.kind() == ErrorKind::NotFound => {
            println!("SKIPPED: pulseaudio and pulseaudio-utils are not installed");
            None
        }
        started => Some(started.expect("the program starts")),
    }
}

/// Makes Studio use a sound server, with these settings.
fn connect(studio: &mut Command, folder: &Path, settings: &str) {
    let config = folder.join("ademan");
    fs::create_dir_all(&config).expect("a folder");
    fs::write(config.join("studio.ron"), settings).expect("a file");
    studio
        .env("XDG_CONFIG_HOME", folder)
        .env("PULSE_SERVER", address(folder));
}

const SILENT: &str = "(has_seen_tour: true)";
const CLICKS: &str = "(has_seen_tour: true, sound: (is_on: true, volume: 1.0))";

#[test]
fn a_typing_hand_is_heard_once_clicks_are_turned_on() {
    let (Some(server), Some(sound)) = (XServer::start(), SoundServer::start()) else {
        return;
    };
    let start = |settings| {
        // Capitals, which need Shift.
        let source = format!("typist:{}", "Hh".repeat(200));
        let mut command = studio(&server, &["--source", &source]);
        connect(&mut command, sound.folder.path(), settings);
        Program::from_command(command)
    };
    let mut silent = start(SILENT);
    assert!(is_typing(&server), "{:#?}", silent.stderr_lines());
    silent.signal(&["TERM"]);
    assert!(silent.wait_for_exit().success());
    assert!(sound.recording().iter().all(|it| *it == 0), "off at first");

    let program = start(CLICKS);
    for click in [Click::Key, Click::Modifier] {
        let is_heard = wait_for(|| sound.count(click) >= 2);
        assert!(is_heard, "{click}: {:#?}", program.stderr_lines());
    }
    assert_eq!(sound.count(Click::Suppressed), 0);
}

#[test]
fn typing_goes_on_while_the_sound_server_hangs_and_after_it_is_gone() {
    let Some(mut sound) = SoundServer::start() else {
        return;
    };
    let folder = sound.folder.path().to_path_buf();
    let use_sound = |command: &mut Command| connect(command, &folder, CLICKS);
    let Some(mut session) = Session::start_with(TRANSCRIPT, use_sound) else {
        return;
    };
    assert!(wait_for(|| sound.count(Click::Key) >= 1));
    signal("STOP", sound.server.0.id());
    (0..5).for_each(|_| session.wait_for_typing());
    sound.server.0.kill().expect("the server runs");
    (0..5).for_each(|_| session.wait_for_typing());
    session.program.signal(&["TERM"]);
    assert!(session.program.wait_for_exit().success());
}
