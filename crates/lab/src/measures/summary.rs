//! The figures of a population.

use serde::{Deserialize, Serialize};

use super::bootstrap::{Interval, bootstrap};
use super::pointing::PointingResult;
use super::score::{PersonScore, ratio};
use crate::trials::{PointingScore, PointingSeries, TaskKind};

/// The part of the people that counts as the worst.
const WORST: usize = 10;

/// The figures of all people with their intervals. Rates are parts, 0..=1 unless stated otherwise.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Summary {
    /// The number of people.
    pub people: usize,
    /// Characters that were to be typed.
    pub characters: u64,
    /// Character error rate: insertions, deletions and substitutions by presented characters.
    pub cer: Interval,
    /// Insertions by presented characters.
    pub insertions: Interval,
    /// Deletions by presented characters.
    pub deletions: Interval,
    /// Substitutions by presented characters.
    pub substitutions: Interval,
    /// Word error rate: insertions, deletions and substitutions of words, by presented words.
    #[serde(default)]
    pub wer: Interval,
    /// Presented words that the lexicon of the decoder lacks, by presented words (OOV rate); `None` without a decoder.
    #[serde(default)]
    pub oov: Option<Interval>,
    /// Wrong characters of the nearest keys of the taps, by presented characters: the errors that no detection of taps avoids
    /// without a decoder. `None` if the layout has chords.
    #[serde(default)]
    pub nearest_cer: Option<Interval>,
    /// The rate of [`nearest_cer`](Self::nearest_cer) for the taps as the pipeline shows them.
    #[serde(default)]
    pub shown_cer: Option<Interval>,
    /// Words of correct text per minute, the mean of the people.
    pub wpm: Interval,
    /// The pace that people intended, in words per minute: an input.
    pub pace_wpm: f64,
    /// Words per minute of the shortest movements, the mean of the people.
    pub fitts_wpm: Interval,
    /// Keystrokes by transcribed character (Soukoreff & MacKenzie 2003).
    pub kspc: Interval,
    /// Uncorrected error rate, INF / (C + INF + IF) of [`KeystrokeClasses`](super::KeystrokeClasses); `None` for people who do not correct.
    #[serde(default)]
    pub uncorrected: Option<Interval>,
    /// Corrected error rate, IF / (C + INF + IF). The sum of both is the total error rate.
    #[serde(default)]
    pub corrected: Option<Interval>,
    /// Strokes that pressed what was meant, by strokes.
    pub hits: Interval,
    /// Presses of a target that touches the meant one, by strokes.
    pub neighbor_slips: Interval,
    /// Turns of all joints for each character, in degrees.
    pub joint_travel_deg: Interval,
    /// The part of the time in which a joint was outside its comfortable range.
    pub uncomfortable: Interval,
    /// The character error rate of the worst tenth of the people, at least one.
    pub worst_cer: f64,
    /// The speed of the slowest tenth of the people, at least one, in words per minute.
    pub worst_wpm: f64,
    /// Parts of pairs of strokes on two targets: by the same finger, by two hands, by two fingers of one hand, and rolls that change
    /// direction.
    pub pairs: [f64; 4],
    /// The part of the strokes of each finger, thumb first.
    pub fingers: [f64; 5],
    /// Tasks that were done, by tries.
    pub tasks_done: Interval,
    /// Presses of other controls, by tries.
    pub tasks_wrong: Interval,
    /// The mean time of a task that was done, in seconds.
    pub task_seconds: Interval,
    /// The mean difference from a value, as a part of the range.
    pub task_error: Interval,
    /// The mean time to set a value, in seconds, of those that were set.
    #[serde(default)]
    pub value_seconds: Interval,
    /// Clicks on rings of targets; `None` if no person has clicked.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub pointing: Option<PointingSummary>,
}

