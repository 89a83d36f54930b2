//! Words that the lexicon lacks and that stayed as they were typed, until they are taken for names.

use arrayvec::ArrayString;

use super::restored::MAX_BYTES;

/// The uses within a run that make a word a name: a slip is hardly repeated letter by letter.
const USES: u8 = 3;
/// The fewest letters: shorter ones are mostly slips and abbreviations.
const MIN_LETTERS: usize = 3;
/// The words that are counted; the one that was used longest ago makes room.
const MAX_COUNTED: usize = 64;

/// A word in lower case and its uses.
#[derive(Clone, Copy, Debug)]
struct Counted {
    word: ArrayString<MAX_BYTES>,
    uses: u8,
}

/// Counts words that the lexicon lacks. Does not allocate after its creation.
#[derive(Clone, Debug)]
pub struct Names {
    /// The one that was used last comes last.
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

    /// Takes the words of another list, and keeps the room for more.
    pub fn take_over(&mut self, other: &Self) {
        self.clear();
        self.counted.extend_from_slice(&other.counted);
    }

    /// Counts a use. Returns `true` if the word is a name from now on.
    pub fn count(&mut self, word: &str) -> bool {
        let mut lower = ArrayString::new();
        let mut letters = word.chars().flat_map(char::to_lowercase);
        let fits = letters.all(|letter| letter.is_alphabetic() && lower.try_push(letter).is_ok());
        if !fits || word.chars().count() < MIN_LETTERS {
            return false;
        }
        let place = self.counted.iter().position(|known| known.word == lower);
        let uses = place.map_or(0, |place| self.counted.remove(place).uses) + 1;
        if uses >= USES {
            return true;
        }
        if self.counted.len() == MAX_COUNTED {
            self.counted.remove(0);
        }
        self.counted.push(Counted { word: lower, uses });
        false
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_word_is_a_name_with_its_third_use() {
        let mut names = Names::default();
        let counts = ["nuria", "Nuria", "kubectl", "NURIA", "nuria"].map(|word| names.count(word));
        assert_eq!(counts, [false, false, false, true, false]);
    }

    #[test]
    fn short_words_signs_and_old_words_are_no_names() {
        let mut names = Names::default();
        let count = |counts: &mut Names, word: &str| (0..USES).any(|_| counts.count(word));
        assert!(!count(&mut names, "tj") && !count(&mut names, "h2o"));
        names.count("nuria");
        names.count("nuria");
        for number in 0..MAX_COUNTED {
            let letter = |digit: usize| char::from(b'a' + digit as u8);
            names.count(&format!("w{}{}", letter(number / 26), letter(number % 26)));
        }
        assert!(!names.count("nuria"));
    }
}
