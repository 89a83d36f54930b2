//! The limit of the number of frames of a client.

use std::io::Cursor;

use arrayvec::ArrayVec;
use tungstenite::protocol::frame::FrameHeader;

use crate::share::request::RateLimit;

/// Most frames of a client in a second, of all kinds. It may send ten requests, each in parts, and pings and pongs.
const MAX_FRAMES_PER_SECOND: u32 = 100;

/// Longest header: two bytes, eight of the length, and four of the mask (RFC 6455, section 5.2).
const MAX_HEADER_BYTES: usize = 14;

/// A counter of the frames in a stream of bytes.
pub(super) struct FrameLimit {
    /// The beginning of a header.
    header: ArrayVec<u8, MAX_HEADER_BYTES>,
    /// Bytes of the present frame that have not arrived.
    payload_left: u64,
    limit: RateLimit,
    /// The reason why the client is disconnected.
    exceeded: Option<String>,
}

impl FrameLimit {
    /// Creates a limit before the first byte.
    pub fn new() -> Self {
        Self {
            header: ArrayVec::new(),
            payload_left: 0,
            limit: RateLimit::new(MAX_FRAMES_PER_SECOND, "frames"),
            exceeded: None,
        }
    }

    /// Returns the reason why the client is disconnected, once it has sent too many frames.
    pub fn exceeded(&self) -> Option<&str> {
        self.exceeded.as_deref()
    }

    /// Counts the frames that begin in the next bytes.
    pub fn push(&mut self, mut bytes: &[u8]) {
        while let Some((&first, rest)) = bytes.split_first()
            && self.exceeded.is_none()
        {
            if self.payload_left > 0 {
                let skipped = bytes
                    .len()
                    .min(usize::try_from(self.payload_left).unwrap_or(usize::MAX));
                self.payload_left -= skipped as u64;
                bytes = &bytes[skipped..];
                continue;
            }
            bytes = rest;
            self.push_header(first);
        }
    }

    /// Adds a byte of a header. An invalid header is left to the reader, which ends the connection.
    fn push_header(&mut self, byte: u8) {
        if self.header.try_push(byte).is_err() {
            return;
        }
        if let Ok(Some((_, length))) = FrameHeader::parse(&mut Cursor::new(&self.header[..])) {
            self.header.clear();
            self.payload_left = length;
            self.exceeded = self.limit.count().err();
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const EMPTY: [u8; 6] = [0x8a, 0x80, 0, 0, 0, 0];

    /// Returns a frame of a text of this length.
    fn text(length: u16) -> Vec<u8> {
        let header = [&[0x81, 0xfe][..], &length.to_be_bytes(), &[0; 4]].concat();
        [header, vec![0x81; length.into()]].concat()
    }

    #[test]
    fn frames_are_counted_in_whatever_pieces_they_arrive_and_payloads_are_not() {
        for piece in [1, 5, 6, 7, 1000] {
            let mut limit = FrameLimit::new();
            let allowed: Vec<u8> = (0..50)
                .flat_map(|_| [&EMPTY[..], &text(200)].concat())
                .collect();
            for bytes in allowed.chunks(piece) {
                limit.push(bytes);
            }
            assert_eq!(limit.exceeded(), None, "{piece}");
            for bytes in EMPTY.chunks(piece) {
                limit.push(bytes);
            }
            assert_eq!(limit.exceeded(), Some("more than 100 frames in a second"));
        }
    }

    #[test]
    fn an_invalid_header_and_a_payload_without_an_end_are_no_further_frames() {
        let mut limit = FrameLimit::new();
        limit.push(&[&[0x81, 0xff][..], &[0xff; 12], &EMPTY.repeat(200)].concat());
        assert_eq!(limit.exceeded(), None);
        let mut long_limit = FrameLimit::new();
        long_limit.push(&[0x83; 2000]);
        assert!(long_limit.header.len() <= MAX_HEADER_BYTES);
    }
}
