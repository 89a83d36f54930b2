//! Waits for bytes without a limit of time, until somebody interrupts it.

use std::fs::{self, File};
use std::io::{Error, ErrorKind, Result};
use std::os::fd::{AsFd, OwnedFd};
use std::os::unix::fs::MetadataExt;
use std::time::Duration;

use rustix::event::{PollFd, PollFlags, Timespec};
use rustix::fs::{Mode, OFlags, open};
use rustix::io::Errno;

use crate::capture::cancel::CancelToken;

/// Where the kernel has its pseudo-terminals.
const TERMINALS: &str = "/dev/pts";

/// Says when a line has bytes.
pub(in crate::capture) struct Readiness(OwnedFd);

impl Readiness {
    /// That of `line`; `None` where the system has no more file numbers.
    pub fn of(line: &impl AsFd) -> Option<Self> {
        line.as_fd().try_clone_to_owned().ok().map(Self)
    }

    /// Whether there is something to read, an end or an error included. Waits for it, for `patience` at most and only
    /// until `interrupt` rings; without a patience for good.
    pub fn wait(
        &self,
        interrupt: Option<&CancelToken>,
        patience: Option<Duration>,
    ) -> Result<bool> {
        let limit = patience.map(timespec);
        let pipe = interrupt.map(|interrupt| PollFd::new(interrupt.pipe(), PollFlags::IN));
        let line = PollFd::new(&self.0, PollFlags::IN);
        // Without an interrupt the line stands in its place too: nothing else can end the wait.
        let mut files = [line.clone(), pipe.unwrap_or(line)];
        match rustix::event::poll(&mut files, limit.as_ref()) {
            Ok(_) => {}
            Err(Errno::INTR) => return Ok(false),
            Err(error) => return Err(error.into()),
        }
        let seen = files[0].revents();
        if seen.contains(PollFlags::HUP) && !seen.contains(PollFlags::IN) {
            return Err(Error::from(ErrorKind::BrokenPipe));
        }
        Ok(!seen.is_empty())
    }
}

/// A second way to the port at `place`, to be opened before the first one closes it to others: a port does not lend
/// its file number. It does not wait. `None` where it cannot be had.
pub(in crate::capture) fn open_to_read(place: &str) -> Option<File> {
    let flags = OFlags::RDONLY | OFlags::NONBLOCK | OFlags::NOCTTY | OFlags::CLOEXEC;
    open(place, flags, Mode::empty()).ok().map(File::from)
}

/// A name of a pseudo-terminal, as it was when it was opened.
#[derive(Clone, Debug, PartialEq)]
pub(in crate::capture) struct TerminalName {
    /// Number and last change of a link; `None` for the terminal's own name.
    link: Option<(u64, i64, i64)>,
}

impl TerminalName {
    /// Of a port that is a pseudo-terminal.
    pub fn of(port: &str) -> Option<Self> {
        if !fs::canonicalize(port).ok()?.starts_with(TERMINALS) {
            return None;
        }
        let name = fs::symlink_metadata(port).ok()?;
        let change = (name.ino(), name.ctime(), name.ctime_nsec());
        Some(Self {
            link: name.file_type().is_symlink().then_some(change),
        })
    }
}

/// A little more than that, so that a deadline has passed when it is over.
fn timespec(duration: Duration) -> Timespec {
    let millis = duration.as_millis() as i64 + 1;
    Timespec {
        tv_sec: millis / 1000,
        tv_nsec: millis % 1000 * 1_000_000,
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::capture::cancel::cancel_token;
    use std::io::{Write, pipe};
    use std::thread::{sleep, spawn};

    #[test]
    fn bytes_and_a_bell_end_a_wait_that_has_no_limit() {
        let (line, mut end) = pipe().unwrap();
        let readiness = Readiness::of(&line).unwrap();
        let (bell, interrupt) = cancel_token().unwrap();
        let later = spawn(move || {
            sleep(Duration::from_millis(50));
            drop(bell);
            sleep(Duration::from_millis(50));
            end.write_all(&[1]).unwrap();
            end
        });
        assert!(!readiness.wait(Some(&interrupt), None).unwrap());
        assert!(readiness.wait(None, None).unwrap());
        drop(later.join().unwrap());
    }

    #[test]
    fn a_name_of_a_terminal_is_another_one_when_its_link_is_made_anew() {
        let folder = tempfile::tempdir().unwrap();
        let link = folder.path().join("glove");
        let name = || TerminalName::of(link.to_str().unwrap());
        assert_eq!(name(), None);
        let wire = crate::capture::open_loopback(Default::default()).unwrap();
        let crate::capture::SourceUri::Serial { port, .. } = &wire.uri else {
            panic!("{}", wire.uri);
        };
        let slave = std::fs::canonicalize(port).unwrap();
        std::os::unix::fs::symlink(&slave, &link).unwrap();
        let first = name();
        assert!(first.is_some());
        assert_eq!(name(), first);
        std::fs::remove_file(&link).unwrap();
        sleep(Duration::from_millis(20));
        std::os::unix::fs::symlink(&slave, &link).unwrap();
        assert_ne!(name(), first);
        let own = TerminalName::of(slave.to_str().unwrap());
        assert_eq!(own, Some(TerminalName { link: None }));
        assert_eq!(TerminalName::of("/dev/null"), None);
    }

    #[test]
    fn a_line_that_was_cut_is_broken_and_one_that_is_quiet_is_not() {
        let (line, end) = pipe().unwrap();
        let readiness = Readiness::of(&line).unwrap();
        let short = Some(Duration::from_millis(5));
        assert!(!readiness.wait(None, short).unwrap());
        drop(end);
        let broken = readiness.wait(None, None).unwrap_err();
        assert_eq!(broken.kind(), ErrorKind::BrokenPipe);
    }
}
