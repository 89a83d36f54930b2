//! The server: a thread that accepts connections, and one for each of them.

use std::io::{self, Read, Write};
use std::net::{SocketAddr, TcpListener, TcpStream};
use std::path::Path;
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};
use std::thread;
use std::time::{Duration, Instant};

use crossbeam_channel::{Receiver, Sender, bounded};
use tungstenite::WebSocket;
use tungstenite::handshake::server::Request;
use tungstenite::protocol::Role;

use super::HeadsetPages;
use super::hello::{Answer, Hello};
use crate::capture::transport::websocket::{
    Admission, ClientEvent, ClientId, Clients, MessageReceiver, MessageServer, MessageStream,
    QUEUE_CAPACITY, send_when_there_is_room, socket_config,
};
use crate::capture::{Headset, HeadsetList};
use crate::files::OpenDocument;
use crate::network::{
    Gatekeeper, ServerStream, TokenEntry, TokenRole, Unproven, canonical, network_folder,
};
use crate::share::{PageFolder, forbid, no_such_page, parse_request, upgrade};
use ademan_core::document::{Document, FileKind};
use ademan_core::message::escape;

/// The path of the WebSocket.
const SOCKET_PATH: &str = "/hands";

/// Longest time until the first message.
const HELLO_TIMEOUT: Duration = Duration::from_secs(5);

/// Longest time in which a page reads an answer: the text of a layout may have a megabyte.
const ANSWER_TIMEOUT: Duration = Duration::from_secs(5);

/// Longest silence of a headset, after which it is no longer connected.
const SILENCE_LIMIT: Duration = Duration::from_secs(5);

/// Longest time after which a client, and the end of the source, are noticed.
const POLL_INTERVAL: Duration = Duration::from_millis(50);

/// The words of the library for a connection that ends without the farewell of TLS, as by a revoked token or a lost network.
const UNEXPECTED_END: &str = "close_notify";

/// A server on threads of its own, which end when it is dropped.
pub(super) struct Server {
    events: Receiver<ClientEvent>,
    shared: Arc<Shared>,
}

struct Shared {
    admission: Admission,
    keeper: Gatekeeper,
    folder: PageFolder,
    layout: Option<String>,
    sender: Sender<ClientEvent>,
    clients: Clients,
    headsets: HeadsetList,
    is_stopped: AtomicBool,
}

impl Server {
    /// Binds an address and starts to accept connections. The error states the cause and what to do.
    pub fn start(
        address: SocketAddr,
        pages: &HeadsetPages,
        headsets: HeadsetList,
    ) -> Result<Self, String> {
        let folder =
            PageFolder::read(Path::new(&pages.folder)).map_err(|error| error.to_string())?;
        let keeper = network_folder().and_then(|tokens| Gatekeeper::open_for_pages(&tokens));
        let keeper = keeper.map_err(|error| error.to_string())?;
        let in_use = |error: io::Error| {
            format!(
                "cannot listen on {address}: {error}; use an address of this machine, as `ip address` shows it, and a free port"
            )
        };
        let listener = TcpListener::bind(address).map_err(in_use)?;
        let bound = canonical(listener.local_addr().map_err(in_use)?);
        let (sender, events) = bounded(QUEUE_CAPACITY);
        let shared = Arc::new(Shared {
            admission: Admission {
                address: bound,
                origins: vec![format!("https://{bound}")],
                remedy: "only the page of this server may connect",
            },
            keeper,
            folder,
            layout: pages.layout.clone(),
            sender,
            clients: Clients::default(),
            headsets,
            is_stopped: AtomicBool::new(false),
        });
        let accepting = Arc::clone(&shared);
        let accept = move || accept(&accepting, &listener);
        let thread = thread::Builder::new().name("headset".into()).spawn(accept);
        thread.map_err(|error| format!("cannot start a thread: {error}"))?;
        Ok(Self { events, shared })
    }
}

impl MessageServer for Server {
    fn events(&self) -> &Receiver<ClientEvent> {
        &self.events
    }

