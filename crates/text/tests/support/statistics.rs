//! Intervals of error rates, and kinds of errors.

use ademan_text::Model;

use super::session::{Errors, normal};

/// The resamplings of an interval.
const SAMPLES: usize = 1_000;

/// The errors of each phrase, summed over all people.
#[derive(Clone, Default)]
pub struct ByPhrase(pub Vec<Errors>);

impl ByPhrase {
    pub fn new(phrases: usize) -> Self {
        Self(vec![Errors::default(); phrases])
    }

    pub fn total(&self) -> Errors {
        let mut total = Errors::default();
        for errors in &self.0 {
            total.merge(errors);
        }
        total
    }

    /// Returns the 95 % bootstrap interval of a rate in percent, phrases drawn with replacement.
    pub fn interval(&self, rate: impl Fn(&Errors) -> f64) -> [f64; 2] {
        let mut random = fastrand::Rng::with_seed(1);
        let mut rates: Vec<f64> = (0..SAMPLES)
            .map(|_| {
                let mut sum = Errors::default();
                for _ in 0..self.0.len() {
                    sum.merge(&self.0[random.usize(..self.0.len())]);
                }
                rate(&sum)
            })
            .collect();
        rates.sort_unstable_by(f64::total_cmp);
        [0.025, 0.975].map(|share| rates[((SAMPLES - 1) as f64 * share).round() as usize])
    }
}

/// Words by what became of them.
#[derive(Clone, Copy, Default, Debug)]
pub struct Kinds {
    /// Right as typed, and left.
    pub kept: usize,
    /// Wrong as typed, and put right.
    pub righted: usize,
    /// Right as typed, and made wrong.
    pub spoiled: usize,
    /// Wrong: the word is none of the lexicon.
    pub unknown: usize,
    /// Wrong: only its punctuation.
    pub punctuation: usize,
    /// Wrong: a space too few or too many.
    pub spaces: usize,
    /// Wrong: left as it was typed, and no word.
    pub left: usize,
    /// Wrong: another word of the lexicon.
    pub other: usize,
    /// Wrong: other letters.
    pub letters: usize,
}

/// Returns the word of another text that each word became, if it is one.
fn partners<'a>(meant: &[&str], read: &[&'a str]) -> Vec<Option<&'a str>> {
    let (rows, columns) = (meant.len() + 1, read.len() + 1);
    let mut costs = vec![0; rows * columns];
    for i in 0..rows {
        for j in 0..columns {
            costs[i * columns + j] = match (i, j) {
                (0, _) => 10 * j,
                (_, 0) => 10 * i,
                _ => {
                    let change = substitution(meant[i - 1], read[j - 1]);
                    let before = costs[(i - 1) * columns + j - 1] + change;
                    let removed = costs[(i - 1) * columns + j] + 10;
                    before.min(removed).min(costs[i * columns + j - 1] + 10)
                }
            };
        }
    }
    let mut partners = vec![None; meant.len()];
    let (mut i, mut j) = (meant.len(), read.len());
    while i > 0 && j > 0 {
        let here = costs[i * columns + j];
        if here == costs[(i - 1) * columns + j - 1] + substitution(meant[i - 1], read[j - 1]) {
            partners[i - 1] = Some(read[j - 1]);
            (i, j) = (i - 1, j - 1);
        } else if here == costs[(i - 1) * columns + j] + 10 {
            i -= 1;
        } else {
            j -= 1;
        }
    }
    partners
}

/// Returns the cost of a word for another one, so that similar words are partners.
fn substitution(left: &str, right: &str) -> usize {
    let letters = |text: &str| text.chars().collect::<Vec<_>>();
    let (left, right) = (letters(left), letters(right));
    let longest = left.len().max(right.len()).max(1);
    19 * super::session::distance(&left, &right) / longest
}

impl Kinds {
    pub fn add(&mut self, model: &Model, meant: &str, typed: &str, read: &str) {
        let [meant, typed, read] = [meant, typed, read].map(normal);
        let meant: Vec<&str> = meant.split(' ').collect();
        let typed: Vec<&str> = typed.split(' ').collect();
        let read: Vec<&str> = read.split(' ').collect();
        let as_typed = partners(&meant, &typed);
        let as_read = partners(&meant, &read);
        let bare = |word: &str| -> String {
            let part = |letter: &char| letter.is_alphanumeric() || *letter == '\'';
            word.chars().filter(part).collect()
        };
        for ((word, typed_word), read_word) in meant.iter().zip(as_typed).zip(as_read) {
            let was_right = typed_word == Some(*word);
            let Some(read_word) = read_word else {
                self.spaces += 1;
                continue;
            };
            if read_word == *word {
                let count = if was_right {
                    &mut self.kept
                } else {
                    &mut self.righted
                };
                *count += 1;
                continue;
            }
            let count = if was_right {
                &mut self.spoiled
            } else if bare(read_word) == bare(word) {
                &mut self.punctuation
            } else if model.find(&bare(word)).is_none() {
                &mut self.unknown
            } else if typed_word == Some(read_word) {
                &mut self.left
            } else if model.find(&bare(read_word)).is_some() {
                &mut self.other
            } else {
                &mut self.letters
            };
            *count += 1;
        }
    }

    pub fn wrong(&self) -> usize {
        self.spoiled
            + self.unknown
            + self.punctuation
            + self.spaces
            + self.left
            + self.other
            + self.letters
    }
}
