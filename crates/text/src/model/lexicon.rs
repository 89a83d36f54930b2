//! The words: a trie in breadth-first order with six bytes per node.
//!
//! The children of a node lie side by side, followed by the children of the next node, so that a node holds only the index of
//! its first child. Besides its letter, a node has the probability of the word that ends there and of the likeliest word below
//! it, which bounds what a prefix may become.
//!
//! Words of the person are in a second trie with nodes from [`OWN`] on. Its first letters follow the first letters of the lexicon as
//! children of the root.

use std::ops::Range;

use super::ModelError;
use super::alphabet::Symbol;
use super::branches::{Branch, Branches, LAST, Letters, bit};
use super::bytes::u64_at;
use super::own_words::OwnWords;
use crate::logarithm::nats;

/// The size of a node in bytes.
pub const NODE_BYTES: usize = 6;
/// Upper limit of the number of nodes, which has to be less: an index has 20 bits.
pub const MAX_NODES: usize = 1 << 20;
/// Number of bytes after the last node, so that every node can be read as eight bytes.
pub const PADDING: usize = 2;

/// The node from which all words start.
pub const ROOT: u32 = 0;

/// The first node of the words of the person.
pub const OWN: u32 = MAX_NODES as u32;

/// The case of a word inside a sentence.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, PartialOrd, Ord)]
pub enum Case {
    /// `word`
    #[default]
    Lower,
    /// `Word`
    Title,
    /// `WORD`
    Upper,
}

/// Returns the case that the bits of a node stand for.
pub(crate) fn case_of(bits: u8) -> Case {
    match bits {
        1 => Case::Title,
        2 => Case::Upper,
        _ => Case::Lower,
    }
}

/// The contents of a node.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Node(u64);

impl Node {
    pub(crate) fn new(first_child: u32, symbol: Symbol, word: u8, best: u8, case: Case) -> Self {
        Self(
            u64::from(first_child)
                | u64::from(symbol) << 20
                | u64::from(word) << 26
                | u64::from(best) << 34
                | (case as u64) << 42,
        )
    }

    pub(crate) fn to_bytes(self) -> [u8; NODE_BYTES] {
        let bytes = self.0.to_le_bytes();
        [bytes[0], bytes[1], bytes[2], bytes[3], bytes[4], bytes[5]]
    }

    fn first_child(self) -> u32 {
        (self.0 & 0xf_ffff) as u32
    }

    /// Returns the letter that leads to this node.
    pub fn symbol(self) -> Symbol {
        (self.0 >> 20 & 0x3f) as Symbol
    }

    /// Returns the log-probability of the word that ends here, if one does.
    pub fn word(self) -> Option<f32> {
        let byte = self.word_byte();
        (byte != 0).then(|| nats(byte))
    }

    /// Returns the node with its first child and the letters of its children.
    fn branch(self, first_child: u32, letters: Letters) -> Branch {
        Branch {
            first_child,
            letters,
            best: (self.0 >> 34) as u8,
            word: self.word_byte(),
        }
    }

    fn word_byte(self) -> u8 {
        (self.0 >> 26) as u8
    }

    /// Returns the log-probability of the likeliest word that ends here or below.
    pub fn best(self) -> f32 {
        nats((self.0 >> 34) as u8)
    }

    /// Returns the case of the word that ends here.
    pub fn case(self) -> Case {
        case_of((self.0 >> 42 & 3) as u8)
    }
}

/// The words of a model.
#[derive(Clone, Debug)]
pub struct Lexicon<'a> {
    nodes: &'a [u8],
    count: u32,
    pub(crate) branches: Branches,
    pub(super) own: OwnWords,
}

impl<'a> Lexicon<'a> {
    pub(super) fn read(nodes: &'a [u8], symbols: usize) -> Result<Self, ModelError> {
        let bytes = nodes.len().saturating_sub(PADDING);
        let count = bytes / NODE_BYTES;
        if count == 0 || !bytes.is_multiple_of(NODE_BYTES) || count >= MAX_NODES {
            return Err(ModelError::Damaged("the size of the lexicon"));
        }
        let lexicon = Self {
            nodes,
            count: count as u32,
            branches: Branches::default(),
            own: OwnWords::default(),
        };
        // Children follow their parent, so that no walk down the trie can turn in a circle.
        let mut first = 1;
        for index in 0..count as u32 {
            let node = lexicon.node(index);
            let child = node.first_child();
            if child < first || child <= index || child > count as u32 {
                return Err(ModelError::Damaged("the order of the lexicon"));
            }
            if usize::from(node.symbol()) >= symbols {
                return Err(ModelError::Damaged("a letter of the lexicon"));
            }
            first = child;
        }
        Ok(lexicon)
    }

    /// Returns the number of nodes, without the words of the person.
    pub fn nodes(&self) -> usize {
        self.count as usize
    }