    fn clients(&self) -> &Clients {
        &self.shared.clients
    }

    fn name(&self) -> String {
        format!("headset:{}", self.shared.admission.address)
    }
}

impl Drop for Server {
    fn drop(&mut self) {
        self.shared.is_stopped.store(true, Ordering::Release);
        self.shared.clients.disconnect_all();
        // Ends the wait for a connection. If it fails, the thread waits for the next one.
        let _ = TcpStream::connect_timeout(&self.shared.admission.address, POLL_INTERVAL);
    }
}

fn accept(shared: &Arc<Shared>, listener: &TcpListener) {
    while !shared.is_stopped() {
        let Ok((stream, address)) = listener.accept() else {
            // Out of file descriptors, for example: they may become free.
            thread::sleep(POLL_INTERVAL);
            continue;
        };
        let serving = Arc::clone(shared);
        shared
            .keeper
            .secure(stream, address.ip(), move |client, stream| {
                // A client that breaks off has got what it wanted, or wants nothing.
                if let Err(error) = serving.serve(client, stream) {
                    tracing::debug!("a connection to the page has ended: {error}");
                }
            });
    }
}

impl Shared {
    fn is_stopped(&self) -> bool {
        self.is_stopped.load(Ordering::Acquire)
    }

    /// Answers a request.
    fn serve(&self, client: Unproven, mut stream: ServerStream) -> io::Result<()> {
        let (request, rest) = match receive_request(&mut stream)? {
            Ok(received) => received,
            Err(refusal) => return finish(stream, &refusal),
        };
        if let Err(reason) = self.admission.check(&request) {
            tracing::warn!(
                "refused a client of the page at {}: {reason}",
                client.address()
            );
            return finish(stream, &forbid(&reason));
        }
        let path = request.uri().path();
        if path != SOCKET_PATH {
            return match self.folder.answer(path) {
                Some(page) => finish(stream, page),
                None => finish(stream, &no_such_page()),
            };
        }
        let answer = match upgrade(&request) {
            Ok(answer) => answer,
            Err(refusal) => return finish(stream, &refusal),
        };
        stream.write_all(&answer)?;
        stream.flush()?;
        // The first message has a deadline of its own, however slowly its bytes and the records of TLS arrive.
        stream.sock.restart_deadline(HELLO_TIMEOUT)?;
        let stream = MessageStream::new(stream);
        let socket =
            WebSocket::from_partially_read(stream, rest, Role::Server, Some(socket_config()));
        self.converse(client, MessageReceiver::new(socket));
        Ok(())
    }

    /// Receives the token, and then the hands.
    fn converse(&self, client: Unproven, mut receiver: MessageReceiver<ServerStream>) {
        let Some(hello) = self.receive_hello(&mut receiver) else {
            return;
        };
        let token = client.prove(&hello.token).ok().flatten();
        let Some(token) = token.filter(|token| token.role != TokenRole::See) else {
            refuse(&mut receiver, &Answer::Refused);
            return;
        };
        let (address, socket) = (client.address(), client.socket());
        // It is no longer a handshake.
        drop(client);
        let Some(id) = self.clients.add(&socket) else {
            refuse(&mut receiver, &Answer::Busy);
            return;
        };
        let headset = Headset::new(&hello.name, address);
        let (name, TokenEntry { name: token, .. }) = (headset.name.clone(), token);
        let connected = self.headsets.add(headset);
        tracing::info!(
            "the headset `{name}` at {address} has connected with the token `{token}`; `ademan token revoke {token}` disconnects it"
        );
        let layout = self.layout.as_deref().and_then(layout_text);
        let welcome = Answer::Welcome { layout }.to_text();
        receiver.limit_silence(SILENCE_LIMIT);
        let reason = match receiver.send(welcome, ANSWER_TIMEOUT) {
            Ok(()) => receiver.receive(
                || self.is_stopped() || !self.clients.is_connected(id),
                |line| self.send(id, ClientEvent::Message(id, line)),
            ),
            Err(reason) => reason,
        };
        drop(connected);
        let is_replaced = !self.clients.is_connected(id);
        let reason = reason_of_end(reason, self.is_stopped(), is_replaced);
        tracing::info!("the headset `{name}` has left: {}", escape(&reason));
        self.send(id, ClientEvent::Left(id, reason));
        self.clients.remove(id);
    }

