//! The lines of one step, each encoded once for all clients.

use std::sync::Arc;

use super::step::SharedStep;
use super::target::ShareFormat;
use crate::capture::protocol::text_line;
use crate::hand::Side;
use crate::trace::{angles_json, pose_json};

/// A set of formats.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub(super) struct FormatSet(u16);

impl FormatSet {
    /// Returns the set of one format.
    pub fn only(format: ShareFormat) -> Self {
        Self(1 << format.index())
    }

    /// Adds the formats of another set.
    pub fn insert_all(&mut self, other: Self) {
        self.0 |= other.0;
    }

    /// Returns whether the set has a format.
    pub fn contains(self, format: ShareFormat) -> bool {
        self.0 & (1 << format.index()) != 0
    }
}

/// A line of a step.
pub(super) struct Line {
    /// Its format.
    pub format: ShareFormat,
    /// Its bytes, with the line end.
    pub bytes: Arc<[u8]>,
}

/// The encoder of the steps of a session.
pub(super) struct LineEncoder {
    /// The first hand of the session.
    first: Side,
    lines: Vec<Line>,
    buffer: Vec<u8>,
}

impl LineEncoder {
    /// Creates an encoder for a session whose first hand is `first`.
    pub fn new(first: Side) -> Self {
        Self {
            first,
            lines: Vec::new(),
            buffer: Vec::new(),
        }
    }

    /// Encodes a step in the wanted formats, as far as they have a line for its hand.
    pub fn encode(&mut self, step: &SharedStep, wanted: FormatSet) -> &[Line] {
        self.lines.clear();
        for format in [
            ShareFormat::TextLine,
            ShareFormat::Angles,
            ShareFormat::Pose,
        ] {
            if wanted.contains(format) && self.write(step, format) {
                self.lines.push(Line {
                    format,
                    bytes: self.buffer.as_slice().into(),
                });
            }
        }
        &self.lines
    }

    /// Writes the line of a format into the buffer. Returns `false` if there is none.
    fn write(&mut self, step: &SharedStep, format: ShareFormat) -> bool {
        let Some((angles, pose)) = step.hand() else {
            return false;
        };
        self.buffer.clear();
        match format {
            ShareFormat::TextLine if pose.side != self.first => return false,
            ShareFormat::TextLine => {
                let line = text_line::encode(angles);
                self.buffer.extend_from_slice(line.as_bytes());
                return true;
            }
            ShareFormat::Angles => _ = angles_json(pose.time, angles, &mut self.buffer),
            ShareFormat::Pose => _ = pose_json(pose, &mut self.buffer),
            ShareFormat::Vmc | ShareFormat::Opentrack => return false,
        }
        self.buffer.push(b'\n');
        true
    }
}
