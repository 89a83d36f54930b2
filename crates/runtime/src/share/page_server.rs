//! A server of the files of a folder, to this machine only.

use std::io::{self, ErrorKind, Read, Write};
use std::net::{SocketAddr, TcpListener, TcpStream};
use std::ops::ControlFlow;
use std::sync::Arc;
use std::sync::atomic::{AtomicUsize, Ordering};
use std::thread;
use std::time::{Duration, Instant};

use super::ShareError;
use super::listener::AcceptThread;
use super::web::{Head, PageFolder, Pages};

/// Most connections at once; further ones are closed. A browser opens six.
const MAX_CLIENTS: usize = 32;

/// Longest time for a write, and for the rest of what a client sends.
const TIMEOUT: Duration = Duration::from_secs(5);

/// Fewest bytes of an answer that a client reads in a second, after [`TIMEOUT`]: a slow tunnel to another machine carries more.
const MIN_BYTES_PER_SECOND: u64 = 1 << 16;

/// Longest time for one read of a request.
const READ_INTERVAL: Duration = Duration::from_millis(50);

/// A server of a folder, until this is dropped. Each connection has a thread of its own, for one request.
pub struct PageServer(AcceptThread);

impl PageServer {
    /// Serves a folder at an address of this machine.
    pub fn start(address: SocketAddr, folder: PageFolder) -> Result<Self, ShareError> {
        let listen_error = |error| ShareError::Listen { address, error };
        if !address.ip().is_loopback() {
            return Err(listen_error(ErrorKind::AddrNotAvailable.into()));
        }
        let listener = TcpListener::bind(address).map_err(listen_error)?;
        let bound = listener.local_addr().map_err(listen_error)?;
        let pages = Pages::Folder(Arc::new(folder));
        let clients = Arc::new(AtomicUsize::new(0));
        let thread = AcceptThread::start("page", listener, bound, move |stream, _| {
            serve(stream, bound, &pages, &clients);
            ControlFlow::Continue(())
        })?;
        Ok(Self(thread))
    }

    /// Returns the address with the port.
    pub fn address(&self) -> SocketAddr {
        self.0.address()
    }
}

/// Answers a client on a thread of its own, unless there are too many.
fn serve(stream: TcpStream, address: SocketAddr, pages: &Pages, clients: &Arc<AtomicUsize>) {
    if clients.fetch_add(1, Ordering::AcqRel) >= MAX_CLIENTS {
        clients.fetch_sub(1, Ordering::AcqRel);
        return;
    }
    let (pages, own) = (pages.clone(), Arc::clone(clients));
    let answer = move || {
        // A client that has gone is not told.
        let _ = answer(stream, Head::new(address, pages));
        own.fetch_sub(1, Ordering::AcqRel);
    };
    let spawned = thread::Builder::new()
        .name("page-client".into())
        .spawn(answer);
    if spawned.is_err() {
        clients.fetch_sub(1, Ordering::AcqRel);
    }
}

fn answer(mut stream: TcpStream, mut head: Head) -> io::Result<()> {
    stream.set_read_timeout(Some(READ_INTERVAL))?;
    let answer = loop {
        match head.receive(&mut stream) {
            Ok(Some(answer)) => break answer,
            Ok(None) => {}
            Err(_) => return Ok(()),
        }
    };
    let time = TIMEOUT + Duration::from_secs(answer.bytes.len() as u64 / MIN_BYTES_PER_SECOND);
    write_by(&mut stream, &answer.bytes, Instant::now() + time)?;
    stream.shutdown(std::net::Shutdown::Write)?;
    // The rest is read, or closing the connection would take the end of the answer back.
    read_rest(&mut stream, Instant::now() + TIMEOUT)
}

/// Writes all bytes, each part within [`TIMEOUT`]. Fails at the deadline: however slowly a client reads, its place becomes free.
fn write_by(stream: &mut TcpStream, mut bytes: &[u8], deadline: Instant) -> io::Result<()> {
    while !bytes.is_empty() {
        let left = deadline.saturating_duration_since(Instant::now());
        if left.is_zero() {
            return Err(ErrorKind::TimedOut.into());
        }
        stream.set_write_timeout(Some(left.min(TIMEOUT)))?;
        match stream.write(bytes) {
            Ok(0) => return Err(ErrorKind::WriteZero.into()),
            Ok(count) => bytes = &bytes[count..],
            Err(error) if error.kind() == ErrorKind::Interrupted => {}
            Err(error) => return Err(error),
        }
    }
    Ok(())
}

/// Reads until the client closes the connection, or until the deadline: however a client spreads its bytes, its place becomes free.
fn read_rest(stream: &mut TcpStream, deadline: Instant) -> io::Result<()> {
    let mut rest = [0; 1024];
    loop {
        let left = deadline.saturating_duration_since(Instant::now());
        if left.is_zero() {
            return Ok(());
        }
        stream.set_read_timeout(Some(left))?;
        if stream.read(&mut rest)? == 0 {
            return Ok(());
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn an_answer_is_written_whole_but_not_beyond_its_deadline() {
        let listener = TcpListener::bind("127.0.0.1:0").unwrap();
        let mut client = TcpStream::connect(listener.local_addr().unwrap()).unwrap();
        let mut server = listener.accept().unwrap().0;
        let late = write_by(&mut server, b"late", Instant::now()).unwrap_err();
        assert_eq!(late.kind(), ErrorKind::TimedOut);

        let answer = vec![b'x'; 1 << 24];
        let length = answer.len();
        let deadline = Instant::now() + Duration::from_secs(60);
        let writer = thread::spawn(move || write_by(&mut server, &answer, deadline));
        let mut received = Vec::new();
        client.read_to_end(&mut received).unwrap();
        writer.join().unwrap().unwrap();
        assert_eq!(received.len(), length);
    }
}
