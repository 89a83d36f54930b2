//! A client of a server, with the lines that it has not read yet.

use std::collections::VecDeque;
use std::io::{ErrorKind, Read, Write};
use std::net::TcpStream;
use std::sync::Arc;
use std::time::{Duration, Instant};

/// Lines that wait for a client: a third of a second of a fast glove.
const MAX_LINES: usize = 64;

/// Longest time in which a client reads nothing while lines wait for it.
const READ_TIMEOUT: Duration = Duration::from_secs(1);

/// A connected client.
pub(super) struct Client {
    stream: TcpStream,
    lines: VecDeque<Arc<[u8]>>,
    /// The bytes of the first line that were written.
    written: usize,
    /// The time of the last write, or of the first line that waits after it.
    progress_at: Instant,
}

/// The client has to be disconnected.
pub(super) struct Disconnected;

impl Client {
    /// Takes over a connection. Fails if it does not support writing without waiting.
    pub(super) fn new(stream: TcpStream) -> std::io::Result<Self> {
        stream.set_nonblocking(true)?;
        // Each line is the state of now.
        stream.set_nodelay(true)?;
        Ok(Self {
            stream,
            lines: VecDeque::with_capacity(MAX_LINES),
            written: 0,
            progress_at: Instant::now(),
        })
    }

    /// Adds a line and writes what the client accepts. When too many lines wait, the oldest one that was not begun is
    /// dropped.
    pub(super) fn push(&mut self, line: &Arc<[u8]>) -> Result<(), Disconnected> {
        if self.lines.is_empty() {
            self.progress_at = Instant::now();
        }
        if self.lines.len() == MAX_LINES {
            self.lines.remove(usize::from(self.written > 0));
        }
        self.lines.push_back(line.clone());
        self.flush()
    }

    /// Writes what the client accepts. Fails if it has gone, has read nothing for one second, or has sent anything.
    pub(super) fn flush(&mut self) -> Result<(), Disconnected> {
        while let Some(line) = self.lines.front() {
            match self.stream.write(&line[self.written..]) {
                Ok(0) => return Err(Disconnected),
                Ok(count) => {
                    self.progress_at = Instant::now();
                    self.written += count;
                    if self.written == line.len() {
                        self.written = 0;
                        self.lines.pop_front();
                    }
                }
                Err(error) if error.kind() == ErrorKind::Interrupted => {}
                Err(error) if error.kind() == ErrorKind::WouldBlock => {
                    if self.progress_at.elapsed() > READ_TIMEOUT {
                        return Err(Disconnected);
                    }
                    break;
                }
                Err(_) => return Err(Disconnected),
            }
        }
        Ok(())
    }

    /// Fails if the client has sent anything.
    pub(super) fn check_silence(&mut self) -> Result<(), Disconnected> {
        match self.stream.read(&mut [0; 1]) {
            Ok(1..) => Err(Disconnected),
            // A client that will never send has closed its half of the connection.
            Ok(0) => Ok(()),
            Err(error) if error.kind() == ErrorKind::WouldBlock => Ok(()),
            Err(error) if error.kind() == ErrorKind::Interrupted => Ok(()),
            Err(_) => Err(Disconnected),
        }
    }

    /// Returns whether lines wait for the client.
    pub(super) fn is_behind(&self) -> bool {
        !self.lines.is_empty()
    }
}
