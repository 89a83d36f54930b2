//! The lines that a client has not read yet.

use std::collections::VecDeque;
use std::io::{ErrorKind, IoSlice};
use std::sync::Arc;
use std::time::{Duration, Instant};

use super::stream::Disconnected;
use crate::network::Stream;

/// Most bytes that wait for a client: a tenth of a second of everything that a fast glove causes.
const MAX_BYTES: usize = 1 << 18;

/// Most chunks that wait for a client: short lines take more memory than their bytes.
const MAX_CHUNKS: usize = 4096;

/// Longest time in which a client reads nothing while lines wait for it.
const READ_TIMEOUT: Duration = Duration::from_secs(1);

/// Chunks of one write.
const CHUNKS_PER_WRITE: usize = 128;

/// Lines that are written together. All clients share the bytes.
#[derive(Clone, Debug)]
pub(super) struct Chunk {
    /// The lines with their ends.
    pub bytes: Arc<[u8]>,
    /// The number of lines.
    pub lines: u64,
}

impl From<Arc<[u8]>> for Chunk {
    /// Returns one line.
    fn from(bytes: Arc<[u8]>) -> Self {
        Self { bytes, lines: 1 }
    }
}

/// Lines that wait for a client.
pub(super) struct Outbox {
    chunks: VecDeque<Chunk>,
    /// The bytes of all chunks.
    bytes: usize,
    /// The bytes of the first chunk that were written.
    written: usize,
    /// Lines that were dropped since the last [`take_dropped`](Self::take_dropped).
    dropped: u64,
    /// The time of the last write, or of the first line that waits after it.
    progress_at: Instant,
}

impl Outbox {
    /// Creates an outbox without lines.
    pub fn new() -> Self {
        Self {
            chunks: VecDeque::new(),
            bytes: 0,
            written: 0,
            dropped: 0,
            progress_at: Instant::now(),
        }
    }

    /// Returns `true` if no line waits.
    pub fn is_empty(&self) -> bool {
        self.chunks.is_empty()
    }

    /// Returns the number of dropped lines since the last call.
    pub fn take_dropped(&mut self) -> u64 {
        std::mem::take(&mut self.dropped)
    }

    /// Adds lines. While too much waits, the oldest chunk that was not begun is dropped and its lines are counted. An empty
    /// chunk is none: to write no bytes looks like the end of the connection.
    pub fn push(&mut self, chunk: impl Into<Chunk>) {
        let chunk = chunk.into();
        if chunk.bytes.is_empty() {
            return;
        }
        if self.chunks.is_empty() {
            self.progress_at = Instant::now();
        }
        self.bytes += chunk.bytes.len();
        self.chunks.push_back(chunk);
        let first = usize::from(self.written > 0);
        // The new chunk stays, however long it is.
        while (self.bytes > MAX_BYTES || self.chunks.len() > MAX_CHUNKS)
            && self.chunks.len() > first + 1
        {
            if let Some(oldest) = self.chunks.remove(first) {
                self.bytes -= oldest.bytes.len();
                self.dropped += oldest.lines;
            }
        }
    }

    /// Writes what the client accepts. Fails if it has gone, or has read nothing for one second.
    pub fn flush(&mut self, stream: &mut dyn Stream) -> Result<(), Disconnected> {
        while !self.chunks.is_empty() {
            let mut slices = [IoSlice::new(&[]); CHUNKS_PER_WRITE];
            for (slice, chunk) in slices.iter_mut().zip(&self.chunks) {
                *slice = IoSlice::new(&chunk.bytes);
            }
            slices[0] = IoSlice::new(&self.chunks[0].bytes[self.written..]);
            let count = self.chunks.len().min(CHUNKS_PER_WRITE);
            match stream.write_vectored(&slices[..count]) {
                Ok(0) => return Err(Disconnected),
                Ok(bytes) => self.advance(bytes),
                Err(error) if error.kind() == ErrorKind::Interrupted => {}
                Err(error) if error.kind() == ErrorKind::WouldBlock => {
                    return if self.progress_at.elapsed() > READ_TIMEOUT {
                        Err(Disconnected)
                    } else {
                        Ok(())
                    };
                }
                Err(_) => return Err(Disconnected),
            }
        }
        match stream.flush() {
            Err(error) if error.kind() != ErrorKind::WouldBlock => Err(Disconnected),
            _ => Ok(()),
        }
    }

    /// Removes bytes that were written.
    fn advance(&mut self, bytes: usize) {
        self.progress_at = Instant::now();
        self.written += bytes;
        while let Some(chunk) = self.chunks.front()
            && self.written >= chunk.bytes.len()
        {
            self.written -= chunk.bytes.len();
            self.bytes -= chunk.bytes.len();
            self.chunks.pop_front();
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::network::MemoryStream;

    #[test]
    fn a_slow_client_loses_whole_lines_and_never_the_one_that_was_begun() {
        let mut outbox = Outbox::new();
        let mut stream = MemoryStream::new(10);
        let line = |number: usize| -> Arc<[u8]> {
            let mut line = vec![b'0' + (number % 10) as u8; MAX_BYTES / 4];
            line.push(b'\n');
            line.into()
        };
        for number in 0..8 {
            outbox.push(line(number));
            assert!(outbox.flush(&mut stream).is_ok());
        }
        assert_eq!(outbox.take_dropped(), 5);
        assert_eq!(outbox.take_dropped(), 0);
        stream.set_room(usize::MAX);
        assert!(outbox.flush(&mut stream).is_ok());
        assert!(outbox.is_empty());
        let received = String::from_utf8(stream.take_received()).unwrap();
        let first: String = received
            .lines()
            .map(|received_line| &received_line[..1])
            .collect();
        assert_eq!(first, "067");
        assert!(
            received
                .lines()
                .all(|received_line| received_line.len() == MAX_BYTES / 4)
        );
    }

    #[test]
    fn short_lines_are_dropped_by_their_number_and_empty_ones_do_not_end_the_connection() {
        let mut outbox = Outbox::new();
        for _ in 0..3 * MAX_CHUNKS {
            outbox.push(Arc::<[u8]>::from(&b""[..]));
            outbox.push(Arc::<[u8]>::from(&b"\n"[..]));
        }
        assert_eq!(outbox.chunks.len(), MAX_CHUNKS);
        assert_eq!(outbox.take_dropped(), 2 * MAX_CHUNKS as u64);
        let mut stream = MemoryStream::new(usize::MAX);
        assert!(outbox.flush(&mut stream).is_ok());
        assert_eq!(stream.take_received().len(), MAX_CHUNKS);
    }
}
