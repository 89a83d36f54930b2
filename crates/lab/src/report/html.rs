//! A report as one HTML file, in light or dark colors, for phones and desktop screens.

use std::fmt::{self, Write};

use super::{curves, keys_of_all, rows, write_curve, wrong_of_all};
use crate::layout::{Heat, Layout, TooManyShapes, heat_style};
use crate::measures::{Comparison, Interval, LabResult, PersonScore, Summary};
use crate::message::escape_markup;
use crate::trials::PointingScore;

/// The largest number of rows of the tables of keys, pairs and people.
const ROWS: usize = 12;
/// The rate of missed keys with the strongest color.
const WORST_RATE: f64 = 0.5;

pub(crate) const STYLE: &str = "\
:root{color-scheme:light dark}
body{margin:1.5rem auto;padding:0 1rem;max-width:70rem;font:1rem/1.45 sans-serif;background:$ground;color:$ink}
h1{margin:0;font-size:1.5rem;overflow-wrap:anywhere}h2{margin:1.8rem 0 .5rem;font-size:1.15rem}h3{margin:1.2rem 0 .3rem;font-size:1rem}
p{margin:.3rem 0}.note{color:$muted;font-size:.9rem}figure{margin:.8rem 0}
.verdict{padding:.6rem .8rem;border-left:4px solid $accent;background:$panel}
svg{max-width:100%;height:auto}
.columns{display:grid;grid-template-columns:repeat(auto-fit,minmax(min(100%,21rem),1fr));gap:0 2rem}
.wide{overflow-x:auto}
table{border-collapse:collapse;width:100%}
td,th{padding:.2rem .6rem .2rem 0;text-align:left;font-weight:normal;vertical-align:top;border-bottom:1px solid $well}
td.number,th.number{text-align:right;font-variant-numeric:tabular-nums;white-space:nowrap;padding-right:.4rem}
th[scope=col]{color:$muted;font-size:.85rem}
.range{color:$muted}
.level{stroke:$well;fill:none}.value{fill:$muted;stroke:none;font-size:.75rem}
.band{fill:$accent;opacity:.2}.line{stroke:$accent;stroke-width:2;fill:none}.dot{fill:$accent}
";

/// Returns a report of one result, or of several layouts that the same people used. `layouts` are the layouts of the results.
pub fn to_html(results: &[LabResult], layouts: &[Layout]) -> Result<String, TooManyShapes> {
    let drawings: Result<Vec<Vec<String>>, TooManyShapes> = results
        .iter()
        .zip(layouts)
        .map(|(result, layout)| layout.to_heat_svgs(&heats(layout, &result.scores)))
        .collect();
    let mut page = String::new();
    write_page(results, &drawings?, &mut page).expect("writing to a string does not fail");
    Ok(page)
}

/// Returns the color of each target: the fraction of strokes that did not press it when it was meant, or of its tasks that were not done.
pub fn heats(layout: &Layout, people: &[PersonScore]) -> Vec<Heat> {
    let names = layout.target_names();
    let keys = keys_of_all(people).into_iter().filter_map(|key| {
        let rate = 1.0 - key.hit as f64 / key.meant.max(1) as f64;
        Some(Heat {
            target: names.find(&key.name)?,
            part: (rate / WORST_RATE) as f32,
            words: format!("{}: {} of {} hit", key.name, key.hit, key.meant),
        })
    });
    let tasks = people.iter().flat_map(|person| &person.tasks);
    let mut of_tasks: Vec<(&str, u64, u64)> = Vec::new();
    for task in tasks {
        match of_tasks.iter_mut().find(|(name, ..)| *name == task.name) {
            Some(sum) => {
                sum.1 += task.done;
                sum.2 += task.tries;
            }
            None => of_tasks.push((&task.name, task.done, task.tries)),
        }
    }
    let task_heats = of_tasks.into_iter().filter_map(|(name, done, tries)| {
        let rate = 1.0 - done as f64 / tries.max(1) as f64;
        Some(Heat {
            target: names.find(name)?,
            part: (rate / WORST_RATE) as f32,
            words: format!("{name}: {done} of {tries} done"),
        })
    });
    keys.chain(task_heats).collect()
}

