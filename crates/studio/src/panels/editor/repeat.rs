//! Repetitions of what is selected: along a grid, and along an arc.

use std::mem;
use std::ops::RangeInclusive;

use eframe::egui::containers::menu::{MenuButton, MenuConfig};
use eframe::egui::{self, Popup, PopupCloseBehavior};

use super::super::look;
use super::{EditorPanel, rounded};
use crate::canvas::Bounds;
use crate::editor::{Edit, Part};
use crate::panels::typed_number;
use crate::texts::text;

/// Pitch and width of the keys of a board whose file does not give them, in millimetres.
const DEFAULT_PITCH_MM: f32 = 19.0;
const DEFAULT_WIDTH_MM: f32 = 17.0;

/// The smallest radius for which an angle is proposed, in millimetres.
const MIN_RADIUS_MM: f32 = 5.0;

/// The numbers of the next repetitions.
pub(super) struct Repeat {
    /// `true` if the menu opens in the next frame.
    pub is_asked: bool,
    /// `true` if its first number gets the focus, as no click has opened it.
    takes_focus: bool,
    /// Columns and rows.
    count: [usize; 2],
    /// Distances to the right and away from the wearer, in millimetres.
    pub pitch_mm: [f64; 2],
    /// Number along an arc, with the first.
    arc_count: usize,
    /// Angle from one to the next, in degrees.
    pub arc_step_deg: f64,
    /// Radius of the arc, in millimetres.
    arc_radius_mm: f64,
}

impl Default for Repeat {
    fn default() -> Self {
        Self {
            is_asked: false,
            takes_focus: false,
            count: [3, 1],
            pitch_mm: [19.0, -19.0],
            arc_count: 3,
            arc_step_deg: 15.0,
            arc_radius_mm: 80.0,
        }
    }
}

impl EditorPanel {
    /// Sets the distances and the angle of repetitions at which the copies of what is selected have the gaps of the keys of a row.
    fn propose_repeat(&mut self) {
        let number = |field: &str, default: f32| {
            let written = self.editor.number(Part::Board(self.board), field);
            written.map_or(default, |number| number as f32)
        };
        let pitch = number("pitch_mm", DEFAULT_PITCH_MM);
        let gap = pitch - number("size_mm.0", DEFAULT_WIDTH_MM);
        let shapes = self.selected.shapes(&self.items.items);
        if let Some(bounds) = Bounds::around(shapes.iter().map(|(_, shape)| shape)) {
            let distance = bounds.size() + gap.max(0.0);
            self.repeat.pitch_mm = [rounded(distance.x), -rounded(distance.y)];
            // The corners towards the center are nearest to each other.
            let radius = self.repeat.arc_radius_mm as f32;
            let inner = radius.abs() - bounds.size().y / 2.0;
            let step = distance.x / inner.max(MIN_RADIUS_MM);
            self.repeat.arc_step_deg = f64::from(step.to_degrees().min(180.0).round());
        }
    }

    /// Makes an edit that repeats what is selected, and shows all copies.
    fn repeat_and_show(&mut self, edit: &Edit) {
        let before = self.editor.revision();
        self.apply(edit);
        if self.editor.revision() != before {
            self.show_added();
        }
    }
}

/// Shows the menu of the repetitions.
pub(super) fn show(ui: &mut egui::Ui, panel: &mut EditorPanel, is_enabled: bool) {
    ui.add_enabled_ui(is_enabled, |ui| {
        // A click into a number must not close it.
        let stays = MenuConfig::new().close_behavior(PopupCloseBehavior::CloseOnClickOutside);
        let menu = MenuButton::new(text("editor-repeat")).config(stays);
        let (button, _) = menu.ui(ui, |ui| show_menu(ui, panel));
        let is_asked = mem::take(&mut panel.repeat.is_asked);
        if is_asked {
            panel.repeat.takes_focus = true;
            Popup::open_id(ui.ctx(), Popup::default_response_id(&button));
        }
        if is_asked || button.clicked() {
            panel.propose_repeat();
        }
    });
}

/// Shows the numbers of the repetitions, and buttons that make them.
fn show_menu(ui: &mut egui::Ui, panel: &mut EditorPanel) {
    look::draw_lines(ui);
    show_grid(ui, &mut panel.repeat);
    if ui.button(text("editor-repeat-now")).clicked() {
        let parts = panel.selected_parts();
        panel.repeat_and_show(&Edit::Repeat {
            parts,
            count: panel.repeat.count,
            pitch_mm: panel.repeat.pitch_mm,
        });
        ui.close();
    }
    ui.separator();
    show_arc(ui, &mut panel.repeat);
    let button = ui.button(text("editor-repeat-arc"));
    if button
        .on_hover_text(text("editor-repeat-arc-hint"))
        .clicked()
    {
        let parts = panel.selected_parts();
        panel.repeat_and_show(&Edit::RepeatAlongArc {
            parts,
            count: panel.repeat.arc_count,
            step_deg: panel.repeat.arc_step_deg,
            radius_mm: panel.repeat.arc_radius_mm,
        });
        ui.close();
    }
}

fn show_grid(ui: &mut egui::Ui, repeat: &mut Repeat) {
    egui::Grid::new("editor-repeat").show(ui, |ui| {
        let counts = ["editor-columns", "editor-rows"];
        for (name, count) in counts.into_iter().zip(&mut repeat.count) {
            // A frame that only measures the menu drops the focus again.
            let takes_focus = !ui.is_sizing_pass() && mem::take(&mut repeat.takes_focus);
            show_count(ui, text(name), (count, 1..=40), takes_focus);
        }
        let pitches = ["editor-pitch-x", "editor-pitch-y"];
        for (name, pitch) in pitches.into_iter().zip(&mut repeat.pitch_mm) {
            show_number(ui, text(name), pitch, (-500.0..=500.0, " mm"));
        }
    });
}

fn show_arc(ui: &mut egui::Ui, repeat: &mut Repeat) {
    egui::Grid::new("editor-repeat-arc").show(ui, |ui| {
        let count = &mut repeat.arc_count;
        show_count(ui, text("editor-arc-count"), (count, 2..=72), false);
        let step = &mut repeat.arc_step_deg;
        show_number(ui, text("editor-arc-step"), step, (-180.0..=180.0, "°"));
        let radius = &mut repeat.arc_radius_mm;
        let range = -2000.0..=2000.0;
        show_number(ui, text("editor-arc-radius"), radius, (range, " mm"));
    });
}

fn show_count(
    ui: &mut egui::Ui,
    name: &str,
    (count, range): (&mut usize, RangeInclusive<usize>),
    takes_focus: bool,
) {
    let label = ui.label(name);
    if takes_focus {
        // A number that gets the focus before it is drawn is selected, and replaced by what is typed.
        let id = ui.next_auto_id();
        ui.memory_mut(|memory| memory.request_focus(id));
    }
    let number = egui::DragValue::new(count).range(range).speed(0.05);
    ui.add(number).labelled_by(label.id);
    ui.end_row();
}

fn show_number(
    ui: &mut egui::Ui,
    name: &str,
    number: &mut f64,
    (range, unit): (RangeInclusive<f64>, &str),
) {
    let label = ui.label(name);
    let number = egui::DragValue::new(number).range(range).speed(0.1);
    let number = number.custom_parser(typed_number);
    ui.add(number.suffix(unit)).labelled_by(label.id);
    ui.end_row();
}
