//! The answers of a server to a client, without a connection.

use std::sync::Arc;

use super::client::Client;
use super::lines::LineEncoder;
use super::listener::Connection;
use super::target::ShareTarget;
use crate::network::MemoryStream;
use ademan_core::hand::Side;
use ademan_core::layout::Layout;

/// The bytes that a client has received, and its connection.
#[derive(Clone, Debug)]
pub struct ShareAnswer {
    /// All bytes.
    pub bytes: Vec<u8>,
    /// `true` if the server has not closed the connection.
    pub is_connected: bool,
}

/// Returns what a server of `target` answers to a client that sends these parts, in a session without readings.
pub fn answer<'a>(
    target: &ShareTarget,
    layout: &Arc<Layout>,
    parts: impl IntoIterator<Item = &'a [u8]>,
) -> ShareAnswer {
    let stream = MemoryStream::new(usize::MAX);
    let connection = Connection {
        server: 0,
        stream: Box::new(stream.clone()),
    };
    let mut client = Client::new(connection, target);
    let mut encoder = LineEncoder::new(Side::Right, Arc::clone(layout));
    let mut is_connected = true;
    for part in parts {
        stream.send(part);
        is_connected = client.receive().is_ok();
        client.catch_up(&mut encoder);
        is_connected &= client.flush().is_ok();
        if !is_connected {
            break;
        }
    }
    ShareAnswer {
        bytes: stream.take_received(),
        is_connected,
    }
}
