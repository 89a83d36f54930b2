//! A serial line whose far end is the test's, and `ademan run` on it.

use std::fs;
use std::io::Write;
use std::os::unix::fs::symlink;
use std::process::Stdio;
use std::thread;
use std::time::{Duration, Instant};

use crossbeam_channel::Receiver;
use serialport::{SerialPort, TTYPort};
use tempfile::TempDir;

use crate::support::binary::ademan;
use crate::support::press::{Posture, glove_format};
use crate::support::process::{Process, lock_spawning};
use crate::support::run::{PATIENCE, lines, next_event};
use crate::support::wearer::stream;

/// A pseudo terminal; its name is a link, so that no other test gets the same one.
pub struct PseudoTerminal {
    pub folder: TempDir,
    far_end: TTYPort,
    _near_end: TTYPort,
}

impl PseudoTerminal {
    pub fn plugged_in() -> Self {
        let _alone = lock_spawning();
        let (mut far_end, near_end) = TTYPort::pair().expect("a pseudo terminal");
        far_end.set_timeout(PATIENCE).expect("it waits for room");
        let folder = tempfile::tempdir().expect("a folder");
        let device = near_end.name().expect("it has a name");
        symlink(device, folder.path().join("glove")).expect("a link to it");
        Self {
            folder,
            far_end,
            _near_end: near_end,
        }
    }

    pub fn source(&self) -> String {
        format!("serial:{}", self.folder.path().join("glove").display())
    }

    /// Sends bytes as fast as they are taken.
    pub fn send(&mut self, bytes: &[u8]) {
        // A terminal takes no more than it has room for.
        for piece in bytes.chunks(256) {
            self.far_end.write_all(piece).expect("somebody listens");
        }
    }

    /// Frames at the pace of a line.
    pub fn play(&mut self, postures: &[Posture]) {
        for posture in postures {
            self.send(&stream(&[*posture]));
            thread::sleep(glove_format().packet_period());
        }
    }
}

/// `ademan run` on a line, on a machine that may hold it up for seconds without ending a press.
pub struct SerialRun {
    pub program: Process,
    pub typed: Receiver<String>,
    pub told: Receiver<String>,
}

impl SerialRun {
    pub fn on(line: &PseudoTerminal, arguments: &[&str]) -> Self {
        let setup = line.folder.path().join("setup.ron");
        fs::write(&setup, "Setup(stall_timeout_ms: 10000)").expect("a file");
        let source = line.source();
        let setup = setup.to_str().expect("a plain path");
        let mut command = ademan(["run", setup, "--source", &source]);
        command
            .args(arguments)
            .env_remove("XDG_RUNTIME_DIR")
            .stdin(Stdio::null())
            .stdout(Stdio::piped())
            .stderr(Stdio::piped());
        let mut program = Process::start(&mut command).expect("it starts");
        let typed = lines(program.0.stdout.take().expect("it is piped"));
        let told = lines(program.0.stderr.take().expect("it is piped"));
        let run = Self {
            program,
            typed,
            told,
        };
        run.wait_until_told("listening to");
        run
    }

    /// Waits for a line with `part` in it, and gives it.
    pub fn wait_until_told(&self, part: &str) -> String {
        let mut heard = Vec::new();
        let start = Instant::now();
        while start.elapsed() < PATIENCE {
            let Ok(line) = self.told.recv_timeout(PATIENCE) else {
                break;
            };
            if line.contains(part) {
                return line;
            }
            heard.push(line);
        }
        panic!("it does not say {part:?}: {heard:#?}");
    }

    /// The next event, without its time.
    pub fn typed(&self) -> String {
        next_event(&self.typed)
    }

    /// What the process has in memory, in KiB.
    pub fn memory(&self) -> u64 {
        let path = format!("/proc/{}/status", self.program.0.id());
        let status = fs::read_to_string(path).expect("it runs");
        let line = status.lines().find(|line| line.starts_with("VmRSS:"));
        let words = line.expect("it has memory").split_whitespace();
        words
            .skip(1)
            .find_map(|word| word.parse().ok())
            .expect("KiB")
    }

    /// Asks it to end, and waits for that; its exit code.
    pub fn end(&mut self) -> Option<i32> {
        let process = self.program.0.id().to_string();
        let mut kill = std::process::Command::new("kill");
        let sent = kill.args(["-s", "TERM", &process]).status();
        assert!(sent.expect("kill is there").success());
        self.code()
    }

    /// Its exit code, once it has ended.
    pub fn code(&mut self) -> Option<i32> {
        let start = Instant::now();
        while start.elapsed() < PATIENCE {
            if let Some(status) = self.program.0.try_wait().expect("it is a child") {
                return status.code();
            }
            thread::sleep(Duration::from_millis(5));
        }
        panic!("it does not end");
    }
}
