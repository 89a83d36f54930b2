//! A person who reads what is typed, and corrects it.

use crate::people::{Draw, Participant};
use crate::sim::EditCounts;

/// The time without strokes after which a person corrects, in seconds.
const STILL: f64 = 0.05;
/// The most corrections of a phrase, as a multiple of its characters: a person who hits another key than Backspace gives up.
const MOST: usize = 2;

/// The next thing that a person does.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Decision {
    /// Go on.
    Type,
    /// Let the strokes end that have begun.
    Wait,
    /// Press Backspace a number of times, and type again from a character of the phrase.
    Correct {
        /// The number of Backspaces.
        backspaces: usize,
        /// The index of the character.
        from: usize,
    },
}

/// An error in the text.
#[derive(Clone, Copy, Debug)]
struct Seen {
    since: f64,
    is_corrected: bool,
}

/// Reads the text of a phrase while it is typed.
#[derive(Clone, Debug)]
pub(super) struct Proofreader {
    presented: Vec<char>,
    probability: f64,
    notice: f64,
    /// The numbers of typed and of presented characters up to which the person has finished reading.
    settled: (usize, usize),
    seen: Option<Seen>,
    left: usize,
    /// The Backspaces of the present correction that are not planned yet.
    backspaces: usize,
    /// The time of the lowest point of the last planned one, in seconds.
    corrected_at: f64,
}

impl Proofreader {
    /// Creates a reader; one that never corrects for a layout without Backspace.
    pub(super) fn new(presented: &str, person: &Participant, has_backspace: bool) -> Self {
        let presented: Vec<char> = presented.chars().collect();
        Self {
            probability: if has_backspace { person.corrects } else { 0.0 },
            notice: person.notice_ms * 1e-3,
            settled: (0, 0),
            seen: None,
            left: MOST * presented.len(),
            backspaces: 0,
            corrected_at: 0.0,
            presented,
        }
    }

    /// Returns the time after the last stroke in which a last error is seen, in seconds; 0 for a person who does not correct.
    pub(super) fn last_look(&self) -> f64 {
        if self.probability > 0.0 {
            self.notice + 2.0 * STILL
        } else {
            0.0
        }
    }

    /// Notes the next planned stroke, by the time of its lowest point in seconds.
    pub(super) fn note_stroke(&mut self, bottom: f64) {
        if self.backspaces > 0 {
            self.backspaces -= 1;
            self.corrected_at = bottom;
        }
    }

    /// Decides what to do at a time in seconds. `done` is the number of presented characters whose strokes have pressed, and `end` is
    /// when the last stroke that has begun is over.
    pub(super) fn decide(
        &mut self,
        typed: &str,
        (now, end): (f64, f64),
        done: usize,
        draw: &mut Draw,
    ) -> Decision {
        if self.probability <= 0.0 || self.left == 0 {
            return Decision::Type;
        }
        // The text is wrong until the last Backspace: that is no other error, about which the person would decide again.
        if self.backspaces > 0 || now < self.corrected_at {
            return Decision::Type;
        }
        let Some((typed_before, right)) = self.first_error(typed) else {
            self.seen = None;
            return Decision::Type;
        };
        let seen = *self.seen.get_or_insert_with(|| Seen {
            since: now,
            is_corrected: draw.happens(self.probability),
        });
        if now < seen.since + self.notice {
            return Decision::Type;
        }
        let length = typed.chars().count();
        if !seen.is_corrected {
            self.settled = (length, self.stands_for(typed, done));
            self.seen = None;
            return Decision::Type;
        }
        if now < end + STILL {
            return Decision::Wait;
        }
        self.seen = None;
        self.left -= 1;
        self.backspaces = length - typed_before;
        Decision::Correct {
            backspaces: self.backspaces,
            from: right,
        }
    }

    /// Returns the number of presented characters for which a text stands. `done` is their number by the lowest points of the strokes;
    /// a key types before that point, and a chord after it, so that the text may be one character ahead or behind.
    fn stands_for(&self, typed: &str, done: usize) -> usize {
        let (skipped, right) = self.settled;
        let rest: String = typed.chars().skip(skipped).collect();
        let errors = |end: &usize| {
            let meant: String = self.presented[right..*end].iter().collect();
            EditCounts::new(&meant, &rest).errors()
        };
        let ends = [done, done + 1, done.saturating_sub(1)].into_iter();
        // Of equal ones, the first.
        let possible = ends.filter(|end| (right..=self.presented.len()).contains(end));
        possible.min_by_key(errors).unwrap_or(done)
    }

