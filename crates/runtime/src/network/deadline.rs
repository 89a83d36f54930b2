//! A TCP connection whose reads fail after a deadline, however slowly bytes arrive.

use std::io::{self, ErrorKind, Read, Write};
use std::net::TcpStream;
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};
use std::time::{Duration, Instant};

use super::Stream;

/// Most bytes that are read at once without waiting. The library for TLS reads on while a client sends records without content.
const MAX_BURST_BYTES: usize = 1 << 16;

/// A TCP connection that can be shut down by the holder of another reference to it.
#[derive(Debug)]
pub(crate) struct DeadlineStream {
    stream: Arc<TcpStream>,
    deadline: Option<Instant>,
    /// Reads do not wait.
    is_nonblocking: AtomicBool,
    /// Bytes that were read without waiting since a read has failed.
    burst_bytes: usize,
}

impl DeadlineStream {
    /// Limits reads, and each single write, to a time from now.
    pub(crate) fn new(stream: Arc<TcpStream>, limit: Duration) -> io::Result<Self> {
        stream.set_write_timeout(Some(limit))?;
        Ok(Self {
            stream,
            deadline: Some(Instant::now() + limit),
            is_nonblocking: AtomicBool::new(false),
            burst_bytes: 0,
        })
    }

    /// Limits reads, and each single write, to another time from now.
    #[cfg(feature = "tls")]
    pub(crate) fn restart_deadline(&mut self, limit: Duration) -> io::Result<()> {
        self.stream.set_write_timeout(Some(limit))?;
        self.deadline = Some(Instant::now() + limit);
        Ok(())
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
        if !self.is_nonblocking.load(Ordering::Relaxed) {
            let read = (&*self.stream).read(buffer);
            return read.map_err(|error| match error.kind() {
                // The error of Unix for a timeout.
                ErrorKind::WouldBlock if self.deadline.is_some() => ErrorKind::TimedOut.into(),
                _ => error,
            });
        }
        if self.burst_bytes >= MAX_BURST_BYTES {
            self.burst_bytes = 0;
            return Err(ErrorKind::WouldBlock.into());
        }
        let read = (&*self.stream).read(buffer);
        let count = *read.as_ref().unwrap_or(&0);
        self.burst_bytes = if count > 0 {
            self.burst_bytes + count
        } else {
            0
        };
        read
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
        self.stream.set_nonblocking(is_nonblocking)?;
        self.is_nonblocking.store(is_nonblocking, Ordering::Relaxed);
        Ok(())
    }
}

#[cfg(test)]
mod tests {
    use std::net::TcpListener;
    use std::thread;

    use super::*;

    /// Returns a client, and the server's end of its connection with a deadline.
    fn connected(limit: Duration) -> (TcpStream, DeadlineStream) {
        let listener = TcpListener::bind("127.0.0.1:0").unwrap();
        let client = TcpStream::connect(listener.local_addr().unwrap()).unwrap();
        let server = Arc::new(listener.accept().unwrap().0);
        (client, DeadlineStream::new(server, limit).unwrap())
    }

    #[test]
    fn a_read_from_a_silent_peer_times_out() {
        let (_silent, mut stream) = connected(Duration::from_millis(10));
        let error = stream.read(&mut [0]).unwrap_err();
        assert_eq!(error.kind(), ErrorKind::TimedOut);
    }

    #[cfg(feature = "tls")]
    #[test]
    fn bytes_after_a_deadline_are_read_only_within_another_one() {
        let (mut client, mut stream) = connected(Duration::from_millis(1));
        let error = stream.read(&mut [0]).unwrap_err();
        assert_eq!(error.kind(), ErrorKind::TimedOut);
        while stream.deadline.is_some_and(|end| Instant::now() < end) {
            thread::yield_now();
        }
        client.write_all(b"ab").unwrap();
        let late = stream.read(&mut [0]).unwrap_err();
        assert_eq!(late.kind(), ErrorKind::TimedOut);
        stream.restart_deadline(Duration::from_secs(60)).unwrap();
        assert_eq!(stream.read(&mut [0]).unwrap(), 1);
    }

    #[test]
    fn reads_of_a_flood_are_interrupted_if_the_server_does_not_wait() {
        let (mut client, mut stream) = connected(Duration::from_secs(60));
        stream.end_deadline(Duration::from_secs(60)).unwrap();
        stream.set_nonblocking(true).unwrap();
        let flood = vec![0; 256 * MAX_BURST_BYTES];
        let length = flood.len();
        let sender = thread::spawn(move || client.write_all(&flood));
        let mut buffer = vec![0; MAX_BURST_BYTES / 4];
        let (mut bursts, mut burst) = (Vec::new(), 0);
        loop {
            match stream.read(&mut buffer) {
                Ok(0) => break,
                Ok(count) => burst += count,
                Err(error) => {
                    assert_eq!(error.kind(), ErrorKind::WouldBlock);
                    bursts.push(std::mem::take(&mut burst));
                    // The buffers of the connection fill.
                    thread::sleep(Duration::from_millis(2));
                }
            }
        }
        sender.join().unwrap().unwrap();
        assert_eq!(bursts.iter().sum::<usize>() + burst, length);
        let longest = bursts.into_iter().max().unwrap();
        assert!(longest <= MAX_BURST_BYTES + buffer.len(), "{longest}");
    }
}
