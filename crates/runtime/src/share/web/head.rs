//! The request of a client of HTTP, up to the empty line, and its answer.

use std::io::Read;
use std::net::SocketAddr;
use std::sync::Arc;
use std::time::{Duration, Instant};

use tungstenite::handshake::server::Request;

use super::folder::PageFolder;
use super::pages;
use super::request::{forbid, no_such_page, parse_request, upgrade};
use super::socket::SocketReader;
use crate::capture::transport::websocket::Admission;
use crate::share::stream::{Disconnected, Input, read};

/// Longest time that a client may take for its request.
const HEAD_TIMEOUT: Duration = Duration::from_secs(2);

/// The path of the WebSocket beside the pages.
const SOCKET_PATH: &str = "/ws";

/// The bytes of a request so far.
pub(in crate::share) struct Head {
    bytes: Vec<u8>,
    deadline: Instant,
    admission: Admission,
    pages: Pages,
}

/// The pages of a server.
#[derive(Clone)]
pub(in crate::share) enum Pages {
    /// None: every path is the WebSocket.
    None,
    /// The viewer, beside the WebSocket.
    Viewer,
    /// The files of a folder, without a WebSocket.
    Folder(Arc<PageFolder>),
}

/// The answer to a request.
pub(in crate::share) struct Answer {
    /// The bytes.
    pub bytes: Arc<[u8]>,
    /// The WebSocket that it opens. Without one, the connection is closed.
    pub socket: Option<SocketReader>,
}

impl Head {
    /// Creates a request without bytes, to a server of pages at an address.
    pub fn new(address: SocketAddr, pages: Pages) -> Self {
        let origins = [address.to_string(), format!("localhost:{}", address.port())];
        Self {
            bytes: Vec::new(),
            deadline: Instant::now() + HEAD_TIMEOUT,
            admission: Admission {
                address,
                origins: origins.map(|host| format!("http://{host}")).to_vec(),
                remedy: "only the page of this server may connect",
            },
            pages,
        }
    }

    /// Receives bytes. Returns the answer once the request is complete or wrong. Fails if the client has gone, or takes
    /// too long.
    pub fn receive(&mut self, stream: &mut dyn Read) -> Result<Option<Answer>, Disconnected> {
        let mut buffer = [0; 1024];
        loop {
            let input = read(stream, &mut buffer);
            // However a client spreads the bytes of its request.
            if Instant::now() > self.deadline {
                return Err(Disconnected);
            }
            match input {
                Input::Bytes(0) | Input::Lost => return Err(Disconnected),
                Input::Nothing => return Ok(None),
                Input::Bytes(count) => self.bytes.extend_from_slice(&buffer[..count]),
            }
            match parse_request(&self.bytes) {
                Ok(Some((length, request))) => return Ok(Some(self.answer(&request, length))),
                Ok(None) => {}
                Err(bytes) => return Ok(Some(Answer::page(bytes))),
            }
        }
    }

    fn answer(&self, request: &Request, length: usize) -> Answer {
        if let Err(reason) = self.admission.check(request) {
            tracing::warn!("refused a client of {}: {reason}", self.admission.address);
            return Answer::page(forbid(&reason));
        }
        let path = request.uri().path();
        let page = match &self.pages {
            Pages::Viewer if path != SOCKET_PATH => Some(pages::file(path).map(Arc::from)),
            Pages::Folder(folder) => Some(folder.answer(path).cloned()),
            Pages::None | Pages::Viewer => None,
        };
        if let Some(page) = page {
            return Answer::page(page.unwrap_or_else(|| no_such_page().into()));
        }
        match upgrade(request) {
            Ok(bytes) => Answer {
                bytes: bytes.into(),
                socket: Some(SocketReader::new(self.bytes[length..].to_vec())),
            },
            Err(bytes) => Answer::page(bytes),
        }
    }
}

impl Answer {
    /// Creates an answer that ends the connection.
    fn page(bytes: impl Into<Arc<[u8]>>) -> Self {
        Self {
            bytes: bytes.into(),
            socket: None,
        }
    }
}

#[cfg(test)]
mod tests {
    use std::fs;

    use super::*;

    #[test]
    fn clients_share_the_bytes_of_a_file() {
        let folder = tempfile::tempdir().unwrap();
        fs::write(folder.path().join("index.html"), "<p>page").unwrap();
        let folder = Arc::new(PageFolder::read(folder.path()).unwrap());
        let address = SocketAddr::from(([127, 0, 0, 1], 8081));
        let mut head = Head::new(address, Pages::Folder(Arc::clone(&folder)));
        let mut request = &b"GET / HTTP/1.1\r\nHost: 127.0.0.1:8081\r\n\r\n"[..];
        let answer = head.receive(&mut request).ok().flatten().unwrap();
        assert!(Arc::ptr_eq(&answer.bytes, folder.answer("/").unwrap()));
    }
}
