//! Wake-up with `eventfd(2)`.

use std::os::fd::OwnedFd;
use std::sync::Arc;
use std::time::Duration;

use rustix::event::{EventfdFlags, PollFd, PollFlags, eventfd, poll};
use rustix::io::{read, write};

use crate::capture::poll::{Readiness, timespec};

/// Descriptor that one thread waits on together with a stream, and that any thread can make ready. Clones share one
/// descriptor.
#[derive(Clone, Debug)]
pub struct WakeUp(Arc<OwnedFd>);

impl WakeUp {
    /// Creates a descriptor that is not ready. Returns `None` if the process is out of file descriptors.
    pub fn new() -> Option<Self> {
        let descriptor = eventfd(0, EventfdFlags::CLOEXEC | EventfdFlags::NONBLOCK).ok()?;
        Some(Self(Arc::new(descriptor)))
    }

    /// Makes the descriptor ready. Never blocks.
    pub fn wake(&self) {
        // The write fails only if the counter is full; then the descriptor is ready already.
        let _ = write(&self.0, &1_u64.to_ne_bytes());
    }

    /// Makes the descriptor wait for the next [`wake`](Self::wake).
    pub fn reset(&self) {
        let _ = read(&self.0, &mut [0; size_of::<u64>()]);
    }

    /// Returns a duplicate to wait on. `None` if the process is out of file descriptors.
    pub fn readiness(&self) -> Option<Readiness> {
        Readiness::new(&self.0)
    }

    /// Waits for `stream`, a wake-up or `timeout`, and resets itself. Returns `true` if the stream has bytes, an end or an
    /// error.
    pub fn wait(&self, stream: Option<&Readiness>, timeout: Duration) -> bool {
        let own = PollFd::new(&self.0, PollFlags::IN);
        // Without a stream its slot repeats this descriptor.
        let other = stream.map(|stream| PollFd::new(stream, PollFlags::IN));
        let mut descriptors = [own.clone(), other.unwrap_or(own)];
        // A wait that fails has no result; the caller waits again.
        if poll(&mut descriptors, Some(&timespec(timeout))).is_err() {
            return false;
        }
        if !descriptors[0].revents().is_empty() {
            self.reset();
        }
        stream.is_some() && !descriptors[1].revents().is_empty()
    }
}

#[cfg(test)]
mod tests {
    use std::io::{Write, pipe};
    use std::thread::spawn;

    use super::*;

    const LONG: Duration = Duration::from_secs(60);

    #[test]
    fn a_wake_up_before_or_during_the_wait_ends_it_once() {
        let wake_up = WakeUp::new().unwrap();
        wake_up.wake();
        assert!(!wake_up.wait(None, LONG));
        let other = wake_up.clone();
        let later = spawn(move || other.wake());
        assert!(!wake_up.wait(None, LONG));
        later.join().unwrap();
        assert!(
            !wake_up
                .readiness()
                .unwrap()
                .poll(None, Some(Duration::ZERO))
                .unwrap()
        );
    }

    #[test]
    fn a_stream_is_ready_with_bytes_and_at_its_end() {
        let wake_up = WakeUp::new().unwrap();
        let (reader, mut writer) = pipe().unwrap();
        let stream = Readiness::new(&reader).unwrap();
        assert!(!wake_up.wait(Some(&stream), Duration::ZERO));
        wake_up.wake();
        assert!(!wake_up.wait(Some(&stream), LONG));
        writer.write_all(b"x").unwrap();
        assert!(wake_up.wait(Some(&stream), LONG));
        drop((reader, writer));
        assert!(wake_up.wait(Some(&stream), LONG));
    }
}
