//! Speed and accuracy of a typed text.

use crate::time::Timestamp;

/// The scores of one typed text.
#[derive(Clone, Debug, PartialEq)]
pub struct TypingScore {
    /// Text to be typed.
    pub presented: String,
    /// Text that was typed.
    pub typed: String,
    /// Words per minute; a word is five characters.
    pub words_per_minute: f64,
    /// MSD error rate, 0..=1: the edit distance divided by the length of the longer text.
    pub error_rate: f64,
}

impl TypingScore {
    /// Scores `typed` against `presented`; `first` and `last` are the times of the first and the last event.
    pub fn new(presented: &str, typed: &str, first: Timestamp, last: Timestamp) -> Self {
        Self {
            presented: presented.to_owned(),
            typed: typed.to_owned(),
            words_per_minute: words_per_minute(typed, last.since(first).as_secs_f64()),
            error_rate: error_rate(presented, typed),
        }
    }
}

/// Returns (length − 1) / seconds × 60 / 5 (Wobbrock 2007); 0 for fewer than two characters or no time.
pub fn words_per_minute(typed: &str, seconds: f64) -> f64 {
    let length = typed.chars().count();
    if length < 2 || seconds <= 0.0 {
        return 0.0;
    }
    (length - 1) as f64 / seconds * 60.0 / 5.0
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
        assert_eq!(words_per_minute(&"x".repeat(61), 60.0), 12.0);
        assert_eq!(words_per_minute("x", 60.0), 0.0);
        assert_eq!(words_per_minute("xx", 0.0), 0.0);
    }

    #[test]
    fn one_wrong_letter_of_four_is_a_quarter() {
        assert_eq!(error_rate("hand", "hond"), 0.25);
        assert_eq!(error_rate("hand", "hands"), 0.2);
        assert_eq!(error_rate("", ""), 0.0);
    }
}
