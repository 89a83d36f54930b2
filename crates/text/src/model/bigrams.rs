//! Probabilities of a word after another one, or two.
//!
//! A row belongs to a preceding word, given by its node in the lexicon; the root is the start of a sentence, and [`AFTER_COMMA`] a
//! comma. Rows and the entries of a row are sorted. A word that is not in the row has its own probability times the weight of the
//! row. A context is the row of two preceding words; a word that it lacks has the probability after the second one, times the
//! weight of the context.

use std::sync::Arc;

use super::ModelError;
use super::bytes::u32_at;
use crate::logarithm::nats;

/// The number for a comma in place of a node. No lexicon has that many nodes.
pub const AFTER_COMMA: u32 = 0xff_fffe;
/// The bytes of a row: node and weight in one number, then the index of the first entry.
pub const ROW_BYTES: usize = 8;
/// The bytes of a context: like a row, with the entry of its two words in place of the node, then the row of the second one.
pub const CONTEXT_BYTES: usize = 12;
/// The bytes of an entry: node and probability in one number.
const ENTRY_BYTES: usize = 4;
/// The number of keys of a group of rows.
const GROUP: u32 = 64;
/// The most groups, of which the last one has all keys beyond the others.
const MAX_GROUPS: u32 = 1 << 14;
/// The index of the row of the first context.
const CONTEXT: u32 = 1 << 24;

/// A row: the words that were seen after one word, or two.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Row(pub(crate) u32);

/// No preceding word is known.
pub const NO_ROW: Row = Row(u32::MAX);

/// The pairs of words of a model, and what follows some of them.
#[derive(Clone, Debug)]
pub struct Bigrams<'a> {
    rows: Table<'a, ROW_BYTES>,
    contexts: Table<'a, CONTEXT_BYTES>,
}

/// Rows with their entries, and one row more that ends the last one.
#[derive(Clone, Debug)]
struct Table<'a, const BYTES: usize> {
    rows: &'a [[u8; BYTES]],
    entries: &'a [[u8; ENTRY_BYTES]],
    /// The first row of each group of [`GROUP`] keys: a search in all rows would read from ten places of the memory.
    groups: Arc<[u32]>,
}

impl<'a, const BYTES: usize> Table<'a, BYTES> {
    fn read(rows: &'a [u8], entries: &'a [u8]) -> Result<Self, ModelError> {
        let (rows, rest) = rows.as_chunks();
        let (entries, rest_of_entries) = entries.as_chunks();
        if rows.is_empty() || !rest.is_empty() || !rest_of_entries.is_empty() {
            return Err(ModelError::Damaged("the size of the pairs of words"));
        }
        let mut table = Self {
            rows,
            entries,
            groups: Arc::default(),
        };
        let last = table.count();
        let increases = (0..last).all(|row| {
            table.key(row) < table.key(row + 1) && table.start(row) <= table.start(row + 1)
        });
        // The last row only ends the one before it.
        if !increases || table.start(last) as usize != entries.len() || last >= CONTEXT {
            return Err(ModelError::Damaged("the order of the pairs of words"));
        }
        let mut groups = vec![0];
        for row in 0..last {
            groups.resize(group(table.key(row)) + 1, row);
        }
        groups.push(last);
        table.groups = groups.into();
        Ok(table)
    }

    fn count(&self) -> u32 {
        self.rows.len() as u32 - 1
    }

    fn number(&self, row: u32, offset: usize) -> u32 {
        let record = self.rows.get(row as usize);
        record.map_or(0, |record| u32_at(record, offset))
    }

    fn key(&self, row: u32) -> u32 {
        self.number(row, 0) >> 8
    }

    fn weight(&self, row: u32) -> f32 {
        nats(self.number(row, 0) as u8)
    }

    fn start(&self, row: u32) -> u32 {
        self.number(row, 4)
    }

