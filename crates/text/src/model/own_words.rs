//! The words of the person, beside the lexicon: a trie of the same kind as the [lexicon](super::lexicon), rebuilt when a word is added.

use arrayvec::ArrayVec;

use super::alphabet::{Alphabet, Symbol};
use super::lexicon::{Case, Node};
use crate::logarithm::quantize;

/// The most words, and the most letters of one.
const MAX_WORDS: usize = 512;
const MAX_LETTERS: usize = 32;
/// The most letters of all words, and so the most nodes beside the root; words for which there is no room are left out.
const MAX_NODES: usize = 8_192;

/// The log-probability of a word of the person: once in 13 000 words, the frequency of the 1 500th most frequent word of English. The
/// person has asked for the word, or has typed it three times within one run.
const LOG_PROBABILITY: f64 = -9.5;

/// A word in lower case, and how it is written inside a sentence.
#[derive(Clone, Debug, PartialEq, Eq, PartialOrd, Ord)]
struct OwnWord {
    letters: ArrayVec<Symbol, MAX_LETTERS>,
    case: Case,
}

/// The range of words below a node that is not built yet.
#[derive(Clone, Copy, Debug)]
struct Open {
    start: u16,
    end: u16,
    depth: u8,
    symbol: Symbol,
}

/// The words of the person. Adding one does not allocate after [`reserve`](Self::reserve).
#[derive(Clone, Debug, Default)]
pub struct OwnWords {
    /// In the order of the letters.
    words: Vec<OwnWord>,
    nodes: Vec<Node>,
    queue: Vec<Open>,
}

impl OwnWords {
    /// Reserves memory for the largest number of words.
    pub fn reserve(&mut self) {
        self.words.reserve_exact(MAX_WORDS);
        self.nodes.reserve_exact(MAX_NODES + 1);
        self.queue.reserve_exact(MAX_NODES + 1);
    }

    /// Copies the words of another list, and keeps the reserved memory.
    pub fn take_over(&mut self, other: &Self) {
        self.clear();
        self.words.extend_from_slice(&other.words);
        self.nodes.extend_from_slice(&other.nodes);
    }

    /// Forgets all words.
    pub fn clear(&mut self) {
        self.words.clear();
        self.nodes.clear();
    }

    /// Adds a word, unless it has a character that is no letter of the alphabet, is too long, or there is no room for it.
    pub fn add(&mut self, word: &str, alphabet: &Alphabet) {
        let mut letters = ArrayVec::new();
        for letter in word.chars().flat_map(char::to_lowercase) {
            let symbol = alphabet.symbol(letter);
            if symbol.is_none_or(|symbol| letters.try_push(symbol).is_err()) {
                return;
            }
        }
        let used: usize = self.words.iter().map(|known| known.letters.len()).sum();
        let has_room = self.words.len() < MAX_WORDS && used + letters.len() <= MAX_NODES;
        if letters.is_empty() || !has_room {
            return;
        }
        let place = self
            .words
            .binary_search_by(|known| known.letters.cmp(&letters));
        let Err(place) = place else { return };
        let case = case_of(word);
        self.words.insert(place, OwnWord { letters, case });
        self.build();
    }

    /// Builds the nodes in breadth-first order.
    fn build(&mut self) {
        let word_byte = quantize(LOG_PROBABILITY);
        self.nodes.clear();
        self.queue.clear();
        let root = Open {
            start: 0,
            end: self.words.len() as u16,
            depth: 0,
            symbol: 0,
        };
        self.queue.push(root);
        let mut next = 0;
        while let Some(&open) = self.queue.get(next) {
            next += 1;
            let depth = usize::from(open.depth);
            let first_child = self.queue.len() as u32;
            let (mut start, end) = (usize::from(open.start), usize::from(open.end));
            let (mut byte, mut case) = (0, Case::Lower);
            if let Some(word) = self.words[start..end].first()
                && word.letters.len() == depth
            {
                (byte, case) = (word_byte, word.case);
                start += 1;
            }
            while start < end {
                let symbol = self.words[start].letters[depth];
                let same = |word: &OwnWord| word.letters[depth] == symbol;
                let group_end = start + self.words[start..end].partition_point(same);
                self.queue.push(Open {
                    start: start as u16,
                    end: group_end as u16,
                    depth: open.depth + 1,
                    symbol,
                });
                start = group_end;
            }
            let node = Node::new(first_child, open.symbol, byte, word_byte, case);
            self.nodes.push(node);
        }
    }

