//! Words of a text that arrives in pieces.

use super::error::{BvhError, error};
use super::limits::MAX_TOKEN_BYTES;

/// Splits a stream into words at blanks, tabs and line ends, and counts lines.
#[derive(Clone, Debug, Default)]
pub(super) struct Tokenizer {
    /// The start of a word that was cut by the end of a piece.
    partial: Vec<u8>,
    /// Line ends so far: LF, CR LF or CR.
    line_ends: u64,
    /// `true` if the last byte was a CR, so that a LF belongs to the same line end.
    ends_in_cr: bool,
    /// Bytes so far.
    bytes: u64,
}

impl Tokenizer {
    /// Returns the current line, counted from 1.
    pub fn line(&self) -> u64 {
        self.line_ends + 1
    }

    /// Passes each word that is complete to `handle`, with its line and the offset of the first byte after it.
    pub fn push(
        &mut self,
        piece: &[u8],
        mut handle: impl FnMut(&[u8], u64, u64) -> Result<(), BvhError>,
    ) -> Result<(), BvhError> {
        let mut start = 0;
        for (index, &byte) in piece.iter().enumerate() {
            let follows_cr = std::mem::replace(&mut self.ends_in_cr, byte == b'\r');
            if !byte.is_ascii_whitespace() {
                continue;
            }
            self.end_token(&piece[start..index], index, &mut handle)?;
            start = index + 1;
            if byte == b'\r' || (byte == b'\n' && !follows_cr) {
                self.line_ends += 1;
            }
        }
        let rest = &piece[start..];
        self.check_length(rest.len())?;
        self.partial.extend_from_slice(rest);
        self.bytes += piece.len() as u64;
        Ok(())
    }

    /// Passes the word at the end of the stream to `handle`.
    pub fn finish(
        &mut self,
        mut handle: impl FnMut(&[u8], u64, u64) -> Result<(), BvhError>,
    ) -> Result<(), BvhError> {
        self.end_token(&[], 0, &mut handle)
    }

    /// Forgets the word at the end of the stream.
    pub fn discard(&mut self) {
        self.partial.clear();
    }

    /// Handles the word that ends `index` bytes into the current piece, of which `end` is the part in the piece.
    fn end_token(
        &mut self,
        end: &[u8],
        index: usize,
        handle: &mut impl FnMut(&[u8], u64, u64) -> Result<(), BvhError>,
    ) -> Result<(), BvhError> {
        self.check_length(end.len())?;
        let (line, offset) = (self.line(), self.bytes + index as u64);
        if self.partial.is_empty() {
            return match end {
                [] => Ok(()),
                token => handle(token, line, offset),
            };
        }
        self.partial.extend_from_slice(end);
        let result = handle(&self.partial, line, offset);
        self.partial.clear();
        result
    }

    fn check_length(&self, more: usize) -> Result<(), BvhError> {
        if self.partial.len() + more > MAX_TOKEN_BYTES {
            let reason = format!("a word is longer than {MAX_TOKEN_BYTES} bytes");
            return Err(error(self.line(), reason));
        }
        Ok(())
    }
}
