//! A connection on which the loop itself presses and releases keys.
//!
//! The servers of X.Org close a connection whose other end is closed before they read what waits in it (`ClientReady` in
//! `os/connection.c`, since 1.19). A press that such a server has not read is therefore revoked by closing the connection,
//! even if the server hangs.

use std::sync::Arc;
use std::time::{Duration, Instant};

use rustix::event::{PollFd, PollFlags, Timespec, poll};
use rustix::fd::{AsFd, OwnedFd};
use rustix::io::Errno;
use rustix::net::{
    AddressFamily, RecvFlags, SendFlags, Shutdown, getsockname, recv, send, shutdown,
};
use x11rb::connection::{Connection, RequestConnection};
use x11rb::protocol::xproto::{GetInputFocusRequest, Setup};
use x11rb::protocol::xtest::{self, FakeInputRequest};
use x11rb::rust_connection::RustConnection;

use super::{fake_input, ignore_grabs};
use crate::output::desktop::direct_keys::{AnswerReader, DirectConnection, KeyWriter};
use crate::output::desktop::injector::WindowId;
use ademan_core::device::KeyCode;
use ademan_core::device::pressed_keys::KeyDirection;

/// The vendor of the servers that close a connection before they read what waits in it.
const VENDOR: &[u8] = b"The X.Org Foundation";
/// The first release of such a server: 1.19.
const FIRST_RELEASE: u32 = 11_900_000;

/// Length of `XTestFakeInput`, in bytes.
const FAKE_INPUT: usize = 36;
/// Length of `GetInputFocus`, in bytes.
const GET_INPUT_FOCUS: usize = 4;

/// Position of the kind in `XTestFakeInput`.
const KIND: usize = 4;
/// Position of the detail in `XTestFakeInput`.
const DETAIL: usize = 5;

/// Length of an error, of an event, and of the reply to `GetInputFocus`, in bytes.
const PACKET: usize = 32;

/// Position of the window in the reply to `GetInputFocus`.
const FOCUS: usize = 8;

/// First byte of an error. Packets other than errors and replies are events.
const ERROR: u8 = 0;
/// First byte of a reply.
const REPLY: u8 = 1;

/// Opens a connection. `None` if the server is not known to close it in time, or does not answer.
pub fn open(name: Option<&str>) -> Option<DirectConnection> {
    let (server, screen) = x11rb::connect(name).ok()?;
    ignore_grabs(&server).ok()?;
    let socket = Socket::from_connection(&server)?;
    if !closes_before_reading(server.setup(), &socket.0) {
        return None;
    }
    let writer = Writer {
        requests: requests(&server, screen)?,
        socket: Arc::clone(&socket),
    };
    Some((Box::new(writer), Box::new(Reader::new(socket))))
}

/// Returns `true` if the server is at the other end of the socket, and closes it before it reads what waits in it. Closing a
/// TCP connection does not show before the bytes are read.
fn closes_before_reading(setup: &Setup, socket: &OwnedFd) -> bool {
    let is_local =
        getsockname(socket).is_ok_and(|name| name.address_family() == AddressFamily::UNIX);
    is_local && setup.vendor == VENDOR && setup.release_number >= FIRST_RELEASE
}

/// Returns the requests for a key event: the event, and a question whose answer shows that the server has executed it.
fn requests(server: &RustConnection, screen: usize) -> Option<[u8; FAKE_INPUT + GET_INPUT_FOCUS]> {
    let xtest = server
        .extension_information(xtest::X11_EXTENSION_NAME)
        .ok()??;
    let event = FakeInputRequest {
        type_: 0,
        detail: 0,
        time: 0,
        root: server.setup().roots[screen].root,
        root_x: 0,
        root_y: 0,
        deviceid: 0,
    };
    let ([event], _) = event.serialize(xtest.major_opcode);
    let ([question], _) = GetInputFocusRequest.serialize();
    [&event[..], &question[..]].concat().try_into().ok()
}

/// A socket that is shut down when either end is dropped.
pub struct Socket(OwnedFd);

impl Socket {
    /// Takes over the socket of a connection that is used for nothing else.
    pub fn from_connection(server: &RustConnection) -> Option<Arc<Self>> {
        let socket = server.stream().as_fd().try_clone_to_owned();
        socket.ok().map(|socket| Arc::new(Self(socket)))
    }

