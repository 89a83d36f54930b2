//! The nodes of the lexicon as the decoder visits them, eight bytes each: with the letters of their children in one number, so that the
//! child of a letter is found without a look at the others.

use std::sync::Arc;

use super::alphabet::Symbol;

/// A set of letters, a bit for each; letters from [`LAST`] on share its bit.
pub type Letters = u32;

/// The symbol of the first letter without a bit of its own.
pub const LAST: Symbol = 27;

/// Returns the bit of a letter.
pub fn bit(symbol: Symbol) -> Letters {
    1 << symbol.min(LAST)
}

/// A node of the lexicon with the letters of its children.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Branch {
    /// The index of its first child.
    pub first_child: u32,
    /// The letters of its children.
    pub letters: Letters,
    /// The stored log-probability of the likeliest word that ends here or below.
    pub best: u8,
    /// The largest stored log-probability that the word that ends here has alone or after other words; 0 if none ends here.
    pub word: u8,
}

impl Branch {
    /// Returns the child of a letter with a bit of its own, or the first child whose letter has none.
    pub fn child(&self, symbol: Symbol) -> u32 {
        self.first_child + (self.letters & (bit(symbol) - 1)).count_ones()
    }

    fn packed(self) -> u64 {
        u64::from(self.first_child)
            | u64::from(self.letters) << 20
            | u64::from(self.best) << 48
            | u64::from(self.word) << 56
    }

    fn unpacked(packed: u64) -> Self {
        Self {
            first_child: child_of(packed) as u32,
            letters: (packed >> 20 & 0xfff_ffff) as Letters,
            best: (packed >> 48) as u8,
            word: (packed >> 56) as u8,
        }
    }
}

/// Returns the index of the first child of a packed node.
fn child_of(packed: u64) -> usize {
    (packed & 0xf_ffff) as usize
}

/// The nodes of a lexicon, shared by all copies of a model.
#[derive(Clone, Debug, Default)]
pub struct Branches(Arc<[u64]>);

impl Branches {
    /// Collects nodes in the order of their indices, with their words alone, and then with the words after other ones. The letters of
    /// their children are found by the letters that lead to them. Returns `None` if the letters of the children of a node are not in order.
    pub fn new(
        nodes: impl Iterator<Item = (Branch, Symbol)>,
        followers: impl Iterator<Item = (u32, u8)>,
    ) -> Option<Self> {
        let (mut branches, symbols): (Vec<u64>, Vec<Symbol>) = nodes
            .map(|(branch, symbol)| (branch.packed(), symbol))
            .unzip();
        let mut first = branches.first().map_or(0, |&root| child_of(root));
        for parent in 0..branches.len() {
            let end = branches
                .get(parent + 1)
                .map_or(symbols.len(), |&next| child_of(next));
            let letters = symbols.get(first..end)?;
            if !letters.is_sorted_by(|a, b| a < b) {
                return None;
            }
            let letters = letters.iter().fold(0, |all, &symbol| all | bit(symbol));
            branches[parent] |= u64::from(letters) << 20;
            first = end;
        }
        for (node, byte) in followers {
            let Some(packed) = branches.get_mut(node as usize) else {
                continue;
            };
            let byte = u64::from(byte.max(1));
            if byte < *packed >> 56 {
                *packed = *packed & 0xff_ffff_ffff_ffff | byte << 56;
            }
        }
        Some(Self(branches.into()))
    }

    /// Returns a node; `None` beyond the last one.
    pub fn get(&self, index: u32) -> Option<Branch> {
        let packed = self.0.get(index as usize);
        packed.copied().map(Branch::unpacked)
    }

    /// Returns the letters of the children of a node whose likeliest word has at most a stored log-probability, and the bit of the
    /// [`LAST`] ones.
    pub fn likely(&self, branch: &Branch, worst: u8) -> Letters {
        let mut likely = branch.letters & bit(LAST);
        let mut rest = branch.letters & !bit(LAST);
        let mut child = branch.first_child as usize;
        while rest != 0 {
            let letter = rest & rest.wrapping_neg();
            let best = self.0.get(child).map_or(0, |packed| (packed >> 48) as u8);
            likely |= if best <= worst { letter } else { 0 };
            rest ^= letter;
            child += 1;
        }
        likely
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn node(first_child: u32, word: u8) -> Branch {
        Branch {
            first_child,
            letters: 0,
            best: 40,
            word,
        }
    }

    /// Makes a root with one child for each letter.
    fn branches(letters: &[Symbol], followers: &[(u32, u8)]) -> Option<Branches> {
        let end = letters.len() as u32 + 1;
        let children = letters.iter().map(|&letter| (node(end, 60), letter));
        let nodes = [(node(1, 0), 0)].into_iter().chain(children);
        Branches::new(nodes, followers.iter().copied())
    }

    #[test]
    fn a_child_is_found_by_the_letters_before_it() {
        let found = branches(&[0, 3, 26, LAST, LAST + 8], &[]).expect("sorted letters");
        let root = found.get(0).expect("the root");
        let children = [0, 3, 26, LAST].map(|letter| root.child(letter));
        assert_eq!(children, [1, 2, 3, 4]);
        assert_eq!(root.letters, bit(0) | bit(3) | bit(26) | bit(LAST));
        assert_eq!(found.get(1).map(|child| child.letters), Some(0));
        assert_eq!(found.get(6), None);
    }

    #[test]
    fn letters_without_order_are_refused() {
        assert!(branches(&[3, 3], &[]).is_none());
        assert!(branches(&[3, 2], &[]).is_none());
    }

    #[test]
    fn a_word_is_as_likely_as_after_its_likeliest_word_before() {
        // The root is no word, and the last node does not exist.
        let followers = [(1, 70), (2, 20), (2, 30), (0, 9), (7, 9)];
        let found = branches(&[0, 3], &followers).expect("sorted letters");
        let words = [0, 1, 2].map(|index| found.get(index).map(|found| found.word));
        assert_eq!(words, [Some(0), Some(60), Some(20)]);
    }

    #[test]
    fn children_with_unlikely_words_are_left_out() {
        let found = branches(&[0, 3, LAST], &[]).expect("sorted letters");
        let root = found.get(0).expect("the root");
        assert_eq!(found.likely(&root, 40), root.letters);
        assert_eq!(found.likely(&root, 39), bit(LAST));
    }
}
