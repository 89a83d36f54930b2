//! The keys of the layout editor.

use eframe::egui::{self, Key, Modifiers};
use parry3d::math::Vec2;

use super::EditorPanel;
use crate::studio::editor::Edit;

/// Distance of an arrow key, in millimetres, and with Shift.
const STEPS_MM: (f32, f32) = (1.0, 0.1);

/// Offset of copies to the right and away from the wearer, in millimetres.
const COPY_OFFSET_MM: [f64; 2] = [5.0, -5.0];

/// Handles the keys pressed since the last picture, unless they are typed into a field.
pub(super) fn handle(ui: &mut egui::Ui, panel: &mut EditorPanel) {
    let pressed = |modifiers, key| ui.input_mut(|input| input.consume_key(modifiers, key));
    if pressed(Modifiers::COMMAND, Key::S) {
        panel.save();
    }
    if ui.ctx().text_edit_focused() {
        return;
    }
    if pressed(Modifiers::COMMAND | Modifiers::SHIFT, Key::Z) || pressed(Modifiers::COMMAND, Key::Y)
    {
        panel.editor.redo();
    }
    if pressed(Modifiers::COMMAND, Key::Z) {
        panel.editor.undo();
    }
    if pressed(Modifiers::COMMAND, Key::A) {
        let count = panel.items.items.len();
        panel.selected.set(0..count);
        panel.select_items_in_editor();
    }
    if pressed(Modifiers::COMMAND, Key::D) {
        panel.duplicate();
    }
    if panel.selected.is_empty() {
        return;
    }
    if pressed(Modifiers::NONE, Key::Delete) {
        panel.delete();
    }
    if pressed(Modifiers::NONE, Key::Escape) {
        panel.selected.clear();
        panel.select_items_in_editor();
    }
    let arrows = [
        (Key::ArrowLeft, Vec2::NEG_X),
        (Key::ArrowRight, Vec2::X),
        (Key::ArrowUp, Vec2::Y),
        (Key::ArrowDown, Vec2::NEG_Y),
    ];
    for (key, direction) in arrows {
        if pressed(Modifiers::SHIFT, key) {
            panel.move_selected(direction * STEPS_MM.1);
        } else if pressed(Modifiers::NONE, key) {
            panel.move_selected(direction * STEPS_MM.0);
        }
    }
}

impl EditorPanel {
    /// Copies what is selected; the copies are selected then.
    pub(super) fn duplicate(&mut self) {
        let parts = self.editor.selection().to_vec();
        if !parts.is_empty() {
            self.apply(&Edit::Duplicate {
                parts,
                by_mm: COPY_OFFSET_MM,
            });
        }
    }

    /// Deletes what is selected.
    pub(super) fn delete(&mut self) {
        let parts = self.editor.selection().to_vec();
        if !parts.is_empty() {
            self.apply(&Edit::Delete { parts });
        }
    }
}