fn write_page(results: &[LabResult], drawings: &[Vec<String>], page: &mut String) -> fmt::Result {
    let names: Vec<String> = results
        .iter()
        .map(|it| escape_markup(&it.layout_file))
        .collect();
    let title = names.join(" and ");
    writeln!(
        page,
        "<!DOCTYPE html>\n<html lang=\"en\">\n<head>\n<meta charset=\"utf-8\"/>\n\
         <meta name=\"viewport\" content=\"width=device-width\"/>\n<title>{title}</title>\n\
         <style>\n{}</style>\n</head>\n<body>\n<h1>{title}</h1>",
        heat_style(STYLE)
    )?;
    if let Some(first) = results.first() {
        write_conditions(first, page)?;
    }
    for comparison in results.iter().filter_map(|it| it.comparison.as_ref()) {
        write_comparison(comparison, page)?;
    }
    for (result, own_drawings) in results.iter().zip(drawings) {
        if results.len() > 1 {
            writeln!(page, "<h2>{}</h2>", escape_markup(&result.layout_file))?;
        }
        write_result(result, own_drawings, page)?;
    }
    writeln!(page, "</body>\n</html>")
}

fn write_conditions(result: &LabResult, page: &mut String) -> fmt::Result {
    let tier = result.tier.as_deref().unwrap_or("their own errors");
    let corrections = match result.corrections {
        0.0 => String::new(),
        part => format!("corrections: {part}; "),
    };
    let decoder = match &result.decoder {
        Some(decoder) => format!("decoder: {}; ", escape_markup(decoder)),
        None => String::new(),
    };
    let resampled = if result.is_repeated() {
        "repetitions of one person, and say nothing about other people"
    } else {
        "populations"
    };
    writeln!(
        page,
        "<p class=\"note\">{}, {} phrases each of {} (hash {}); tier: {}; source: {}; {corrections}{decoder}seed {}; \
         program {}. Every figure is simulated; ranges are intervals of 95 % from resampled {resampled}.</p>",
        result.subjects(),
        result.phrases,
        escape_markup(&result.corpus),
        escape_markup(&result.corpus_hash),
        escape_markup(tier),
        escape_markup(&result.source),
        result.seed,
        escape_markup(&result.program_version)
    )?;
    match &result.partial {
        Some(partial) => writeln!(
            page,
            "<p class=\"verdict\">Partial: {} of {} people; {} of {} shards are missing.</p>",
            result.scores.len(),
            partial.people,
            partial.missing.len(),
            partial.shards
        ),
        None => Ok(()),
    }
}

fn write_comparison(comparison: &Comparison, page: &mut String) -> fmt::Result {
    writeln!(
        page,
        "<p class=\"verdict\">{}</p>\n<div class=\"wide\"><table>\n<tr><th scope=\"col\">difference from {}</th>\
         <th scope=\"col\" class=\"number\">all</th><th scope=\"col\" class=\"number\">hands up to {:.0} mm</th>\
         <th scope=\"col\" class=\"number\">longer hands</th></tr>",
        escape_markup(&comparison.verdict()),
        escape_markup(&comparison.first),
        comparison.median_hand_mm
    )?;
    for (index, difference) in comparison.differences.iter().enumerate() {
        write!(
            page,
            "<tr><th scope=\"row\">{}</th>{}",
            escape_markup(difference.measure.name()),
            cell(&difference.interval, 1.0, 2)
        )?;
        for group in &comparison.groups {
            let own = group.differences.get(index);
            // A group that completed no task has no times.
            let unknown = || "<td class=\"number\">–</td>".to_owned();
            let text = own.map_or_else(unknown, |it| cell(&it.interval, 1.0, 2));
            write!(page, "{text}")?;
        }
        writeln!(page, "</tr>")?;
    }
    writeln!(page, "</table></div>")
}

fn write_result(result: &LabResult, drawings: &[String], page: &mut String) -> fmt::Result {
    let summary = &result.summary;
    writeln!(
        page,
        "<div class=\"columns\"><section>\n<h2>Figures</h2>\n<table>"
    )?;
    for (name, interval, factor, digits) in rows(summary) {
        writeln!(
            page,
            "<tr><th scope=\"row\">{name}</th>{}</tr>",
            cell(&interval, factor, digits)
        )?;
    }
    writeln!(page, "</table>\n</section><section>")?;
    write_people(result, page)?;
    writeln!(page, "</section></div>")?;
    write_curves(result, page)?;
    let what = match summary.characters {
        0 => "Tasks that were not done, in color",
        _ => "Strokes that did not press what was meant, in color",
    };
    writeln!(
        page,
        "<h2>{what}</h2>\n<p class=\"note\">The strongest color means {:.0} % or more. Point at a key to see its figures.</p>",
        WORST_RATE * 100.0
    )?;
    for drawing in drawings {
        writeln!(page, "<figure>{drawing}</figure>")?;
    }
    write_tables(result, page)
}

