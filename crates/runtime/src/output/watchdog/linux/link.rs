//! The process of the watchdog and the Unix socket pair to it.

use std::io;
use std::os::fd::OwnedFd;
use std::os::unix::net::UnixStream;
use std::os::unix::process::CommandExt;
use std::process::{Child, Command, Stdio};
use std::sync::Arc;

use crossbeam_channel::Receiver;
use rustix::net::{SendFlags, send};

use super::{ReleaseTarget, receive};
use crate::output::watchdog::message::{WatchdogLost, WatchdogMessage};
use crate::output::watchdog::ready::read_ready;
use crate::output::watchdog::replies::Replies;
use crate::output::watchdog::{PROCESS_NAME, START_TIMEOUT, WatchdogSettings};

/// The socket to a watchdog.
#[derive(Clone)]
pub struct Link {
    socket: Arc<UnixStream>,
}

impl Link {
    /// Starts a watchdog.
    pub fn start(settings: &WatchdogSettings) -> io::Result<(Child, Self)> {
        let (socket, watchdog_end) = UnixStream::pair()?;
        let process = Command::new(&settings.program)
            .arg0(PROCESS_NAME)
            .args(&settings.arguments)
            .stdin(Stdio::from(OwnedFd::from(watchdog_end)))
            .stdout(Stdio::null())
            .spawn()?;
        let socket = Arc::new(socket);
        Ok((process, Self { socket }))
    }

    /// Passes the handle to release keys with, and waits until the watchdog is ready.
    pub fn prepare(&mut self, target: &ReleaseTarget) -> Result<(), String> {
        let failed = |error: io::Error| error.to_string();
        let thread = target.thread_handle();
        target.send(&self.socket, thread.as_ref()).map_err(failed)?;
        let timeout = Some(START_TIMEOUT);
        self.socket.set_read_timeout(timeout).map_err(failed)?;
        read_ready(&*self.socket)?;
        self.socket.set_read_timeout(None).map_err(failed)
    }

    /// Receives replies from now on. Returns a channel that is closed when the watchdog is lost.
    pub fn receive(&mut self, replies: Arc<Replies>) -> io::Result<Receiver<()>> {
        receive::receive(&self.socket, replies)
    }

    /// Sends a message without blocking: a watchdog that does not read is lost.
    pub fn send(&self, message: WatchdogMessage) -> Result<(), WatchdogLost> {
        send_message(&self.socket, message)
    }

    /// Ends the connection, upon which the watchdog exits.
    pub fn close(&self) {
        let _ = self.socket.shutdown(std::net::Shutdown::Both);
    }
}

/// Sends a message without blocking.
pub(super) fn send_message(
    socket: &UnixStream,
    message: WatchdogMessage,
) -> Result<(), WatchdogLost> {
    match send(socket, &message.to_bytes(), SendFlags::DONTWAIT) {
        Ok(WatchdogMessage::BYTES) => Ok(()),
        _ => Err(WatchdogLost),
    }
}
