//! The figures of a study, and its trials as a table.

use std::fmt::Write;

use super::{Trial, TrialKind};
use crate::measures::{Interval, bootstrap};
use crate::message::quote_csv;

/// The columns: factors for a mixed model first (random effects of `participant` and `task`), then the measures.
const COLUMNS: &str = "participant,layout,kind,task,order,simulated,time,program,seconds,characters,substitutions,insertions,deletions,cer,wpm,keystrokes,backspaces,deleted,kspc,uncorrected,corrected,targets,misses,movement_s,path_efficiency,throughput_bits_per_s,axis_deviation_px,target_reentries,goal,value,value_error";

/// Returns the trials as CSV, one line for each, the columns first. Figures that a trial does not have are empty. There are no texts in
/// it.
pub fn trials_to_csv(trials: &[Trial]) -> String {
    let mut text = COLUMNS.to_owned() + "\n";
    for trial in trials {
        let task = match trial.task {
            // A phrase has the same number on every layout.
            Some(task) => format!("{}-{task}", trial.kind.name()),
            None => trial.kind.name().to_owned(),
        };
        let whole = |value: Option<usize>| value.map_or(String::new(), |it| it.to_string());
        let real = |value: Option<f64>| value.map_or(String::new(), |it| it.to_string());
        let part = |own: u64, all: u64| own as f64 / all.max(1) as f64;
        let classes = trial.keystrokes_by_class();
        let pointing = trial.pointing.as_ref();
        let fields = [
            quote_csv(&trial.participant),
            quote_csv(&trial.layout),
            trial.kind.name().to_owned(),
            task,
            trial.order.to_string(),
            trial.is_simulated.to_string(),
            quote_csv(&trial.time),
            quote_csv(&trial.program_version),
            trial.seconds.to_string(),
            whole(trial.characters),
            whole(trial.substitutions),
            whole(trial.insertions),
            whole(trial.deletions),
            real(trial.cer()),
            real(trial.wpm),
            whole(trial.keystrokes),
            whole(trial.backspaces),
            whole(trial.deleted),
            real(trial.kspc()),
            real(classes.map(|it| part(it.not_fixed, it.typed()))),
            real(classes.map(|it| part(it.fixed, it.typed()))),
            whole(pointing.map(|it| it.targets)),
            whole(pointing.map(|it| it.misses)),
            real(pointing.map(|it| it.movement_s)),
            real(pointing.map(|it| it.path_efficiency)),
            real(pointing.map(|it| it.throughput)),
            real(pointing.map(|it| it.axis_deviation_px)),
            real(pointing.map(|it| it.reentries)),
            real(trial.value.map(|[goal, _]| goal)),
            real(trial.value.map(|[_, set]| set)),
            real(trial.value_error()),
        ];
        _ = writeln!(text, "{}", fields.join(","));
    }
    text
}

/// The figures of one layout. Intervals are over participants; figures without trials are `None`.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct LayoutFigures {
    /// The layout.
    pub layout: String,
    /// The number of participants.
    pub participants: usize,
    /// The number of trials.
    pub trials: usize,
    /// The number of trials of simulated hands among these.
    pub simulated: usize,
    /// Words of correct text per minute, the mean of the participants.
    pub wpm: Option<Interval>,
    /// Insertions, deletions and substitutions by presented characters.
    pub cer: Option<Interval>,
    /// Keystrokes by transcribed characters.
    pub kspc: Option<Interval>,
    /// Characters that are wrong in the end, by those that were typed (uncorrected error rate).
    pub uncorrected: Option<Interval>,
    /// Characters that were deleted again, by those that were typed (corrected error rate).
    pub corrected: Option<Interval>,
    /// Throughput of a pointer in bits per second, the mean of the participants.
    pub throughput: Option<Interval>,
    /// Clicks beside their target, by clicks.
    pub misses: Option<Interval>,
    /// The mean time to set a value, in seconds.
    pub value_seconds: Option<Interval>,
    /// The mean difference from a value.
    pub value_error: Option<Interval>,
}

impl LayoutFigures {
    /// Returns the figures that there are, with their names and units, the factors to these units, and the digits after the point.
    pub fn rows(&self) -> Vec<(&'static str, Interval, f64, usize)> {
        let rows: [(&str, Option<Interval>, f64, usize); 9] = [
            ("words of correct text/min", self.wpm, 1.0, 1),
            ("wrong characters (CER), %", self.cer, 100.0, 1),
            ("keystrokes per character", self.kspc, 1.0, 2),
            ("  uncorrected errors, %", self.uncorrected, 100.0, 1),
            ("  corrected errors, %", self.corrected, 100.0, 1),
            ("effective throughput, bit/s", self.throughput, 1.0, 2),
            ("clicks beside the target, %", self.misses, 100.0, 1),
            ("time to set a value, s", self.value_seconds, 1.0, 2),
            (
                "error of a value, % of the range",
                self.value_error,
                100.0,
                1,
            ),
        ];
        let rows = rows.into_iter();
        let known = rows
            .filter_map(|(name, interval, factor, digits)| Some((name, interval?, factor, digits)));
        known.collect()
    }
}

