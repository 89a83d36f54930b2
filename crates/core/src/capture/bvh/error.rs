//! Errors in BVH texts.

use super::limits::MAX_SHOWN_CHARS;

/// An error in a BVH text: its line and its cause.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
#[error("line {line}: {reason}")]
pub struct BvhError {
    /// The line, counted from 1.
    pub line: u64,
    /// The cause and what to write instead.
    pub reason: String,
}

/// Creates an error in `line`.
pub(super) fn error(line: u64, reason: impl Into<String>) -> BvhError {
    BvhError {
        line,
        reason: reason.into(),
    }
}

/// Returns a word of a file as it is shown in messages: in backticks, escaped and shortened.
pub(super) fn shown(token: &[u8]) -> String {
    let text = String::from_utf8_lossy(token);
    let start: String = text.chars().take(MAX_SHOWN_CHARS).collect();
    let more = if start.len() < text.len() { "…" } else { "" };
    format!("`{}{more}`", start.escape_debug())
}
