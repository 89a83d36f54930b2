//! Two layouts with the same people, phrases and seeds.

use serde::{Deserialize, Serialize};

use super::bootstrap::{FEWEST_PEOPLE, Interval, bootstrap};
use super::score::{PersonScore, ratio};
use crate::message::escape;

/// A difference between two layouts: the second minus the first, of the same people.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct Difference {
    /// The measure.
    pub measure: Measure,
    /// The difference, in the unit of the measure.
    pub interval: Interval,
}

/// A measure by which layouts are compared.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum Measure {
    /// Words of correct text per minute.
    WordsPerMinute,
    /// Character error rate, in percentage points.
    ErrorPoints,
    /// Turns of all joints for each character, in degrees.
    JointTravel,
    /// The part of the time outside the comfortable range, in percentage points.
    UncomfortablePoints,
    /// Tasks that are done, in percentage points.
    TaskPoints,
    /// The time of a task that is done, in seconds.
    TaskSeconds,
    /// Effective throughput of a pointer, in bits per second.
    Throughput,
    /// Clicks beside their target, in percentage points.
    MissPoints,
}

impl Measure {
    /// Returns the name with the unit.
    pub fn name(self) -> &'static str {
        match self {
            Self::WordsPerMinute => "words/min of correct text",
            Self::ErrorPoints => "wrong characters, points",
            Self::JointTravel => "joint travel, °/character",
            Self::UncomfortablePoints => "outside comfortable range, points",
            Self::TaskPoints => "tasks done, points",
            Self::TaskSeconds => "seconds a task",
            Self::Throughput => "throughput, bit/s",
            Self::MissPoints => "clicks beside the target, points",
        }
    }

    fn of(self, people: &[&PersonScore]) -> f64 {
        let sum = |value: fn(&PersonScore) -> f64| people.iter().map(|it| value(it)).sum::<f64>();
        let count = people.len() as f64;
        match self {
            Self::WordsPerMinute => ratio(sum(|it| it.wpm), count),
            Self::ErrorPoints => {
                100.0 * ratio(sum(|it| it.errors() as f64), sum(|it| it.characters as f64))
            }
            Self::JointTravel => ratio(sum(|it| it.joint_travel_deg), count),
            Self::UncomfortablePoints => 100.0 * ratio(sum(|it| it.uncomfortable), count),
            Self::TaskPoints => 100.0 * ratio(sum(|it| it.tasks()[1]), sum(|it| it.tasks()[0])),
            Self::TaskSeconds => ratio(sum(|it| it.tasks()[3]), sum(|it| it.tasks()[1])),
            Self::Throughput => ratio(sum(|it| it.clicks()[2]), count),
            Self::MissPoints => 100.0 * ratio(sum(|it| it.clicks()[1]), sum(|it| it.clicks()[0])),
        }
    }
}

/// The differences for people with hands of a size.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct HandGroup {
    /// `true` for hands longer than the median.
    pub is_long: bool,
    /// The number of people.
    pub people: usize,
    /// The differences.
    pub differences: Vec<Difference>,
}

/// A second layout against a first one.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Comparison {
    /// The name of the first layout.
    pub first: String,
    /// The name of the second layout.
    pub second: String,
    /// The median hand length, in millimetres.
    pub median_hand_mm: f64,
    /// The differences of all people.
    pub differences: Vec<Difference>,
    /// The differences of people with short and with long hands. An empty group is left out.
    pub groups: Vec<HandGroup>,
}

/// Reason why two layouts cannot be compared.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
pub enum NotComparable {
    /// One layout types and the other does not.
    #[error(
        "{typing} types the phrases and {other} does not; compare {typing} with a layout that types, or {other} with one that is scored by tasks",
        typing = escape(.typing),
        other = escape(.other)
    )]
    Kinds {
        /// The layout that types.
        typing: String,
        /// The other one.
        other: String,
    },
}

/// Compares a second layout with a first one. Both scores are of the same people in the same order.
pub fn compare(
    (first, before): (&str, &[PersonScore]),
    (second, after): (&str, &[PersonScore]),
) -> Result<Comparison, NotComparable> {
    let measures = measures((first, before), (second, after))?;
    let pairs: Vec<(&PersonScore, &PersonScore)> = before.iter().zip(after).collect();
    let mut hands: Vec<f64> = before.iter().map(|it| it.hand_mm).collect();
    hands.sort_by(f64::total_cmp);
    let median_hand_mm = match hands.len() {
        0 => 0.0,
        count => (hands[(count - 1) / 2] + hands[count / 2]) / 2.0,
    };
    let group = |is_long: bool| {
        let own = pairs.iter().copied();
        let own = own.filter(|(it, _)| (it.hand_mm > median_hand_mm) == is_long);
        let own: Vec<_> = own.collect();
        HandGroup {
            is_long,
            people: own.len(),
            differences: differences(measures, &own),
        }
    };
    Ok(Comparison {
        first: first.to_owned(),
        second: second.to_owned(),
        median_hand_mm,
        differences: differences(measures, &pairs),
        groups: [false, true]
            .map(group)
            .into_iter()
            .filter(|group| group.people > 0)
            .collect(),
    })
}

