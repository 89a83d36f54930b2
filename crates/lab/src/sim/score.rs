//! Speed and accuracy of a typed text.

use crate::time::Timestamp;

/// The scores of one typed text.
#[derive(Clone, Debug, PartialEq)]
pub struct TypingScore {
    /// Text to be typed.
    pub presented: String,
    /// Text that was typed.
    pub typed: String,
    /// Words per minute of the characters that are correct; a word is five characters.
    pub words_per_minute: f64,
    /// MSD error rate, 0..=1: the edit distance divided by the length of the longer text.
    pub error_rate: f64,
    /// The characters of a shortest edit.
    pub edits: EditCounts,
}

/// The characters of a shortest edit of the presented text into the typed one; of several, the one with the most correct characters.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct EditCounts {
    /// Typed as presented.
    pub correct: usize,
    /// Typed in place of another one.
    pub substitutions: usize,
    /// Typed without being presented.
    pub insertions: usize,
    /// Presented without being typed.
    pub deletions: usize,
}

impl EditCounts {
    /// Compares two texts.
    pub fn new(presented: &str, typed: &str) -> Self {
        let presented: Vec<char> = presented.chars().collect();
        // Row by row of the usual table: the counts for the first characters of both texts.
        let first = Self::default();
        let insert = |before: Self| Self {
            insertions: before.insertions + 1,
            ..before
        };
        let delete = |before: Self| Self {
            deletions: before.deletions + 1,
            ..before
        };
        let mut row: Vec<Self> = std::iter::successors(Some(first), |before| Some(delete(*before)))
            .take(presented.len() + 1)
            .collect();
        for found in typed.chars() {
            let mut diagonal = row[0];
            row[0] = insert(row[0]);
            for (index, &wanted) in presented.iter().enumerate() {
                let paired = if wanted == found {
                    Self {
                        correct: diagonal.correct + 1,
                        ..diagonal
                    }
                } else {
                    Self {
                        substitutions: diagonal.substitutions + 1,
                        ..diagonal
                    }
                };
                diagonal = row[index + 1];
                let others = [insert(diagonal), delete(row[index])];
                row[index + 1] = others.into_iter().fold(paired, Self::better);
            }
        }
        row[presented.len()]
    }

    /// Returns the number of edits: the Levenshtein distance.
    pub fn errors(&self) -> usize {
        self.substitutions + self.insertions + self.deletions
    }

    /// Adds the characters of another text.
    pub fn add(&mut self, other: Self) {
        self.correct += other.correct;
        self.substitutions += other.substitutions;
        self.insertions += other.insertions;
        self.deletions += other.deletions;
    }

    fn better(self, other: Self) -> Self {
        let rank = |counts: &Self| (counts.errors(), usize::MAX - counts.correct);
        if rank(&other) < rank(&self) {
            other
        } else {
            self
        }
    }
}

impl TypingScore {
    /// Scores `typed` against `presented`; `first` and `last` are the times of the first and the last event.
    pub fn new(presented: &str, typed: &str, first: Timestamp, last: Timestamp) -> Self {
        let edits = EditCounts::new(presented, typed);
        Self {
            presented: presented.to_owned(),
            typed: typed.to_owned(),
            words_per_minute: words_per_minute(edits.correct, last.since(first).as_secs_f64()),
            error_rate: error_rate(presented, typed),
            edits,
        }
    }
}

/// Returns for each character of the presented text whether a shortest edit into the typed text keeps it. Takes memory for the product
/// of both lengths.
pub fn kept_characters(presented: &str, typed: &str) -> Vec<bool> {
    let presented: Vec<char> = presented.chars().collect();
    let typed: Vec<char> = typed.chars().collect();
    // Entry (i, j) is the distance between what follows the first i and j characters.
    let width = typed.len() + 1;
    let mut distances = vec![0_usize; (presented.len() + 1) * width];
    for i in (0..=presented.len()).rev() {
        for j in (0..=typed.len()).rev() {
            let at = |row: usize, column: usize| distances[row * width + column];
            distances[i * width + j] = match (presented.get(i), typed.get(j)) {
                (None, _) => typed.len() - j,
                (_, None) => presented.len() - i,
                (Some(wanted), Some(found)) => {
                    let paired = at(i + 1, j + 1) + usize::from(wanted != found);
                    paired.min(at(i + 1, j) + 1).min(at(i, j + 1) + 1)
                }
            };
        }
    }
    let mut kept = vec![false; presented.len()];
    let (mut i, mut j) = (0, 0);
    while i < presented.len() && j < typed.len() {
        let (here, is_same) = (distances[i * width + j], presented[i] == typed[j]);
        let paired = distances[(i + 1) * width + j + 1] + usize::from(!is_same);
        if paired == here {
            kept[i] = is_same;
            (i, j) = (i + 1, j + 1);
        } else if distances[(i + 1) * width + j] + 1 == here {
            i += 1;
        } else {
            j += 1;
        }
    }
    kept
}

/// Returns (length − 1) / seconds × 60 / 5 (Wobbrock 2007) for a text of `length` characters; 0 for fewer than two characters or no
/// time.
pub fn words_per_minute(length: usize, seconds: f64) -> f64 {
    if length < 2 || seconds <= 0.0 {
        return 0.0;
    }
    (length - 1) as f64 / seconds * 60.0 / 5.0
}

