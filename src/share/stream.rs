//! Reading from the stream of a client.

use std::io::ErrorKind;

use crate::network::Stream;

/// The client has to be disconnected.
#[derive(Debug)]
pub(super) struct Disconnected;

/// A part of what a client has sent.
pub(super) enum Received {
    /// There is nothing more.
    Nothing,
    /// A request.
    Request(Vec<u8>),
    /// Bytes to send to the client.
    Reply(Vec<u8>),
    /// The client may not go on, for this reason.
    Refused(String),
    /// The client has gone, or there is no way to tell it what is wrong.
    Gone,
}

/// The result of a read.
pub(super) enum Input {
    /// Bytes; none if the client has closed its half of the connection.
    Bytes(usize),
    /// Nothing has arrived.
    Nothing,
    /// The connection is lost.
    Lost,
}

/// Reads the bytes that have arrived.
pub(super) fn read(stream: &mut dyn Stream, buffer: &mut [u8]) -> Input {
    match stream.read(buffer) {
        Ok(count) => Input::Bytes(count),
        Err(error) if is_temporary(error.kind()) => Input::Nothing,
        Err(_) => Input::Lost,
    }
}

/// Returns whether a stream without data failed with this kind of error.
pub(super) fn is_temporary(kind: ErrorKind) -> bool {
    matches!(kind, ErrorKind::WouldBlock | ErrorKind::Interrupted)
}
