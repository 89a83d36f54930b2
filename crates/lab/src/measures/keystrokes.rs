//! Keystrokes by class, of people who correct.

use serde::{Deserialize, Serialize};

use crate::sim::EditCounts;

/// The keystrokes of texts by class (Soukoreff & MacKenzie 2003, doi 10.1145/642611.642632). P is a text that was to be typed, T what
/// was typed in the end, and MSD their edit distance. Modifiers such as Shift belong to no class.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
pub struct KeystrokeClasses {
    /// C, correct: max(|P|, |T|) − MSD.
    pub correct: u64,
    /// INF, incorrect and not fixed: MSD.
    pub not_fixed: u64,
    /// IF, incorrect and fixed: characters that were deleted again. Right ones after an error are among them.
    pub fixed: u64,
    /// F, fixes: presses of Backspace.
    pub fixes: u64,
}

impl KeystrokeClasses {
    /// Classes the keystrokes of one text: `edits` make T of P, `fixed` characters were deleted again, by `fixes` presses.
    pub fn new(edits: &EditCounts, fixed: usize, fixes: usize) -> Self {
        let longer = edits.correct + edits.substitutions + edits.insertions.max(edits.deletions);
        Self {
            correct: longer.saturating_sub(edits.errors()) as u64,
            not_fixed: edits.errors() as u64,
            fixed: fixed as u64,
            fixes: fixes as u64,
        }
    }

    /// Adds the keystrokes of another text.
    pub fn add(&mut self, other: Self) {
        self.correct += other.correct;
        self.not_fixed += other.not_fixed;
        self.fixed += other.fixed;
        self.fixes += other.fixes;
    }

    /// Returns C + INF + IF, by which rates of errors are computed.
    pub fn typed(&self) -> u64 {
        self.correct + self.not_fixed + self.fixed
    }
}

#[cfg(test)]
mod tests {
    use super::super::{PersonScore, summarize};
    use super::*;

    #[test]
    fn the_classes_of_a_corrected_text_are_those_of_the_paper() {
        // "the quix" is typed, then three Backspaces for "uix", and "ick brwn": U and O are missing.
        let (presented, typed) = ("the quick brown", "the qick brwn");
        let edits = EditCounts::new(presented, typed);
        let found = KeystrokeClasses::new(&edits, 3, 3);
        let expected = KeystrokeClasses {
            correct: 13,
            not_fixed: 2,
            fixed: 3,
            fixes: 3,
        };
        assert_eq!(found, expected);
        // Insertions and deletions of one text: the longer text counts.
        let both = KeystrokeClasses::new(&EditCounts::new("abcd", "xabc"), 0, 0);
        assert_eq!((both.correct, both.not_fixed), (2, 2));
    }

    #[test]
    fn rates_of_errors_are_of_the_people_who_correct_only() {
        let person = |keystrokes| PersonScore {
            characters: 20,
            keystrokes_by_class: keystrokes,
            ..PersonScore::default()
        };
        let classes = |correct, not_fixed, fixed| {
            Some(KeystrokeClasses {
                correct,
                not_fixed,
                fixed,
                fixes: fixed,
            })
        };
        let people = [person(classes(18, 2, 0)), person(classes(20, 0, 10))];
        let summary = summarize(&people);
        let value = |rate: Option<crate::measures::Interval>| rate.expect("a rate").value;
        assert!((value(summary.uncorrected) - 2.0 / 50.0).abs() < 1e-12);
        assert!((value(summary.corrected) - 10.0 / 50.0).abs() < 1e-12);
        let careless = summarize(&[person(None)]);
        assert_eq!((careless.uncorrected, careless.corrected), (None, None));
    }
}
