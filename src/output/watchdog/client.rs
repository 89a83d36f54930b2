//! The program's end: a guardian that is told what is down.

use std::io::{self, Read};
use std::os::fd::OwnedFd;
use std::os::unix::net::UnixStream;
use std::os::unix::process::CommandExt;
use std::process::{Child, Command, Stdio};
use std::thread;
use std::time::{Duration, Instant};

use crossbeam_channel::{Receiver, bounded};
use enigo::Direction;
use rustix::net::{SendFlags, send};

use super::{READY, ReleaseTarget, WatchdogMessage, WatchdogSettings};
use crate::device::KeyCode;

/// How long a guardian may take to connect to the display.
const START_LIMIT: Duration = Duration::from_secs(5);

/// How long it may take to end when it is told to.
const END_LIMIT: Duration = Duration::from_millis(200);

/// The longest text in which a guardian says why it cannot work, in bytes.
const LONGEST_REASON: u64 = 4096;

/// The guardian is gone, or does not listen.
#[derive(Debug, PartialEq)]
pub struct WatchdogLost;

/// A guardian that is at work.
pub struct WatchdogClient {
    launch: WatchdogSettings,
    means: ReleaseTarget,
    process: Child,
    line: UnixStream,
    gone: Receiver<()>,
    may_be_replaced: bool,
}

impl WatchdogClient {
    /// Starts one and waits until it can let go of keys.
    pub fn start(launch: &WatchdogSettings, means: ReleaseTarget) -> Result<Self, String> {
        let (line, its_end) = UnixStream::pair().map_err(refuse)?;
        // Signals of a terminal are for the program; its guardian has to outlive it.
        let process = Command::new(&launch.program)
            .args(&launch.arguments)
            .process_group(0)
            .stdin(Stdio::from(OwnedFd::from(its_end)))
            .stdout(Stdio::null())
            .spawn()
            .map_err(refuse)?;
        let mut guard = Self {
            launch: launch.clone(),
            means,
            process,
            gone: bounded(0).1,
            line,
            may_be_replaced: true,
        };
        guard.means.send(&guard.line).map_err(refuse)?;
        guard.wait_until_ready()?;
        guard.gone = notice_end(&guard.line).map_err(refuse)?;
        Ok(guard)
    }

    /// Tells of a key: before it goes down, and after it came up.
    pub fn report_key(&self, key: KeyCode, direction: Direction) -> Result<(), WatchdogLost> {
        self.send(WatchdogMessage::of(key, direction))
    }

    /// Tells whether axes are away from their rest: before the first leaves it, and after the last came back.
    pub fn report_axes(&self, are_deflected: bool) -> Result<(), WatchdogLost> {
        self.send(match are_deflected {
            true => WatchdogMessage::AxesDeflected,
            false => WatchdogMessage::AxesCentered,
        })
    }

    /// Tells whether a character is being written: before, and afterwards.
    pub fn report_text(&self, is_writing: bool) -> Result<(), WatchdogLost> {
        self.send(match is_writing {
            true => WatchdogMessage::TextStarted,
            false => WatchdogMessage::TextFinished,
        })
    }

    /// Gives a sign of life.
    pub fn send_heartbeat(&self) -> Result<(), WatchdogLost> {
        self.send(WatchdogMessage::Heartbeat)
    }

    /// Closed when the guardian has ended.
    pub fn exited(&self) -> &Receiver<()> {
        &self.gone
    }

    /// Tells that the guardian was lost and starts another; nothing may be down. Only once: one that is lost
    /// again is ended by somebody who will do so for ever.
    pub fn restart(&mut self) -> Result<(), String> {
        (self.launch.on_lost)();
        if !self.may_be_replaced {
            return Err("the guardian that lets go of keys was ended a second time".into());
        }
        *self = Self::start(&self.launch, std::mem::take(&mut self.means))?;
        self.may_be_replaced = false;
        Ok(())
    }

    fn wait_until_ready(&mut self) -> Result<(), String> {
        self.line
            .set_read_timeout(Some(START_LIMIT))
            .map_err(refuse)?;
        let mut said = Vec::new();
        let mut first = [0];
        match self.line.read(&mut first) {
            Ok(1) if first[0] == READY => {}
            Ok(1) => {
                said.extend(first);
                let _ = (&self.line).take(LONGEST_REASON).read_to_end(&mut said);
                return Err(refuse(String::from_utf8_lossy(&said)));
            }
            Ok(_) => return Err(refuse("it ended at once")),
            Err(error) => return Err(refuse(error)),
        }
        self.line.set_read_timeout(None).map_err(refuse)
    }

    /// Does not wait: one that does not listen is as good as none.
    fn send(&self, word: WatchdogMessage) -> Result<(), WatchdogLost> {
        match send(&self.line, &word.to_bytes(), SendFlags::DONTWAIT) {
            Ok(WatchdogMessage::BYTES) => Ok(()),
            _ => Err(WatchdogLost),
        }
    }
}

impl Drop for WatchdogClient {
    fn drop(&mut self) {
        let _ = self.line.shutdown(std::net::Shutdown::Both);
        let start = Instant::now();
        while matches!(self.process.try_wait(), Ok(None)) && start.elapsed() < END_LIMIT {
            thread::sleep(Duration::from_millis(1));
        }
        let _ = self.process.kill();
        let _ = self.process.try_wait();
    }
}

/// A channel that is closed when the other end of the line is.
fn notice_end(line: &UnixStream) -> io::Result<Receiver<()>> {
    let (end, gone) = bounded::<()>(0);
    let mut line = line.try_clone()?;
    thread::Builder::new()
        .name("guardian".into())
        .spawn(move || {
            let _end = end;
            while matches!(line.read(&mut [0; 16]), Ok(1..)) {}
        })?;
    Ok(gone)
}

fn refuse(reason: impl std::fmt::Display) -> String {
    format!("no guardian that would let go of keys: {reason}")
}
