//! Waiting with `poll(2)`.

use std::io::{Error, ErrorKind, Result};
use std::os::fd::{AsFd, BorrowedFd, OwnedFd};
use std::time::Duration;

use rustix::event::{PollFd, PollFlags, Timespec, poll};
use rustix::io::Errno;

use crate::capture::cancel::CancelToken;

/// File descriptor that reports when bytes can be read.
#[derive(Debug)]
pub struct Readiness(OwnedFd);

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

impl AsFd for Readiness {
    fn as_fd(&self) -> BorrowedFd<'_> {
        self.0.as_fd()
    }
}

/// Converts a timeout. The kernel ends no wait early.
pub(in crate::capture) fn timespec(duration: Duration) -> Timespec {
    Timespec {
        tv_sec: duration.as_secs() as i64,
        tv_nsec: duration.subsec_nanos().into(),
    }
}

#[cfg(test)]
mod tests {
    use std::io::{Write, pipe};
    use std::sync::mpsc::channel;
    use std::thread::{sleep, spawn};

    use super::*;
    use crate::capture::cancel::cancel_token;

    #[test]
    fn bytes_and_cancellation_end_a_wait_without_timeout() {
        let (stream, mut writer) = pipe().unwrap();
        let readiness = Readiness::new(&stream).unwrap();
        let (handle, token) = cancel_token().unwrap();
        let (end_first_wait, first_wait) = channel();
        let later = spawn(move || {
            sleep(Duration::from_millis(50));
            drop(handle);
            first_wait.recv().unwrap();
            sleep(Duration::from_millis(50));
            writer.write_all(&[1]).unwrap();
            writer
        });
        assert!(!readiness.poll(Some(&token), None).unwrap());
        end_first_wait.send(()).unwrap();
        assert!(readiness.poll(None, None).unwrap());
        drop(later.join().unwrap());
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
