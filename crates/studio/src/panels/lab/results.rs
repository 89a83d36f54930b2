//! The figures of a run.

use eframe::egui::{self, RichText};

use super::super::editor::EditorPanel;
use super::{LabState, Shown};
use crate::lab::Scored;
use crate::texts::{text, text_with};
use ademan_lab::measures::{Comparison, Interval, Measure};
use ademan_lab::report::task_rows;

pub(super) fn show(ui: &mut egui::Ui, state: &LabState, editor: &EditorPanel) {
    ui.add_space(6.0);
    ui.strong(text("lab-results"));
    let Some(shown) = &state.shown else {
        ui.label(RichText::new(text("lab-no-results")).weak());
        return;
    };
    let outcome = &shown.outcome;
    ui.label(RichText::new(conditions(shown)).weak());
    if !outcome.is_of(editor.editor.text()) {
        ui.colored_label(ui.visuals().warn_fg_color, text("lab-stale"));
    }
    ui.add_space(4.0);
    show_figures(ui, &outcome.own);
    show_left_out(ui, &outcome.own);
    if let Some(comparison) = &outcome.comparison {
        ui.add_space(8.0);
        show_comparison(ui, comparison);
    }
    ui.add_space(8.0);
}

/// Returns who typed what, in one line.
fn conditions(shown: &Shown) -> String {
    let settings = &shown.outcome.request.settings;
    let tier = settings.tier.map_or(text("lab-own-errors"), |it| it.name());
    let values = [
        ("people", settings.people.into()),
        ("phrases", settings.phrases.into()),
        ("corpus", settings.corpus.name().into()),
        ("tier", tier.into()),
        ("source", settings.source.name().into()),
        ("decoder", settings.decoder.name().into()),
        ("seed", settings.seed.to_string().into()),
    ];
    text_with("lab-conditions", &values)
}

fn show_figures(ui: &mut egui::Ui, scored: &Scored) {
    let summary = &scored.summary;
    let grid = egui::Grid::new("lab figures").num_columns(2).striped(true);
    grid.show(ui, |ui| {
        if summary.characters == 0 {
            for (name, interval, factor, digits) in task_rows(summary) {
                show_row(ui, &name, &interval, factor, digits);
            }
            return;
        }
        let rows = [
            ("lab-wpm", &summary.wpm, 1.0, 1),
            ("lab-cer", &summary.cer, 100.0, 1),
            ("lab-insertions", &summary.insertions, 100.0, 1),
            ("lab-deletions", &summary.deletions, 100.0, 1),
            ("lab-substitutions", &summary.substitutions, 100.0, 1),
            ("lab-wer", &summary.wer, 100.0, 1),
            ("lab-kspc", &summary.kspc, 1.0, 2),
            ("lab-hits", &summary.hits, 100.0, 1),
            ("lab-travel", &summary.joint_travel_deg, 1.0, 0),
        ];
        for (key, interval, factor, digits) in rows {
            show_row(ui, text(key), interval, factor, digits);
        }
        if let Some(oov) = &summary.oov {
            show_row(ui, text("lab-oov"), oov, 100.0, 1);
        }
        ui.label(text("lab-worst"));
        let values = [
            ("cer", format!("{:.1}", 100.0 * summary.worst_cer).into()),
            ("wpm", format!("{:.1}", summary.worst_wpm).into()),
        ];
        ui.label(text_with("lab-worst-values", &values));
        ui.end_row();
    });
}

fn show_row(ui: &mut egui::Ui, name: &str, interval: &Interval, factor: f64, digits: usize) {
    ui.label(name);
    let [value, low, high] = [interval.value, interval.low, interval.high].map(|it| it * factor);
    ui.horizontal(|ui| {
        ui.strong(format!("{value:.digits$}"));
        let range = format!("{low:.digits$} – {high:.digits$}");
        ui.label(RichText::new(range).weak());
    });
    ui.end_row();
}

/// Names the characters and controls that nobody could use.
fn show_left_out(ui: &mut egui::Ui, scored: &Scored) {
    let most = scored
        .scores
        .iter()
        .max_by_key(|it| it.untypable.chars().count());
    let untypable = most.filter(|it| it.characters > 0).map(|it| &it.untypable);
    if let Some(characters) = untypable.filter(|it| !it.is_empty()) {
        let characters: Vec<String> = characters.chars().map(|it| it.to_string()).collect();
        let values = [("characters", characters.join(" ").into())];
        ui.colored_label(
            ui.visuals().warn_fg_color,
            text_with("lab-untypable", &values),
        );
    }
    let mut unreached: Vec<&str> = Vec::new();
    for name in scored.scores.iter().flat_map(|it| &it.unreached) {
        if !unreached.contains(&name.as_str()) {
            unreached.push(name);
        }
    }
    if !unreached.is_empty() {
        let values = [("names", unreached.join(", ").into())];
        ui.colored_label(
            ui.visuals().warn_fg_color,
            text_with("lab-unreached", &values),
        );
    }
}

fn show_comparison(ui: &mut egui::Ui, comparison: &Comparison) {
    let values = [
        ("first", comparison.first.as_str().into()),
        ("second", comparison.second.as_str().into()),
    ];
    ui.strong(text_with("lab-minus", &values));
    ui.label(RichText::new(comparison.verdict()).strong());
    let grid = egui::Grid::new("lab comparison")
        .num_columns(2)
        .striped(true);
    grid.show(ui, |ui| {
        for difference in &comparison.differences {
            let name = text(measure_key(difference.measure));
            show_row(ui, name, &difference.interval, 1.0, 2);
        }
    });
}

const fn measure_key(measure: Measure) -> &'static str {
    match measure {
        Measure::WordsPerMinute => "lab-wpm",
        Measure::ErrorPoints => "lab-points-cer",
        Measure::JointTravel => "lab-travel",
        Measure::UncomfortablePoints => "lab-points-uncomfortable",
        Measure::TaskPoints => "lab-points-tasks",
        Measure::TaskSeconds => "lab-seconds-task",
        Measure::Throughput => "lab-throughput",
        Measure::MissPoints => "lab-points-misses",
    }
}
