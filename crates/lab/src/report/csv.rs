//! One line for each person, for R or Python.

use std::fmt::Write;

use crate::measures::LabResult;
use crate::message::quote_csv;

/// The columns.
const COLUMNS: &str = "layout,person,hand_mm,fingers,pace_wpm,characters,correct,substitutions,insertions,deletions,cer,keystrokes,wpm,fitts_wpm,strokes,hits,neighbor_slips,joint_travel_deg,uncomfortable,tasks,tasks_done,simulated_seconds,throughput_bits_per_s,misses,clicks,axis_deviation_px,target_reentries,words,word_errors,unknown_words,keystrokes_correct,keystrokes_not_fixed,keystrokes_fixed,keystrokes_fixing";

/// Returns the people of results as CSV, the columns first.
pub fn to_csv(results: &[LabResult]) -> String {
    let mut text = COLUMNS.to_owned() + "\n";
    for result in results {
        let layout = quote_csv(&result.layout_file);
        for person in &result.scores {
            let tries: u64 = person.tasks.iter().map(|task| task.tries).sum();
            let done: u64 = person.tasks.iter().map(|task| task.done).sum();
            let pointing = match &person.pointing {
                Some(pointing) => {
                    let misses: usize = pointing.series.iter().map(|it| it.result.misses).sum();
                    format!(
                        "{},{misses},{},{},{}",
                        pointing.throughput(),
                        pointing.clicks(),
                        pointing.mean(|it| it.axis_deviation_px),
                        pointing.mean(|it| it.reentries)
                    )
                }
                None => ",,,,".to_owned(),
            };
            let unknown = person.unknown_words;
            let unknown = unknown.map_or_else(String::new, |count| count.to_string());
            let classes = match &person.keystrokes_by_class {
                Some(own) => format!(
                    "{},{},{},{}",
                    own.correct, own.not_fixed, own.fixed, own.fixes
                ),
                None => ",,,".to_owned(),
            };
            _ = writeln!(
                text,
                "{layout},{},{},{},{},{},{},{},{},{},{},{},{},{},{},{},{},{},{},{tries},{done},{},{pointing},{},{},{unknown},{classes}",
                person.number,
                person.hand_mm,
                person.style,
                person.pace_wpm,
                person.characters,
                person.correct,
                person.substitutions,
                person.insertions,
                person.deletions,
                person.cer(),
                person.keystrokes,
                person.wpm,
                person.fitts_wpm,
                person.strokes,
                person.hits,
                person.neighbor_slips,
                person.joint_travel_deg,
                person.uncomfortable,
                person.simulated_seconds,
                person.words,
                person.word_errors,
            );
        }
    }
    text
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::measures::{KeystrokeClasses, PersonScore};
    use crate::trials::PointingScore;

    #[test]
    fn every_person_has_a_field_for_each_column() {
        let typing = PersonScore {
            unknown_words: Some(1),
            keystrokes_by_class: Some(KeystrokeClasses::default()),
            ..PersonScore::default()
        };
        let pointing = PersonScore {
            pointing: Some(PointingScore::default()),
            ..PersonScore::default()
        };
        let result = LabResult {
            scores: vec![PersonScore::default(), typing, pointing],
            ..LabResult::unscored(3)
        };
        let text = to_csv(&[result]);
        let counts: Vec<usize> = text.lines().map(|line| line.split(',').count()).collect();
        assert_eq!(counts, [COLUMNS.split(',').count(); 4]);
    }
}
