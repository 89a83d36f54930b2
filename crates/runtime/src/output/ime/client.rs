//! Requests of the loop to the thread of an input method, and state that both share; neither waits for the other.

use std::sync::atomic::{AtomicU8, AtomicU32, AtomicU64, Ordering};

use arrayvec::ArrayVec;

use super::composition::Text;
use crate::output::{FieldKind, TextField};
use ademan_core::pipeline::press_filter::{CandidateText, MAX_CANDIDATES};

/// Capacity of the queue of requests: the parts of some steps.
pub(super) const QUEUE: usize = 256;

/// Candidates for the open word.
pub(super) type Candidates = ArrayVec<CandidateText, MAX_CANDIDATES>;

/// A request of the loop.
pub(super) struct Request {
    pub action: Action,
    /// The field for which the text was typed: another one does not get it.
    pub field: u32,
    /// The key presses that the output of keys got before: the text follows them.
    pub after_presses: u32,
    /// The number of stops before it: later stops make it void.
    pub stops: u32,
}

/// An action of the thread.
#[derive(Debug, PartialEq)]
pub(super) enum Action {
    /// Shows a word in the field.
    Show(Text),
    /// Puts text into the field in place of the shown word.
    Commit(Text),
    /// Lists candidates beside the field; none hides them.
    List(Candidates),
}

/// State that both sides read and write.
#[derive(Default)]
pub(super) struct Shared {
    /// The generation of the field in the upper half, its kind in the lower one.
    field: AtomicU64,
    /// The number of the candidate that was chosen; 0 for none.
    choice: AtomicU8,
    /// The key presses that the output of keys got.
    presses: AtomicU32,
    stops: AtomicU32,
}

impl Shared {
    /// Returns the field that has the focus.
    pub(super) fn field(&self) -> TextField {
        let both = self.field.load(Ordering::Acquire);
        TextField {
            generation: (both >> 32) as u32,
            kind: match both as u32 {
                0 => FieldKind::Unknown,
                1 => FieldKind::Text,
                _ => FieldKind::Literal,
            },
        }
    }

    /// Reports that a field of this kind has the focus from now on.
    pub(super) fn enter_field(&self, kind: FieldKind) {
        let next = self.field().generation.wrapping_add(1);
        let both = u64::from(next) << 32 | kind as u64;
        self.field.store(both, Ordering::Release);
    }

    /// Reports the choice of a candidate, counted from 1.
    pub(super) fn choose(&self, number: u8) {
        self.choice.store(number, Ordering::Release);
    }

    /// Returns the candidate that was chosen since the last call.
    pub(super) fn take_choice(&self) -> Option<u8> {
        // Without a write in every turn of the loop.
        if self.choice.load(Ordering::Relaxed) == 0 {
            return None;
        }
        Some(self.choice.swap(0, Ordering::Acquire)).filter(|number| *number > 0)
    }

    /// Counts a key press, and returns the number of presses so far.
    pub(super) fn count_press(&self) -> u32 {
        self.presses.fetch_add(1, Ordering::AcqRel).wrapping_add(1)
    }

    pub(super) fn presses(&self) -> u32 {
        self.presses.load(Ordering::Acquire)
    }

    /// Makes all requests so far void.
    pub(super) fn stop(&self) {
        self.stops.fetch_add(1, Ordering::AcqRel);
    }

    pub(super) fn stops(&self) -> u32 {
        self.stops.load(Ordering::Acquire)
    }
}