/// Returns the measures that both layouts have.
fn measures(
    (first, before): (&str, &[PersonScore]),
    (second, after): (&str, &[PersonScore]),
) -> Result<&'static [Measure], NotComparable> {
    let types = |people: &[PersonScore]| people.iter().any(|it| it.characters > 0);
    let points = |people: &[PersonScore]| people.iter().all(|it| it.pointing.is_some());
    let works = |people: &[PersonScore]| people.iter().any(|it| !it.tasks.is_empty());
    let measures: &'static [Measure] = match (types(before), types(after)) {
        (true, true) => &[
            Measure::WordsPerMinute,
            Measure::ErrorPoints,
            Measure::JointTravel,
            Measure::UncomfortablePoints,
        ],
        (false, false) if points(before) && points(after) => {
            if works(before) && works(after) {
                &[
                    Measure::Throughput,
                    Measure::MissPoints,
                    Measure::TaskPoints,
                    Measure::TaskSeconds,
                ]
            } else {
                &[Measure::Throughput, Measure::MissPoints]
            }
        }
        (false, false) => &[Measure::TaskPoints, Measure::TaskSeconds],
        (has_text, _) => {
            let (typing, other) = if has_text {
                (first, second)
            } else {
                (second, first)
            };
            return Err(NotComparable::Kinds {
                typing: typing.to_owned(),
                other: other.to_owned(),
            });
        }
    };
    Ok(measures)
}

fn differences(measures: &[Measure], pairs: &[(&PersonScore, &PersonScore)]) -> Vec<Difference> {
    let difference = |&measure: &Measure| Difference {
        measure,
        interval: bootstrap(pairs, |pairs| {
            let before: Vec<&PersonScore> = pairs.iter().map(|pair| pair.0).collect();
            let after: Vec<&PersonScore> = pairs.iter().map(|pair| pair.1).collect();
            measure.of(&after) - measure.of(&before)
        }),
    };
    // Without a task that is done there is no time, and 0 s would be the fastest. The time is the last measure of a list, so that the
    // others of a group keep their places.
    let has_times = pairs.iter().any(|(before, _)| before.tasks()[1] > 0.0)
        && pairs.iter().any(|(_, after)| after.tasks()[1] > 0.0);
    let is_known = |measure: &&Measure| has_times || **measure != Measure::TaskSeconds;
    let known = measures.iter().filter(is_known);
    known.map(difference).collect()
}

impl Comparison {
    /// Returns one sentence: what the intervals say about speed and errors, or about tasks, and for which hands it is the reverse. Fewer
    /// than [`FEWEST_PEOPLE`] tell nothing.
    pub fn verdict(&self) -> String {
        let people: usize = self.groups.iter().map(|group| group.people).sum();
        if people < FEWEST_PEOPLE {
            let who = match people {
                1 => "One person".to_owned(),
                count => format!("{count} people"),
            };
            return format!(
                "{who} cannot show a difference between {} and {}: choose {FEWEST_PEOPLE} or more.",
                self.first, self.second
            );
        }
        let mut parts: Vec<String> = self.differences.iter().take(2).map(words).collect();
        let last = parts.pop().unwrap_or_default();
        let all = match parts.pop() {
            Some(first) => format!("{first} and {last}"),
            None => last,
        };
        let groups = self.groups.iter();
        let groups = groups.filter(|group| group.people >= FEWEST_PEOPLE);
        let reversed = groups.filter(|group| {
            let pairs = group.differences.iter().zip(&self.differences).take(2);
            pairs.into_iter().any(|(own, overall)| {
                own.interval.excludes_zero()
                    && overall.interval.excludes_zero()
                    && own.interval.value.signum() != overall.interval.value.signum()
            })
        });
        let reversed: Vec<String> = reversed
            .map(|group| {
                let side = if group.is_long { "above" } else { "up to" };
                let own: Vec<String> = group.differences.iter().take(2).map(words).collect();
                format!(
                    "; for hands {side} {:.0} mm it {}",
                    self.median_hand_mm,
                    own.join(" and ")
                )
            })
            .collect();
        format!("{} {all}{}.", self.second, reversed.concat())
    }
}

