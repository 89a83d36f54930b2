//! Reports of results: one HTML file without references to others, and CSV.

mod csv;
mod curve;
mod html;
mod tasks;
mod typing;

pub use csv::to_csv;
pub use curve::{Curve, curves, write_curve};
pub(crate) use html::STYLE;
pub use html::{heats, to_html};
pub use tasks::{Row, task_rows};
use typing::rows;

use std::collections::BTreeMap;

use crate::measures::{KeyScore, PersonScore};

/// Returns the keys of all people together, in the order of their names.
pub fn keys_of_all(people: &[PersonScore]) -> Vec<KeyScore> {
    let mut all: BTreeMap<&str, KeyScore> = BTreeMap::new();
    for key in people.iter().flat_map(|person| &person.keys) {
        let sum = all.entry(&key.name).or_insert_with(|| KeyScore {
            name: key.name.clone(),
            meant: 0,
            hit: 0,
            nothing: 0,
            bias_mm: [0.0; 2],
            spread_mm: [0.0; 2],
            places: 0,
        });
        let (old, new) = (sum.places as f64, key.places as f64);
        let count = (old + new).max(1.0);
        for axis in 0..2 {
            let mean = (sum.bias_mm[axis] * old + key.bias_mm[axis] * new) / count;
            let squares = |spread: f64, bias: f64, places: f64| {
                places * (spread * spread + (bias - mean).powi(2))
            };
            let both = squares(sum.spread_mm[axis], sum.bias_mm[axis], old)
                + squares(key.spread_mm[axis], key.bias_mm[axis], new);
            sum.spread_mm[axis] = (both / count).sqrt();
            sum.bias_mm[axis] = mean;
        }
        sum.places += key.places;
        sum.meant += key.meant;
        sum.hit += key.hit;
        sum.nothing += key.nothing;
    }
    all.into_values().collect()
}

/// Returns the presses of wrong targets of all people: meant, pressed, number; the most frequent first.
pub fn wrong_of_all(people: &[PersonScore]) -> Vec<(&str, &str, u64)> {
    let mut all: BTreeMap<(&str, &str), u64> = BTreeMap::new();
    for wrong in people.iter().flat_map(|person| &person.wrong) {
        *all.entry((&wrong.meant, &wrong.pressed)).or_default() += wrong.count;
    }
    let mut all: Vec<_> = all
        .into_iter()
        .map(|((a, b), count)| (a, b, count))
        .collect();
    all.sort_by_key(|&(_, _, count)| std::cmp::Reverse(count));
    all
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_spread_of_all_people_holds_the_differences_between_their_means() {
        let key = |bias: f64, spread: f64| KeyScore {
            name: "A".into(),
            meant: 10,
            hit: 9,
            nothing: 0,
            bias_mm: [bias, 0.0],
            spread_mm: [spread, 0.0],
            places: 10,
        };
        let people = [key(-1.0, 2.0), key(1.0, 2.0)].map(|key| PersonScore {
            keys: vec![key],
            ..PersonScore::default()
        });
        let all = keys_of_all(&people);
        assert_eq!(all.len(), 1);
        assert_eq!((all[0].meant, all[0].places), (20, 20));
        assert!(all[0].bias_mm[0].abs() < 1e-12);
        assert!((all[0].spread_mm[0] - 5.0_f64.sqrt()).abs() < 1e-12);
    }
}
