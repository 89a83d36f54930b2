//! Waiting with `poll(2)`.

use std::fs::{self, File};
use std::io::{Error, ErrorKind, Read, Result};
use std::os::fd::{AsFd, OwnedFd};
use std::os::unix::fs::MetadataExt;
use std::time::Duration;

use rustix::event::{PollFd, PollFlags, Timespec, poll};
use rustix::fs::{Mode, OFlags, open};
use rustix::io::Errno;

use crate::capture::cancel::CancelToken;

/// Directory of the kernel's pseudo-terminals.
const PSEUDO_TERMINALS: &str = "/dev/pts";

/// File descriptor that reports when bytes can be read.
pub(in crate::capture) struct Readiness(OwnedFd);

impl Readiness {
    /// Duplicates the descriptor. Returns `None` if the process is out of file descriptors.
    pub fn new(descriptor: &impl AsFd) -> Option<Self> {
        descriptor.as_fd().try_clone_to_owned().ok().map(Self)
    }

    /// Waits until there is something to read, the end of the stream or an error included. Returns `false` after
    /// `timeout` or cancellation. A timeout of `None` blocks indefinitely.
    pub fn poll(&self, cancel: Option<&CancelToken>, timeout: Option<Duration>) -> Result<bool> {
        let timeout = timeout.map(timespec);
        let pipe = cancel.map(|cancel| PollFd::new(cancel.pipe(), PollFlags::IN));
        let stream = PollFd::new(&self.0, PollFlags::IN);
        // Without a token the stream fills its slot: nothing else can end the wait.
        let mut descriptors = [stream.clone(), pipe.unwrap_or(stream)];
        match poll(&mut descriptors, timeout.as_ref()) {
            Ok(_) => {}
            Err(Errno::INTR) => return Ok(false),
            Err(error) => return Err(error.into()),
        }
        let events = descriptors[0].revents();
        if events.contains(PollFlags::HUP) && !events.contains(PollFlags::IN) {
            return Err(Error::from(ErrorKind::BrokenPipe));
        }
        Ok(!events.is_empty())
    }
}

/// Opens `port` for reading, without blocking, before the port is locked: `serialport` does not expose its
/// descriptor. Returns `None` on failure.
pub(in crate::capture) fn open_to_read(port: &str) -> Option<File> {
    let flags = OFlags::RDONLY | OFlags::NONBLOCK | OFlags::NOCTTY | OFlags::CLOEXEC;
    open(port, flags, Mode::empty()).ok().map(File::from)
}

/// Opens the standard input. The file bypasses the buffer of [`std::io::stdin`], whose content `poll` cannot see.
pub(in crate::capture) fn open_stdin() -> Result<(Box<dyn Read + Send>, Option<Readiness>)> {
    let file = File::from(std::io::stdin().as_fd().try_clone_to_owned()?);
    let readiness = Readiness::new(&file);
    Ok((Box::new(file), readiness))
}

/// Identity of a pseudo-terminal: its number is given to the next terminal after it has ended.
#[derive(Clone, Debug, PartialEq)]
pub(in crate::capture) struct TerminalIdentity {
    /// Inode and change time (seconds, nanoseconds) of a link; `None` for the terminal's own name.
    link: Option<(u64, i64, i64)>,
}

impl TerminalIdentity {
    /// Reads the identity of `port`. Returns `None` if it is not a pseudo-terminal.
    pub fn read(port: &str) -> Option<Self> {
        if !fs::canonicalize(port).ok()?.starts_with(PSEUDO_TERMINALS) {
            return None;
        }
        let metadata = fs::symlink_metadata(port).ok()?;
        let change = (metadata.ino(), metadata.ctime(), metadata.ctime_nsec());
        Some(Self {
            link: metadata.file_type().is_symlink().then_some(change),
        })
    }
}

/// Rounds up to a millisecond, so that a deadline has passed after the wait.
fn timespec(duration: Duration) -> Timespec {
    let millis = duration.as_millis() as i64 + 1;
    Timespec {
        tv_sec: millis / 1000,
        tv_nsec: millis % 1000 * 1_000_000,
    }
}

#[cfg(test)]
mod tests {
    use std::io::{Write, pipe};
    use std::thread::{sleep, spawn};

    use super::*;
    use crate::capture::cancel::cancel_token;

    #[test]
    fn bytes_and_cancellation_end_a_wait_without_timeout() {
        let (stream, mut writer) = pipe().unwrap();
        let readiness = Readiness::new(&stream).unwrap();
        let (handle, token) = cancel_token().unwrap();
        let later = spawn(move || {
            sleep(Duration::from_millis(50));
            drop(handle);
            sleep(Duration::from_millis(50));
            writer.write_all(&[1]).unwrap();
            writer
        });
        assert!(!readiness.poll(Some(&token), None).unwrap());
        assert!(readiness.poll(None, None).unwrap());
        drop(later.join().unwrap());
    }

    #[test]
    fn a_replaced_link_has_another_identity() {
        let folder = tempfile::tempdir().unwrap();
        let link = folder.path().join("glove");
        let identity = || TerminalIdentity::read(link.to_str().unwrap());
        assert_eq!(identity(), None);
        let (_master, slave) = serialport::TTYPort::pair().unwrap();
        let terminal = serialport::SerialPort::name(&slave).unwrap();
        std::os::unix::fs::symlink(&terminal, &link).unwrap();
        let first = identity();
        assert!(first.is_some());
        assert_eq!(identity(), first);
        fs::remove_file(&link).unwrap();
        sleep(Duration::from_millis(20));
        std::os::unix::fs::symlink(&terminal, &link).unwrap();
        assert_ne!(identity(), first);
        let own = TerminalIdentity::read(&terminal);
        assert_eq!(own, Some(TerminalIdentity { link: None }));
        assert_eq!(TerminalIdentity::read("/dev/null"), None);
    }

    #[test]
    fn a_closed_stream_is_broken_and_a_silent_one_is_not() {
        let (stream, writer) = pipe().unwrap();
        let readiness = Readiness::new(&stream).unwrap();
        let short = Some(Duration::from_millis(5));
        assert!(!readiness.poll(None, short).unwrap());
        drop(writer);
        let error = readiness.poll(None, None).unwrap_err();
        assert_eq!(error.kind(), ErrorKind::BrokenPipe);
    }
}
