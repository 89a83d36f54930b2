//! Results as text.

use std::io::{self, Write};

use ademan::measures::{Comparison, Interval, LabResult, PersonScore, Summary, bootstrap};
use ademan::message::escape;
use ademan::readings::READERS;
use ademan::report::{keys_of_all, task_rows, wrong_of_all};

/// Keys and pairs that are named.
const NAMED: usize = 6;

/// Prints the figures of a result.
pub fn print(result: &LabResult, out: &mut impl Write) -> io::Result<()> {
    let tier = match &result.tier {
        Some(tier) => format!("tier {tier}"),
        None => "their own errors".to_owned(),
    };
    let corrections = match result.corrections {
        0.0 => String::new(),
        part => format!(", corrections {part}"),
    };
    writeln!(
        out,
        "{}: {}, {tier}, source {}{corrections}, {} phrases each of {}, seed {}",
        escape(&result.layout_file),
        result.subjects(),
        result.source,
        result.phrases,
        escape(&result.corpus),
        result.seed
    )?;
    if result.is_repeated() {
        writeln!(
            out,
            "  the ranges are over repetitions of one person, and say nothing about other people"
        )?;
    }
    if let Some(partial) = &result.partial {
        writeln!(
            out,
            "  PARTIAL: {} of {} people; {} of {} shards are missing",
            result.scores.len(),
            partial.people,
            partial.missing.len(),
            partial.shards
        )?;
    }
    match result.summary.characters {
        0 => print_tasks(result, out),
        _ => {
            print_typing(result, out)?;
            print_readings(result, out)
        }
    }
}

/// Prints the errors of a decoder and of other readings of the same taps.
fn print_readings(result: &LabResult, out: &mut impl Write) -> io::Result<()> {
    let Some(decoder) = &result.decoder else {
        return Ok(());
    };
    writeln!(
        out,
        "  readings of the same taps, wrong characters in %, decoder {}:",
        escape(decoder)
    )?;
    for reader in READERS {
        let own = |person: &PersonScore| {
            let mut own = person.text_readings.iter();
            let own = own.find(|it| it.reader == reader);
            own.map_or([0.0; 2], |it| [it.errors as f64, it.characters as f64])
        };
        let cer = bootstrap(&result.scores, |people| {
            let sums = people.iter().map(|person| own(person));
            let [errors, characters] = sums.fold([0.0; 2], |a, b| [a[0] + b[0], a[1] + b[1]]);
            errors / characters.max(1.0)
        });
        row(out, &format!("  {reader}"), &cer, 100.0, 2)?;
    }
    Ok(())
}

fn print_typing(result: &LabResult, out: &mut impl Write) -> io::Result<()> {
    let summary = &result.summary;
    row(out, "words of correct text/min", &summary.wpm, 1.0, 1)?;
    writeln!(
        out,
        "  {:<34} {:>7.1}  (an input: the mean of the people)",
        "intended pace, words/min", summary.pace_wpm
    )?;
    row(
        out,
        "fastest movements, words/min",
        &summary.fitts_wpm,
        1.0,
        1,
    )?;
    row(out, "wrong characters (CER), %", &summary.cer, 100.0, 1)?;
    row(out, "  insertions, %", &summary.insertions, 100.0, 1)?;
    row(out, "  deletions, %", &summary.deletions, 100.0, 1)?;
    row(out, "  substitutions, %", &summary.substitutions, 100.0, 1)?;
    if let Some(nearest) = &summary.nearest_cer {
        row(out, "  nearest keys of the taps, %", nearest, 100.0, 1)?;
    }
    if let Some(shown) = &summary.shown_cer {
        row(out, "  nearest keys as shown, %", shown, 100.0, 1)?;
    }
    row(out, "wrong words (WER), %", &summary.wer, 100.0, 1)?;
    if let Some(oov) = &summary.oov {
        row(out, "words not in the lexicon (OOV), %", oov, 100.0, 1)?;
    }
    row(out, "keystrokes per character", &summary.kspc, 1.0, 2)?;
    for (name, rate) in [
        ("  uncorrected errors, %", &summary.uncorrected),
        ("  corrected errors, %", &summary.corrected),
    ] {
        if let Some(known) = rate {
            row(out, name, known, 100.0, 1)?;
        }
    }
    row(out, "strokes that hit, %", &summary.hits, 100.0, 1)?;
    row(
        out,
        "slips to a neighbor, %",
        &summary.neighbor_slips,
        100.0,
        1,
    )?;
    row(
        out,
        "joint travel, °/character",
        &summary.joint_travel_deg,
        1.0,
        0,
    )?;
    row(
        out,
        "outside comfortable range, %",
        &summary.uncomfortable,
        100.0,
        1,
    )?;
    writeln!(
        out,
        "  worst tenth of the people: {:.1} % wrong characters; slowest tenth: {:.1} words/min",
        100.0 * summary.worst_cer,
        summary.worst_wpm
    )?;
    print_fingers(summary, out)?;
    let mut keys = keys_of_all(&result.scores);
    let rate = |hit: u64, meant: u64| 100.0 * hit as f64 / meant.max(1) as f64;
    keys.sort_by(|a, b| rate(a.hit, a.meant).total_cmp(&rate(b.hit, b.meant)));
    let worst = keys.iter().take(NAMED).map(|key| {
        let name = escape(&key.name);
        format!("{name} {:.0} %", rate(key.hit, key.meant))
    });
    writeln!(
        out,
        "  keys hit worst: {}",
        worst.collect::<Vec<_>>().join(", ")
    )?;
    let wrong = wrong_of_all(&result.scores);
    let wrong = wrong.iter().take(NAMED).map(|(meant, pressed, count)| {
        format!("{} for {} ({count})", escape(pressed), escape(meant))
    });
    let wrong: Vec<String> = wrong.collect();
    if !wrong.is_empty() {
        writeln!(out, "  pressed most instead: {}", wrong.join(", "))?;
    }
    Ok(())
}

