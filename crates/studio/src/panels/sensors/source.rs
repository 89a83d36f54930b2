//! The source: state, rate, losses by reason, and the latency of the session.

use eframe::egui;

use crate::model::StudioModel;
use crate::panels::status::{source_words, state_words};
use crate::texts::text;
use ademan_core::estimate::Rejection;

pub(super) fn show(ui: &mut egui::Ui, model: &StudioModel) {
    let grid = egui::Grid::new("source")
        .num_columns(2)
        .spacing([16.0, 2.0]);
    grid.show(ui, |ui| {
        for (name, value) in rows(model) {
            ui.label(name);
            ui.add(egui::Label::new(egui::RichText::new(value).strong()).truncate());
            ui.end_row();
        }
    });
}

/// Returns the rows of the table. Losses and rejections are left out until one occurs.
fn rows(model: &StudioModel) -> Vec<(String, String)> {
    let (state, stats) = (&model.view.state, &model.stats);
    let mut rows = vec![
        (
            text("stats-source").to_owned(),
            source_words(&state.source).into_owned(),
        ),
        (text("stats-state").to_owned(), state_words(model)),
        (
            text("stats-rate").to_owned(),
            format!("{:.0}", state.readings_per_second),
        ),
        (
            text("stats-accepted").to_owned(),
            stats.accepted.to_string(),
        ),
    ];
    // Another process counts without reasons.
    let counts = &state.counts;
    let (rejected, suppressed) = if model.is_from_views {
        (counts.rejected, counts.suppressed)
    } else {
        (0, stats.suppressed.total())
    };
    let reasons = Rejection::ALL.iter().map(ToString::to_string);
    let losses = [
        (text("stats-dropped").to_owned(), stats.source.dropped),
        (text("stats-losses").to_owned(), stats.source.losses),
        (text("stats-stalls").to_owned(), stats.stalls),
        (
            text("stats-dropped-presses").to_owned(),
            stats.dropped_presses,
        ),
        (text("stats-suppressed").to_owned(), suppressed),
        (text("stats-rejected").to_owned(), rejected),
    ];
    let losses = losses.into_iter().chain(reasons.zip(stats.rejected));
    let occurred = losses.filter(|(_, count)| *count > 0);
    rows.extend(occurred.map(|(name, count)| (name, count.to_string())));
    if let Some(latency) = model.latency.percentiles() {
        let milliseconds = |micros: u64| micros as f64 / 1e3;
        let values = format!(
            "{:.2} / {:.2} / {:.2} ms",
            milliseconds(latency.p50),
            milliseconds(latency.p99),
            milliseconds(latency.max)
        );
        rows.push((text("stats-latency").to_owned(), values));
    }
    rows
}