    fn row(&self, key: u32) -> Option<u32> {
        let index = group(key);
        let start = *self.groups.get(index)?;
        let end = *self.groups.get(index + 1)?;
        let rows = self.rows.get(start as usize..end as usize)?;
        search(rows, key).map(|row| start + row as u32)
    }

    /// Returns the index of the entry of a word.
    fn entry(&self, row: u32, node: u32) -> Option<u32> {
        let start = self.start(row);
        let entries = start as usize..self.start(row + 1) as usize;
        let found = search(self.entries.get(entries)?, node)?;
        Some(start + found as u32)
    }

    fn entry_nats(&self, index: u32) -> f32 {
        let entry = self.entries.get(index as usize);
        nats(entry.map_or(0, |entry| entry[0]))
    }
}

impl<'a> Bigrams<'a> {
    pub(super) fn read(
        [rows, entries, contexts, triples]: [&'a [u8]; 4],
    ) -> Result<Self, ModelError> {
        Ok(Self {
            rows: Table::read(rows, entries)?,
            contexts: Table::read(contexts, triples)?,
        })
    }

    /// Returns the number of pairs.
    pub fn len(&self) -> usize {
        self.rows.entries.len()
    }

    /// Returns the nodes and the stored log-probabilities of all words that follow others.
    pub(super) fn followers(&self) -> impl Iterator<Item = (u32, u8)> {
        let entries = self.rows.entries.iter().chain(self.contexts.entries);
        entries.map(|entry| (u32_at(entry, 0) >> 8, entry[0]))
    }

    /// Returns `true` if there are no pairs.
    pub fn is_empty(&self) -> bool {
        self.rows.entries.is_empty()
    }

    /// Returns the row of a preceding word, whatever was before it.
    pub fn row(&self, node: u32) -> Row {
        self.rows.row(node).map_or(NO_ROW, Row)
    }

    /// Returns the row of the words that follow a word in a row.
    pub fn next(&self, row: Row, node: u32) -> Row {
        let pairs = match row {
            NO_ROW => None,
            Row(index) if index >= CONTEXT => self.shorter(index - CONTEXT),
            Row(index) => Some(index),
        };
        let entry = pairs.and_then(|pairs| self.rows.entry(pairs, node));
        let context = entry.and_then(|entry| self.contexts.row(entry));
        context.map_or_else(|| self.row(node), |context| Row(CONTEXT + context))
    }

    /// Returns the row of the last word of a context alone.
    fn shorter(&self, context: u32) -> Option<u32> {
        let row = self.contexts.number(context, ROW_BYTES);
        (row < self.rows.count()).then_some(row)
    }

    /// Returns the log-probability of a word in a row, given `alone`, the log-probability of the word by itself.
    pub fn after(&self, row: Row, node: u32, alone: f32) -> f32 {
        if row == NO_ROW {
            return alone;
        }
        let mut sum = 0.0;
        let mut pairs = Some(row.0);
        if row.0 >= CONTEXT {
            let context = row.0 - CONTEXT;
            if let Some(index) = self.contexts.entry(context, node) {
                return self.contexts.entry_nats(index);
            }
            sum = self.contexts.weight(context);
            pairs = self.shorter(context);
        }
        let Some(pairs) = pairs else {
            return sum + alone;
        };
        match self.rows.entry(pairs, node) {
            Some(index) => sum + self.rows.entry_nats(index),
            None => sum + self.rows.weight(pairs) + alone,
        }
    }
}

/// Returns the index of the group of a key.
fn group(key: u32) -> usize {
    (key / GROUP).min(MAX_GROUPS) as usize
}

/// Returns the index of a key among increasing ones, in the upper 24 bits of records.
fn search<const BYTES: usize>(records: &[[u8; BYTES]], key: u32) -> Option<usize> {
    records
        .binary_search_by(|record| (u32_at(record, 0) >> 8).cmp(&key))
        .ok()
}