    /// Returns the numbers of typed and of presented characters before the first that is wrong.
    fn first_error(&self, typed: &str) -> Option<(usize, usize)> {
        let (skipped, right) = self.settled;
        let rest = self.presented.get(right..).unwrap_or_default();
        let mut typed = typed.chars().skip(skipped).enumerate();
        let wrong = typed.find(|(index, own)| rest.get(*index) != Some(own));
        wrong.map(|(index, _)| (skipped + index, right + index))
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::people::{People, population};

    fn reader(presented: &str, corrects: f64) -> Proofreader {
        let person = Participant {
            corrects,
            notice_ms: 300.0,
            ..population(&People::Drawn(1), None, 1).remove(0)
        };
        Proofreader::new(presented, &person, true)
    }

    #[test]
    fn an_error_is_corrected_when_it_was_noticed_and_the_hand_is_still() {
        let mut draw = Draw::new(1, 1);
        let mut careful = reader("abc", 1.0);
        let mut decide = |reader: &mut Proofreader, typed, now, end| {
            reader.decide(typed, (now, end), 1, &mut draw)
        };
        assert_eq!(decide(&mut careful, "a", 1.0, 1.0), Decision::Type);
        assert_eq!(decide(&mut careful, "ax", 1.1, 1.2), Decision::Type);
        assert_eq!(decide(&mut careful, "ax", 1.45, 1.45), Decision::Wait);
        let correct = Decision::Correct {
            backspaces: 2,
            from: 1,
        };
        assert_eq!(decide(&mut careful, "axc", 1.6, 1.45), correct);
        for bottom in [1.7, 1.8] {
            careful.note_stroke(bottom);
        }
        assert_eq!(decide(&mut careful, "abc", 2.0, 1.9), Decision::Type);
        // A character too many.
        assert_eq!(decide(&mut careful, "abcc", 2.1, 2.1), Decision::Type);
        let removed = Decision::Correct {
            backspaces: 1,
            from: 3,
        };
        assert_eq!(decide(&mut careful, "abcc", 2.6, 2.1), removed);
    }

    #[test]
    fn a_person_looks_again_only_when_the_last_backspace_is_pressed() {
        let mut draw = Draw::new(1, 1);
        let mut careful = reader("abc", 1.0);
        let mut decide = |reader: &mut Proofreader, typed, now, end| {
            reader.decide(typed, (now, end), 1, &mut draw)
        };
        assert_eq!(decide(&mut careful, "axc", 1.0, 1.0), Decision::Type);
        let correct = |backspaces| Decision::Correct {
            backspaces,
            from: 1,
        };
        assert_eq!(decide(&mut careful, "axc", 1.4, 1.0), correct(2));
        // The text stays wrong for longer than the person needs to see an error.
        assert_eq!(decide(&mut careful, "axc", 1.41, 1.0), Decision::Type);
        careful.note_stroke(1.7);
        assert_eq!(decide(&mut careful, "ax", 1.8, 1.9), Decision::Type);
        careful.note_stroke(2.2);
        assert_eq!(decide(&mut careful, "ax", 2.1, 2.3), Decision::Type);
        // The second Backspace pressed nothing.
        assert_eq!(decide(&mut careful, "ax", 2.2, 2.3), Decision::Type);
        assert_eq!(decide(&mut careful, "ax", 2.6, 2.3), correct(1));
    }

    #[test]
    fn an_error_that_stays_shifts_nothing_after_it() {
        for (typed, done, later) in [
            ("axcd", 4, "axcde"),
            // D is typed before its stroke is at its lowest point, or after it.
            ("axcd", 3, "axcde"),
            ("axc", 4, "axcd"),
            // B is missing, or X is too many.
            ("acd", 3, "acde"),
            ("axbc", 2, "axbcd"),
        ] {
            let mut careless = reader("abcdef", 1e-9);
            let mut draw = Draw::new(1, 1);
            for now in [1.0, 1.4] {
                let decision = careless.decide(typed, (now, now), done, &mut draw);
                assert_eq!(decision, Decision::Type);
            }
            assert_eq!(careless.first_error(later), None, "{typed} {done}");
        }
    }

    #[test]
    fn a_person_who_never_corrects_types_on() {
        let mut draw = Draw::new(1, 1);
        let mut careless = reader("abc", 0.0);
        for now in [1.0, 2.0, 9.0] {
            let decision = careless.decide("xxx", (now, 0.0), 3, &mut draw);
            assert_eq!(decision, Decision::Type);
        }
    }
}
