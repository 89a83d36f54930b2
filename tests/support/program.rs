//! The program itself, as a child that the test can talk to as a system does.

use std::ffi::OsStr;
use std::fs;
use std::process::{Command, ExitStatus, Stdio};
use std::sync::{Arc, Mutex};

use super::binary::ademan;
use super::process::{Process, overheard};
use super::x11::{XServer, wait_for};

/// `ademan`, running on a display.
pub struct Program {
    process: Process,
    said: Arc<Mutex<Vec<String>>>,
}

impl Program {
    /// Starts it with these arguments.
    pub fn start<S: AsRef<OsStr>>(
        server: &XServer,
        arguments: impl IntoIterator<Item = S>,
    ) -> Self {
        let mut command = ademan(arguments);
        command
            .env("DISPLAY", server.display())
            .env_remove("WAYLAND_DISPLAY")
            .env_remove("XDG_RUNTIME_DIR");
        Self::of(command)
    }

    /// Starts it as this says.
    pub fn of(mut command: Command) -> Self {
        command
            .stdin(Stdio::null())
            .stdout(Stdio::null())
            .stderr(Stdio::piped());
        let mut process = Process::start(&mut command).expect("the program starts");
        let stderr = process.0.stderr.take().expect("it is piped");
        let said = overheard(stderr);
        Self { process, said }
    }

    /// What it has said on standard error so far.
    pub fn said(&self) -> Vec<String> {
        self.said.lock().unwrap().clone()
    }

    /// How many lines with `part` in them it has said so far.
    pub fn times_said(&self, part: &str) -> usize {
        let said = self.said.lock().unwrap();
        said.iter().filter(|line| line.contains(part)).count()
    }

    /// Waits until it has said a line with `part` in it for the `times`th time.
    pub fn wait_until_it_says(&self, part: &str, times: usize) {
        assert!(
            wait_for(|| self.times_said(part) >= times),
            "it does not say {part:?}: {:#?}",
            self.said()
        );
    }

    /// Sends it these signals in one go, by their names: `INT`, `TERM`, `HUP`.
    pub fn signal(&self, signals: &[&str]) {
        let process = self.process.0.id();
        let kills: Vec<_> = signals
            .iter()
            .map(|signal| format!("kill -s {signal} {process}"))
            .collect();
        let mut shell = Command::new("sh");
        let mut shell = Process::start(shell.args(["-c", &kills.join("; ")])).expect("a shell");
        shell.0.wait().expect("it ends");
    }

    /// The number of its process.
    pub fn id(&self) -> u32 {
        self.process.0.id()
    }

    /// The processes that it has started (Linux).
    pub fn children(&self) -> Vec<u32> {
        let threads = fs::read_dir(format!("/proc/{}/task", self.id()));
        let of_thread = |thread: fs::DirEntry| {
            fs::read_to_string(thread.path().join("children")).unwrap_or_default()
        };
        let lists: String = threads.expect("it runs").flatten().map(of_thread).collect();
        let numbers = lists.split_whitespace();
        numbers.filter_map(|child| child.parse().ok()).collect()
    }

    /// Whether it still runs.
    pub fn runs(&mut self) -> bool {
        self.process.0.try_wait().expect("it is a child").is_none()
    }

    /// How it ended, once it has.
    pub fn status(&mut self) -> ExitStatus {
        assert!(
            wait_for(|| !self.runs()),
            "it does not end: {:#?}",
            self.said()
        );
        self.process.0.wait().expect("it has ended")
    }
}
