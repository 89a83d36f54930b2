//! The figures of a layout that types, in the HTML report.

use super::{Row, task_rows};
use crate::measures::{Interval, Summary};

/// Returns the figures of a summary: of texts, or else of tasks and of a pointer.
pub(super) fn rows(summary: &Summary) -> Vec<Row> {
    if summary.characters == 0 {
        return task_rows(summary);
    }
    let percent = |name: &'static str, rate: Interval| -> Row { (name.into(), rate, 100.0, 1) };
    let mut rows: Vec<Row> = vec![
        (
            "words of correct text per minute".into(),
            summary.wpm,
            1.0,
            1,
        ),
        percent("wrong characters (CER), %", summary.cer),
        percent("insertions, %", summary.insertions),
        percent("deletions, %", summary.deletions),
        percent("substitutions, %", summary.substitutions),
        percent("wrong words (WER), %", summary.wer),
    ];
    let optional = [
        ("words not in the lexicon (OOV), %", summary.oov),
        ("uncorrected errors, % of keystrokes", summary.uncorrected),
        ("corrected errors, % of keystrokes", summary.corrected),
    ];
    let known = optional.into_iter();
    rows.extend(known.filter_map(|(name, rate)| Some(percent(name, rate?))));
    rows.extend([
        ("keystrokes per character".into(), summary.kspc, 1.0, 2),
        percent("strokes that hit, %", summary.hits),
        percent("slips to a neighbor, % of strokes", summary.neighbor_slips),
        (
            "fastest movements (Fitts), words/min".into(),
            summary.fitts_wpm,
            1.0,
            1,
        ),
        (
            "joint travel, °/character".into(),
            summary.joint_travel_deg,
            1.0,
            0,
        ),
        percent(
            "outside the comfortable range, % of time",
            summary.uncomfortable,
        ),
    ]);
    rows
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::measures::{KeystrokeClasses, PersonScore, summarize};

    #[test]
    fn words_of_a_decoder_and_errors_of_people_who_correct_have_rows_where_they_are_known() {
        let plain = PersonScore {
            characters: 20,
            words: 4,
            word_errors: 1,
            ..PersonScore::default()
        };
        let decoded = PersonScore {
            unknown_words: Some(2),
            ..plain.clone()
        };
        let corrected = PersonScore {
            keystrokes_by_class: Some(KeystrokeClasses {
                correct: 18,
                not_fixed: 2,
                fixed: 5,
                fixes: 5,
            }),
            ..plain.clone()
        };
        let shown = |person: PersonScore| -> Vec<(String, f64)> {
            let figures = rows(&summarize(&[person])).into_iter();
            let values =
                figures.map(|(name, rate, factor, _)| (name.into_owned(), rate.value * factor));
            let names = ["WER", "OOV", "uncorrected", "corrected"];
            let is_new = |row: &(String, f64)| names.iter().any(|name| row.0.contains(name));
            values.filter(is_new).collect()
        };
        let wer = ("wrong words (WER), %".to_owned(), 25.0);
        assert_eq!(shown(plain), std::slice::from_ref(&wer));
        let oov = ("words not in the lexicon (OOV), %".to_owned(), 50.0);
        assert_eq!(shown(decoded), [wer.clone(), oov]);
        let uncorrected = ("uncorrected errors, % of keystrokes".to_owned(), 8.0);
        let fixed = ("corrected errors, % of keystrokes".to_owned(), 20.0);
        assert_eq!(shown(corrected), [wer, uncorrected, fixed]);
    }
}
