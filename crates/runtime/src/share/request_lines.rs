//! Requests of a client as lines.

use std::io::Read;

use super::request::{MAX_REQUEST_BYTES, too_long};
use super::stream::{Input, Received, read};

/// The bytes of requests that were not handled yet.
#[derive(Default)]
pub(super) struct RequestLines {
    bytes: Vec<u8>,
}

impl RequestLines {
    /// Receives the next request.
    pub fn receive(&mut self, stream: &mut dyn Read) -> Received {
        let mut buffer = [0; MAX_REQUEST_BYTES];
        loop {
            let end = self.bytes.iter().position(|&byte| byte == b'\n');
            if end.unwrap_or(self.bytes.len()) > MAX_REQUEST_BYTES {
                return Received::Refused(too_long());
            }
            if let Some(end) = end {
                let rest = self.bytes.split_off(end + 1);
                let request = std::mem::replace(&mut self.bytes, rest);
                return Received::Request(request);
            }
            match read(stream, &mut buffer) {
                Input::Nothing => return Received::Nothing,
                Input::Bytes(0) | Input::Lost => return Received::Gone,
                Input::Bytes(count) => self.bytes.extend_from_slice(&buffer[..count]),
            }
        }
    }
}