/// Writes the curves over the phrases.
fn write_curves(result: &LabResult, page: &mut String) -> fmt::Result {
    let curves = curves(&result.scores);
    if curves.is_empty() {
        return Ok(());
    }
    let learns = match &result.decoder {
        Some(_) => "Simulated people do not learn; their decoder does.",
        None => {
            "Simulated people do not learn a layout: a trend comes from the phrases, or is chance."
        }
    };
    writeln!(
        page,
        "<h2>From phrase to phrase</h2>\n<p class=\"note\">{learns} The bands are intervals of 95 % from resampled populations.</p>\n<div class=\"columns\">"
    )?;
    for curve in &curves {
        writeln!(
            page,
            "<figure><figcaption>{}</figcaption>",
            escape_markup(&curve.name)
        )?;
        write_curve(curve, page)?;
        writeln!(page, "</figure>")?;
    }
    writeln!(page, "</div>")
}

fn write_people(result: &LabResult, page: &mut String) -> fmt::Result {
    let summary = &result.summary;
    writeln!(page, "<h2>The people</h2>")?;
    if summary.characters > 0 {
        writeln!(
            page,
            "<p>The intended pace, an input, is {:.1} words/min on average. The worst tenth of the people types {:.1} % wrong characters; \
             the slowest tenth types {:.1} words/min.</p>",
            summary.pace_wpm,
            100.0 * summary.worst_cer,
            summary.worst_wpm
        )?;
    }
    let mut people: Vec<&PersonScore> = result.scores.iter().collect();
    let badness = |person: &PersonScore| match summary.characters {
        // A person is worse with fewer tasks done or, without tasks, with a lower throughput.
        0 => -own_figures(result, person).first().map_or(0.0, |own| own.1),
        _ => person.cer(),
    };
    people.sort_by(|a, b| badness(b).total_cmp(&badness(a)));
    write!(
        page,
        "<table>\n<tr><th scope=\"col\">worst people</th><th scope=\"col\" class=\"number\">hand mm</th><th scope=\"col\">fingers</th>"
    )?;
    let worst = people.first();
    for (name, _) in worst.map_or_else(Vec::new, |worst| own_figures(result, worst)) {
        write!(page, "<th scope=\"col\" class=\"number\">{name}</th>")?;
    }
    writeln!(page, "</tr>")?;
    for person in people.iter().take(ROWS / 2) {
        write!(
            page,
            "<tr><td>{}</td><td class=\"number\">{:.0}</td><td>{}</td>",
            person.number,
            person.hand_mm,
            escape_markup(&person.style)
        )?;
        for (_, figure) in own_figures(result, person) {
            write!(page, "<td class=\"number\">{figure:.1}</td>")?;
        }
        writeln!(page, "</tr>")?;
    }
    writeln!(page, "</table>")
}

/// Returns the figures of a person with their names: of typed text, otherwise of tasks and of the pointer, as far as the result has them.
fn own_figures(result: &LabResult, person: &PersonScore) -> Vec<(&'static str, f64)> {
    if result.summary.characters > 0 {
        return vec![("words/min", person.wpm), ("CER %", 100.0 * person.cer())];
    }
    let mut figures = Vec::new();
    if result.scores.iter().any(|it| !it.tasks.is_empty()) {
        let tries: u64 = person.tasks.iter().map(|it| it.tries).sum();
        let done: u64 = person.tasks.iter().map(|it| it.done).sum();
        figures.push(("tasks done %", 100.0 * done as f64 / tries.max(1) as f64));
    }
    if result.summary.pointing.is_some() {
        let pointing = person.pointing.as_ref();
        figures.push(("bit/s", pointing.map_or(0.0, PointingScore::throughput)));
    }
    figures
}

fn write_tables(result: &LabResult, page: &mut String) -> fmt::Result {
    writeln!(page, "<div class=\"columns\">")?;
    let mut keys = keys_of_all(&result.scores);
    let rate = |hit: u64, meant: u64| 100.0 * hit as f64 / meant.max(1) as f64;
    keys.sort_by(|a, b| rate(a.hit, a.meant).total_cmp(&rate(b.hit, b.meant)));
    if !keys.is_empty() {
        writeln!(
            page,
            "<section>\n<h2>Worst keys</h2>\n<table>\n<tr><th scope=\"col\">key</th><th scope=\"col\" class=\"number\">hit %</th>\
             <th scope=\"col\" class=\"number\">strokes</th><th scope=\"col\" class=\"number\">bias mm</th><th scope=\"col\" class=\"number\">spread mm</th></tr>"
        )?;
        for key in keys.iter().take(ROWS) {
            writeln!(
                page,
                "<tr><td>{}</td><td class=\"number\">{:.1}</td><td class=\"number\">{}</td>\
                 <td class=\"number\">{:+.1} {:+.1}</td><td class=\"number\">{:.1} {:.1}</td></tr>",
                escape_markup(&key.name),
                rate(key.hit, key.meant),
                key.meant,
                key.bias_mm[0],
                key.bias_mm[1],
                key.spread_mm[0],
                key.spread_mm[1]
            )?;
        }
        writeln!(page, "</table>\n</section>")?;
    }
    let wrong = wrong_of_all(&result.scores);
    if !wrong.is_empty() {
        writeln!(
            page,
            "<section>\n<h2>Most frequent wrong presses</h2>\n<table>\n<tr><th scope=\"col\">meant</th><th scope=\"col\">pressed</th>\
             <th scope=\"col\" class=\"number\">times</th></tr>"
        )?;
        for (meant, pressed, count) in wrong.iter().take(ROWS) {
            writeln!(
                page,
                "<tr><td>{}</td><td>{}</td><td class=\"number\">{count}</td></tr>",
                escape_markup(meant),
                escape_markup(pressed)
            )?;
        }
        writeln!(page, "</table>\n</section>")?;
    }
    if result.summary.characters > 0 {
        write_fingers(&result.summary, page)?;
    }
    writeln!(page, "</div>")
}

