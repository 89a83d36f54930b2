//! The output of a child process, which a test can stop reading.

use std::fs::{File, OpenOptions};
use std::io::{ErrorKind, Read, Write};
use std::os::fd::{AsRawFd, OwnedFd};
use std::os::unix::fs::OpenOptionsExt;
use std::sync::{Arc, Condvar, Mutex};
use std::thread;
use std::time::{Duration, Instant};

use rustix::fs::OFlags;

/// The read end of a pipe, and the lines that arrived through it.
pub struct OutputPipe {
    pipe: File,
    shared: Arc<Shared>,
}

#[derive(Default)]
struct Shared {
    state: Mutex<State>,
    changed: Condvar,
}

#[derive(Default)]
struct State {
    lines: Vec<String>,
    incomplete: Vec<u8>,
    is_blocked: bool,
    /// The thread does not read until the pipe is unblocked.
    is_parked: bool,
    /// The child and everything that inherited the pipe have exited.
    is_closed: bool,
}

impl OutputPipe {
    /// Collects the lines of a pipe in a thread.
    pub fn new(pipe: impl Into<OwnedFd>) -> Self {
        let pipe = File::from(pipe.into());
        let shared = Arc::new(Shared::default());
        let reader = Arc::clone(&shared);
        let read_end = pipe.try_clone().expect("a duplicate");
        thread::spawn(move || reader.read(read_end));
        Self { pipe, shared }
    }

    /// Returns the lines so far.
    pub fn lines(&self) -> Vec<String> {
        self.shared.state.lock().unwrap().lines.clone()
    }

    /// Returns the number of lines so far that contain `part`.
    pub fn count(&self, part: &str) -> usize {
        let state = self.shared.state.lock().unwrap();
        let lines = state.lines.iter();
        lines.filter(|line| line.contains(part)).count()
    }

    /// Stops reading and fills the pipe, as a terminal does after Ctrl-S. The next write of the child blocks.
    pub fn block(&self) {
        self.shared.state.lock().unwrap().is_blocked = true;
        // The thread may be in a read, which ends with the first filler.
        let start = Instant::now();
        while !self.is_parked() {
            let is_in_time = start.elapsed() < Duration::from_secs(60);
            assert!(is_in_time, "the thread still reads");
            self.fill();
            thread::sleep(Duration::from_millis(1));
        }
        self.fill();
    }

    /// Continues to read. The filler is not among the lines.
    pub fn unblock(&self) {
        self.shared.state.lock().unwrap().is_blocked = false;
        self.shared.changed.notify_all();
    }

    fn is_parked(&self) -> bool {
        let state = self.shared.state.lock().unwrap();
        state.is_parked || state.is_closed
    }

    fn fill(&self) {
        // Another file description of the same pipe, so that its flags do not affect the child.
        let path = format!("/proc/self/fd/{}", self.pipe.as_raw_fd());
        let mut options = OpenOptions::new();
        options
            .write(true)
            .custom_flags(OFlags::NONBLOCK.bits().cast_signed());
        let mut pipe = options.open(path).expect("the pipe is open");
        // Of a write of more than one byte the system may accept nothing while a byte has room.
        for filler in [&[b'\n'; 4096][..], b"\n"] {
            while pipe.write(filler).is_ok() {}
        }
    }
}

impl Drop for OutputPipe {
    fn drop(&mut self) {
        self.unblock();
    }
}

impl Shared {
    fn read(&self, mut pipe: File) {
        let mut bytes = [0; 1024];
        loop {
            match pipe.read(&mut bytes) {
                Err(error) if error.kind() == ErrorKind::Interrupted => continue,
                Ok(0) | Err(_) => break,
                Ok(count) => self.push(&bytes[..count]),
            }
            let mut state = self.state.lock().unwrap();
            while state.is_blocked {
                state.is_parked = true;
                state = self.changed.wait(state).unwrap();
            }
            state.is_parked = false;
        }
        self.state.lock().unwrap().is_closed = true;
    }

    fn push(&self, bytes: &[u8]) {
        let mut state = self.state.lock().unwrap();
        state.incomplete.extend_from_slice(bytes);
        while let Some(end) = state.incomplete.iter().position(|byte| *byte == b'\n') {
            let line: Vec<u8> = state.incomplete.drain(..=end).collect();
            let line = String::from_utf8_lossy(&line).trim_end().to_owned();
            if !line.is_empty() {
                state.lines.push(line);
            }
        }
    }
}
