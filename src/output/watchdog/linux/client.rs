//! The client side: the running watchdog, as the process that started it sees it.

use std::io::{self, Read};
use std::os::fd::OwnedFd;
use std::os::unix::net::UnixStream;
use std::os::unix::process::CommandExt;
use std::process::{Child, Command, Stdio};
use std::thread;
use std::time::{Duration, Instant};

use crossbeam_channel::{Receiver, bounded};
use rustix::net::{SendFlags, send};

use super::{READY, ReleaseTarget, WatchdogMessage};
use crate::device::KeyCode;
use crate::device::pressed_keys::KeyDirection;
use crate::output::watchdog::WatchdogSettings;

/// Longest time in which a watchdog connects to the display.
const START_TIMEOUT: Duration = Duration::from_secs(5);

/// Longest time in which it exits after its socket is closed.
const EXIT_TIMEOUT: Duration = Duration::from_millis(200);

/// Maximum length of the reason for which a watchdog cannot work, in bytes.
const MAX_REASON: u64 = 4096;

/// The watchdog has exited, or does not read.
#[derive(Debug, PartialEq)]
pub struct WatchdogLost;

/// A running watchdog.
pub struct WatchdogClient {
    settings: WatchdogSettings,
    target: ReleaseTarget,
    process: Child,
    socket: UnixStream,
    exited: Receiver<()>,
    may_restart: bool,
}

impl WatchdogClient {
    /// Starts a watchdog and waits until it is ready to release keys on `target`.
    pub fn start(settings: &WatchdogSettings, target: ReleaseTarget) -> Result<Self, String> {
        let (socket, watchdog_end) = UnixStream::pair().map_err(start_error)?;
        // A process group of its own: a signal from the terminal must not end the watchdog first.
        let process = Command::new(&settings.program)
            .args(&settings.arguments)
            .process_group(0)
            .stdin(Stdio::from(OwnedFd::from(watchdog_end)))
            .stdout(Stdio::null())
            .spawn()
            .map_err(start_error)?;
        let mut watchdog = Self {
            settings: settings.clone(),
            target,
            process,
            exited: bounded(0).1,
            socket,
            may_restart: true,
        };
        watchdog
            .target
            .send(&watchdog.socket)
            .map_err(start_error)?;
        watchdog.wait_until_ready()?;
        watchdog.exited = watch_for_exit(&watchdog.socket).map_err(start_error)?;
        Ok(watchdog)
    }

    /// Reports a key: before a press and after a release.
    pub fn report_key(&self, key: KeyCode, direction: KeyDirection) -> Result<(), WatchdogLost> {
        self.send(WatchdogMessage::from_key(key, direction))
    }

    /// Reports deflected axes: `true` before the first leaves its center, `false` after the last is centered.
    pub fn report_axes(&self, are_deflected: bool) -> Result<(), WatchdogLost> {
        self.send(match are_deflected {
            true => WatchdogMessage::AxesDeflected,
            false => WatchdogMessage::AxesCentered,
        })
    }

    /// Sends a heartbeat.
    pub fn send_heartbeat(&self) -> Result<(), WatchdogLost> {
        self.send(WatchdogMessage::Heartbeat)
    }

    /// Returns a channel that is closed when the watchdog has exited.
    pub fn exited(&self) -> &Receiver<()> {
        &self.exited
    }

    /// Reports the loss of the watchdog and starts another one; no key may be pressed. Fails at the second call,
    /// because a watchdog that exits twice would exit again.
    pub fn restart(&mut self) -> Result<(), String> {
        (self.settings.on_lost)();
        if !self.may_restart {
            return Err("the watchdog exited a second time".into());
        }
        *self = Self::start(&self.settings, std::mem::take(&mut self.target))?;
        self.may_restart = false;
        Ok(())
    }

    fn wait_until_ready(&mut self) -> Result<(), String> {
        self.socket
            .set_read_timeout(Some(START_TIMEOUT))
            .map_err(start_error)?;
        let mut first = [0];
        match self.socket.read(&mut first) {
            Ok(1) if first[0] == READY => {}
            Ok(1) => {
                let mut reason = first.to_vec();
                let _ = (&self.socket).take(MAX_REASON).read_to_end(&mut reason);
                return Err(start_error(String::from_utf8_lossy(&reason)));
            }
            Ok(_) => return Err(start_error("it exited at once")),
            Err(error) => return Err(start_error(error)),
        }
        self.socket.set_read_timeout(None).map_err(start_error)
    }

    /// Sends a message without blocking: a watchdog that does not read is lost.
    fn send(&self, message: WatchdogMessage) -> Result<(), WatchdogLost> {
        match send(&self.socket, &message.to_bytes(), SendFlags::DONTWAIT) {
            Ok(WatchdogMessage::BYTES) => Ok(()),
            _ => Err(WatchdogLost),
        }
    }
}

impl Drop for WatchdogClient {
    fn drop(&mut self) {
        let _ = self.socket.shutdown(std::net::Shutdown::Both);
        let start = Instant::now();
        while matches!(self.process.try_wait(), Ok(None)) && start.elapsed() < EXIT_TIMEOUT {
            thread::sleep(Duration::from_millis(1));
        }
        let _ = self.process.kill();
        let _ = self.process.try_wait();
    }
}

/// Returns a channel that is closed when the other end of the socket is.
fn watch_for_exit(socket: &UnixStream) -> io::Result<Receiver<()>> {
    let (end, exited) = bounded::<()>(0);
    let mut socket = socket.try_clone()?;
    thread::Builder::new()
        .name("watchdog".into())
        .spawn(move || {
            let _end = end;
            while matches!(socket.read(&mut [0; 16]), Ok(1..)) {}
        })?;
    Ok(exited)
}

fn start_error(reason: impl std::fmt::Display) -> String {
    format!("cannot start the watchdog: {reason}")
}