fn print_fingers(summary: &Summary, out: &mut impl Write) -> io::Result<()> {
    let [same, alternating, rolls, redirects] = summary.pairs.map(|part| 100.0 * part);
    let [thumb, index, middle, ring, little] = summary.fingers.map(|part| 100.0 * part);
    writeln!(
        out,
        "  pairs: same finger {same:.0} %, alternating hands {alternating:.0} %, rolls {rolls:.0} %, redirects {redirects:.0} %"
    )?;
    writeln!(
        out,
        "  fingers: thumb {thumb:.0} %, index {index:.0} %, middle {middle:.0} %, ring {ring:.0} %, little {little:.0} %"
    )
}

fn print_tasks(result: &LabResult, out: &mut impl Write) -> io::Result<()> {
    let summary = &result.summary;
    for (name, interval, factor, digits) in task_rows(summary) {
        row(out, &name, &interval, factor, digits)?;
    }
    let mut failed: Vec<(&str, u64, u64)> = Vec::new();
    for task in result.scores.iter().flat_map(|person| &person.tasks) {
        match failed.iter_mut().find(|(name, ..)| *name == task.name) {
            Some(sum) => (sum.1, sum.2) = (sum.1 + task.done, sum.2 + task.tries),
            None => failed.push((&task.name, task.done, task.tries)),
        }
    }
    failed.retain(|(_, done, tries)| done < tries);
    failed.sort_by_key(|&(_, done, tries)| done * 1000 / tries.max(1));
    let failed = failed.iter().take(NAMED);
    let failed = failed.map(|(name, done, tries)| format!("{} {done}/{tries}", escape(name)));
    let failed: Vec<String> = failed.collect();
    if !failed.is_empty() {
        writeln!(out, "  done least: {}", failed.join(", "))?;
    }
    Ok(())
}

/// Prints the differences of a second layout from a first one, and the verdict.
pub fn print_comparison(comparison: &Comparison, out: &mut impl Write) -> io::Result<()> {
    writeln!(
        out,
        "\n{} minus {}, the same people and phrases:",
        escape(&comparison.second),
        escape(&comparison.first)
    )?;
    for (index, difference) in comparison.differences.iter().enumerate() {
        row(out, difference.measure.name(), &difference.interval, 1.0, 2)?;
        for group in &comparison.groups {
            let (count, noun) = (group.people, people(group.people));
            let name = if group.is_long {
                format!("  {count} {noun}, longer hands")
            } else {
                format!(
                    "  {count} {noun}, hands up to {:.0} mm",
                    comparison.median_hand_mm
                )
            };
            if let Some(own) = group.differences.get(index) {
                row(out, &name, &own.interval, 1.0, 2)?;
            }
        }
    }
    writeln!(out, "{}", escape(&comparison.verdict()))
}

/// Returns the noun after a number of people.
pub(super) fn people(count: usize) -> &'static str {
    if count == 1 { "person" } else { "people" }
}

/// Prints a figure with its interval.
pub fn row(
    out: &mut impl Write,
    name: &str,
    interval: &Interval,
    factor: f64,
    digits: usize,
) -> io::Result<()> {
    let [value, low, high] = [interval.value, interval.low, interval.high].map(|it| it * factor);
    writeln!(
        out,
        "  {name:<34} {value:>7.digits$}  ({low:.digits$} to {high:.digits$})"
    )
}
