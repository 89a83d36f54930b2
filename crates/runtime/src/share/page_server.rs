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
    stream.set_write_timeout(Some(TIMEOUT))?;
    let answer = loop {
        match head.receive(&mut stream) {
            Ok(Some(answer)) => break answer,
            Ok(None) => {}
            Err(_) => return Ok(()),
        }
    };
    stream.write_all(&answer.bytes)?;
    stream.shutdown(std::net::Shutdown::Write)?;
    // The rest is read, or closing the connection would take the end of the answer back.
    read_rest(&mut stream, Instant::now() + TIMEOUT)
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