fn write_fingers(summary: &Summary, page: &mut String) -> fmt::Result {
    writeln!(page, "<section>\n<h2>Fingers</h2>\n<table>")?;
    let pairs = [
        "same finger, % of pairs",
        "alternating hands, %",
        "rolls of two fingers, %",
        "redirects, %",
    ];
    let fingers = ["thumb", "index", "middle", "ring", "little"];
    let fingers = fingers.map(|finger| format!("{finger}, % of strokes"));
    let pairs = pairs
        .iter()
        .map(|name| (*name).to_owned())
        .zip(summary.pairs);
    for (name, part) in pairs.chain(fingers.into_iter().zip(summary.fingers)) {
        writeln!(
            page,
            "<tr><th scope=\"row\">{name}</th><td class=\"number\">{:.1}</td></tr>",
            100.0 * part
        )?;
    }
    writeln!(page, "</table>\n</section>")
}

/// Returns the cells of an interval.
fn cell(interval: &Interval, factor: f64, digits: usize) -> String {
    let [value, low, high] = [interval.value, interval.low, interval.high].map(|it| it * factor);
    format!(
        "<td class=\"number\">{value:.digits$} <span class=\"range\">({low:.digits$} to {high:.digits$})</span></td>"
    )
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::measures::{TaskScore, compare, summarize};
    use crate::trials::TaskKind;

    #[test]
    fn people_who_do_not_type_have_their_tasks_and_no_other_figures() {
        let person = PersonScore {
            tasks: vec![TaskScore {
                name: "A".to_owned(),
                kind: TaskKind::Touch,
                tries: 4,
                done: 3,
                wrong: 0,
                seconds: 0.5,
                error: None,
            }],
            ..PersonScore::default()
        };
        let scores = vec![person];
        let result = LabResult {
            summary: summarize(&scores),
            scores,
            ..LabResult::unscored(1)
        };
        let mut page = String::new();
        write_people(&result, &mut page).expect("writing to a string does not fail");
        assert!(
            page.contains("tasks done %") && page.contains(">75.0<"),
            "{page}"
        );
        for other in ["CER", "words/min", "bit/s"] {
            assert!(!page.contains(other), "{page}");
        }
    }

    #[test]
    fn a_report_states_what_else_changes_its_figures() {
        let result = LabResult {
            corrections: 0.9,
            decoder: Some("auto:es".to_owned()),
            ..LabResult::unscored(1)
        };
        let mut page = String::new();
        write_conditions(&result, &mut page).expect("writing to a string does not fail");
        let words = "; corrections: 0.9; decoder: auto:es; seed";
        assert!(page.contains(words), "{page}");
    }

    #[test]
    fn a_group_that_does_no_task_has_no_time() {
        let people = |done: [u64; 2]| -> Vec<PersonScore> {
            let person = |(count, hand_mm): (u64, f64)| PersonScore {
                hand_mm,
                tasks: vec![TaskScore {
                    name: "A".to_owned(),
                    kind: TaskKind::Touch,
                    tries: 4,
                    done: count,
                    wrong: 0,
                    seconds: if count > 0 { 0.5 } else { 0.0 },
                    error: None,
                }],
                ..PersonScore::default()
            };
            done.into_iter().zip([170.0, 200.0]).map(person).collect()
        };
        let (before, after) = (people([4, 4]), people([4, 0]));
        let comparison = compare(("a", &before), ("b", &after)).expect("both are tasks");
        let mut page = String::new();
        write_comparison(&comparison, &mut page).expect("writing to a string does not fail");
        assert_eq!(
            page.matches("<td class=\"number\">–</td>").count(),
            1,
            "{page}"
        );
    }
}
