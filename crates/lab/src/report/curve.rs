//! A figure over the phrases or trials of people, as a drawing: a learning curve.

use std::fmt::{self, Write};

use crate::measures::{Interval, PersonScore, bootstrap};
use crate::message::escape_markup;

/// The size of a drawing, and the space for its axes, in pixels.
const SIZE: [f64; 2] = [420.0, 190.0];
const LEFT: f64 = 44.0;
const BELOW: f64 = 34.0;
const ABOVE: f64 = 10.0;
/// The most points of a curve: more phrases are put together.
const POINTS: usize = 20;
/// The fewest phrases of a curve.
const FEWEST: usize = 3;

/// A curve with its intervals.
#[derive(Clone, Debug, PartialEq)]
pub struct Curve {
    /// The name with the unit.
    pub name: String,
    /// The name of the horizontal axis.
    pub axis: String,
    /// The first and the last phrase or trial of each point, from 1, and its figure.
    pub points: Vec<([usize; 2], Interval)>,
}

/// Returns the curves of words per minute and of wrong characters over the phrases; none for few phrases.
pub fn curves(people: &[PersonScore]) -> Vec<Curve> {
    let count = people.iter().map(|it| it.by_phrase.len()).min();
    let count = count.unwrap_or_default();
    if count < FEWEST {
        return Vec::new();
    }
    let figure = |part: fn(&PersonScore, usize, usize) -> f64,
                  whole: fn(&PersonScore, usize, usize) -> f64| {
        let points = spans(count).map(|[first, last]| {
            let interval = bootstrap(people, |people| {
                let parts: f64 = people.iter().map(|it| part(it, first, last)).sum();
                let all: f64 = people.iter().map(|it| whole(it, first, last)).sum();
                if all > 0.0 { parts / all } else { 0.0 }
            });
            ([first + 1, last], interval)
        });
        points.collect::<Vec<_>>()
    };
    let speed = figure(
        |it, first, last| {
            let sums = it.by_phrase[first..last].iter();
            let (correct, seconds) = sums.fold((0.0, 0.0), |sum, phrase| {
                let correct = phrase.correct.saturating_sub(1);
                (sum.0 + correct as f64, sum.1 + phrase.seconds)
            });
            if seconds > 0.0 {
                correct * 12.0 / seconds
            } else {
                0.0
            }
        },
        |_, _, _| 1.0,
    );
    let errors = figure(
        |it, first, last| {
            it.by_phrase[first..last]
                .iter()
                .map(|it| 100.0 * it.errors as f64)
                .sum()
        },
        |it, first, last| {
            it.by_phrase[first..last]
                .iter()
                .map(|it| it.characters as f64)
                .sum()
        },
    );
    let curve = |name: &str, points| Curve {
        name: name.to_owned(),
        axis: "phrase".to_owned(),
        points,
    };
    vec![
        curve("words of correct text per minute", speed),
        curve("wrong characters, %", errors),
    ]
}

/// Returns the first phrase of each point, from 0, and the first of the next point.
fn spans(count: usize) -> impl Iterator<Item = [usize; 2]> {
    let points = count.min(POINTS);
    (0..points).map(move |point| [point * count / points, (point + 1) * count / points])
}

