//! Terminals of Unix systems. Signals come by themselves, and no thread waits for keys: a read spins once its window is closed.

use std::fs::{File, OpenOptions};
use std::io::{self, Read, Write};
use std::mem;
use std::os::unix::fs::OpenOptionsExt;
use std::sync::atomic::{AtomicBool, AtomicU32, Ordering};
use std::sync::{Mutex, MutexGuard, PoisonError};
use std::time::{Duration, Instant};

use rustix::event::{PollFd, PollFlags, Timespec, poll};
use rustix::fs::OFlags;
use rustix::process::getpgrp;
use rustix::termios::{
    Action, LocalModes, OptionalActions, QueueSelector, Termios, tcflow, tcflush, tcgetattr,
    tcgetpgrp, tcsetattr,
};

use super::{ENTER, LEAVE};

/// The environment names the character set.
pub const HAS_LOCALE: bool = true;

/// Longest wait for the terminal after the view.
const LEAVE_TIMEOUT: Duration = Duration::from_millis(200);

/// Longest wait before a check whether the view was ended.
const POLL_PERIOD: Duration = Duration::from_millis(50);

/// The terminal while the view covers it.
static COVERED: Mutex<Option<Covered>> = Mutex::new(None);
/// `true` while pictures are written. The thread that writes must not wait for the lock.
static IS_COVERED: AtomicBool = AtomicBool::new(false);

/// Number of takeovers so far.
static TAKEOVERS: AtomicU32 = AtomicU32::new(0);

struct Covered {
    terminal: File,
    /// The terminal modes to restore.
    modes: Termios,
}

/// Returns `true` if standard output is a terminal that this process may change: a process in the background is stopped when
/// it tries.
pub fn is_usable() -> bool {
    let group = tcgetpgrp(io::stdout());
    group.is_ok_and(|group| group == getpgrp())
}

/// Covers the terminal: keys are neither shown nor kept, but Ctrl-C, Ctrl-Z and Ctrl-S work.
pub fn take_over() -> io::Result<()> {
    let mut covered = lock();
    let mut terminal = open()?;
    let modes = tcgetattr(&terminal)?;
    let mut quiet = modes.clone();
    quiet.local_modes -= LocalModes::ECHO | LocalModes::ICANON;
    tcsetattr(&terminal, OptionalActions::Now, &quiet)?;
    let written = write_within(&mut terminal, ENTER);
    *covered = Some(Covered { terminal, modes });
    TAKEOVERS.fetch_add(1, Ordering::Release);
    IS_COVERED.store(true, Ordering::Release);
    written
}

/// Restores the terminal. Has no effect if it is not covered; waits 0.4 s at most.
pub fn restore() {
    IS_COVERED.store(false, Ordering::Release);
    let Some(Covered {
        mut terminal,
        modes,
    }) = lock().take()
    else {
        return;
    };
    if !is_usable() {
        return;
    }
    // The shell would read the keys that were typed during the view.
    let _ = tcflush(&terminal, QueueSelector::IFlush);
    let _ = tcsetattr(&terminal, OptionalActions::Now, &modes);
    // After Ctrl-S it accepts nothing. It starts again only if it was stopped in this way.
    let _ = tcflow(&terminal, Action::OOff);
    let _ = tcflow(&terminal, Action::OOn);
    let _ = write_within(&mut terminal, LEAVE);
}

/// Writes to the terminal after the view, as far as it accepts that within 0.2 s.
pub fn write_after(text: &str) {
    if let Ok(mut terminal) = open() {
        let text = text.replace('\n', "\r\n");
        let _ = write_within(&mut terminal, text.as_bytes());
    }
}

/// Drops pictures from now on, also one that the terminal has not accepted yet.
pub fn end_output() {
    IS_COVERED.store(false, Ordering::Release);
}

/// Returns the number of takeovers so far.
pub fn takeover() -> u32 {
    TAKEOVERS.load(Ordering::Acquire)
}

/// Returns `true` if the view covers the terminal.
pub fn is_covered() -> bool {
    IS_COVERED.load(Ordering::Acquire)
}

/// Does nothing: signals come by themselves.
pub fn check_keys() -> io::Result<()> {
    Ok(())
}

/// Returns the keys that were typed since the last call, without waiting.
pub fn typed_keys() -> io::Result<Vec<u8>> {
    let mut keys = [0; 64];
    let Some(covered) = &mut *lock() else {
        return Ok(Vec::new());
    };
    match covered.terminal.read(&mut keys) {
        Ok(length) => Ok(keys[..length].to_vec()),
        Err(error) if error.kind() == io::ErrorKind::WouldBlock => Ok(Vec::new()),
        Err(error) => Err(error),
    }
}

fn lock() -> MutexGuard<'static, Option<Covered>> {
    COVERED.lock().unwrap_or_else(PoisonError::into_inner)
}

/// Opens the terminal of standard output a second time: non-blocking mode is a property of the open file description, which
/// standard output shares with other processes.
fn open() -> io::Result<File> {
    let name = rustix::termios::ttyname(io::stdout(), Vec::new())?;
    let name = name.to_string_lossy().into_owned();
    OpenOptions::new()
        .read(true)
        .write(true)
        .custom_flags((OFlags::NONBLOCK | OFlags::NOCTTY).bits() as i32)
        .open(name)
}

/// Writes bytes, as far as the terminal accepts them in time.
fn write_within(terminal: &mut File, bytes: &[u8]) -> io::Result<()> {
    let deadline = Instant::now() + LEAVE_TIMEOUT;
    write_while(terminal, bytes, || Instant::now() < deadline)
}

fn write_while(
    terminal: &mut File,
    mut bytes: &[u8],
    goes_on: impl Fn() -> bool,
) -> io::Result<()> {
    while !bytes.is_empty() {
        match terminal.write(bytes) {
            Ok(length) => bytes = &bytes[length..],
            Err(error) if error.kind() == io::ErrorKind::Interrupted => {}
            Err(error) if error.kind() == io::ErrorKind::WouldBlock => {
                if !goes_on() {
                    return Err(error);
                }
                let period = Timespec::try_from(POLL_PERIOD).ok();
                let _ = poll(
                    &mut [PollFd::new(terminal, PollFlags::OUT)],
                    period.as_ref(),
                );
            }
            Err(error) => return Err(error),
        }
    }
    Ok(())
}

/// The writer of pictures. A picture is dropped when the view ends before the terminal accepts it.
pub struct Output {
    terminal: File,
    bytes: Vec<u8>,
}

impl Output {
    pub fn open() -> io::Result<Self> {
        Ok(Self {
            terminal: open()?,
            bytes: Vec::new(),
        })
    }
}

impl Write for Output {
    fn write(&mut self, bytes: &[u8]) -> io::Result<usize> {
        self.bytes.extend_from_slice(bytes);
        Ok(bytes.len())
    }

    fn flush(&mut self) -> io::Result<()> {
        let bytes = mem::take(&mut self.bytes);
        if is_covered() {
            write_while(&mut self.terminal, &bytes, is_covered)
        } else {
            Ok(())
        }
    }
}
