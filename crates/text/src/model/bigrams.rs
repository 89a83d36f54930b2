//! Probabilities of a word after another one.
//!
//! A row belongs to a preceding word, given by its node in the lexicon; the root is the start of a sentence. Rows and the entries of
//! a row are sorted. A word that is not in the row has its own probability times the weight of the row.

use super::ModelError;
use super::bytes::u32_at;
use crate::logarithm::nats;

/// The bytes of a row: node and weight in one number, then the index of the first entry.
pub const ROW_BYTES: usize = 8;

/// A row: the words that were seen after one word.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Row(pub(crate) u32);

/// No preceding word is known.
pub const NO_ROW: Row = Row(u32::MAX);

/// The pairs of words of a model.
#[derive(Clone, Copy, Debug)]
pub struct Bigrams<'a> {
    rows: &'a [u8],
    entries: &'a [u8],
}

impl<'a> Bigrams<'a> {
    pub(super) fn read(rows: &'a [u8], entries: &'a [u8]) -> Result<Self, ModelError> {
        if !rows.len().is_multiple_of(ROW_BYTES)
            || rows.is_empty()
            || !entries.len().is_multiple_of(4)
        {
            return Err(ModelError::Damaged("the size of the pairs of words"));
        }
        let bigrams = Self { rows, entries };
        let last = bigrams.row_count() as u32 - 1;
        let count = (entries.len() / 4) as u32;
        let increases = (0..last).all(|row| {
            bigrams.key(row) >> 8 < bigrams.key(row + 1) >> 8
                && bigrams.start(row) <= bigrams.start(row + 1)
        });
        // The last row only ends the one before it.
        if !increases || bigrams.start(last) != count {
            return Err(ModelError::Damaged("the order of the pairs of words"));
        }
        Ok(bigrams)
    }

    fn row_count(&self) -> usize {
        self.rows.len() / ROW_BYTES
    }

    /// Returns the number of pairs.
    pub fn len(&self) -> usize {
        self.entries.len() / 4
    }

    /// Returns `true` if there are no pairs.
    pub fn is_empty(&self) -> bool {
        self.entries.is_empty()
    }

    fn key(&self, row: u32) -> u32 {
        u32_at(self.rows, row as usize * ROW_BYTES)
    }

    fn start(&self, row: u32) -> u32 {
        u32_at(self.rows, row as usize * ROW_BYTES + 4)
    }

    /// Returns the row of a preceding word.
    pub fn row(&self, node: u32) -> Row {
        let found = search(0, self.row_count() as u32 - 1, node, |row| {
            self.key(row) >> 8
        });
        found.map_or(NO_ROW, Row)
    }

    /// Returns the log-probability of a word in a row, given that of the word alone.
    pub fn after(&self, row: Row, node: u32, alone: f32) -> f32 {
        if row == NO_ROW {
            return alone;
        }
        let entry = |index: u32| u32_at(self.entries, index as usize * 4);
        let found = search(self.start(row.0), self.start(row.0 + 1), node, |index| {
            entry(index) >> 8
        });
        match found {
            Some(index) => nats(entry(index) as u8),
            None => alone + nats(self.key(row.0) as u8),
        }
    }
}

fn search(mut low: u32, mut high: u32, node: u32, key: impl Fn(u32) -> u32) -> Option<u32> {
    while low < high {
        let middle = low + (high - low) / 2;
        match key(middle).cmp(&node) {
            std::cmp::Ordering::Less => low = middle + 1,
            std::cmp::Ordering::Greater => high = middle,
            std::cmp::Ordering::Equal => return Some(middle),
        }
    }
    None
}
