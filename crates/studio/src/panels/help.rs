//! The list of keys, and the tour of the first start.

use eframe::egui::{self, Align2, Key, Modifiers};

use super::PanelState;
use super::actions::{ACTIONS, OTHER_KEYS};
use crate::texts::{text, text_with};
use crate::tour::{STEPS, Tour};

/// Distance of the tour from the lower left corner, in points: over the scope and above the status line. What the steps explain is
/// beside it: the 3D view, the toolbar, the sensors, the status line.
const TOUR_OFFSET: egui::Vec2 = egui::vec2(10.0, -44.0);

/// Height of the window above and below the list of keys, with its title and hint, in points.
const KEYS_MARGIN: f32 = 190.0;

/// Width of the words of the tour, in points.
const TOUR_WIDTH: f32 = 460.0;

pub(super) fn show(ui: &mut egui::Ui, state: &mut PanelState) {
    show_keys(ui, state);
    show_tour(ui, state);
}

fn show_keys(ui: &egui::Ui, state: &mut PanelState) {
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

fn show_tour(ui: &egui::Ui, state: &mut PanelState) {
    let Some(index) = state.tour.index() else {
        return;
    };
    if is_escape_pressed(ui) {
        state.tour.close();
        return;
    }
    let step = STEPS[index];
    let window = egui::Window::new(text(step.heading))
        .id(egui::Id::unique("tour"))
        .anchor(Align2::LEFT_BOTTOM, TOUR_OFFSET)
        .collapsible(false)
        .resizable(false);
    window.show(ui.ctx(), |ui| {
        ui.set_width(TOUR_WIDTH);
        ui.label(egui::RichText::new(text(step.words)).size(15.0));
        ui.add_space(10.0);
        ui.horizontal(|ui| show_buttons(ui, &mut state.tour, index));
    });
}

fn show_buttons(ui: &mut egui::Ui, tour: &mut Tour, index: usize) {
    ui.spacing_mut().button_padding = egui::vec2(10.0, 5.0);
    let values = [("step", (index + 1).into()), ("count", STEPS.len().into())];
    ui.label(text_with("tour-step", &values));
    let is_last = index + 1 == STEPS.len();
    let next = ui.button(if is_last {
        text("tour-done")
    } else {
        text("tour-next")
    });
    if ui.memory(|memory| memory.focused().is_none()) {
        next.request_focus();
    }
    let back = ui.add_enabled(index > 0, egui::Button::new(text("tour-back")));
    let is_skipped = !is_last && ui.button(text("tour-skip")).clicked();
    if next.clicked() {
        tour.advance();
    } else if back.clicked() {
        tour.go_back();
    } else if is_skipped {
        tour.close();
    }
}

fn is_escape_pressed(ui: &egui::Ui) -> bool {
    ui.input_mut(|input| input.consume_key(Modifiers::NONE, Key::Escape))
}
