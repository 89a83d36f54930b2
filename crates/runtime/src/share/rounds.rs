//! The lines of clients without requests, which wait for one write to all of them.

use super::kinds::LineKind;
use super::lines::Line;
use super::outbox::Chunk;

/// The lines of each kind since the last write.
#[derive(Default)]
pub(super) struct Rounds(Vec<Round>);

struct Round {
    kind: LineKind,
    bytes: Vec<u8>,
    lines: u64,
}

impl Rounds {
    /// Adds a line.
    pub fn push(&mut self, line: &Line) {
        let index = self.0.iter().position(|round| round.kind == line.kind);
        let index = index.unwrap_or_else(|| {
            self.0.push(Round {
                kind: line.kind,
                bytes: Vec::new(),
                lines: 0,
            });
            self.0.len() - 1
        });
        let round = &mut self.0[index];
        round.bytes.extend_from_slice(&line.bytes);
        round.lines += 1;
    }

    /// Returns `true` if no line waits.
    pub fn is_empty(&self) -> bool {
        self.0.iter().all(|round| round.lines == 0)
    }

    /// Calls `send` with the lines of each kind, and removes them.
    pub fn take(&mut self, mut send: impl FnMut(LineKind, Chunk)) {
        for round in self.0.iter_mut().filter(|round| round.lines > 0) {
            let chunk = Chunk {
                bytes: round.bytes.as_slice().into(),
                lines: std::mem::take(&mut round.lines),
            };
            round.bytes.clear();
            send(round.kind, chunk);
        }
    }
}