    fn receive_hello(&self, receiver: &mut MessageReceiver<ServerStream>) -> Option<Hello> {
        let deadline = Instant::now() + HELLO_TIMEOUT;
        while Instant::now() < deadline && !self.is_stopped() {
            if let Some(message) = receiver.next().ok()? {
                let stream = receiver.socket_mut().get_mut().stream_mut();
                stream.sock.end_deadline(POLL_INTERVAL).ok()?;
                return Hello::parse(&message);
            }
        }
        None
    }

    fn send(&self, id: ClientId, event: ClientEvent) -> bool {
        let is_open = || !self.is_stopped() && self.clients.is_connected(id);
        send_when_there_is_room(&self.sender, event, is_open)
    }
}

/// Returns the reason why a headset has left, from the words for the end of its connection. A headset that `is_replaced` was
/// disconnected by the server, which reads one at a time.
fn reason_of_end(words: String, is_stopped: bool, is_replaced: bool) -> String {
    if is_stopped {
        "the server stops".to_owned()
    } else if is_replaced {
        "it made room for another headset".to_owned()
    } else if words.contains(UNEXPECTED_END) {
        "the connection has broken off, or the token was revoked".to_owned()
    } else {
        words
    }
}

/// A request with the bytes after it, or the answer that refuses it.
type Received = Result<(Request, Vec<u8>), Vec<u8>>;

/// Receives a request.
fn receive_request(stream: &mut ServerStream) -> io::Result<Received> {
    let (mut bytes, mut buffer) = (Vec::new(), [0; 1024]);
    loop {
        match stream.read(&mut buffer)? {
            0 => return Err(io::ErrorKind::UnexpectedEof.into()),
            count => bytes.extend_from_slice(&buffer[..count]),
        }
        match parse_request(&bytes) {
            Ok(Some((length, request))) => return Ok(Ok((request, bytes.split_off(length)))),
            Ok(None) => {}
            Err(refusal) => return Ok(Err(refusal)),
        }
    }
}

/// Sends an answer, and ends the connection as TLS asks for.
fn finish(mut stream: ServerStream, bytes: &[u8]) -> io::Result<()> {
    stream.write_all(bytes)?;
    stream.conn.send_close_notify();
    stream.flush()
}

/// Answers a page whose hands are not read, and ends its connection.
fn refuse(receiver: &mut MessageReceiver<ServerStream>, answer: &Answer) {
    if receiver.send(answer.to_text(), ANSWER_TIMEOUT).is_ok() {
        let socket = receiver.socket_mut();
        let _ = socket.close(None);
        let _ = socket.flush();
    }
}

/// Returns the present text of a layout: of a file, or of one that comes with the program.
fn layout_text(name: &str) -> Option<String> {
    let document = Document::open_kind(FileKind::Layout, name);
    if let Err(error) = &document {
        tracing::warn!("the headset keeps the layout of its page: {error}");
    }
    document.ok().map(|document| document.text)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_headset_that_makes_room_leaves_for_that_reason_and_not_for_the_end_of_the_server() {
        let broken = "peer closed connection without sending TLS close_notify";
        for (words, is_stopped, is_replaced, expected) in [
            ("the server stops", false, true, "made room for another"),
            (broken, false, true, "made room for another"),
            (broken, true, true, "the server stops"),
            (broken, false, false, "broken off, or the token was revoked"),
            ("it sent nonsense", false, false, "it sent nonsense"),
        ] {
            let reason = reason_of_end(words.to_owned(), is_stopped, is_replaced);
            assert!(reason.contains(expected), "{words}: {reason}");
        }
    }
}