/// Writes a curve as SVG with the colors of a report.
pub fn write_curve(curve: &Curve, page: &mut String) -> fmt::Result {
    let [width, height] = SIZE;
    let highest = curve.points.iter().map(|(_, it)| it.high.max(it.value));
    let top = round_up(highest.fold(0.0, f64::max));
    let last = curve.points.last().map_or(1, |([_, last], _)| *last);
    let first = curve.points.first().map_or(1, |([first, _], _)| *first);
    let x = |[from, to]: [usize; 2]| {
        let middle = (from + to) as f64 / 2.0 - first as f64;
        LEFT + (width - LEFT - 12.0) * middle / ((last - first) as f64).max(1.0)
    };
    let y = |value: f64| ABOVE + (height - ABOVE - BELOW) * (1.0 - (value / top).clamp(0.0, 1.0));
    let name = escape_markup(&curve.name);
    writeln!(
        page,
        "<svg viewBox=\"0 0 {width} {height}\" width=\"{width}\" height=\"{height}\" role=\"img\" aria-label=\"{name} by {}\">\n<title>{name}</title>",
        escape_markup(&curve.axis)
    )?;
    for part in [0.0, 0.5, 1.0] {
        let value = top * part;
        let at = y(value);
        writeln!(
            page,
            "<path class=\"level\" d=\"M{LEFT} {at:.1}H{:.1}\"/><text class=\"value\" x=\"{:.1}\" y=\"{:.1}\" text-anchor=\"end\">{}</text>",
            width - 12.0,
            LEFT - 6.0,
            at + 4.0,
            short(value)
        )?;
    }
    let middle = (first + last) / 2;
    let mut ticks = vec![first, middle, last];
    ticks.dedup();
    for tick in ticks {
        writeln!(
            page,
            "<text class=\"value\" x=\"{:.1}\" y=\"{:.1}\" text-anchor=\"middle\">{tick}</text>",
            x([tick, tick]),
            height - BELOW + 16.0
        )?;
    }
    writeln!(
        page,
        "<text class=\"value\" x=\"{:.1}\" y=\"{:.1}\" text-anchor=\"middle\">{}</text>",
        (LEFT + width - 12.0) / 2.0,
        height - 4.0,
        escape_markup(&curve.axis)
    )?;
    let there = curve.points.iter().map(|(span, it)| (x(*span), y(it.high)));
    let back = curve
        .points
        .iter()
        .rev()
        .map(|(span, it)| (x(*span), y(it.low)));
    writeln!(
        page,
        "<path class=\"band\" d=\"{}Z\"/>",
        path(there.chain(back))
    )?;
    let line = curve
        .points
        .iter()
        .map(|(span, it)| (x(*span), y(it.value)));
    writeln!(page, "<path class=\"line\" d=\"{}\"/>", path(line))?;
    for (span, it) in &curve.points {
        let [from, to] = *span;
        let place = if from == to {
            from.to_string()
        } else {
            format!("{from} to {to}")
        };
        writeln!(
            page,
            "<circle class=\"dot\" cx=\"{:.1}\" cy=\"{:.1}\" r=\"2.5\"><title>{} {place}: {:.1} ({:.1} to {:.1})</title></circle>",
            x(*span),
            y(it.value),
            escape_markup(&curve.axis),
            it.value,
            it.low,
            it.high
        )?;
    }
    writeln!(page, "</svg>")
}

/// Returns the commands of a path through points.
fn path(points: impl Iterator<Item = (f64, f64)>) -> String {
    let mut commands = String::new();
    for (index, (x, y)) in points.enumerate() {
        let letter = if index == 0 { 'M' } else { 'L' };
        _ = write!(commands, "{letter}{x:.1} {y:.1}");
    }
    commands
}

/// Returns the next number with one digit, times a power of ten, that is not lower.
fn round_up(value: f64) -> f64 {
    if value <= 0.0 {
        return 1.0;
    }
    let power = 10.0_f64.powf(value.log10().floor());
    let steps = [1.0, 2.0, 3.0, 4.0, 5.0, 6.0, 8.0, 10.0].map(|step| step * power);
    steps
        .into_iter()
        .find(|step| *step >= value)
        .unwrap_or(10.0 * power)
}

/// Returns the words of a level: half of a round number needs a digit more than it.
fn short(value: f64) -> String {
    match value {
        value if value == 0.0 || value >= 10.0 => format!("{value:.0}"),
        value if value >= 1.0 => format!("{value:.1}"),
        value => format!("{value:.2}"),
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::measures::PhraseScore;

    #[test]
    fn a_person_who_gets_better_has_a_curve_that_falls() {
        let people: Vec<PersonScore> = (0..4)
            .map(|person| PersonScore {
                by_phrase: (0..30)
                    .map(|phrase| PhraseScore {
                        characters: 100,
                        correct: 60 + phrase + person,
                        errors: 40 - phrase - person,
                        seconds: 60.0,
                    })
                    .collect(),
                ..PersonScore::default()
            })
            .collect();
        let [speed, errors] = &curves(&people)[..] else {
            panic!("two curves");
        };
        assert_eq!(errors.points.len(), POINTS);
        assert_eq!(errors.points[0].0, [1, 1]);
        assert_eq!(errors.points[POINTS - 1].0[1], 30);
        assert!(errors.points[0].1.value > errors.points[POINTS - 1].1.value);
        assert!(speed.points[0].1.value < speed.points[POINTS - 1].1.value);
        let mut page = String::new();
        write_curve(errors, &mut page).expect("writing to a string does not fail");
        assert_eq!(page.matches("<circle").count(), POINTS);
        assert!(page.contains("phrase 1: "), "{page}");
        assert!(curves(&people[..0]).is_empty());
    }

    #[test]
    fn axes_end_at_round_numbers() {
        let values = [0.0, 0.5, 7.0, 20.0, 21.0, 100.0];
        assert_eq!(values.map(round_up), [1.0, 0.5, 8.0, 20.0, 30.0, 100.0]);
    }

    #[test]
    fn the_levels_of_a_low_curve_have_words_of_their_own() {
        for (top, words) in [
            (0.1, ["0", "0.05", "0.10"]),
            (0.5, ["0", "0.25", "0.50"]),
            (3.0, ["0", "1.5", "3.0"]),
            (40.0, ["0", "20", "40"]),
        ] {
            let levels = [0.0, 0.5, 1.0].map(|part| short(top * part));
            assert_eq!(levels, words);
        }
    }
}
