//! The live channels of a calibration, those first that the present pose moves.

use eframe::egui::{self, Align, RichText};

use crate::guide::Guide;
use crate::joint_names::joint_name;
use crate::panels::sensors::{CountBar, cell};
use crate::sensors::SensorRow;
use crate::texts::text;

/// Widths of the columns of joints and counts, in points.
const JOINT_WIDTH: f32 = 190.0;
const COUNT_WIDTH: f32 = 44.0;

pub(super) fn show(ui: &mut egui::Ui, guide: &Guide) {
    let table = guide.table();
    ui.spacing_mut().item_spacing.y = 2.0;
    let bar = ui.available_width() - JOINT_WIDTH - COUNT_WIDTH - 24.0;
    let mut rows: Vec<_> = table.rows().iter().collect();
    let is_moved = |row: &SensorRow| row.joints.iter().any(|joint| guide.moves(joint.dof));
    rows.sort_by_key(|row| !is_moved(row));
    if !table.is_seen() {
        ui.label(text("channel-no-reading"));
    }
    egui::ScrollArea::vertical().show(ui, |ui| {
        for row in rows {
            let Some(joint) = row.joints.first() else {
                continue;
            };
            ui.horizontal(|ui| {
                cell(ui, JOINT_WIDTH, Align::Min, |ui| {
                    let name = RichText::new(joint_name(joint.dof));
                    let name = if is_moved(row) { name.strong() } else { name };
                    ui.add(egui::Label::new(name).truncate());
                });
                cell(ui, bar, Align::Min, |ui| {
                    let range = guide.seen(row.channel);
                    CountBar { table, row, range }.show(ui, bar);
                });
                cell(ui, COUNT_WIDTH, Align::Max, |ui| {
                    ui.monospace(row.count.map_or("–".to_owned(), |count| count.to_string()));
                });
            });
        }
    });
}