/// Returns the words for a difference, such as `is 4.1 to 6.0 words/min faster`.
fn words(difference: &Difference) -> String {
    let Interval { value, low, high } = difference.interval;
    let range = |digits: usize| {
        let (least, most) = if value < 0.0 {
            (-high, -low)
        } else {
            (low, high)
        };
        format!("{least:.digits$} to {most:.digits$}")
    };
    let is_clear = difference.interval.excludes_zero();
    let (verb, digits, unit, more, fewer, what) = match difference.measure {
        Measure::WordsPerMinute => ("is ", 1, "words/min", "faster", "slower", ""),
        Measure::ErrorPoints => ("makes ", 1, "points", "more", "fewer", " errors"),
        Measure::Throughput => ("has ", 2, "bit/s", "more", "less", " throughput"),
        Measure::MissPoints => ("", 1, "points", "more", "fewer", " misses"),
        Measure::TaskPoints => ("has ", 1, "points", "more", "fewer", " tasks done"),
        Measure::TaskSeconds if is_clear => ("takes ", 2, "s", "more", "less", " a task"),
        Measure::TaskSeconds => ("takes ", 2, "s", "more", "less", " time"),
        Measure::JointTravel | Measure::UncomfortablePoints => {
            return format!("has {} {}", range(1), difference.measure.name());
        }
    };
    if !is_clear {
        return format!("{verb}not clearly {more} or {fewer}{what}");
    }
    let more_or_fewer = if value > 0.0 { more } else { fewer };
    format!("{verb}{} {unit} {more_or_fewer}{what}", range(digits))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::measures::TaskScore;
    use crate::trials::TaskKind;

    fn people(hands: &[f64], wpm: f64) -> Vec<PersonScore> {
        let person = |&hand_mm: &f64| PersonScore {
            hand_mm,
            wpm,
            characters: 10,
            ..PersonScore::default()
        };
        hands.iter().map(person).collect()
    }

    fn compared(hands: &[f64]) -> Comparison {
        let (before, after) = (people(hands, 10.0), people(hands, 12.0));
        compare(("a", &before), ("b", &after)).expect("both type")
    }

    #[test]
    fn five_people_tell_no_difference_and_six_do() {
        let hands = [180.0, 181.0, 182.0, 190.0, 191.0, 192.0];
        for (count, words) in [
            (1, "One person cannot show a difference between a and b"),
            (5, "5 people cannot show a difference between a and b"),
            (6, "b is 2.0 to 2.0 words/min faster"),
        ] {
            let verdict = compared(&hands[..count]).verdict();
            assert!(verdict.starts_with(words), "{verdict}");
        }
    }

    #[test]
    fn a_group_of_few_people_reverses_no_verdict() {
        let hands = [180.0; 7];
        let with_long = |short: f64, long: f64, count: usize| {
            let mut all = people(&hands, short);
            all.extend(people(&[200.0; FEWEST_PEOPLE][..count], long));
            all
        };
        for (count, is_reversed) in [(1, false), (5, false), (6, true)] {
            let before = with_long(10.0, 14.0, count);
            let after = with_long(20.0, 13.0, count);
            let verdict = compare(("a", &before), ("b", &after))
                .expect("both type")
                .verdict();
            assert!(verdict.contains("words/min faster"), "{verdict}");
            let says_so = verdict.contains("; for hands above 180 mm");
            assert_eq!(says_so, is_reversed, "{verdict}");
        }
    }

    #[test]
    fn a_layout_on_which_no_task_is_done_is_not_the_faster_one() {
        let on = |done: u64| {
            let mut own = people(&[180.0; FEWEST_PEOPLE], 0.0);
            for person in &mut own {
                person.characters = 0;
                person.tasks = vec![TaskScore {
                    name: "A".to_owned(),
                    kind: TaskKind::Touch,
                    tries: 4,
                    done,
                    wrong: 0,
                    seconds: if done > 0 { 0.5 } else { 0.0 },
                    error: None,
                }];
            }
            own
        };
        let compared = compare(("a", &on(4)), ("b", &on(0))).expect("both are tasks");
        let measures: Vec<Measure> = compared.differences.iter().map(|it| it.measure).collect();
        assert_eq!(measures, [Measure::TaskPoints]);
        assert_eq!(
            compared.verdict(),
            "b has 100.0 to 100.0 points fewer tasks done."
        );
        let timed = compare(("a", &on(4)), ("b", &on(2))).expect("both are tasks");
        assert_eq!(timed.differences.len(), 2);
    }

    #[test]
    fn a_group_of_nobody_is_left_out() {
        let sizes = |hands: &[f64]| {
            let groups = compared(hands).groups;
            groups.iter().map(|it| (it.is_long, it.people)).collect()
        };
        let of_two: Vec<(bool, usize)> = sizes(&[180.0, 190.0]);
        assert_eq!(of_two, [(false, 1), (true, 1)]);
        assert_eq!(sizes(&[180.0, 180.0]), [(false, 2)]);
    }

    #[test]
    fn the_remedy_names_a_layout_of_the_same_kind_for_each() {
        let mut tasks = people(&[180.0], 30.0);
        tasks[0].characters = 0;
        let typing = people(&[180.0], 30.0);
        let refused = compare(("letters", &typing), ("media", &tasks)).unwrap_err();
        let words = refused.to_string();
        assert!(
            words.ends_with(
                "compare letters with a layout that types, or media with one that is scored by tasks"
            ),
            "{words}"
        );
    }
}
