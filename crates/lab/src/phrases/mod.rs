//! Texts for simulated people: phrases that were written for this project (CC0), and texts of files.

use crate::document::BYTE_ORDER_MARK;
use crate::names::named_enum;

named_enum! {
    /// A set of phrases that comes with the program.
    pub enum PhraseSet ("phrases") {
        /// English sentences in lower case, without punctuation.
        En = "en",
        /// Spanish sentences in lower case, without punctuation, with accents.
        Es = "es",
        /// Numbers as on forms: codes, telephone numbers, prices.
        Digits = "digits",
        /// Lines of programs and shells.
        Code = "code",
    }
}

/// The longest text, in characters: what a phrase is.
pub const MAX_PHRASE: usize = 200;

/// Phrases with the name and the hash of the whole set.
#[derive(Clone, Debug, PartialEq)]
pub struct Corpus {
    /// The name of the set, or the file.
    pub name: String,
    /// The phrases, each without line breaks.
    pub phrases: Vec<String>,
}

/// The reason why a text has no phrases.
#[derive(Clone, Copy, Debug, PartialEq, Eq, thiserror::Error)]
#[error("the text has no phrase; write one phrase on each line")]
pub struct NoPhrase;

impl Corpus {
    /// Returns a set that comes with the program.
    pub fn shipped(set: PhraseSet) -> Self {
        let text = match set {
            PhraseSet::En => include_str!("en.txt"),
            PhraseSet::Es => include_str!("es.txt"),
            PhraseSet::Digits => include_str!("digits.txt"),
            PhraseSet::Code => include_str!("code.txt"),
        };
        Self::from_text(set.name(), text).expect("the sets of the program have phrases")
    }

    /// Reads one phrase from each line that is not blank, without a byte order mark. Longer ones than [`MAX_PHRASE`] characters are cut
    /// between two words.
    pub fn from_text(name: &str, text: &str) -> Result<Self, NoPhrase> {
        let text = text.trim_start_matches(BYTE_ORDER_MARK);
        let lines = text.lines().map(str::trim).filter(|line| !line.is_empty());
        let phrases: Vec<String> = lines.flat_map(cut).collect();
        if phrases.is_empty() {
            Err(NoPhrase)
        } else {
            Ok(Self {
                name: name.to_owned(),
                phrases,
            })
        }
    }

    /// Returns the hash of the phrases: FNV-1a, 64 bits.
    pub fn hash(&self) -> u64 {
        let bytes = self.phrases.iter().flat_map(|phrase| {
            let line = phrase.bytes();
            line.chain(std::iter::once(b'\n'))
        });
        fnv(bytes)
    }

    /// Returns the phrases with an even or an odd index, to choose on one half and to judge on the other.
    #[must_use]
    pub fn half(&self, is_odd: bool) -> Self {
        let phrases = self.phrases.iter().skip(usize::from(is_odd)).step_by(2);
        Self {
            name: self.name.clone(),
            phrases: phrases.cloned().collect(),
        }
    }
}

/// Returns the FNV-1a hash of bytes, 64 bits.
pub(crate) fn fnv(bytes: impl IntoIterator<Item = u8>) -> u64 {
    let add = |hash: u64, byte: u8| (hash ^ u64::from(byte)).wrapping_mul(0x0100_0000_01b3);
    bytes.into_iter().fold(0xcbf2_9ce4_8422_2325, add)
}

fn cut(line: &str) -> Vec<String> {
    let mut phrases = vec![String::new()];
    for word in line.split_whitespace() {
        let last = phrases.last_mut().expect("there is always one");
        let length = last.chars().count() + word.chars().count();
        if !last.is_empty() && length >= MAX_PHRASE {
            phrases.push(word.to_owned());
            continue;
        }
        if !last.is_empty() {
            last.push(' ');
        }
        last.push_str(word);
    }
    for phrase in &mut phrases {
        *phrase = phrase.chars().take(MAX_PHRASE).collect();
    }
    phrases
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_set_has_at_least_40_different_phrases() {
        for set in PhraseSet::ALL {
            let corpus = Corpus::shipped(*set);
            let mut phrases = corpus.phrases.clone();
            phrases.sort();
            phrases.dedup();
            assert!(phrases.len() >= 40, "{set}: {}", phrases.len());
            assert_eq!(phrases.len(), corpus.phrases.len(), "{set}");
        }
    }

    #[test]
    fn the_halves_of_a_set_share_no_phrase() {
        let corpus = Corpus::shipped(PhraseSet::En);
        let (even, odd) = (corpus.half(false), corpus.half(true));
        assert_eq!(even.phrases.len() + odd.phrases.len(), corpus.phrases.len());
        assert!(even.phrases.iter().all(|it| !odd.phrases.contains(it)));
        assert_ne!(even.hash(), odd.hash());
    }

    #[test]
    fn a_text_without_phrases_is_refused_and_a_long_line_is_cut() {
        for empty in [" \n\n", "\u{feff}\n"] {
            assert_eq!(Corpus::from_text("empty", empty), Err(NoPhrase));
        }
        let marked = Corpus::from_text("marked", "\u{feff}one\ntwo").expect("phrases");
        assert_eq!(marked.phrases, ["one", "two"]);
        let long = "word ".repeat(100);
        let corpus = Corpus::from_text("long", &long).expect("phrases");
        let lengths = corpus.phrases.iter().map(|it| it.chars().count());
        assert!(lengths.clone().all(|it| it <= MAX_PHRASE), "{corpus:?}");
        assert_eq!(corpus.phrases.len(), 3);
    }
}
