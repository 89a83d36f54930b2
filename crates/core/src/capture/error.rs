//! Errors of sources.

use crate::hand::{HandPart, Side};
use crate::message::{escape, escape_line, escape_lines};

/// Error of a source. Each message states what failed, why, and what to do.
#[derive(Clone, Debug, thiserror::Error)]
#[non_exhaustive]
pub enum CaptureError {
    /// The text is not a source URI.
    #[error("cannot read `{}` as a source: {}", escape(.text), escape_line(.reason))]
    InvalidUri {
        /// The text as written.
        text: String,
        /// Error in the text.
        reason: String,
    },
    /// The device or file cannot be opened.
    #[error("cannot open {}: {}", escape(.source_name), escape_lines(.reason))]
    Open {
        /// Name of the source.
        source_name: String,
        /// Cause and remedy.
        reason: String,
    },
    /// The device was lost. The source reconnects.
    #[error("lost {}: {}; reconnecting", escape(.source_name), escape_line(.reason))]
    Lost {
        /// Name of the source.
        source_name: String,
        /// Cause.
        reason: String,
    },
    /// One of several merged sources was lost or interrupted. The others continue.
    #[error("{error}")]
    PartLost {
        /// Hand that it measures; `None` for both.
        side: Option<Side>,
        /// Part of the hand that it measures; `None` for all of it.
        part: Option<HandPart>,
        /// Cause.
        error: Box<CaptureError>,
    },
    /// The readings before and after the interruption may be unrelated.
    #[error(
        "{} was interrupted: {}; hold the hand off all keys for a moment",
        escape(.source_name), escape_line(.reason)
    )]
    Interrupted {
        /// Name of the source.
        source_name: String,
        /// Cause.
        reason: String,
    },
    /// The data of the source cannot be used.
    #[error("cannot use {}: {}", escape(.source_name), escape_lines(.reason))]
    Malformed {
        /// Name of the source.
        source_name: String,
        /// Position and cause.
        reason: String,
    },
}

impl CaptureError {
    /// Returns `true` if the source continues, so that `Source::next` may be called again.
    pub const fn is_recoverable(&self) -> bool {
        matches!(
            self,
            Self::Lost { .. } | Self::PartLost { .. } | Self::Interrupted { .. }
        )
    }

    /// Returns the name of the source; the text as written if it is not a URI.
    pub fn source_name(&self) -> &str {
        match self {
            Self::InvalidUri { text, .. } => text,
            Self::Open { source_name, .. }
            | Self::Lost { source_name, .. }
            | Self::Interrupted { source_name, .. }
            | Self::Malformed { source_name, .. } => source_name,
            Self::PartLost { error, .. } => error.source_name(),
        }
    }
}
