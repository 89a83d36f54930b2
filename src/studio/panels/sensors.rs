//! The sensors: source and losses, and each channel of the glove.

use eframe::egui::{self, Color32};

use super::PanelContext;
use crate::estimate::Rejection;
use crate::studio::model::StudioModel;
use crate::studio::sensors::{ChannelState, SensorRow, SensorTable};
use crate::studio::texts;

pub(super) fn show(ui: &mut egui::Ui, context: &mut PanelContext) {
    ui.add_space(6.0);
    ui.heading(texts::SENSORS);
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
        (texts::SOURCE.to_owned(), state.source.clone()),
        (texts::OUTPUT.to_owned(), state.output.clone()),
        (
            texts::RATE.to_owned(),
            format!("{:.0}", state.readings_per_second),
        ),
        (texts::ACCEPTED.to_owned(), stats.accepted.to_string()),
        (texts::DROPPED.to_owned(), stats.source.dropped.to_string()),
        (texts::LOSSES.to_owned(), stats.source.losses.to_string()),
        (texts::STALLS.to_owned(), stats.stalls.to_string()),
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
            texts::NO_READING
        } else {
            texts::NO_CHANNELS
        });
        return;
    }
    let grid = egui::Grid::new("channels").num_columns(4).striped(true);
    grid.spacing([10.0, 3.0]).show(ui, |ui| {
        for name in texts::SENSOR_COLUMNS {
            ui.strong(name);
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
        ChannelState::AtEnd => texts::AT_END,
        ChannelState::Unchanged => texts::UNCHANGED,
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
