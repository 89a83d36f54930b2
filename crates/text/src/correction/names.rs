//! Words that the lexicon lacks and that stayed as they were typed, until they are taken for names.

use arrayvec::ArrayString;

use super::restored::MAX_BYTES;

/// The uses within a run that make a word a name: a slip is hardly repeated letter by letter.
const USES: u8 = 3;
/// The fewest letters: shorter ones are mostly slips and abbreviations.
const MIN_LETTERS: usize = 3;
/// The most words that are counted; the least recently used one is removed for another.
const MAX_COUNTED: usize = 64;

/// A word.
pub type Name = ArrayString<MAX_BYTES>;

/// A word in lower case and its uses.
#[derive(Clone, Copy, Debug)]
struct Counted {
    word: Name,
    uses: u8,
    /// `true` if each use had a capital; `None` if each was at the start of a sentence, where any word has one.
    is_capital: Option<bool>,
}

/// Counts words that the lexicon lacks. Does not allocate after its creation.
#[derive(Clone, Debug)]
pub struct Names {
    /// In the order of their last use.
    counted: Vec<Counted>,
}

impl Default for Names {
    fn default() -> Self {
        Self {
            counted: Vec::with_capacity(MAX_COUNTED),
        }
    }
}

impl Names {
    /// Forgets all words.
    pub fn clear(&mut self) {
        self.counted.clear();
    }

    /// Copies the words of another list, and keeps the room for more.
    pub fn take_over(&mut self, other: &Self) {
        self.clear();
        self.counted.extend_from_slice(&other.counted);
    }

    /// Counts a use. Returns the word, as it is written inside a sentence, if it is a name from now on.
    pub fn count(&mut self, word: &str, starts_sentence: bool) -> Option<Name> {
        let mut lower = Name::new();
        let mut letters = word.chars().flat_map(char::to_lowercase);
        let fits = letters.all(|letter| letter.is_alphabetic() && lower.try_push(letter).is_ok());
        if !fits || word.chars().count() < MIN_LETTERS {
            return None;
        }
        let place = self.counted.iter().position(|known| known.word == lower);
        let before = place.map(|place| self.counted.remove(place));
        let uses = before.map_or(0, |before| before.uses) + 1;
        let has_capital = word.starts_with(char::is_uppercase);
        let is_of_sentence =
            starts_sentence && has_capital && !word.chars().skip(1).any(char::is_uppercase);
        let own_capital = (!is_of_sentence).then_some(has_capital);
        let is_capital = match before.and_then(|before| before.is_capital) {
            Some(each) => Some(each && own_capital.unwrap_or(true)),
            None => own_capital,
        };
        if uses >= USES {
            let written = if is_capital == Some(true) {
                Name::from(word)
            } else {
                Ok(lower)
            };
            return written.ok();
        }
        if self.counted.len() == MAX_COUNTED {
            self.counted.remove(0);
        }
        self.counted.push(Counted {
            word: lower,
            uses,
            is_capital,
        });
        None
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_word_is_a_name_with_its_third_use() {
        let mut names = Names::default();
        let words = ["nuria", "Nuria", "kubectl", "NURIA", "nuria"];
        let counts = words.map(|word| names.count(word, false).map(|name| name.to_string()));
        assert_eq!(counts, [None, None, None, Some("nuria".to_owned()), None]);
    }

    #[test]
    fn a_name_that_always_has_a_capital_keeps_it() {
        let mut names = Names::default();
        let mut last = |words: [&str; 3]| words.map(|word| names.count(word, false))[2];
        assert_eq!(last(["Nuria"; 3]).as_deref(), Some("Nuria"));
        assert_eq!(
            last(["kubectl", "kubectl", "Kubectl"]).as_deref(),
            Some("kubectl")
        );
        assert_eq!(last(["NAVO"; 3]).as_deref(), Some("NAVO"));
    }

    #[test]
    fn a_capital_at_the_start_of_a_sentence_is_not_of_the_name() {
        let mut names = Names::default();
        let mut last = |uses: [(&str, bool); 3]| uses.map(|(word, is)| names.count(word, is))[2];
        let kubectl = last([("Kubectl", true); 3]);
        assert_eq!(kubectl.as_deref(), Some("kubectl"));
        let nuria = last([("Nuria", true), ("Nuria", false), ("Nuria", true)]);
        assert_eq!(nuria.as_deref(), Some("Nuria"));
        let rsync = last([("rsync", false), ("Rsync", true), ("Rsync", true)]);
        assert_eq!(rsync.as_deref(), Some("rsync"));
        assert_eq!(last([("NAVO", true); 3]).as_deref(), Some("NAVO"));
    }

    #[test]
    fn short_words_signs_and_old_words_are_no_names() {
        let mut names = Names::default();
        let count =
            |counts: &mut Names, word: &str| (0..USES).any(|_| counts.count(word, false).is_some());
        assert!(!count(&mut names, "tj") && !count(&mut names, "h2o"));
        names.count("nuria", false);
        names.count("nuria", false);
        for number in 0..MAX_COUNTED {
            let letter = |digit: usize| char::from(b'a' + digit as u8);
            let word = format!("w{}{}", letter(number / 26), letter(number % 26));
            names.count(&word, false);
        }
        assert_eq!(names.count("nuria", false), None);
    }
}
