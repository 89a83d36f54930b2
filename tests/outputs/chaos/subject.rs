//! The program under attack.

use std::fs;
use std::net::SocketAddr;
use std::path::{Path, PathBuf};
use std::process::{ExitStatus, Stdio};

use ademan::session::control_socket::Client;
use rustix::process::{Pid, Signal, kill_process};

use crate::support::binary::ademan;
use crate::support::free_address::free_address;
use crate::support::output_pipe::OutputPipe;
use crate::support::process::{Process, children};
use crate::support::x11::{XServer, wait_for};

/// A setup with which a busy machine rarely causes a stall. The time-out is below the bound of the rig.
const SETUP: &str = "Setup(stall_timeout_ms: 3000)";

/// A running program with a glove, a layout file and a control socket in a folder.
pub struct Subject {
    process: Process,
    socket: PathBuf,
    share: SocketAddr,
    pub stdout: OutputPipe,
    pub stderr: OutputPipe,
}

/// Returns the path of the port of the glove.
pub fn port(folder: &Path) -> PathBuf {
    folder.join("glove")
}

/// Returns the path of the layout file.
pub fn layout(folder: &Path) -> PathBuf {
    folder.join("my.ron")
}

impl Subject {
    /// Starts the program and waits until it listens to the glove.
    pub fn start(server: &XServer, folder: &Path) -> Self {
        let socket = folder.join("control.sock");
        let setup = folder.join("setup.ron");
        fs::write(&setup, SETUP).expect("space on the disk");
        let source = format!("serial:{}", port(folder).display());
        let share = free_address();
        let mut command = ademan(["run", "--output", "desktop,transcript", "--source", &source]);
        command
            .arg("--share")
            .arg(format!("ws:{share}"))
            .arg("--layout")
            .arg(layout(folder))
            .arg("--control")
            .arg(&socket)
            .arg(setup)
            .env("DISPLAY", server.display())
            .env_remove("WAYLAND_DISPLAY")
            .env_remove("XDG_RUNTIME_DIR")
            .stdin(Stdio::null())
            .stdout(Stdio::piped())
            .stderr(Stdio::piped());
        let mut process = Process::start(&mut command).expect("the program starts");
        let stdout = process.0.stdout.take().expect("it is piped");
        let stderr = process.0.stderr.take().expect("it is piped");
        let subject = Self {
            process,
            socket,
            share,
            stdout: OutputPipe::new(stdout),
            stderr: OutputPipe::new(stderr),
        };
        let listens = || subject.stderr.count("listening to") > 0;
        assert!(wait_for(listens), "{:#?}", subject.stderr.lines());
        subject
    }

    /// Returns the path of the control socket.
    pub fn socket(&self) -> &Path {
        &self.socket
    }

    /// Returns the address at which the hand is shared.
    pub fn share(&self) -> SocketAddr {
        self.share
    }

    /// Returns the resident memory in kB and the number of file descriptors; `None` if the program has exited.
    pub fn resources(&self) -> Option<(u64, usize)> {
        let folder = PathBuf::from(format!("/proc/{}", self.process.0.id()));
        let status = fs::read_to_string(folder.join("status")).ok()?;
        let line = status
            .lines()
            .find_map(|line| line.strip_prefix("VmRSS:"))?;
        let memory = line.trim().trim_end_matches(" kB").parse().ok()?;
        let descriptors = fs::read_dir(folder.join("fd")).ok()?.count();
        Some((memory, descriptors))
    }

    /// Returns the exit status if the program has exited.
    pub fn exit_status(&mut self) -> Option<ExitStatus> {
        self.process.0.try_wait().expect("a child process")
    }

    pub fn signal(&self, signal: Signal) {
        send(self.process.0.id(), signal);
    }

    /// Returns the processes of the watchdog.
    pub fn watchdogs(&self) -> Vec<u32> {
        children(self.process.0.id())
    }
}

/// Sends a signal to a process, which may have exited.
pub fn send(process: u32, signal: Signal) {
    let process = Pid::from_raw(process.cast_signed()).expect("an id is positive");
    let _ = kill_process(process, signal);
}

/// Sends a command and returns the reason if it is not accepted.
pub fn request(socket: &Path, command: &str) -> Result<(), String> {
    let mut client = Client::connect(socket).map_err(|error| error.to_string())?;
    let response = client.request(&format!("{{\"command\":\"{command}\"}}"));
    let response = response.map_err(|error| error.to_string())?;
    if response.starts_with("{\"ok\":true") {
        Ok(())
    } else {
        Err(response)
    }
}
