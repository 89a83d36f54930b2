//! The presses of two layouts for the same readings.

use std::time::Duration;

use crate::history::{SentEvent, SentKey};
use ademan_core::device::OutputEvent;
use ademan_core::time::Timestamp;

/// The longest time between the starts of two presses that count as the same.
const SAME_WITHIN: Duration = Duration::from_millis(50);

/// A key that was down.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Press {
    /// The key or character.
    pub key: SentKey,
    /// Time of the press.
    pub from: Timestamp,
    /// Time of the release, or of the press of a character.
    pub to: Timestamp,
}

/// A press, and whether the other layout has the same one.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Match {
    /// The press.
    pub press: Press,
    /// The other layout presses the same key at most 50 ms earlier or later.
    pub is_same: bool,
}

/// The presses of two layouts, A and B, for the same readings.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Comparison {
    /// The presses of A, by time.
    pub a: Vec<Match>,
    /// The presses of B, by time.
    pub b: Vec<Match>,
}

impl Comparison {
    /// Returns the numbers of presses of both, of A only, and of B only.
    pub fn counts(&self) -> [usize; 3] {
        let count = |matches: &[Match], is_same: bool| {
            matches.iter().filter(|one| one.is_same == is_same).count()
        };
        [
            count(&self.a, true),
            count(&self.a, false),
            count(&self.b, false),
        ]
    }
}

/// Compares the presses of two layouts, both by time. Each press is the same as at most one of the other layout, the first that
/// has no counterpart yet.
pub fn compare(a: &[Press], b: &[Press]) -> Comparison {
    let unmatched = |press: &Press| Match {
        press: *press,
        is_same: false,
    };
    let mut compared = Comparison {
        a: a.iter().map(unmatched).collect(),
        b: b.iter().map(unmatched).collect(),
    };
    let mut first = 0;
    for own in &mut compared.a {
        let from = own.press.from;
        let is_earlier = |other: &&Match| from.since(other.press.from) > SAME_WITHIN;
        first += compared.b[first..].iter().take_while(is_earlier).count();
        let near = compared.b[first..].iter_mut();
        let mut near = near.take_while(|other| other.press.from.since(from) <= SAME_WITHIN);
        let same = near.find(|other| !other.is_same && other.press.key == own.press.key);
        if let Some(other) = same {
            (own.is_same, other.is_same) = (true, true);
        }
    }
    compared
}

/// Collects presses from events.
#[derive(Clone, Debug, Default)]
pub struct PressList {
    presses: Vec<Press>,
    /// Indices of the presses without a release.
    open: Vec<usize>,
}

impl PressList {
    /// Adds the events of a step.
    pub fn add(&mut self, events: &[OutputEvent]) {
        for event in events.iter().filter_map(SentEvent::new) {
            let (key, time) = (event.key, event.time);
            let presses = &mut self.presses;
            if !event.is_press {
                let released = self.open.iter().position(|&open| presses[open].key == key);
                if let Some(released) = released {
                    presses[self.open.remove(released)].to = time;
                }
                continue;
            }
            if matches!(key, SentKey::Code(_)) {
                self.open.push(presses.len());
            }
            presses.push(Press {
                key,
                from: time,
                to: time,
            });
        }
    }

    /// Returns the presses, by time.
    pub fn finish(mut self) -> Vec<Press> {
        self.presses.sort_by_key(|press| press.from);
        self.presses
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use ademan_core::device::EventKind;

    fn press(key: &str, ms: u64) -> Press {
        Press {
            key: SentKey::Code(key.parse().unwrap()),
            from: Timestamp(ms * 1000),
            to: Timestamp(ms * 1000 + 40_000),
        }
    }

    fn counts(a: &[(&str, u64)], b: &[(&str, u64)]) -> [usize; 3] {
        let presses = |list: &[(&str, u64)]| -> Vec<Press> {
            list.iter().map(|(key, ms)| press(key, *ms)).collect()
        };
        compare(&presses(a), &presses(b)).counts()
    }

    #[test]
    fn presses_of_the_same_key_at_nearly_the_same_time_are_the_same() {
        assert_eq!(counts(&[("A", 100)], &[("A", 150)]), [1, 0, 0]);
        assert_eq!(counts(&[("A", 150)], &[("A", 100)]), [1, 0, 0]);
        assert_eq!(counts(&[("A", 100)], &[("A", 151)]), [0, 1, 1]);
        assert_eq!(counts(&[("A", 100)], &[("B", 100)]), [0, 1, 1]);
        assert_eq!(counts(&[], &[("B", 100)]), [0, 0, 1]);
    }

    #[test]
    fn a_press_has_one_counterpart() {
        let a = [("A", 100), ("A", 130)];
        assert_eq!(counts(&a, &[("A", 110)]), [1, 1, 0]);
        assert_eq!(counts(&[("A", 110)], &a), [1, 0, 1]);
        assert_eq!(counts(&a, &a), [2, 0, 0]);
    }

    #[test]
    fn another_key_between_does_not_hide_a_counterpart() {
        let b = [("X", 90), ("Y", 95), ("A", 105), ("A", 400)];
        assert_eq!(counts(&[("A", 100), ("A", 390)], &b), [2, 0, 2]);
    }

    #[test]
    fn a_press_lasts_to_its_release() {
        let code = "A".parse().unwrap();
        let event = |ms: u64, kind| OutputEvent {
            time: Timestamp(ms * 1000),
            kind,
        };
        let mut list = PressList::default();
        list.add(&[event(1, EventKind::KeyDown(code))]);
        list.add(&[event(5, EventKind::Character('ñ'))]);
        list.add(&[event(41, EventKind::KeyUp(code))]);
        let presses = list.finish();
        let ends: Vec<_> = presses.iter().map(|press| press.to.0 / 1000).collect();
        assert_eq!(ends, [41, 5]);
    }
}
