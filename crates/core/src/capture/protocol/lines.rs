//! Protocols with one packet per line of text.

use super::{Decoder, InvalidPacket, Packet, PacketError};
use crate::capture::SourceStats;
use crate::capture::feedback::FeedbackFormat;
use crate::document::BYTE_ORDER_MARK;

/// Parser of a line without its line end. The ends of the packets are filled in later.
pub trait LineParser: Send {
    /// Longest line in bytes, line end excluded. A longer line is skipped.
    const MAX_LINE_BYTES: usize;

    /// Parses a line and passes its packets to `emit`: one or more, or none if the line is invalid.
    fn parse(&mut self, line: &[u8], emit: &mut dyn FnMut(Packet)) -> Result<(), PacketError>;

    /// Returns `true` if the rest of a line whose start is missing may pass for a whole line with other values. The default, for lines
    /// whose start shows, is `false`.
    fn may_lack_start(line: &[u8]) -> bool {
        let _ = line;
        false
    }

    /// Returns `true` if a line of an unknown form is text that a board prints when it restarts. The default, for packets without a
    /// relation to earlier ones, is `false`.
    fn is_restart(line: &[u8]) -> bool {
        let _ = line;
        false
    }

    /// Forgets earlier lines, after a stream broke off or its sender restarted.
    fn reset(&mut self) {}

    /// Returns the form of feedback that the sender of the latest packet reads, if its packets show it.
    fn feedback(&self) -> Option<&'static FeedbackFormat> {
        None
    }
}

/// Decoder of lines, which end with LF or CR LF. Blank lines are ignored, and invalid lines are skipped. In a datagram the last
/// line end may be missing.
#[derive(Clone, Debug)]
pub struct LineDecoder<P> {
    parser: P,
    /// The line so far, at most `MAX_LINE_BYTES`.
    line: Vec<u8>,
    /// `true` if the current line is too long; its bytes are skipped up to the line end.
    is_skipping: bool,
    /// `true` if a stream may begin within a line.
    starts_anywhere: bool,
    /// `true` if the current line may have begun before the stream.
    is_first: bool,
    stats: SourceStats,
    /// Offset of the first byte after the last line end, from the start of the stream.
    line_start: u64,
    /// `true` if the previous line was skipped.
    is_searching: bool,
    /// `true` after a packet: text before the first packet is a normal start.
    has_packet: bool,
    has_restarted: bool,
    last_error: Option<PacketError>,
}

impl<P: LineParser> LineDecoder<P> {
    /// Creates a decoder at the start of a stream.
    pub(super) fn with_parser(parser: P) -> Self {
        Self {
            parser,
            line: Vec::with_capacity(P::MAX_LINE_BYTES),
            is_skipping: false,
            starts_anywhere: false,
            is_first: false,
            stats: SourceStats::default(),
            line_start: 0,
            is_searching: false,
            has_packet: false,
            has_restarted: false,
            last_error: None,
        }
    }

    /// Returns the bytes that a line may occupy.
    #[cfg(test)]
    pub(super) fn line_capacity(&self) -> usize {
        self.line.capacity()
    }

    /// Handles the line so far, which occupies `bytes` of the stream, line end included.
    fn end_line(&mut self, bytes: u64, emit: &mut dyn FnMut(Packet)) {
        if self.line_start == 0 && self.line.starts_with(BYTE_ORDER_MARK.as_bytes()) {
            self.line.drain(..BYTE_ORDER_MARK.len());
        }
        self.line_start += bytes;
        let end = self.line_start;
        let is_too_long = std::mem::take(&mut self.is_skipping);
        let is_cut = std::mem::take(&mut self.is_first) && P::may_lack_start(&self.line);
        if !is_too_long && self.line.trim_ascii().is_empty() {
            // Some senders separate lines by blank ones.
            self.line.clear();
            self.stats.skipped_bytes += bytes;
            return;
        }
        let mut packets = 0;
        let result = if is_too_long {
            Err(too_long::<P>())
        } else if is_cut {
            let text = "the first line may have begun before the connection";
            Err(PacketError::new(InvalidPacket::Truncated, text))
        } else {
            self.parser.parse(&self.line, &mut |packet| {
                packets += 1;
                emit(Packet { end, ..packet });
            })
        };
        self.stats.readings += packets;
        self.has_packet |= packets > 0;
        if let Err(error) = &result {
            self.stats.skipped_bytes += bytes;
            self.stats.resyncs += u64::from(!self.is_searching);
            self.stats.invalid.count(error.reason);
            self.check_restart(error.reason);
        }
        self.line.clear();
        self.is_searching = result.is_err();
        self.last_error = result.err();
    }

