//! A connection in memory, for conversations without sockets.

use std::collections::VecDeque;
use std::io::{self, ErrorKind, Read, Write};
use std::sync::{Arc, Mutex, MutexGuard, PoisonError};

use super::Stream;

/// A connection whose other end is in the same process. A clone is the same connection. No call waits.
#[derive(Clone, Debug, Default)]
pub struct MemoryStream(Arc<Mutex<State>>);

#[derive(Debug, Default)]
struct State {
    /// Bytes of the other end that were not read.
    sent: VecDeque<u8>,
    /// Bytes for the other end.
    received: Vec<u8>,
    /// Number of bytes that the other end still accepts.
    room: usize,
}

impl MemoryStream {
    /// Creates a connection whose other end accepts this number of bytes.
    pub fn new(room: usize) -> Self {
        let stream = Self::default();
        stream.set_room(room);
        stream
    }

    /// Sends bytes from the other end.
    pub fn send(&self, bytes: &[u8]) {
        self.state().sent.extend(bytes);
    }

    /// Sets the number of bytes that the other end accepts from now on.
    pub fn set_room(&self, room: usize) {
        self.state().room = room;
    }

    /// Returns the bytes that the other end has received since the last call.
    pub fn take_received(&self) -> Vec<u8> {
        std::mem::take(&mut self.state().received)
    }

    fn state(&self) -> MutexGuard<'_, State> {
        self.0.lock().unwrap_or_else(PoisonError::into_inner)
    }
}

impl Read for MemoryStream {
    fn read(&mut self, buffer: &mut [u8]) -> io::Result<usize> {
        match self.state().sent.read(buffer)? {
            0 => Err(ErrorKind::WouldBlock.into()),
            count => Ok(count),
        }
    }
}

impl Write for MemoryStream {
    fn write(&mut self, buffer: &[u8]) -> io::Result<usize> {
        let mut state = self.state();
        let count = buffer.len().min(state.room);
        state.room -= count;
        state.received.extend_from_slice(&buffer[..count]);
        match count {
            0 => Err(ErrorKind::WouldBlock.into()),
            count => Ok(count),
        }
    }

    fn flush(&mut self) -> io::Result<()> {
        Ok(())
    }
}

impl Stream for MemoryStream {
    fn set_nonblocking(&self, _: bool) -> io::Result<()> {
        Ok(())
    }
}