/// Returns the figures of each layout in the order of their names. Practice counts only if `with_practice`: its texts are others.
pub fn figures(trials: &[Trial], with_practice: bool) -> Vec<LayoutFigures> {
    let trials = trials.iter();
    let counted: Vec<&Trial> = trials
        .filter(|trial| with_practice || trial.kind != TrialKind::Practice)
        .collect();
    let mut layouts: Vec<&str> = counted.iter().map(|it| it.layout.as_str()).collect();
    layouts.sort_unstable();
    layouts.dedup();
    let of_layout = |&layout: &&str| {
        let own = counted.iter().copied().filter(|it| it.layout == layout);
        let own: Vec<&Trial> = own.collect();
        let mut names: Vec<&str> = own.iter().map(|it| it.participant.as_str()).collect();
        names.sort_unstable();
        names.dedup();
        let people: Vec<Vec<&Trial>> = names
            .iter()
            .map(|name| {
                own.iter()
                    .copied()
                    .filter(|it| it.participant == *name)
                    .collect()
            })
            .collect();
        LayoutFigures {
            layout: layout.to_owned(),
            participants: people.len(),
            trials: own.len(),
            simulated: own.iter().filter(|it| it.is_simulated).count(),
            wpm: mean(&people, |it| it.wpm),
            cer: rate(&people, |it| {
                let characters = it.characters? as f64;
                Some((it.cer()? * characters, characters))
            }),
            kspc: rate(&people, |it| {
                Some((it.keystrokes? as f64, it.transcribed()? as f64))
            }),
            uncorrected: rate(&people, |it| {
                let classes = it.keystrokes_by_class()?;
                Some((classes.not_fixed as f64, classes.typed() as f64))
            }),
            corrected: rate(&people, |it| {
                let classes = it.keystrokes_by_class()?;
                Some((classes.fixed as f64, classes.typed() as f64))
            }),
            throughput: mean(&people, |it| Some(it.pointing?.throughput)),
            misses: rate(&people, |it| {
                let pointing = it.pointing?;
                Some((pointing.misses as f64, pointing.targets as f64))
            }),
            value_seconds: mean(&people, |it| it.value.map(|_| it.seconds)),
            value_error: mean(&people, Trial::value_error),
        }
    };
    layouts.iter().map(of_layout).collect()
}

/// Returns the mean of the means of the participants.
fn mean(people: &[Vec<&Trial>], value: impl Fn(&Trial) -> Option<f64>) -> Option<Interval> {
    let means = people.iter().filter_map(|trials| {
        let values: Vec<f64> = trials.iter().filter_map(|trial| value(trial)).collect();
        (!values.is_empty()).then(|| values.iter().sum::<f64>() / values.len() as f64)
    });
    let means: Vec<f64> = means.collect();
    (!means.is_empty()).then(|| {
        bootstrap(&means, |means| {
            means.iter().copied().sum::<f64>() / means.len() as f64
        })
    })
}

/// Returns the quotient of the sums of all participants.
fn rate(people: &[Vec<&Trial>], parts: impl Fn(&Trial) -> Option<(f64, f64)>) -> Option<Interval> {
    let sums = people.iter().filter_map(|trials| {
        let (part, whole) = trials
            .iter()
            .filter_map(|trial| parts(trial))
            .fold((0.0, 0.0), |sum, own| (sum.0 + own.0, sum.1 + own.1));
        (whole > 0.0).then_some((part, whole))
    });
    let sums: Vec<(f64, f64)> = sums.collect();
    (!sums.is_empty()).then(|| {
        bootstrap(&sums, |sums| {
            let (part, whole) = sums
                .iter()
                .fold((0.0, 0.0), |sum, own| (sum.0 + own.0, sum.1 + own.1));
            part / whole
        })
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_figure_of_pointing_has_a_column() {
        let trial = r#"{"participant":"P01","order":0,"layout":"board","kind":"targets","task":0,"time":"","is_simulated":false,"program_version":"","seconds":1.0,"pointing":{"targets":9,"misses":2,"movement_s":0.75,"path_efficiency":0.9,"axis_deviation_px":6.5,"reentries":0.25,"throughput":4.25}}"#;
        let trial: Trial = serde_json::from_str(trial).expect("a trial");
        let csv = trials_to_csv(&[trial]);
        let rows: Vec<Vec<&str>> = csv.lines().map(|line| line.split(',').collect()).collect();
        assert_eq!(rows[0].len(), rows[1].len());
        let first = rows[0].iter().position(|column| *column == "targets");
        let first = first.expect("a column");
        let names = "targets,misses,movement_s,path_efficiency,throughput_bits_per_s,axis_deviation_px,target_reentries";
        assert_eq!(rows[0][first..first + 7].join(","), names);
        assert_eq!(
            rows[1][first..first + 7].join(","),
            "9,2,0.75,0.9,4.25,6.5,0.25"
        );
    }
}
