//! The list of keys.

use eframe::egui::{self, Align2, Key, Modifiers};

use super::actions::{ACTIONS, OTHER_KEYS};
use super::{PanelState, editor};
use crate::texts::text;

/// Height of the window above and below the list of keys, with its title and hint, in points.
const KEYS_MARGIN: f32 = 190.0;

pub(super) fn show_keys(ui: &egui::Ui, state: &mut PanelState) {
    if state.shows_keys && is_escape_pressed(ui) {
        state.shows_keys = false;
    }
    let window = egui::Window::new(text("keys-title"))
        .id(egui::Id::unique("keys"))
        .open(&mut state.shows_keys)
        .anchor(Align2::CENTER_CENTER, egui::Vec2::ZERO)
        .collapsible(false)
        .resizable(false);
    window.show(ui.ctx(), |ui| {
        // A small window scrolls the list.
        let height = ui.ctx().content_rect().height() - KEYS_MARGIN;
        let area = egui::ScrollArea::vertical().max_height(height);
        area.show(ui, show_key_list);
        ui.add_space(6.0);
        ui.label(text("hint-camera"));
    });
}

fn show_key_list(ui: &mut egui::Ui) {
    let grid = egui::Grid::new("key_list").num_columns(2).striped(true);
    grid.spacing([24.0, 6.0]).show(ui, |ui| {
        for spec in &ACTIONS {
            ui.monospace(spec.keys(ui.ctx()));
            ui.label(text(spec.name));
            ui.end_row();
        }
        for (keys, words) in OTHER_KEYS {
            ui.monospace(keys);
            ui.label(text(words));
            ui.end_row();
        }
    });
}

/// Returns `true` if Escape was pressed to close a window, and not to answer a question.
pub(super) fn is_escape_pressed(ui: &egui::Ui) -> bool {
    !editor::is_asked(ui) && ui.input_mut(|input| input.consume_key(Modifiers::NONE, Key::Escape))
}
