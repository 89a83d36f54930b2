//! One line for each person, for R or Python.

use std::fmt::Write;

use crate::measures::LabResult;
use crate::message::quote_csv;

/// The columns.
const COLUMNS: &str = "layout,person,hand_mm,fingers,pace_wpm,characters,correct,substitutions,insertions,deletions,cer,keystrokes,wpm,fitts_wpm,strokes,hits,neighbor_slips,joint_travel_deg,uncomfortable,tasks,tasks_done,simulated_seconds,throughput_bits_per_s,misses,clicks,axis_deviation_px,target_reentries";

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
            _ = writeln!(
                text,
                "{layout},{},{},{},{},{},{},{},{},{},{},{},{},{},{},{},{},{},{},{tries},{done},{},{pointing}",
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
            );
        }
    }
    text
}
