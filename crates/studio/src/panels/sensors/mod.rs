//! The sensors: source and losses, each channel of the glove with its values, and the filter.

mod bar;
mod channels;
mod filter;
mod glove_bar;
mod source;
mod values;

use eframe::egui;

pub(super) use self::bar::CountBar;
pub(super) use self::glove_bar::show_question;
use super::PanelContext;
use crate::texts::text;

/// Height of a row of the table, in points.
const ROW_HEIGHT: f32 = 18.0;

pub(super) fn show(ui: &mut egui::Ui, context: &mut PanelContext) {
    ui.add_space(6.0);
    ui.heading(text("panel-sensors"));
    glove_bar::show(ui, context);
    ui.add_space(4.0);
    let area = egui::ScrollArea::vertical().auto_shrink(false);
    area.show(ui, |ui| {
        section(ui, text("stats-source"), |ui| {
            source::show(ui, context.session)
        });
        if context.attached.is_some() {
            ui.weak(text("attached-sensors"));
            return;
        }
        section(ui, text("sensor-channels"), |ui| {
            channels::show(ui, context)
        });
        if context.player.is_none() {
            section(ui, text("filter-title"), |ui| filter::show(ui, context));
        }
    });
}

fn section(ui: &mut egui::Ui, name: &str, content: impl FnOnce(&mut egui::Ui)) {
    let header = egui::CollapsingHeader::new(egui::RichText::new(name).strong());
    header.default_open(true).show_unindented(ui, content);
}

/// Adds a name with a hint, and the number that it names.
fn named_number(
    ui: &mut egui::Ui,
    name: &'static str,
    hint: &'static str,
    number: egui::DragValue<'_>,
) {
    let label = ui.label(text(name)).on_hover_text(text(hint));
    ui.add(number).labelled_by(label.id);
}

/// Adds a part of a row with a width of its own.
pub(super) fn cell(
    ui: &mut egui::Ui,
    width: f32,
    align: egui::Align,
    content: impl FnOnce(&mut egui::Ui),
) {
    let layout = match align {
        egui::Align::Max => egui::Layout::right_to_left(egui::Align::Center),
        _ => egui::Layout::left_to_right(egui::Align::Center),
    };
    let size = egui::vec2(width, ROW_HEIGHT);
    ui.allocate_ui_with_layout(size, layout, |ui| {
        ui.set_min_size(size);
        content(ui);
    });
}
