//! The free view of the plan: mouse and keys turn it.

use eframe::egui::{self, Key, Modifiers, PointerButton};
use parry3d::math::{Vec2, Vec3};

use super::EditorPanel;
use crate::camera::key_drag;

/// The keys that turn the view, with the directions in which the eye moves: to the right and up.
const KEYS: [(Key, f32, f32); 4] = [
    (Key::ArrowLeft, -1.0, 0.0),
    (Key::ArrowRight, 1.0, 0.0),
    (Key::ArrowDown, 0.0, -1.0),
    (Key::ArrowUp, 0.0, 1.0),
];

/// Turns the view by a drag of the secondary button. With Shift, it pans.
pub(super) fn turn_by_mouse(ui: &egui::Ui, response: &egui::Response, panel: &mut EditorPanel) {
    let is_shift = ui.input(|input| input.modifiers.shift);
    // The points of a drag belong to the view in which it began.
    let can_turn = !is_shift && !panel.plan.is_dragging();
    if can_turn && response.dragged_by(PointerButton::Secondary) {
        let drag = response.drag_delta();
        panel.turn_plan(Vec2::new(drag.x, drag.y));
    }
}

/// Returns `true` while the view is panned: by a drag of the middle button, or of the secondary one with Shift.
pub(super) fn pans(ui: &egui::Ui, response: &egui::Response) -> bool {
    let is_shift = ui.input(|input| input.modifiers.shift);
    response.dragged_by(PointerButton::Middle)
        || is_shift && response.dragged_by(PointerButton::Secondary)
}

/// Turns the view with `Ctrl` and the arrow keys; without `Ctrl` only while nothing is selected, because they move what is selected.
pub(super) fn turn_by_keys(ui: &egui::Ui, panel: &mut EditorPanel) {
    if !panel.plan.is_open || !panel.plan.view.is_free() {
        return;
    }
    let is_nothing_selected = panel.editor.selection().is_empty();
    let modifiers = [
        Some(Modifiers::COMMAND),
        is_nothing_selected.then_some(Modifiers::NONE),
    ];
    let mut drag = Vec2::ZERO;
    for with in modifiers.into_iter().flatten() {
        for (key, right, up) in KEYS {
            let taps = ui.input_mut(|input| input.count_and_consume_key(with, key));
            drag += key_drag(right, up) * taps as f32;
        }
    }
    panel.turn_plan(drag);
}

impl EditorPanel {
    /// Turns the free view by a drag in points, around the middle of what is selected, or of everything.
    fn turn_plan(&mut self, drag: Vec2) {
        let old = self.plan.view;
        let new = old.turned(drag);
        if new == old {
            return;
        }
        let middle = self.middle_of_plan();
        self.plan.view = new;
        self.plan.free = Some(new);
        let viewport = self.plan.viewport();
        if let Some(mut shown) = viewport.viewport() {
            shown.center += new.flatten(middle) - old.flatten(middle);
            viewport.move_to(shown);
        }
    }

    fn middle_of_plan(&self) -> Vec3 {
        let items = &self.plan.plan.items;
        let selection = self.editor.selection();
        let selected = items.iter().filter(|item| selection.contains(&item.part));
        let mut centers: Vec<Vec3> = selected.map(|item| item.center()).collect();
        if centers.is_empty() {
            centers = items.iter().map(|item| item.center()).collect();
        }
        let count = centers.len().max(1) as f32;
        centers.into_iter().sum::<Vec3>() / count
    }
}