/// The figures of all people with a pointer. Rates are parts, 0..=1.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct PointingSummary {
    /// The number of people who could use it.
    pub people: usize,
    /// Effective throughput in bits per second, the mean of the people.
    pub throughput: Interval,
    /// The throughput of the same people by that with a cursor that follows the hand at once and without errors; `None` for a pointer
    /// whose velocity follows the hand.
    pub of_ideal: Option<Interval>,
    /// The mean time from click to click, in seconds.
    pub movement_s: Interval,
    /// Clicks beside their target, by clicks.
    pub misses: Interval,
    /// Clicks beside the target that began on it, by clicks.
    pub slips: Interval,
    /// The part of the way of the cursor that was straight.
    pub path_efficiency: Interval,
    /// The mean distance of the way of the cursor from the line through the centers of both targets, in pixels.
    #[serde(default)]
    pub axis_deviation_px: Interval,
    /// Entries of a target after the first one and before the click, by clicks.
    #[serde(default)]
    pub reentries: Interval,
    /// Targets that were given up, by targets.
    pub given_up: Interval,
    /// The width in pixels, the throughput, and the part of the clicks that slipped, for each width of targets, the widest first.
    pub by_width: Vec<(f64, Interval, Interval)>,
}

impl PersonScore {
    /// Returns insertions, deletions and substitutions.
    pub fn errors(&self) -> u64 {
        self.insertions + self.deletions + self.substitutions
    }

    /// Returns the number of characters of the typed text.
    pub fn transcribed(&self) -> u64 {
        self.correct + self.substitutions + self.insertions
    }

    /// Returns the character error rate, 0 or more.
    pub fn cer(&self) -> f64 {
        ratio(self.errors() as f64, self.characters as f64)
    }

    /// Returns tries, done tries, wrong presses and seconds of the done tries of all tasks.
    pub(super) fn tasks(&self) -> [f64; 4] {
        self.tasks.iter().fold([0.0; 4], |sum, task| {
            let done = task.done as f64;
            [
                sum[0] + task.tries as f64,
                sum[1] + done,
                sum[2] + task.wrong as f64,
                sum[3] + task.seconds * done,
            ]
        })
    }

    /// Returns the clicks with a pointer that follow another one, those beside their target, and the throughput.
    pub(super) fn clicks(&self) -> [f64; 3] {
        let Some(pointing) = &self.pointing else {
            return [0.0; 3];
        };
        let misses: usize = pointing.series.iter().map(|it| it.result.misses).sum();
        [
            pointing.clicks() as f64,
            misses as f64,
            pointing.throughput(),
        ]
    }

    /// Returns the seconds and the number of values that were set.
    fn values(&self) -> [f64; 2] {
        let values = self
            .tasks
            .iter()
            .filter(|task| task.kind == TaskKind::Value);
        values.fold([0.0; 2], |sum, task| {
            let done = task.done as f64;
            [sum[0] + task.seconds * done, sum[1] + done]
        })
    }

    /// Returns the sum of the errors of values, and their number.
    pub(super) fn value_errors(&self) -> [f64; 2] {
        let values = self.tasks.iter().filter_map(|task| {
            let error = task.error?;
            Some([error * task.done as f64, task.done as f64])
        });
        values.fold([0.0; 2], |sum, value| {
            [sum[0] + value[0], sum[1] + value[1]]
        })
    }
}

