//! The words of the person, which are never changed: brought back with a Backspace, used as names, or from a file.

use arrayvec::ArrayString;
use serde::{Deserialize, Serialize};

use super::tail::ends_word;
use crate::decoder::same_letters;

/// The most words.
const MAX_WORDS: usize = 512;
/// The longest word in bytes.
pub(super) const MAX_BYTES: usize = 64;
/// Room for the words of one correction, in bytes.
const PENDING_BYTES: usize = 1_024;

/// Words that are never changed, as they are written inside a sentence. Learning one does not allocate.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(from = "Vec<String>", into = "Vec<String>")]
pub struct Restored {
    words: Vec<ArrayString<MAX_BYTES>>,
    /// The words of the last correction as they were typed, separated by spaces.
    pending: String,
}

impl Default for Restored {
    fn default() -> Self {
        Self {
            words: Vec::with_capacity(MAX_WORDS),
            pending: String::with_capacity(PENDING_BYTES),
        }
    }
}

impl From<Vec<String>> for Restored {
    fn from(words: Vec<String>) -> Self {
        let mut restored = Self::default();
        for word in words {
            restored.add(&word);
        }
        restored
    }
}

impl From<Restored> for Vec<String> {
    fn from(restored: Restored) -> Self {
        restored.words.iter().map(ToString::to_string).collect()
    }
}

/// Returns the words of a text from the word around a position to the last word before the end that it has in common with another text.
fn changed<'a>(shown: &'a str, prefix: usize, target: &str) -> impl Iterator<Item = &'a str> {
    let pairs = shown[prefix..]
        .chars()
        .rev()
        .zip(target[prefix..].chars().rev());
    let common = pairs.take_while(|(left, right)| left == right);
    let common: usize = common.map(|(letter, _)| letter.len_utf8()).sum();
    let start = shown[..prefix].rfind(ends_word).map_or(0, |last| {
        last + shown[last..].chars().next().map_or(1, char::len_utf8)
    });
    let changed_end = shown.len() - common;
    let end = shown[changed_end..]
        .find(ends_word)
        .map_or(shown.len(), |more| changed_end + more);
    shown[start..end.max(start)]
        .split(ends_word)
        .filter(|word| !word.is_empty())
}

impl Restored {
    /// Iterates over the words, the oldest first.
    pub fn words(&self) -> impl ExactSizeIterator<Item = &str> {
        self.words.iter().map(ArrayString::as_str)
    }

    /// Copies the words of another list, and keeps the room for more.
    pub(super) fn take_over(&mut self, other: &Self) {
        self.clear();
        self.words.extend_from_slice(&other.words);
    }

    /// Forgets all words.
    pub fn clear(&mut self) {
        self.words.clear();
        self.pending.clear();
    }

    /// Adds a word, unless it is empty, too long or there already, whatever its case, or there is no room.
    pub fn add(&mut self, word: &str) {
        let Ok(kept) = ArrayString::from(word) else {
            return;
        };
        if word.is_empty() || self.words.iter().any(|known| same_letters(known, word)) {
            return;
        }
        if self.words.len() < MAX_WORDS {
            self.words.push(kept);
        }
    }

    /// Returns `true` if the change from a text to another one would change one of the words.
    pub(super) fn touches(&self, shown: &str, prefix: usize, target: &str) -> bool {
        let is_known = |word: &str| self.words.iter().any(|known| same_letters(word, known));
        changed(shown, prefix, target).any(is_known)
    }

    /// Notes the words that a change replaces, unless the new text has them too.
    pub(super) fn remember(&mut self, shown: &str, prefix: usize, target: &str) {
        self.pending.clear();
        for word in changed(shown, prefix, target) {
            let stays = target.split(ends_word).any(|new| new == word);
            if !stays && self.pending.len() + word.len() < PENDING_BYTES {
                self.pending.push_str(word);
                self.pending.push(' ');
            }
        }
    }

    /// Learns the noted words, and calls `learned` with each.
    pub(super) fn learn(&mut self, mut learned: impl FnMut(&str)) {
        let pending = std::mem::take(&mut self.pending);
        for word in pending.split(' ').filter(|word| !word.is_empty()) {
            self.add(word);
            learned(word);
        }
        self.pending = pending;
        self.pending.clear();
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn words(shown: &str, prefix: usize, target: &str) -> Vec<String> {
        changed(shown, prefix, target).map(str::to_owned).collect()
    }

    #[test]
    fn the_changed_words_are_whole() {
        assert_eq!(words("see teh ", 5, "see the "), ["teh"]);
        assert_eq!(words("wis dom is ", 3, "wisdom is "), ["wis", "dom"]);
        assert_eq!(words("como ", 1, "cómo "), ["como"]);
        assert_eq!(words("cómo él ", 4, "cóma él "), ["cómo"]);
    }

    #[test]
    fn a_full_list_keeps_its_words() {
        let mut restored = Restored::default();
        for number in 0..=MAX_WORDS {
            restored.add(&format!("w{number}"));
        }
        assert_eq!(restored.words().len(), MAX_WORDS);
        assert_eq!(restored.words().next(), Some("w0"));
    }

    #[test]
    fn stored_words_are_checked() {
        let text = format!("[\"Teh\", \"teh\", \"\", \"{}\"]", "x".repeat(100));
        let restored: Restored = serde_json::from_str(&text).expect("words");
        assert!(restored.words().eq(["Teh"]));
        assert_eq!(serde_json::to_string(&restored).expect("text"), "[\"Teh\"]");
    }
}
