//! The hand of a session for other programs on this machine: joint angles, poses, touches and events.
//!
//! | format | transport | sent |
//! |---|---|---|
//! | `text-line`, `angles`, `pose` | TCP | one line for each accepted reading, to every client |
//! | `json` | TCP | lines of the kinds that a client asks for |
//! | `ws`, `web` | WebSocket | the same as messages; `web` also serves a page that shows them |
//! | `vmc`, `opentrack` | UDP | datagrams to one address |
//!
//! Everything is sent by one thread, the [hub](ShareHub)'s, which encodes each line once for all clients. The session hands it
//! steps through a bounded queue and waits for nothing. Connections are accepted on threads of their own, one for each port,
//! and passed on as streams of bytes.
//!
//! No client occupies the thread: a round reads a limited number of bytes of each one, a WebSocket may send a limited number of
//! frames in a second, and lines beyond a limit are dropped. The number of clients is limited, too; one that asks for nothing
//! makes room for another.
//!
//! A plain address is one of this machine, because the angles of a typing hand tell what is typed. A program on another
//! machine shows a token behind TLS ([`crate::network`]), or receives what a router of zenoh passes on. A client of a format
//! without requests is disconnected when it sends anything, so that no web page can make a request of it.

mod answer;
mod broadcast;
mod client;
mod conversation;
mod datagrams;
mod frame;
mod hub;
mod kinds;
mod lines;
mod listener;
mod outbox;
mod page_server;
mod request;
mod request_lines;
mod rounds;
mod step;
mod stream;
mod target;
mod web;

pub use answer::{ShareAnswer, answer};
pub use hub::ShareHub;
pub use kinds::ShareKind;
pub use page_server::PageServer;
pub use target::{ShareFormat, ShareLink, ShareTarget};
pub use web::{PageFolder, PageFolderError};
#[cfg(feature = "tls")]
pub(crate) use web::{forbid, no_such_page, parse_request, upgrade};

use std::io;
use std::net::SocketAddr;

use crate::network::NetworkError;
use crate::network::zenoh::ZenohError;
use ademan_core::message::{escape, escape_line};

/// The reason why a hand cannot be shared.
#[derive(Debug, thiserror::Error)]
pub enum ShareError {
    /// The text names no target.
    #[error("cannot share with `{}`: {}", escape(.text), escape_line(.reason))]
    InvalidTarget {
        /// The text as written.
        text: String,
        /// The error in it.
        reason: String,
    },
    /// The address cannot be used.
    #[error(
        "cannot listen on {address}: {error}; another program may use the port, choose another one"
    )]
    Listen {
        /// The address.
        address: SocketAddr,
        /// The cause.
        error: io::Error,
    },
    /// Two targets listen on one address.
    #[error("`{}` and `{}` listen on the same port; give one of them another port", .0[0], .0[1])]
    SamePort(Box<[ShareTarget; 2]>),
    /// No datagrams can be sent.
    #[error("cannot send to {address}: {error}; choose an address of this machine")]
    Send {
        /// The address.
        address: SocketAddr,
        /// The cause.
        error: io::Error,
    },
    /// Clients of other machines cannot be admitted.
    #[error(transparent)]
    Network(#[from] NetworkError),
    /// The router of zenoh cannot be used.
    #[error(transparent)]
    Zenoh(#[from] ZenohError),
    /// A thread cannot be started.
    #[error("{0}")]
    NoThread(String),
}
