//! The process of the watchdog and the pipes to it.

use std::io::{self, Read, Write};
#[cfg(windows)]
use std::os::windows::process::CommandExt;
use std::process::{Child, ChildStdin, ChildStdout, Command, Stdio};
use std::sync::{Arc, Mutex, PoisonError};
use std::thread;

use crossbeam_channel::{Receiver, bounded};

use super::ReleaseTarget;
use crate::output::watchdog::message::{WatchdogLost, WatchdogMessage, WatchdogReply};
use crate::output::watchdog::ready::read_ready;
use crate::output::watchdog::replies::Replies;
use crate::output::watchdog::{START_TIMEOUT, WatchdogSettings};
use crate::priority;

/// `DETACHED_PROCESS` and `CREATE_NEW_PROCESS_GROUP`: neither Ctrl-C nor the end of the console reaches the watchdog.
#[cfg(windows)]
const CREATION_FLAGS: u32 = 0x0000_0008 | 0x0000_0200;

/// The pipes to a watchdog.
#[derive(Clone)]
pub struct Link {
    /// `None` once it is closed.
    messages: Arc<Mutex<Option<ChildStdin>>>,
    /// `None` once a thread reads it.
    replies: Arc<Mutex<Option<ChildStdout>>>,
}

impl Link {
    /// Starts a watchdog.
    pub fn start(settings: &WatchdogSettings) -> io::Result<(Child, Self)> {
        let mut command = Command::new(&settings.program);
        command
            .args(&settings.arguments)
            .stdin(Stdio::piped())
            .stdout(Stdio::piped());
        #[cfg(windows)]
        command.creation_flags(CREATION_FLAGS).stderr(Stdio::null());
        let mut process = command.spawn()?;
        let link = Self {
            messages: Arc::new(Mutex::new(process.stdin.take())),
            replies: Arc::new(Mutex::new(process.stdout.take())),
        };
        Ok((process, link))
    }

    /// Waits until the watchdog is ready.
    pub fn prepare(&mut self, _: &ReleaseTarget) -> Result<(), String> {
        let failed = |error: io::Error| error.to_string();
        let mut replies = self.take_replies().ok_or("it has no output")?;
        let (ready, answer) = bounded(1);
        // A pipe has no time limit. The thread ends with the process.
        let wait = move || _ = ready.send((read_ready(&mut replies), replies));
        let thread = thread::Builder::new().name("watchdog start".into());
        thread.spawn(wait).map_err(failed)?;
        let (result, replies) = answer
            .recv_timeout(START_TIMEOUT)
            .map_err(|_| "it does not respond")?;
        *lock(&self.replies) = Some(replies);
        result
    }

    /// Receives replies on a thread. Returns a channel that is closed when the watchdog has exited. One that hangs shows at the
    /// next press, which waits for a reply.
    pub fn receive(&mut self, replies: Arc<Replies>) -> io::Result<Receiver<()>> {
        let (end, exited) = bounded::<()>(0);
        let Some(mut output) = self.take_replies() else {
            return Ok(exited);
        };
        let receive = move || {
            let _end = end;
            // A press may wait for the reply.
            priority::raise_thread_priority();
            let mut bytes = [0; 16];
            while let Ok(count) = output.read(&mut bytes)
                && count > 0
            {
                let received = bytes[..count].iter();
                received
                    .filter_map(|byte| WatchdogReply::from_byte(*byte))
                    .for_each(|reply| replies.receive(reply));
            }
        };
        let thread = thread::Builder::new().name("watchdog".into());
        thread.spawn(receive)?;
        Ok(exited)
    }

    /// Sends a message. It does not wait: a watchdog that does not read is lost long before the pipe is full, after
    /// [`MAX_UNANSWERED`](crate::output::watchdog::MAX_UNANSWERED) heartbeats.
    pub fn send(&self, message: WatchdogMessage) -> Result<(), WatchdogLost> {
        let mut messages = lock(&self.messages);
        let pipe = messages.as_mut().ok_or(WatchdogLost)?;
        let sent = pipe.write_all(&message.to_bytes());
        sent.map_err(|_| WatchdogLost)
    }

    /// Closes the input of the watchdog, upon which it exits.
    pub fn close(&self) {
        *lock(&self.messages) = None;
    }

    fn take_replies(&self) -> Option<ChildStdout> {
        lock(&self.replies).take()
    }
}

fn lock<T>(mutex: &Mutex<T>) -> std::sync::MutexGuard<'_, T> {
    mutex.lock().unwrap_or_else(PoisonError::into_inner)
}