/// Returns the figures of people.
pub fn summarize(people: &[PersonScore]) -> Summary {
    // A rate of all people is computed from their sums; a speed is the mean of the people.
    let rate = |part: fn(&PersonScore) -> f64, all: fn(&PersonScore) -> f64| {
        bootstrap(people, |people| {
            let parts: f64 = people.iter().map(|it| part(it)).sum();
            ratio(parts, people.iter().map(|it| all(it)).sum())
        })
    };
    let mean = |value: fn(&PersonScore) -> f64| rate(value, |_| 1.0);
    let characters = |it: &PersonScore| it.characters as f64;
    let strokes = |it: &PersonScore| it.strokes as f64;
    let tries = |it: &PersonScore| it.tasks()[0];
    let done = |it: &PersonScore| it.tasks()[1];
    let sum = |value: fn(&PersonScore) -> u64| people.iter().map(value).sum::<u64>() as f64;
    let known = |errors: fn(&PersonScore) -> Option<u64>, all: fn(&PersonScore) -> f64| {
        people.iter().all(|it| errors(it).is_some()).then(|| {
            bootstrap(people, |people| {
                let errors: u64 = people.iter().filter_map(|it| errors(it)).sum();
                ratio(errors as f64, people.iter().map(|it| all(it)).sum())
            })
        })
    };
    let typed = |it: &PersonScore| it.keystrokes_by_class.map_or(0.0, |own| own.typed() as f64);
    let pairs = sum(|it| it.pairs[0]);
    let pair_sums = [
        sum(|it| it.pairs[1]),
        sum(|it| it.pairs[2]),
        sum(|it| it.pairs[3]),
        sum(|it| it.pairs[4]),
    ];
    let all_strokes = sum(|it| it.fingers.iter().sum());
    let fingers: [f64; 5] = std::array::from_fn(|finger| {
        let own: u64 = people.iter().map(|it| it.fingers[finger]).sum();
        ratio(own as f64, all_strokes)
    });
    Summary {
        people: people.len(),
        characters: people.iter().map(|it| it.characters).sum(),
        cer: rate(|it| it.errors() as f64, characters),
        insertions: rate(|it| it.insertions as f64, characters),
        deletions: rate(|it| it.deletions as f64, characters),
        substitutions: rate(|it| it.substitutions as f64, characters),
        wer: rate(|it| it.word_errors as f64, |it| it.words as f64),
        oov: known(|it| it.unknown_words, |it| it.words as f64),
        nearest_cer: known(|it| it.nearest_errors, characters),
        shown_cer: known(|it| it.shown_errors, characters),
        wpm: mean(|it| it.wpm),
        pace_wpm: ratio(
            people.iter().map(|it| it.pace_wpm).sum(),
            people.len() as f64,
        ),
        fitts_wpm: mean(|it| it.fitts_wpm),
        kspc: rate(|it| it.keystrokes as f64, |it| it.transcribed() as f64),
        uncorrected: known(|it| Some(it.keystrokes_by_class?.not_fixed), typed),
        corrected: known(|it| Some(it.keystrokes_by_class?.fixed), typed),
        hits: rate(|it| it.hits as f64, strokes),
        neighbor_slips: rate(|it| it.neighbor_slips as f64, strokes),
        joint_travel_deg: mean(|it| it.joint_travel_deg),
        uncomfortable: mean(|it| it.uncomfortable),
        worst_cer: worst(people, |it| -it.cer()).map_or(0.0, |cer| -cer),
        worst_wpm: worst(people, |it| it.wpm).unwrap_or_default(),
        pairs: pair_sums.map(|own| ratio(own, pairs)),
        fingers,
        tasks_done: rate(done, tries),
        tasks_wrong: rate(|it| it.tasks()[2], tries),
        task_seconds: rate(|it| it.tasks()[3], done),
        task_error: rate(|it| it.value_errors()[0], |it| it.value_errors()[1]),
        value_seconds: rate(|it| it.values()[0], |it| it.values()[1]),
        pointing: summarize_pointing(people),
    }
}

fn summarize_pointing(people: &[PersonScore]) -> Option<PointingSummary> {
    let scores: Vec<&PointingScore> = people
        .iter()
        .filter_map(|it| it.pointing.as_ref())
        .collect();
    let first = scores.iter().find(|score| score.clicks() > 0)?;
    let mean = |value: &dyn Fn(&PointingScore) -> f64| {
        bootstrap(&scores, |sample| {
            let sum: f64 = sample.iter().map(|it| value(it)).sum();
            ratio(sum, sample.len() as f64)
        })
    };
    // A rate by the clicks of all series, or of one of them.
    let rate = |of: Option<usize>,
                part: &dyn Fn(&PointingSeries) -> f64,
                all: &dyn Fn(&PointingSeries) -> f64| {
        bootstrap(&scores, |sample| {
            let series = sample.iter().flat_map(|it| it.series.iter().enumerate());
            let own = series.filter(|(index, _)| of.is_none_or(|of| of == *index));
            let (parts, whole) = own.fold((0.0, 0.0), |sum, (_, run)| {
                (sum.0 + part(run), sum.1 + all(run))
            });
            ratio(parts, whole)
        })
    };
    let clicks = |it: &PointingSeries| it.result.targets as f64;
    let series = |value: fn(&PointingResult) -> f64| {
        rate(None, &|it| value(&it.result) * clicks(it), &clicks)
    };
    let widths = first.series.iter().enumerate().map(|(index, width)| {
        (
            width.width_px,
            mean(&|it| it.series.get(index).map_or(0.0, |it| it.result.throughput)),
            rate(Some(index), &|it| it.slips as f64, &|it| it.clicks as f64),
        )
    });
    let has_ideal = scores.iter().all(|it| it.ideal_throughput.is_some());
    Some(PointingSummary {
        people: scores.len(),
        throughput: mean(&PointingScore::throughput),
        of_ideal: has_ideal
            .then(|| mean(&|it| ratio(it.throughput(), it.ideal_throughput.unwrap_or_default()))),
        movement_s: series(|it| it.movement_s),
        misses: series(PointingResult::miss_rate),
        slips: rate(None, &|it| it.slips as f64, &|it| it.clicks as f64),
        path_efficiency: series(|it| it.path_efficiency),
        axis_deviation_px: series(|it| it.axis_deviation_px),
        reentries: series(|it| it.reentries),
        given_up: rate(None, &|it| it.given_up as f64, &|it| {
            (it.clicks + it.given_up) as f64
        }),
        by_width: widths.collect(),
    })
}