    /// Checks a line that was refused for this reason. A restart of the sender breaks its stream off.
    fn check_restart(&mut self, reason: InvalidPacket) {
        if self.has_packet && reason == InvalidPacket::Unknown && P::is_restart(&self.line) {
            // Further lines of text belong to the same restart.
            self.has_packet = false;
            self.has_restarted = true;
            self.parser.reset();
        }
    }

    fn push_to_line(&mut self, bytes: &[u8]) {
        if self.line.len() + bytes.len() > P::MAX_LINE_BYTES {
            if !self.is_skipping {
                self.last_error = Some(no_line_end::<P>());
            }
            self.is_skipping = true;
            self.line.clear();
        }
        if !self.is_skipping {
            self.line.extend_from_slice(bytes);
        }
    }
}

fn too_long<P: LineParser>() -> PacketError {
    let text = format!("a line is longer than {} bytes", P::MAX_LINE_BYTES);
    PacketError::new(InvalidPacket::WrongSize, text)
}

fn no_line_end<P: LineParser>() -> PacketError {
    let text = format!("no line end (LF) within {} bytes", P::MAX_LINE_BYTES);
    PacketError::new(InvalidPacket::WrongSize, text)
}

impl<P: LineParser> Decoder for LineDecoder<P> {
    fn push(&mut self, bytes: &[u8], emit: &mut dyn FnMut(Packet)) {
        let start = self.stats.bytes;
        self.stats.bytes += bytes.len() as u64;
        let mut offset = 0;
        for piece in bytes.split_inclusive(|&byte| byte == b'\n') {
            offset += piece.len() as u64;
            match piece {
                [line @ .., b'\n'] => {
                    self.push_to_line(line);
                    self.end_line(start + offset - self.line_start, emit);
                }
                _ => self.push_to_line(piece),
            }
        }
    }

    fn finish(&mut self, emit: &mut dyn FnMut(Packet)) {
        let bytes = self.stats.bytes - self.line_start;
        if bytes > 0 {
            self.end_line(bytes, emit);
        }
        self.is_searching = false;
    }

    /// Skips a line without its end: a number that was cut off has another value.
    fn finish_cut(&mut self, _: &mut dyn FnMut(Packet)) {
        let bytes = self.stats.bytes - self.line_start;
        if bytes == 0 {
            return;
        }
        if self.is_skipping || !self.line.trim_ascii().is_empty() {
            self.stats.invalid.count(InvalidPacket::Truncated);
            let text = "the last line has no line end";
            self.last_error = Some(PacketError::new(InvalidPacket::Truncated, text.to_owned()));
        }
        self.reset();
    }

    fn start_anywhere(&mut self) {
        (self.starts_anywhere, self.is_first) = (true, true);
    }

    fn reset(&mut self) {
        self.is_first = self.starts_anywhere;
        self.stats.skipped_bytes += self.stats.bytes - self.line_start;
        self.line_start = self.stats.bytes;
        self.line.clear();
        (self.is_skipping, self.is_searching) = (false, false);
        self.has_packet = false;
        self.parser.reset();
    }

    fn pending_bytes(&self) -> usize {
        (self.stats.bytes - self.line_start) as usize
    }

    fn stats(&self) -> SourceStats {
        self.stats
    }

    fn last_error(&self) -> Option<&PacketError> {
        self.last_error.as_ref()
    }

    fn feedback(&self) -> Option<&'static FeedbackFormat> {
        self.parser.feedback()
    }

    fn take_restart(&mut self) -> bool {
        std::mem::take(&mut self.has_restarted)
    }
}