    /// Sends bytes without waiting. Returns the number of bytes that were sent.
    pub fn send(&self, bytes: &[u8]) -> usize {
        let flags = SendFlags::DONTWAIT | SendFlags::NOSIGNAL;
        send(&self.0, bytes, flags).unwrap_or(0)
    }

    fn close(&self) {
        // The server may have closed it.
        let _ = shutdown(&self.0, Shutdown::Both);
    }
}

struct Writer {
    socket: Arc<Socket>,
    requests: [u8; FAKE_INPUT + GET_INPUT_FOCUS],
}

impl KeyWriter for Writer {
    fn write(&mut self, key: KeyCode, direction: KeyDirection) -> bool {
        let Ok((kind, detail)) = fake_input(key, direction) else {
            return false;
        };
        self.requests[KIND] = kind;
        self.requests[DETAIL] = detail;
        let length = self.socket.send(&self.requests);
        if (1..self.requests.len()).contains(&length) {
            // The rest would not fit. Without an answer the event counts as not executed.
            self.socket.close();
        }
        length > 0
    }
}

impl Drop for Writer {
    fn drop(&mut self) {
        self.socket.close();
    }
}

/// The reader of answers to `GetInputFocus`.
pub struct Reader {
    socket: Arc<Socket>,
    /// The bytes of an incomplete packet.
    incomplete: Vec<u8>,
    /// Number of answers that have arrived and were not waited for.
    answers: usize,
    /// The window of the last answer.
    focus: Option<WindowId>,
}

impl Reader {
    /// Creates a reader that has received nothing.
    pub fn new(socket: Arc<Socket>) -> Self {
        Self {
            socket,
            incomplete: Vec::with_capacity(PACKET),
            answers: 0,
            focus: None,
        }
    }

    /// Returns `true` once if an answer has arrived that was not waited for.
    pub fn take_answer(&mut self) -> bool {
        let has_answer = self.answers > 0;
        self.answers -= usize::from(has_answer);
        has_answer
    }

    /// Reads what has arrived. Returns `false` if the connection is closed or the server has rejected an event.
    pub fn receive(&mut self) -> bool {
        let mut bytes = [0; 64 * PACKET];
        loop {
            match recv(&self.socket.0, &mut bytes, RecvFlags::DONTWAIT) {
                Ok((0, _)) => return false,
                Ok((length, _)) => self.incomplete.extend(&bytes[..length]),
                Err(Errno::AGAIN) => return true,
                Err(Errno::INTR) => {}
                Err(_) => return false,
            }
            let (packets, rest) = self.incomplete.as_chunks::<PACKET>();
            if packets.iter().any(|packet| packet[0] == ERROR) {
                return false;
            }
            for packet in packets.iter().filter(|packet| packet[0] == REPLY) {
                self.answers += 1;
                let window = packet[FOCUS..].first_chunk().copied();
                self.focus = window.map(WindowId::from_ne_bytes);
            }
            let complete = self.incomplete.len() - rest.len();
            self.incomplete.drain(..complete);
        }
    }

    /// Waits until something can be read. Returns `false` after `deadline`.
    fn poll(&self, deadline: Instant) -> bool {
        let remaining = deadline.saturating_duration_since(Instant::now());
        let timeout = Timespec::try_from(remaining).ok();
        let is_over = remaining == Duration::ZERO;
        !is_over
            && poll(
                &mut [PollFd::new(&self.socket.0, PollFlags::IN)],
                timeout.as_ref(),
            ) != Ok(0)
    }
}

impl AnswerReader for Reader {
    fn wait_for_answer(&mut self, deadline: Instant) -> bool {
        loop {
            let is_open = self.receive();
            if self.take_answer() {
                return true;
            }
            if !is_open || !self.poll(deadline) {
                return false;
            }
        }
    }

    fn focus(&self) -> Option<WindowId> {
        self.focus
    }

    fn discard_events(&mut self) -> bool {
        self.receive()
    }
}

impl Drop for Reader {
    fn drop(&mut self) {
        self.socket.close();
    }
}
