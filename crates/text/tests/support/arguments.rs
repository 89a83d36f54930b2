//! Phrases and people of the examples that print tables of the docs, from the arguments `[--phrases N] [--people N] [--tuning]`.

use std::ops::Range;

use super::phrases::phrases;

/// The phrases and the simulated people of a table.
pub struct Sample {
    pub phrases: Vec<String>,
    /// The seeds of the people.
    pub seeds: Range<u64>,
    pub is_tuning: bool,
}

impl Sample {
    /// Reads the arguments of the program, with numbers for those that are left out. Returns `None` if there are no phrases.
    pub fn from_arguments(phrase_count: usize, people: usize) -> Option<Self> {
        let number = |name: &str, default: usize| {
            argument(name).map_or(default, |value| value.parse().expect("a number"))
        };
        let is_tuning = std::env::args().any(|argument| argument == "--tuning");
        let mut phrases = phrases(!is_tuning)?;
        phrases.truncate(number("--phrases", phrase_count));
        let people = number("--people", people) as u64;
        let first = if is_tuning { 1_000 } else { 0 };
        Some(Self {
            phrases,
            seeds: first..first + people,
            is_tuning,
        })
    }
}

/// Returns the argument of the program after the one with this name.
pub fn argument(name: &str) -> Option<String> {
    std::env::args()
        .skip_while(|argument| argument != name)
        .nth(1)
}

/// Returns the number of phrases of a person, or of people, of a test: more with `ADEMAN_TEXT_PHRASES` and `ADEMAN_TEXT_PEOPLE`.
pub fn amount(name: &str, default: usize) -> usize {
    let text = std::env::var(name);
    text.map_or(default, |text| text.parse().expect("a number"))
}
