//! A report of a study as one HTML file: figures, and how participants changed from trial to trial.

use std::fmt::{self, Write};

use super::{LayoutFigures, Trial, TrialKind, figures};
use crate::layout::heat_style;
use crate::measures::{Interval, bootstrap};
use crate::message::escape_markup;
use crate::report::{Curve, STYLE, write_curve};

/// The fewest trials of a curve.
const FEWEST: usize = 3;

/// Returns a report of trials. Practice counts only if `with_practice`. There are no texts and no pseudonyms in it.
pub fn study_to_html(trials: &[Trial], with_practice: bool) -> String {
    let mut page = String::new();
    write_page(trials, with_practice, &mut page).expect("writing to a string does not fail");
    page
}

fn write_page(trials: &[Trial], with_practice: bool, page: &mut String) -> fmt::Result {
    writeln!(
        page,
        "<!DOCTYPE html>\n<html lang=\"en\">\n<head>\n<meta charset=\"utf-8\"/>\n\
         <meta name=\"viewport\" content=\"width=device-width\"/>\n<title>Study</title>\n\
         <style>\n{}</style>\n</head>\n<body>\n<h1>Study</h1>\n\
         <p class=\"note\">Ranges are intervals of 95 % from resampled groups of the participants.</p>",
        heat_style(STYLE)
    )?;
    for layout in figures(trials, with_practice) {
        write_layout(&layout, page)?;
        let curves = study_curves(trials, &layout.layout, with_practice);
        if curves.is_empty() {
            continue;
        }
        writeln!(
            page,
            "<h3>From trial to trial</h3>\n<p class=\"note\">Each point is the trial of this number of each participant on this layout; later \
             points may have fewer participants.</p>\n<div class=\"columns\">"
        )?;
        for curve in &curves {
            let name = escape_markup(&curve.name);
            writeln!(page, "<figure><figcaption>{name}</figcaption>")?;
            write_curve(curve, page)?;
            writeln!(page, "</figure>")?;
        }
        writeln!(page, "</div>")?;
    }
    writeln!(page, "</body>\n</html>")
}

fn write_layout(figures: &LayoutFigures, page: &mut String) -> fmt::Result {
    let simulated = match figures.simulated {
        0 => String::new(),
        count => format!("; simulated hands did {count} of them"),
    };
    writeln!(
        page,
        "<h2>{}</h2>\n<p>Participants: {}; trials: {}{simulated}.</p>\n<table>",
        escape_markup(&figures.layout),
        figures.participants,
        figures.trials
    )?;
    for (name, interval, factor, digits) in figures.rows() {
        let [value, low, high] =
            [interval.value, interval.low, interval.high].map(|it| it * factor);
        writeln!(
            page,
            "<tr><th scope=\"row\">{name}</th><td class=\"number\">{value:.digits$} <span class=\"range\">({low:.digits$} to {high:.digits$})</span></td></tr>"
        )?;
    }
    writeln!(page, "</table>")
}

/// Returns how the participants changed from trial to trial on a layout; nothing for figures with few trials.
pub fn study_curves(trials: &[Trial], layout: &str, with_practice: bool) -> Vec<Curve> {
    let is_counted = |trial: &&Trial| {
        trial.layout == layout && (with_practice || trial.kind != TrialKind::Practice)
    };
    let mut own: Vec<&Trial> = trials.iter().filter(is_counted).collect();
    own.sort_by_key(|trial| trial.order);
    let mut names: Vec<&str> = own.iter().map(|it| it.participant.as_str()).collect();
    names.sort_unstable();
    names.dedup();
    let curve = |name: &str, value: fn(&Trial) -> Option<f64>| {
        let of_participant = |participant: &&str| {
            let theirs = own.iter().filter(|it| it.participant == *participant);
            theirs
                .filter_map(|trial| value(trial))
                .collect::<Vec<f64>>()
        };
        let values: Vec<Vec<f64>> = names.iter().map(of_participant).collect();
        let longest = values.iter().map(Vec::len).max().unwrap_or_default();
        if longest < FEWEST {
            return None;
        }
        let point = |index: usize| {
            let there = values.iter().filter_map(|it| it.get(index).copied());
            let interval: Interval = bootstrap(&there.collect::<Vec<_>>(), |sample| {
                sample.iter().copied().sum::<f64>() / sample.len() as f64
            });
            ([index + 1; 2], interval)
        };
        Some(Curve {
            name: name.to_owned(),
            axis: "trial".to_owned(),
            points: (0..longest).map(point).collect(),
        })
    };
    let curves = [
        curve("words of correct text per minute", |it| it.wpm),
        curve("wrong characters, %", |it| Some(100.0 * it.cer()?)),
        curve("effective throughput, bit/s", |it| {
            Some(it.pointing?.throughput)
        }),
    ];
    curves.into_iter().flatten().collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    fn trial(participant: &str, order: usize, wpm: f64, kind: TrialKind) -> Trial {
        let text = format!(
            "{{\"participant\":\"{participant}\",\"order\":{order},\"layout\":\"board\",\"kind\":\"{}\",\"task\":null,\"time\":\"\",\
             \"is_simulated\":false,\"program_version\":\"\",\"seconds\":1.0,\"characters\":20,\"substitutions\":1,\"insertions\":0,\
             \"deletions\":0,\"wpm\":{wpm}}}",
            kind.name()
        );
        serde_json::from_str(&text).expect("a trial")
    }

    #[test]
    fn a_curve_follows_the_trials_of_each_participant_in_their_order() {
        let mut trials: Vec<Trial> = (0..4_u8)
            .rev()
            .flat_map(|order| {
                ["P01", "P02"].map(|name| {
                    let wpm = 10.0 + f64::from(order);
                    trial(name, order.into(), wpm, TrialKind::Phrase)
                })
            })
            .collect();
        trials.push(trial("P01", 9, 40.0, TrialKind::Practice));
        let curves = study_curves(&trials, "board", false);
        let speed = &curves[0];
        let values: Vec<f64> = speed.points.iter().map(|(_, it)| it.value).collect();
        assert_eq!(values, [10.0, 11.0, 12.0, 13.0]);
        let with = study_curves(&trials, "board", true);
        assert_eq!(with[0].points.len(), 5);
        assert!(study_curves(&trials, "other", false).is_empty());
        let page = study_to_html(&trials, false);
        assert!(page.contains("From trial to trial") && page.contains("<svg"));
        assert!(!page.contains("P01"), "no pseudonyms");
    }
}
