//! The language model: an alphabet, a lexicon, pairs of words and spelling, borrowed from the bytes of one file.
//!
//! | offset | bytes | contents |
//! |---|---|---|
//! | 0 | 8 | `ADEMTEXT` |
//! | 8 | 4 | version of the format, 2 |
//! | 12 | 4 | number of sections, 8 |
//! | 16 | 8 | checksum of all bytes from offset 24 on |
//! | 24 | 32 | the size of each section in bytes |
//! | 56 | | alphabet, nodes, rows, entries, contexts, triples, states, arcs |
//!
//! Numbers are little-endian. [`Model::from_bytes`] checks the checksum and the order of every section; after that no look-up fails. It also
//! makes eight bytes for each node, from which the decoder reads.

pub mod alphabet;
pub mod bigrams;
pub(crate) mod branches;
pub(crate) mod bytes;
pub mod lexicon;
mod own_words;
pub mod spelling;

use alphabet::Alphabet;
use bigrams::{AFTER_COMMA, Bigrams, NO_ROW, Row};
use bytes::{checksum, u32_at, u64_at};
use lexicon::{Case, Lexicon, Prefix, ROOT};
use own_words::OwnWords;
use spelling::Spelling;

/// The first bytes of a model.
pub const MAGIC: &[u8; 8] = b"ADEMTEXT";
/// The version of the format that this library writes and reads.
pub const VERSION: u32 = 2;
pub(crate) const SECTIONS: usize = 8;
pub(crate) const CHECKED_FROM: usize = 24;
pub(crate) const HEADER_BYTES: usize = CHECKED_FROM + 4 * SECTIONS;

/// Reason why bytes are not a model.
#[derive(Clone, Copy, Debug, PartialEq, Eq, thiserror::Error)]
pub enum ModelError {
    /// The first bytes are not [`MAGIC`].
    #[error(
        "it is not a language model: it does not start with ADEMTEXT; `ademan text build` makes one"
    )]
    Foreign,
    /// The format has another version.
    #[error(
        "it has version {0} of the format of language models, and this program reads version {VERSION}; build it again with `ademan text build`"
    )]
    Version(u32),
    /// The file is shorter or longer than its header states, or has another number of sections.
    #[error("it has {found} bytes instead of {expected}; copy or build it again")]
    Length {
        /// The number of bytes that the header states.
        expected: u64,
        /// The number of bytes in the file.
        found: u64,
    },
    /// The checksum is wrong.
    #[error("its checksum is wrong, so it was damaged; copy or build it again")]
    Checksum,
    /// A section contradicts itself.
    #[error("{0} cannot be read; build it again with `ademan text build`")]
    Damaged(&'static str),
}

/// A word found in the lexicon.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Found {
    /// The node.
    pub node: u32,
    /// The log-probability.
    pub log_probability: f32,
    /// The case.
    pub case: Case,
}

/// The language model of one file.
#[derive(Clone, Debug)]
pub struct Model<'a> {
    /// The letters.
    pub alphabet: Alphabet,
    /// The words.
    pub lexicon: Lexicon<'a>,
    /// The pairs of words.
    pub bigrams: Bigrams<'a>,
    /// The spelling of other words.
    pub spelling: Spelling<'a>,
}

impl<'a> Model<'a> {
    /// Checks the bytes of a file and borrows them.
    ///
    /// # Errors
    ///
    /// Fails if the bytes are not a model of this version, whole and undamaged.
    pub fn from_bytes(bytes: &'a [u8]) -> Result<Self, ModelError> {
        if bytes.get(..MAGIC.len()) != Some(MAGIC) {
            return Err(ModelError::Foreign);
        }
        let version = u32_at(bytes, 8);
        if version != VERSION {
            return Err(ModelError::Version(version));
        }
        let sizes: [u32; SECTIONS] =
            std::array::from_fn(|section| u32_at(bytes, CHECKED_FROM + 4 * section));
        let expected = HEADER_BYTES as u64 + sizes.iter().map(|&size| u64::from(size)).sum::<u64>();
        if bytes.len() as u64 != expected || u32_at(bytes, 12) as usize != SECTIONS {
            return Err(ModelError::Length {
                expected,
                found: bytes.len() as u64,
            });
        }
        if checksum(&bytes[CHECKED_FROM..]) != u64_at(bytes, 16) {
            return Err(ModelError::Checksum);
        }
        let mut rest = &bytes[HEADER_BYTES..];
        let sections = sizes.map(|size| {
            let (section, following) = rest.split_at(size as usize);
            rest = following;
            section
        });
        let [
            letters,
            nodes,
            rows,
            entries,
            contexts,
            triples,
            states,
            arcs,
        ] = sections;
        let alphabet = Alphabet::read(letters)?;
        let symbols = alphabet.len();
        let mut lexicon = Lexicon::read(nodes, symbols)?;
        let bigrams = Bigrams::read([rows, entries, contexts, triples])?;
        lexicon.prepare(bigrams.followers())?;
        Ok(Self {
            lexicon,
            bigrams,
            spelling: Spelling::read(states, arcs, symbols)?,
            alphabet,
        })
    }

    /// Returns the words in lower case with the natural logarithms of their probabilities.
    pub fn word_list(&self) -> Vec<(String, f32)> {
        let mut words = Vec::new();
        let mut open = vec![(0, String::new())];
        while let Some((node, word)) = open.pop() {
            if let Some(log_probability) = self.lexicon.node(node).word() {
                words.push((word.clone(), log_probability));
            }
            for child in self.lexicon.children(node) {
                let letter = self.alphabet.letter(self.lexicon.node(child).symbol());
                open.push((child, format!("{word}{letter}")));
            }
        }
        words
    }

    /// Looks a word up, ignoring its case.
    pub fn find(&self, word: &str) -> Option<Found> {
        let mut prefix = Prefix::EMPTY;
        for letter in word.chars().flat_map(char::to_lowercase) {
            prefix = prefix.with(self.alphabet.symbol(letter)?, &self.lexicon);
        }
        let (node, log_probability) = self.lexicon.word(prefix)?;
        Some(Found {
            node,
            log_probability,
            case: self.lexicon.node(node).case(),
        })
    }

    /// Adds a word of the person, unless the lexicon has it or the alphabet lacks one of its letters.
    pub fn add_own_word(&mut self, word: &str) {
        if self.find(word).is_none() {
            self.lexicon.own.add(word, &self.alphabet);
        }
    }

    /// Returns the words of the person.
    pub(crate) fn own(&self) -> &OwnWords {
        &self.lexicon.own
    }

    /// Returns the words of the person, to change them.
    pub(crate) fn own_mut(&mut self) -> &mut OwnWords {
        &mut self.lexicon.own
    }

    /// Returns the row of the words that follow a word; the row of the root has the words that start a sentence.
    pub fn row(&self, node: u32) -> Row {
        self.bigrams.row(node)
    }

    /// Returns the row of the words that follow a punctuation mark.
    pub fn row_after(&self, punctuation: char) -> Row {
        match punctuation {
            mark if ends_sentence(mark) => self.row(ROOT),
            ',' => self.row(AFTER_COMMA),
            _ => NO_ROW,
        }
    }

    /// Returns the row of the words that follow a word which itself is in a row.
    pub fn next_row(&self, row: Row, node: u32) -> Row {
        self.bigrams.next(row, node)
    }
}

/// Returns `true` for a mark that ends a sentence.
pub(crate) fn ends_sentence(character: char) -> bool {
    matches!(character, '.' | '!' | '?')
}
