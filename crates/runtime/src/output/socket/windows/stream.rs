//! A connection over a pipe, with time-outs, which pipes do not have.

use std::convert::Infallible;
use std::io::{self, Read, Write};
use std::net::Shutdown;
use std::sync::{Arc, Mutex, MutexGuard, PoisonError};
use std::thread;
use std::time::Duration;

use crossbeam_channel::{Receiver, Sender, after, bounded, never, select};
use interprocess::os::windows::named_pipe::DuplexPipeStream;
use interprocess::os::windows::named_pipe::pipe_mode::Bytes;

/// Bytes of one read.
const CHUNK: usize = 4096;

/// Pieces that are read ahead. A peer that sends more waits.
const CHUNKS: usize = 4;

type Pipe = Arc<DuplexPipeStream<Bytes>>;

/// A connection to a client or server. A thread reads, another one writes.
pub(crate) struct Stream {
    incoming: Receiver<Vec<u8>>,
    /// The rest of the latest piece, and its start.
    rest: Mutex<(Vec<u8>, usize)>,
    outgoing: Sender<Vec<u8>>,
    written: Receiver<io::Result<()>>,
    timeouts: Mutex<Timeouts>,
    /// `None` after the shutdown, which disconnects `is_closed`.
    open: Mutex<Option<Sender<Infallible>>>,
    is_closed: Receiver<Infallible>,
}

/// Longest waits; `None` waits indefinitely.
#[derive(Clone, Copy, Default)]
struct Timeouts {
    read: Option<Duration>,
    write: Option<Duration>,
}

impl Stream {
    /// Starts the threads of a connection.
    pub fn new(pipe: DuplexPipeStream<Bytes>) -> io::Result<Self> {
        // A peer can still read what is left after the handle is closed, so closing need not wait for a flush.
        pipe.assume_flushed();
        let pipe = Arc::new(pipe);
        let (open, is_closed) = bounded(0);
        let (send_incoming, incoming) = bounded(CHUNKS);
        let (outgoing, to_write) = bounded(0);
        let (send_written, written) = bounded(1);
        let (reader, closed) = (Arc::clone(&pipe), is_closed.clone());
        spawn("pipe read", move || {
            read_all(&reader, &send_incoming, &closed)
        })?;
        spawn("pipe write", move || {
            write_all(&pipe, &to_write, &send_written)
        })?;
        Ok(Self {
            incoming,
            rest: Mutex::default(),
            outgoing,
            written,
            timeouts: Mutex::default(),
            open: Mutex::new(Some(open)),
            is_closed,
        })
    }

    /// Sets the longest wait of a read.
    pub fn set_read_timeout(&self, timeout: Option<Duration>) -> io::Result<()> {
        lock(&self.timeouts).read = timeout;
        Ok(())
    }

    /// Sets the longest wait of a write.
    pub fn set_write_timeout(&self, timeout: Option<Duration>) -> io::Result<()> {
        lock(&self.timeouts).write = timeout;
        Ok(())
    }

    /// Ends both directions: reads return 0, writes fail. The peer sees the end once its own writes or this process end.
    pub fn shutdown(&self, _: Shutdown) -> io::Result<()> {
        *lock(&self.open) = None;
        Ok(())
    }

    fn next_piece(&self) -> io::Result<Vec<u8>> {
        let timeout = lock(&self.timeouts).read.map_or(never(), after);
        select! {
            recv(self.incoming) -> piece => Ok(piece.unwrap_or_default()),
            recv(self.is_closed) -> _ => Ok(Vec::new()),
            recv(timeout) -> _ => Err(timed_out()),
        }
    }
}

impl Read for &Stream {
    fn read(&mut self, buffer: &mut [u8]) -> io::Result<usize> {
        let mut rest = lock(&self.rest);
        if rest.1 >= rest.0.len() {
            *rest = (self.next_piece()?, 0);
        }
        let (piece, start) = &mut *rest;
        let length = buffer.len().min(piece.len() - *start);
        buffer[..length].copy_from_slice(&piece[*start..*start + length]);
        *start += length;
        Ok(length)
    }
}

impl Write for &Stream {
    /// Returns when the pipe has taken all bytes.
    fn write(&mut self, bytes: &[u8]) -> io::Result<usize> {
        let timeout = lock(&self.timeouts).write.map_or(never(), after);
        select! {
            send(self.outgoing, bytes.to_vec()) -> sent => {
                sent.map_err(|_| io::Error::from(io::ErrorKind::BrokenPipe))?;
            }
            recv(self.is_closed) -> _ => return Err(io::ErrorKind::BrokenPipe.into()),
            recv(timeout) -> _ => return Err(timed_out()),
        }
        select! {
            recv(self.written) -> written => match written {
                Ok(result) => result.map(|()| bytes.len()),
                Err(_) => Err(io::ErrorKind::BrokenPipe.into()),
            },
            recv(self.is_closed) -> _ => Err(io::ErrorKind::BrokenPipe.into()),
            recv(timeout) -> _ => {
                // A later write must not have the result of this one.
                let _ = self.shutdown(Shutdown::Both);
                Err(timed_out())
            }
        }
    }

    fn flush(&mut self) -> io::Result<()> {
        Ok(())
    }
}

impl Read for Stream {
    fn read(&mut self, buffer: &mut [u8]) -> io::Result<usize> {
        (&*self).read(buffer)
    }
}

impl Write for Stream {
    fn write(&mut self, bytes: &[u8]) -> io::Result<usize> {
        (&*self).write(bytes)
    }

    fn flush(&mut self) -> io::Result<()> {
        Ok(())
    }
}

fn read_all(pipe: &Pipe, incoming: &Sender<Vec<u8>>, is_closed: &Receiver<Infallible>) {
    let mut buffer = [0; CHUNK];
    while let Ok(length @ 1..) = (&**pipe).read(&mut buffer) {
        let sent = select! {
            send(incoming, buffer[..length].to_vec()) -> sent => sent.is_ok(),
            recv(is_closed) -> _ => false,
        };
        if !sent {
            return;
        }
    }
}

fn write_all(pipe: &Pipe, outgoing: &Receiver<Vec<u8>>, written: &Sender<io::Result<()>>) {
    for bytes in outgoing {
        let result = (&**pipe).write_all(&bytes);
        pipe.assume_flushed();
        let is_broken = result.is_err();
        if written.send(result).is_err() || is_broken {
            return;
        }
    }
}

fn timed_out() -> io::Error {
    io::Error::new(io::ErrorKind::TimedOut, "timed out")
}

fn lock<T>(mutex: &Mutex<T>) -> MutexGuard<'_, T> {
    mutex.lock().unwrap_or_else(PoisonError::into_inner)
}

fn spawn(name: &str, work: impl FnOnce() + Send + 'static) -> io::Result<()> {
    thread::Builder::new()
        .name(name.into())
        .spawn(work)
        .map(drop)
}