    /// Returns a node, 0 for the root. For the index after the last node, returns a node that ends the list of children of the last node.
    pub(super) fn node(&self, index: u32) -> Node {
        let node = self.nodes.get(index as usize).copied();
        node.unwrap_or_else(|| {
            Node::new(
                self.nodes.len().max(1) as u32,
                0,
                0,
                u8::MAX,
                Case::default(),
            )
        })
    }
}

/// Returns how a word is written inside a sentence. Capitals elsewhere than at the start of a word are kept only where they are typed.
fn case_of(word: &str) -> Case {
    let mut letters = word.chars().filter(|letter| letter.is_alphabetic());
    let is_upper = |letter: char| letter.is_uppercase();
    match (letters.next().is_some_and(is_upper), letters.next()) {
        (true, Some(second)) if second.is_uppercase() && letters.all(is_upper) => Case::Upper,
        (true, _) => Case::Title,
        (false, _) => Case::Lower,
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::decoder::fixture;
    use crate::model::Model;

    fn model() -> Model<'static> {
        fixture::model("cat\ncar\nnun")
    }

    fn cased(model: &Model, word: &str) -> Option<Case> {
        model.find(word).map(|found| found.case)
    }

    #[test]
    fn own_words_are_found_beside_the_lexicon() {
        let mut model = model();
        model.own_mut().reserve();
        for word in ["Nut", "cart", "NAC", "run"] {
            model.add_own_word(word);
        }
        assert_eq!(cased(&model, "nut"), Some(Case::Title));
        assert_eq!(cased(&model, "NAC"), Some(Case::Upper));
        assert_eq!(cased(&model, "cart"), Some(Case::Lower));
        assert_eq!(cased(&model, "run"), Some(Case::Lower));
        // Words of the lexicon keep their nodes, and a prefix is not a word.
        assert!(model.find("cat").is_some_and(|found| found.node < 1 << 20));
        assert!(model.find("ru").is_none() && model.find("nu").is_none());
        let words = model.word_list();
        assert_eq!(words.len(), 3 + 4, "{words:?}");
        model.own_mut().clear();
        assert_eq!(model.word_list().len(), 3);
        assert!(model.find("run").is_none());
    }

    #[test]
    fn words_that_cannot_be_added_change_nothing() {
        let mut model = model();
        for word in ["", "h2o", "cat", &"run".repeat(20)] {
            model.add_own_word(word);
        }
        assert_eq!(model.word_list().len(), 3);
    }

    #[test]
    fn the_room_is_limited_by_words_and_by_nodes() {
        let mut model = model();
        model.own_mut().reserve();
        let letters = ['a', 'c', 'n', 'r', 't', 'u'];
        let long = |mut number: usize| -> String {
            let mut digits = [0; MAX_LETTERS];
            for digit in &mut digits {
                (*digit, number) = (number % letters.len(), number / letters.len());
            }
            digits.iter().map(|&digit| letters[digit]).collect()
        };
        for number in 0..2 * MAX_WORDS {
            model.add_own_word(&long(number));
        }
        let own = model.own_mut();
        let room = [
            own.words.capacity(),
            own.nodes.capacity(),
            own.queue.capacity(),
        ];
        assert_eq!(room, [MAX_WORDS, MAX_NODES + 1, MAX_NODES + 1]);
        assert_eq!(own.words.len(), MAX_NODES / MAX_LETTERS);
        for number in 0..2 * MAX_WORDS {
            model.add_own_word(&long(number)[..1 + number % 4]);
        }
        let kept = model.own().words.len();
        assert_eq!(model.word_list().len(), 3 + kept);
        assert!(model.find(&long(0)).is_some());
    }
}
