//! The characters of all hypotheses: chains that share their beginnings, in one block of memory.

/// The end of a chain.
pub const NONE: u32 = u32::MAX;
/// The characters that fit.
const CAPACITY: usize = 1 << 16;
/// The characters that the hypotheses of one tap may add.
const RESERVE: usize = 1 << 13;

/// A character of a hypothesis.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Entry {
    /// The character before.
    pub previous: u32,
    /// The tap that means it, or [`NONE`].
    pub tap: u32,
    /// The character.
    pub character: char,
    /// The case of the word that this character ends.
    pub case: crate::model::lexicon::Case,
}

/// The chains.
#[derive(Clone, Debug)]
pub struct History {
    entries: Vec<Entry>,
    moved: Vec<u32>,
}

impl History {
    pub fn new() -> Self {
        Self {
            entries: Vec::with_capacity(CAPACITY),
            moved: vec![NONE; CAPACITY],
        }
    }

    pub fn clear(&mut self) {
        self.entries.clear();
    }

    /// Returns `true` if the characters of one more tap fit for sure.
    pub fn has_room(&self) -> bool {
        self.entries.len() + RESERVE <= CAPACITY
    }

    /// Appends a character to a chain and returns its end.
    pub fn push(&mut self, entry: Entry) -> u32 {
        if self.entries.len() >= CAPACITY {
            return entry.previous;
        }
        self.entries.push(entry);
        self.entries.len() as u32 - 1
    }

    pub fn get(&self, index: u32) -> Option<Entry> {
        self.entries.get(index as usize).copied()
    }

    /// Marks the chain that ends at a place as needed.
    pub fn keep(&mut self, end: u32) {
        let mut index = end;
        while let Some(entry) = self.entries.get(index as usize) {
            let mark = &mut self.moved[index as usize];
            if *mark != NONE {
                return;
            }
            *mark = 0;
            index = entry.previous;
        }
    }

    /// Removes what was not marked.
    pub fn sweep(&mut self) {
        let mut kept = 0;
        for index in 0..self.entries.len() {
            if self.moved[index] == NONE {
                continue;
            }
            let mut entry = self.entries[index];
            entry.previous = self.moved(entry.previous);
            self.entries[kept] = entry;
            self.moved[index] = kept as u32;
            kept += 1;
        }
        self.entries.truncate(kept);
    }

    /// Returns the new place of an old one, after [`sweep`](Self::sweep).
    pub fn moved(&self, index: u32) -> u32 {
        self.moved.get(index as usize).copied().unwrap_or(NONE)
    }

    /// Removes the marks.
    pub fn unmark(&mut self) {
        self.moved.fill(NONE);
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn entry(previous: u32, character: char) -> Entry {
        Entry {
            previous,
            tap: NONE,
            character,
            case: Default::default(),
        }
    }

    #[test]
    fn needed_chains_survive_a_sweep() {
        let mut history = History::new();
        let shared = history.push(entry(NONE, 'a'));
        let dropped = history.push(entry(shared, 'x'));
        let end = history.push(entry(shared, 'b'));
        let _ = history.push(entry(dropped, 'y'));
        history.keep(end);
        history.sweep();
        let end = history.moved(end);
        history.unmark();
        let last = history.get(end).expect("the end");
        let first = history.get(last.previous).expect("the start");
        assert_eq!((first.character, last.character), ('a', 'b'));
        assert_eq!(first.previous, NONE);
        assert_eq!(history.entries.len(), 2);
    }
}