/// Returns the mean of the lowest tenth of a figure.
fn worst(people: &[PersonScore], figure: impl Fn(&PersonScore) -> f64) -> Option<f64> {
    let mut figures: Vec<f64> = people.iter().map(figure).collect();
    figures.sort_by(f64::total_cmp);
    let count = figures.len().div_ceil(WORST);
    let lowest = figures.get(..count).filter(|lowest| !lowest.is_empty())?;
    Some(lowest.iter().sum::<f64>() / count as f64)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::measures::score::task_scores;
    use crate::measures::{Measure, compare};
    use crate::trials::TaskResult;

    #[test]
    fn characters_that_are_missing_or_too_many_do_not_change_the_keystrokes_by_character() {
        let person = |insertions: u64, deletions: u64| PersonScore {
            characters: 100,
            correct: 100 - deletions,
            insertions,
            deletions,
            keystrokes: 100 + insertions - deletions,
            ..PersonScore::default()
        };
        for (insertions, deletions) in [(0, 0), (0, 10), (5, 0)] {
            let summary = summarize(&[person(insertions, deletions)]);
            assert_eq!(summary.kspc.value, 1.0, "{insertions} {deletions}");
        }
        // Each Backspace, and each character that it deletes, is a keystroke more.
        let corrected = PersonScore {
            keystrokes: 120,
            ..person(0, 0)
        };
        assert_eq!(summarize(&[corrected]).kspc.value, 1.2);
    }

    #[test]
    fn a_control_out_of_reach_does_not_make_tasks_faster() {
        let result = |is_done, seconds| TaskResult {
            name: "A".to_owned(),
            kind: TaskKind::Touch,
            is_done,
            wrong: 0,
            seconds,
            error: None,
        };
        let tasks = |results: &[(bool, f64)]| {
            let results = results
                .iter()
                .map(|&(is_done, seconds)| result(is_done, seconds));
            PersonScore {
                tasks: task_scores(results.collect()),
                ..PersonScore::default()
            }
        };
        let all = tasks(&[(true, 0.2), (true, 0.4)]);
        let half = tasks(&[(true, 0.2), (false, 0.0), (true, 0.4), (false, 0.0)]);
        for (person, done) in [(&all, 1.0), (&half, 0.5)] {
            let summary = summarize(std::slice::from_ref(person));
            assert!(
                (summary.task_seconds.value - 0.3).abs() < 1e-12,
                "{summary:?}"
            );
            assert_eq!(summary.tasks_done.value, done);
        }
        let none = summarize(&[tasks(&[(false, 0.0)])]);
        assert_eq!((none.task_seconds.value, none.tasks_done.value), (0.0, 0.0));
        let compared = compare(("all", &[all]), ("half", &[half])).expect("both are tasks");
        let time = compared
            .differences
            .iter()
            .find(|it| it.measure == Measure::TaskSeconds);
        let time = time.expect("a time").interval;
        assert!(time.value.abs() < 1e-12, "{time:?}");
    }
}