/// Returns the number of words of a presented text, and the Levenshtein distance between its words and the typed ones. Words are
/// separated by blanks; capitals and punctuation are part of them.
pub fn word_errors(presented: &str, typed: &str) -> [usize; 2] {
    let [presented, typed] =
        [presented, typed].map(|text| text.split_whitespace().collect::<Vec<&str>>());
    let errors = strsim::generic_levenshtein(&presented, &typed);
    [presented.len(), errors]
}

/// Returns the Levenshtein distance divided by the length of the longer text (Soukoreff & MacKenzie 2003), 0..=1; 0 for
/// two empty texts.
pub fn error_rate(presented: &str, typed: &str) -> f64 {
    let longer = presented.chars().count().max(typed.chars().count());
    if longer == 0 {
        return 0.0;
    }
    strsim::levenshtein(presented, typed) as f64 / longer as f64
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn sixty_one_characters_per_minute_are_twelve_words() {
        assert_eq!(words_per_minute(61, 60.0), 12.0);
        assert_eq!(words_per_minute(1, 60.0), 0.0);
        assert_eq!(words_per_minute(2, 0.0), 0.0);
    }

    #[test]
    fn wrong_characters_do_not_raise_the_speed() {
        let speed = |typed: &str| {
            let minute = Timestamp(60_000_000);
            TypingScore::new("a hand types", typed, Timestamp(0), minute).words_per_minute
        };
        let correct = speed("a hand types");
        assert!((correct - 2.2).abs() < 1e-9, "{correct}");
        assert_eq!(speed("aa hhanndd ttyyppees"), correct);
        assert!(speed("a xxxx types") < correct);
    }

    #[test]
    fn the_edits_add_up_to_both_texts_and_to_the_levenshtein_distance() {
        let counts = |correct, substitutions, insertions, deletions| EditCounts {
            correct,
            substitutions,
            insertions,
            deletions,
        };
        assert_eq!(EditCounts::new("hand", "hond"), counts(3, 1, 0, 0));
        assert_eq!(EditCounts::new("hand", "hands"), counts(4, 0, 1, 0));
        assert_eq!(EditCounts::new("hand", "and"), counts(3, 0, 0, 1));
        assert_eq!(EditCounts::new("", "ab"), counts(0, 0, 2, 0));
        let mut random = fastrand::Rng::with_seed(3);
        let mut text = || -> String {
            let length = random.usize(0..12);
            (0..length).map(|_| random.char('a'..='c')).collect()
        };
        for _ in 0..500 {
            let (presented, typed) = (text(), text());
            let found = EditCounts::new(&presented, &typed);
            let distance = strsim::levenshtein(&presented, &typed);
            assert_eq!(found.errors(), distance, "{presented} {typed}");
            let paired = found.correct + found.substitutions;
            assert_eq!(paired + found.deletions, presented.len());
            assert_eq!(paired + found.insertions, typed.len());
        }
    }

    #[test]
    fn the_kept_characters_are_those_that_no_shortest_edit_touches() {
        let kept = |presented: &str, typed: &str| -> String {
            let kept = kept_characters(presented, typed).into_iter();
            kept.map(|is_kept| if is_kept { '+' } else { '-' })
                .collect()
        };
        assert_eq!(kept("hand", "hand"), "++++");
        assert_eq!(kept("hand", "hond"), "+-++");
        assert_eq!(kept("hand", "hnd"), "+-++");
        assert_eq!(kept("hand", "haxnd"), "++++");
        assert_eq!(kept("hand", ""), "----");
        assert_eq!(kept("", "hand"), "");
        let mut random = fastrand::Rng::with_seed(5);
        let mut text = || -> String {
            let length = random.usize(0..9);
            (0..length).map(|_| random.char('a'..='c')).collect()
        };
        for _ in 0..300 {
            let (presented, typed) = (text(), text());
            let flags = kept_characters(&presented, &typed);
            let count = flags.iter().filter(|is_kept| **is_kept).count();
            let distance = strsim::levenshtein(&presented, &typed);
            // Without the kept characters, each edit is an insertion, a deletion or both at once.
            let longer = presented.len().max(typed.len());
            assert!(
                count >= longer.saturating_sub(distance),
                "{presented} {typed}"
            );
            assert!(
                count <= presented.len().min(typed.len()),
                "{presented} {typed}"
            );
        }
    }

    #[test]
    fn a_word_is_wrong_once_however_many_of_its_letters_are() {
        for (presented, typed, expected) in [
            ("we met at noon", "we met at noon", [4, 0]),
            ("we met at noon", "we mat at mqqn", [4, 2]),
            // A blank too many or too few.
            ("we met at noon", "we me t at noon", [4, 2]),
            ("we met at noon", "wemet at noon", [4, 2]),
            ("we met at noon", "we at noon", [4, 1]),
            ("we met", "", [2, 2]),
            ("", "we", [0, 1]),
        ] {
            assert_eq!(word_errors(presented, typed), expected, "{typed}");
        }
    }

    #[test]
    fn one_wrong_letter_of_four_is_a_quarter() {
        assert_eq!(error_rate("hand", "hond"), 0.25);
        assert_eq!(error_rate("hand", "hands"), 0.2);
        assert_eq!(error_rate("", ""), 0.0);
    }
}
