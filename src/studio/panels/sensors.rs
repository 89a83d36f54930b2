//! The sensors: source and losses, and each channel of the glove.

use eframe::egui::{self, Color32};

use super::PanelContext;
use crate::estimate::Rejection;
use crate::studio::model::StudioModel;
use crate::studio::sensors::{ChannelState, SensorRow, SensorTable};
use crate::studio::texts::text;

/// Headings of the table of channels.
const COLUMNS: [&str; 4] = [
    "channel-column",
    "channel-joint",
    "channel-count",
    "channel-angle",
];

pub(super) fn show(ui: &mut egui::Ui, context: &mut PanelContext) {
    ui.add_space(6.0);
    ui.heading(text("panel-sensors"));
    ui.add_space(4.0);
    egui::ScrollArea::vertical().show(ui, |ui| {
        show_source(ui, context.model);
        ui.separator();
        show_channels(ui, context.model);
    });
}

fn show_source(ui: &mut egui::Ui, model: &StudioModel) {
    let state = &model.view.state;
    let stats = &model.stats;
    let mut rows = vec![
        (text("stats-source").to_owned(), state.source.clone()),
        (text("stats-output").to_owned(), state.output.clone()),
        (
            text("stats-rate").to_owned(),
            format!("{:.0}", state.readings_per_second),
        ),
        (
            text("stats-accepted").to_owned(),
            stats.accepted.to_string(),
        ),
        (
            text("stats-dropped").to_owned(),
            stats.source.dropped.to_string(),
        ),
        (
            text("stats-losses").to_owned(),
            stats.source.losses.to_string(),
        ),
        (text("stats-stalls").to_owned(), stats.stalls.to_string()),
    ];
    for (reason, count) in Rejection::ALL.iter().zip(stats.rejected) {
        if count > 0 {
            rows.push((reason.to_string(), count.to_string()));
        }
    }
    let grid = egui::Grid::new("source")
        .num_columns(2)
        .spacing([16.0, 4.0]);
    grid.show(ui, |ui| {
        for (name, value) in rows {
            ui.label(name);
            ui.add(egui::Label::new(egui::RichText::new(value).strong()).truncate());
            ui.end_row();
        }
    });
}

fn show_channels(ui: &mut egui::Ui, model: &StudioModel) {
    if !model.sensors.is_seen() {
        let is_waiting = model.stats.source.readings == 0;
        ui.label(if is_waiting {
            text("channel-no-reading")
        } else {
            text("channel-none")
        });
        return;
    }
    let grid = egui::Grid::new("channels").num_columns(4).striped(true);
    grid.spacing([10.0, 3.0]).show(ui, |ui| {
        for key in COLUMNS {
            ui.strong(text(key));
        }
        ui.end_row();
        for row in model.sensors.rows() {
            show_row(ui, model, &model.sensors, row);
            ui.end_row();
        }
    });
}

fn show_row(ui: &mut egui::Ui, model: &StudioModel, table: &SensorTable, row: &SensorRow) {
    let state = table.state(row);
    let hint = match state {
        ChannelState::Good => row.label.as_str(),
        ChannelState::AtEnd => text("channel-at-end"),
        ChannelState::Unchanged => text("channel-unchanged"),
    };
    let color = match state {
        ChannelState::Good => Color32::from_rgb(0x3b, 0x82, 0xc4),
        ChannelState::AtEnd => Color32::from_rgb(0xc9, 0x4a, 0x4a),
        ChannelState::Unchanged => Color32::from_rgb(0xc2, 0x84, 0x1e),
    };
    let mark = if state == ChannelState::Good {
        ""
    } else {
        " !"
    };
    ui.label(format!("{}{mark}", row.channel))
        .on_hover_text(hint);
    ui.label(row.dof.name()).on_hover_text(&row.label);
    let count = row
        .count
        .map_or_else(|| "–".to_owned(), |count| count.to_string());
    let bar = egui::ProgressBar::new(table.fraction(row))
        .desired_width(64.0)
        .fill(color);
    ui.add(bar.text(count)).on_hover_text(hint);
    match row.degrees(model.angles.as_ref()) {
        Some(degrees) => ui.monospace(format!("{degrees:6.1}°")),
        None => ui.monospace("–"),
    };
}
