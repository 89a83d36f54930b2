//! A TCP connection whose reads fail after a deadline, however slowly bytes arrive.

use std::io::{self, ErrorKind, Read, Write};
use std::net::TcpStream;
use std::sync::Arc;
use std::time::{Duration, Instant};

use super::Stream;

/// A TCP connection that can be shut down by the holder of another reference to it.
#[derive(Debug)]
pub(crate) struct DeadlineStream {
    stream: Arc<TcpStream>,
    deadline: Option<Instant>,
}

impl DeadlineStream {
    /// Limits reads, and each single write, to a time from now.
    pub(crate) fn new(stream: Arc<TcpStream>, limit: Duration) -> io::Result<Self> {
        stream.set_write_timeout(Some(limit))?;
        Ok(Self {
            stream,
            deadline: Some(Instant::now() + limit),
        })
    }

    /// Removes the deadline. From now on each read and write may take up to `timeout`.
    pub(crate) fn end_deadline(&mut self, timeout: Duration) -> io::Result<()> {
        self.deadline = None;
        self.stream.set_read_timeout(Some(timeout))?;
        self.stream.set_write_timeout(Some(timeout))?;
        self.stream.set_nodelay(true)
    }
}

impl Read for DeadlineStream {
    fn read(&mut self, buffer: &mut [u8]) -> io::Result<usize> {
        if let Some(deadline) = self.deadline {
            let left = deadline.saturating_duration_since(Instant::now());
            if left.is_zero() {
                return Err(ErrorKind::TimedOut.into());
            }
            self.stream.set_read_timeout(Some(left))?;
        }
        (&*self.stream).read(buffer)
    }
}

impl Write for DeadlineStream {
    fn write(&mut self, buffer: &[u8]) -> io::Result<usize> {
        (&*self.stream).write(buffer)
    }

    fn flush(&mut self) -> io::Result<()> {
        Ok(())
    }
}

impl Stream for DeadlineStream {
    fn set_nonblocking(&self, is_nonblocking: bool) -> io::Result<()> {
        self.stream.set_nonblocking(is_nonblocking)
    }
}
