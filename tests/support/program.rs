//! The binary as a child process with a display.

use std::ffi::OsStr;
use std::process::{Command, ExitStatus, Stdio};
use std::sync::{Arc, Mutex};

use super::binary::ademan;
use super::process::{Process, children, collect_lines};
use super::x11::{XServer, wait_for};

/// The start of the message of a run whose watchdog does not reply. A machine that starves it for 300 ms has the same effect. The run
/// is paused until a person resumes it.
pub const WATCHDOG_LOST: &str = "the watchdog exited or hangs";

/// A running `ademan`.
pub struct Program {
    process: Process,
    stderr_lines: Arc<Mutex<Vec<String>>>,
}

impl Program {
    /// Starts `ademan` with these arguments on an X server.
    pub fn start<S: AsRef<OsStr>>(
        server: &XServer,
        arguments: impl IntoIterator<Item = S>,
    ) -> Self {
        let mut command = ademan(arguments);
        command
            .env("DISPLAY", server.display())
            .env_remove("WAYLAND_DISPLAY")
            .env_remove("XDG_RUNTIME_DIR");
        Self::from_command(command)
    }

    /// Starts a command.
    pub fn from_command(mut command: Command) -> Self {
        command
            .stdin(Stdio::null())
            .stdout(Stdio::null())
            .stderr(Stdio::piped());
        let mut process = Process::start(&mut command).expect("the program starts");
        let stderr = process.0.stderr.take().expect("stderr is piped");
        Self {
            process,
            stderr_lines: collect_lines(stderr),
        }
    }

    /// Returns the lines on the standard error so far.
    pub fn stderr_lines(&self) -> Vec<String> {
        self.stderr_lines.lock().unwrap().clone()
    }

    /// Returns the number of lines so far that contain `part`.
    pub fn count_lines(&self, part: &str) -> usize {
        let lines = self.stderr_lines.lock().unwrap();
        lines.iter().filter(|line| line.contains(part)).count()
    }

    /// Waits for the `count`th line that contains `part`.
    pub fn wait_for_line(&self, part: &str, count: usize) {
        assert!(
            wait_for(|| self.count_lines(part) >= count),
            "no line with {part:?}: {:#?}",
            self.stderr_lines()
        );
    }

    /// Sends signals without a delay between them. They have the names that `kill -s` uses: `INT`, `TERM`, `HUP`.
    pub fn signal(&self, signals: &[&str]) {
        let process = self.id();
        let commands: Vec<_> = signals
            .iter()
            .map(|signal| format!("kill -s {signal} {process}"))
            .collect();
        let mut shell = Command::new("sh");
        let mut shell = Process::start(shell.args(["-c", &commands.join("; ")])).expect("a shell");
        shell.0.wait().expect("the shell exits");
    }

    /// Returns the process id.
    pub fn id(&self) -> u32 {
        self.process.0.id()
    }

    /// Returns the ids of its child processes (Linux).
    pub fn children(&self) -> Vec<u32> {
        children(self.id())
    }

    /// Returns `true` if the program has not exited.
    pub fn is_running(&mut self) -> bool {
        let status = self.process.0.try_wait().expect("a child process");
        status.is_none()
    }

    /// Waits until the program exits and its standard error is closed, so that [`stderr_lines`](Self::stderr_lines) is
    /// complete. A watchdog closes it shortly after the program.
    pub fn wait_for_exit(&mut self) -> ExitStatus {
        assert!(
            wait_for(|| !self.is_running()),
            "the program does not exit: {:#?}",
            self.stderr_lines()
        );
        // The collecting thread has the other reference.
        wait_for(|| Arc::strong_count(&self.stderr_lines) == 1);
        self.process.0.wait().expect("the program has exited")
    }
}
