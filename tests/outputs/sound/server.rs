//! Clicks on a real sound server, whose output is recorded.

use std::fs::{self, File};
use std::io::ErrorKind;
use std::path::Path;
use std::process::{Command, Stdio};

use ademan::sound::click::Click;
use ademan::sound::waveform::samples;
use tempfile::TempDir;

use crate::support::process::Process;
use crate::support::x11::wait_for;

/// Largest difference between a sample that is played and the one that is recorded. The server may round.
const TOLERANCE: i32 = 2;

/// PulseAudio with a sound device that plays into a file.
pub struct SoundServer {
    pub folder: TempDir,
    pub server: Process,
    _recorder: Process,
}

impl SoundServer {
    /// Starts a server and a recorder. Returns `None` with a message if they are not installed.
    pub fn start() -> Option<Self> {
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
        let mut recording_command = Command::new("parec");
        recording_command
            .arg(format!("--server={}", address(folder.path())))
            .args(["--device=file.monitor", "--raw", "--format=s16le"])
            .args(["--rate=48000", "--channels=1", "--latency-msec=50"])
            .stdout(recording);
        let recorder = quiet(&mut recording_command, folder.path())?;
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
    pub fn recording(&self) -> Vec<i16> {
        let bytes = fs::read(self.folder.path().join("recording")).expect("the recording");
        let samples = bytes.chunks_exact(2);
        samples
            .map(|it| i16::from_le_bytes([it[0], it[1]]))
            .collect()
    }

    /// Returns the number of clicks of this kind that were played so far.
    pub fn count(&self, click: Click) -> usize {
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
pub fn address(folder: &Path) -> String {
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
