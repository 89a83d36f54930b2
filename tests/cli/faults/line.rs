//! A serial line whose other end the test holds, and `ademan run` on it.

use std::fs;
use std::io::Write;
use std::os::unix::fs::symlink;
use std::process::Stdio;
use std::thread;
use std::time::Instant;

use crossbeam_channel::Receiver;
use serialport::{SerialPort, TTYPort};
use tempfile::TempDir;

use crate::support::binary::ademan;
use crate::support::press::{Posture, glove_format};
use crate::support::process::{Process, lock_spawning, signal};
use crate::support::run::{TIMEOUT, next_event, start_with_lines};
use crate::support::wearer::packets;

/// A pseudo-terminal. The program sees it by a link, because the system reuses device names.
pub struct PseudoTerminal {
    pub folder: TempDir,
    remote_end: TTYPort,
    _local_end: TTYPort,
}

impl PseudoTerminal {
    /// Opens a pseudo-terminal.
    pub fn open() -> Self {
        let _alone = lock_spawning();
        let (mut remote_end, local_end) = TTYPort::pair().expect("a pseudo-terminal");
        remote_end.set_timeout(TIMEOUT).expect("a timeout");
        let folder = tempfile::tempdir().expect("a folder");
        let device = local_end.name().expect("a device name");
        symlink(device, folder.path().join("glove")).expect("a link to the device");
        Self {
            folder,
            remote_end,
            _local_end: local_end,
        }
    }

    /// Returns the URI of the line as a source.
    pub fn source(&self) -> String {
        format!("serial:{}", self.folder.path().join("glove").display())
    }

    /// Sends bytes as fast as the terminal accepts them.
    pub fn send(&mut self, bytes: &[u8]) {
        // A longer piece may not fit into a terminal that is ready, and would wait for a program that does not read.
        for piece in bytes.chunks(128) {
            self.remote_end
                .write_all(piece)
                .expect("the terminal accepts bytes");
        }
    }

    /// Sends a packet for each posture, at the pace of a serial line.
    pub fn play(&mut self, postures: &[Posture]) {
        for posture in postures {
            self.send(&packets(&[*posture]));
            thread::sleep(glove_format().packet_period());
        }
    }
}

/// `ademan run` on a line. A busy machine may delay packets for 10 s without ending a press.
pub struct SerialRun {
    pub program: Process,
    /// The lines of the transcript, on standard output.
    pub events: Receiver<String>,
    /// The lines on standard error.
    pub messages: Receiver<String>,
}

impl SerialRun {
    /// Starts the program, and waits until it has opened the line.
    pub fn start(line: &PseudoTerminal, arguments: &[&str]) -> Self {
        let setup = line.folder.path().join("setup.ron");
        fs::write(&setup, "Setup(stall_timeout_ms: 10000)").expect("a file");
        let source = line.source();
        let setup = setup.to_str().expect("a plain path");
        let mut command = ademan(["run", setup, "--source", &source]);
        command
            .args(arguments)
            .env_remove("XDG_RUNTIME_DIR")
            .stdin(Stdio::null());
        let (program, events, messages) = start_with_lines(&mut command);
        let run = Self {
            program,
            events,
            messages,
        };
        run.wait_for_message("listening to");
        run
    }

    /// Waits for a message that contains `part`, and returns it.
    pub fn wait_for_message(&self, part: &str) -> String {
        let mut others = Vec::new();
        let start = Instant::now();
        while start.elapsed() < TIMEOUT {
            let Ok(line) = self.messages.recv_timeout(TIMEOUT) else {
                break;
            };
            if line.contains(part) {
                return line;
            }
            others.push(line);
        }
        panic!("no message contains {part:?}: {others:#?}");
    }

    /// Waits for the next event, and returns it without its time.
    pub fn next_event(&self) -> String {
        next_event(&self.events)
    }

    /// Returns the resident memory of the process in KiB.
    pub fn memory(&self) -> u64 {
        let path = format!("/proc/{}/status", self.program.0.id());
        let status = fs::read_to_string(path).expect("the process runs");
        let line = status.lines().find(|line| line.starts_with("VmRSS:"));
        let words = line.expect("a line about memory").split_whitespace();
        words
            .skip(1)
            .find_map(|word| word.parse().ok())
            .expect("KiB")
    }

    /// Sends SIGTERM, waits for the end of the process, and returns its exit code.
    pub fn end(&mut self) -> Option<i32> {
        signal("TERM", self.program.0.id());
        self.program.wait_for_exit().code()
    }
}