    /// Returns the number of words, without the words of the person.
    pub fn words(&self) -> usize {
        (0..self.count)
            .filter(|&index| self.node(index).word().is_some())
            .count()
    }

    /// Returns a node. An index beyond the end gives a node without children.
    pub fn node(&self, index: u32) -> Node {
        if index >= self.count {
            return self.beyond(index);
        }
        Node(u64_at(self.nodes, index as usize * NODE_BYTES))
    }

    #[cold]
    fn beyond(&self, index: u32) -> Node {
        match index.checked_sub(OWN) {
            Some(own) => self.own.node(own),
            None => Node(u64::from(self.count)),
        }
    }

    /// Returns the indices of the children of a node: of the lexicon, and below the root also of the words of the person.
    pub fn children(&self, index: u32) -> impl Iterator<Item = u32> + use<> {
        let own = match index {
            ROOT => self.own_children(OWN),
            _ => 0..0,
        };
        self.child_range(index).chain(own)
    }

    /// Returns the indices of the children of a node, without the words of the person below the root of the lexicon.
    pub(crate) fn child_range(&self, index: u32) -> Range<u32> {
        if index >= OWN {
            return self.own_children(index);
        }
        let first = |node: u32| self.branch(node).first_child;
        first(index)..first(index + 1)
    }

    /// Returns a node with the letters of its children. The children of [`OWN`] are further children of the root.
    pub(crate) fn branch(&self, index: u32) -> Branch {
        let known = self.branches.get(index);
        known.unwrap_or_else(|| self.own_branch(index))
    }

    /// Returns the children of a node of the lexicon, or of the words of the person, whose letters have no bit of their own.
    pub(crate) fn last_children(&self, index: u32, branch: &Branch) -> Range<u32> {
        branch.child(LAST)..self.child_range(index).end
    }

    /// Reads nodes and their first children, all at once, so that a search for which they are needed one after another does not wait
    /// for the memory each time.
    pub(crate) fn fetch(&self, nodes: impl Iterator<Item = u32> + Clone) {
        let first_child = |node: u32| {
            let branch = self.branches.get(node);
            branch.map_or(0, |branch| branch.first_child)
        };
        let mut sum = nodes.clone().fold(0, |sum, node| {
            sum ^ first_child(node) ^ self.node(node).0 as u32
        });
        for node in nodes {
            let first = first_child(node);
            // Two lines of the memory have most children.
            sum ^= first_child(first) ^ first_child(first + 8);
            sum ^= self.node(first).0 as u32;
        }
        std::hint::black_box(sum);
    }

    #[cold]
    fn own_branch(&self, index: u32) -> Branch {
        if index < OWN {
            return self.node(index).branch(self.count, 0);
        }
        let children = self.own_children(index);
        let symbols = children.clone().map(|child| self.node(child).symbol());
        let letters = symbols.fold(0, |letters, symbol| letters | bit(symbol));
        self.node(index).branch(children.start, letters)
    }

    /// Prepares the nodes for the decoder, with the words that follow others and their stored log-probabilities.
    pub(super) fn prepare(
        &mut self,
        followers: impl Iterator<Item = (u32, u8)>,
    ) -> Result<(), ModelError> {
        let nodes = (0..self.count).map(|index| {
            let node = self.node(index);
            (node.branch(node.first_child(), 0), node.symbol())
        });
        self.branches = Branches::new(nodes, followers).ok_or(ModelError::Damaged(
            "the order of the letters of the lexicon",
        ))?;
        Ok(())
    }

    fn own_children(&self, index: u32) -> Range<u32> {
        let first = |node: u32| OWN + self.beyond(node).first_child();
        first(index)..first(index + 1)
    }

    /// Returns the child of a node by its letter.
    pub fn child(&self, index: u32, symbol: Symbol) -> Option<u32> {
        self.children(index)
            .find(|&child| self.node(child).symbol() == symbol)
    }

    /// Returns the node of the word with these letters, and its log-probability.
    pub fn word(&self, letters: Prefix) -> Option<(u32, f32)> {
        let nodes = [letters.known, letters.own];
        nodes.into_iter().flatten().find_map(|node| {
            let log_probability = self.node(node).word()?;
            Some((node, log_probability))
        })
    }
}

/// The nodes to which the letters of a word lead, in the lexicon and among the words of the person.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Prefix {
    known: Option<u32>,
    own: Option<u32>,
}

impl Prefix {
    /// No letter.
    pub const EMPTY: Self = Self {
        known: Some(ROOT),
        own: Some(OWN),
    };
    /// Letters with which no word begins.
    pub const UNKNOWN: Self = Self {
        known: None,
        own: None,
    };

    /// Returns the nodes after one more letter.
    pub fn with(self, symbol: Symbol, lexicon: &Lexicon) -> Self {
        let next = |node| lexicon.child(node, symbol);
        Self {
            known: self.known.and_then(next),
            own: self.own.and_then(next),
        }
    }
}
