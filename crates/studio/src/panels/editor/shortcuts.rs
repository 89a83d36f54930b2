//! The keys of the layout editor.

use std::mem;

use eframe::egui::{self, Event, Key, Modifiers};
use parry3d::math::Vec2;

use super::{EditorPanel, free_view};
use crate::canvas::plan::PlanView;
use crate::editor::Part;

/// Distance of an arrow key with Shift, in millimetres. Without Shift, it is the spacing of the grid.
pub(super) const FINE_STEP_MM: f32 = 0.1;

/// The arrow keys: sign, direction, and words.
pub(super) const ARROWS: [(Key, &str, Vec2, &str); 4] = [
    (Key::ArrowLeft, "←", Vec2::NEG_X, "editor-nudge-left"),
    (Key::ArrowRight, "→", Vec2::X, "editor-nudge-right"),
    (Key::ArrowUp, "↑", Vec2::Y, "editor-nudge-up"),
    (Key::ArrowDown, "↓", Vec2::NEG_Y, "editor-nudge-down"),
];

/// Pause after which the next tap of an arrow key is a step of undo of its own, in seconds.
const NUDGE_PAUSE_S: f64 = 1.0;

/// Taps of an arrow key that are one step of undo.
pub(super) struct Nudge {
    direction: Vec2,
    /// Distance so far, in millimetres.
    total: Vec2,
    /// The view of all boards, whose axes are others.
    view: Option<PlanView>,
    /// The parts as they were before.
    parts: Vec<Part>,
    /// Time of the last tap, in seconds.
    time: f64,
    /// Revision of the text and selection after it. With others, the last edit does not belong to the taps.
    revision: u64,
    selection: Vec<Part>,
}

/// Handles the keys pressed since the last frame, unless they are typed into a field or answer a question. Escape in a field
/// discards what is typed.
pub(super) fn handle(ui: &mut egui::Ui, panel: &mut EditorPanel) {
    let was_typing = mem::replace(&mut panel.is_typing, ui.ctx().text_edit_focused());
    if is_asked(ui) {
        return;
    }
    // The focus has left the field by now.
    let ends_typing = was_typing || panel.form.drafts.is_typing();
    if ends_typing && ui.input(|input| input.key_pressed(Key::Escape)) {
        panel.discard_drafts();
    }
    let pressed = |modifiers, key| ui.input_mut(|input| input.consume_key(modifiers, key));
    if pressed(Modifiers::COMMAND, Key::S) {
        panel.save();
    }
    if pressed(Modifiers::COMMAND, Key::O) {
        panel.ask_for_layout();
    }
    if pressed(Modifiers::COMMAND, Key::K) {
        panel.palette.toggle();
    }
    // A menu and the palette take their own keys, and act on what is selected.
    if panel.palette.is_open() || egui::Popup::is_any_open(ui.ctx()) {
        return;
    }
    if ui.ctx().text_edit_focused() {
        // A field undoes what is typed into it.
        if panel.form.has_focus && !panel.form.drafts.has_changes() {
            undo_and_redo(ui, panel);
        }
        return;
    }
    // A window, and the name of a copy, take their own Escape unless something is dragged.
    let is_dragging = panel.plan.is_dragging() || panel.is_dragging_on_canvas();
    let has_name = panel.save_as.as_ref().is_some_and(|asked| asked.has_focus);
    let is_covered = (panel.is_covered || has_name) && !is_dragging;
    let can_escape = panel.can_escape() && !is_covered && !ends_typing;
    if can_escape && pressed(Modifiers::NONE, Key::Escape) {
        panel.escape();
    }
    if panel.plan.is_dragging() || panel.is_dragging_on_canvas() {
        // Its edit is the last one until it ends.
        return;
    }
    undo_and_redo(ui, panel);
    if pressed(Modifiers::COMMAND, Key::A) {
        panel.select_all();
    }
    if pressed(Modifiers::COMMAND, Key::D) {
        panel.duplicate();
    }
    if pressed(Modifiers::NONE, Key::F) {
        panel.zoom_to_selection();
    }
    handle_clipboard(ui, panel);
    free_view::turn_by_keys(ui, panel);
    if panel.is_nothing_selected() {
        return;
    }
    if pressed(Modifiers::NONE, Key::Delete) {
        panel.delete();
    }
    // Several taps may come with one frame.
    let count = |modifiers, key| ui.input_mut(|input| input.count_and_consume_key(modifiers, key));
    let mut way = Vec2::ZERO;
    for (key, _, direction, _) in ARROWS {
        way += direction * (count(Modifiers::SHIFT, key) as f32 * FINE_STEP_MM);
        way += direction * (count(Modifiers::NONE, key) as f32 * panel.grid_mm);
    }
    if way != Vec2::ZERO {
        let now = ui.input(|input| input.time);
        panel.nudge(way, now);
    }
}

/// Undoes an edit for each press of the key since the last frame, and makes one again.
fn undo_and_redo(ui: &egui::Ui, panel: &mut EditorPanel) {
    let count = |modifiers, key| ui.input_mut(|input| input.count_and_consume_key(modifiers, key));
    let redone =
        count(Modifiers::COMMAND | Modifiers::SHIFT, Key::Z) + count(Modifiers::COMMAND, Key::Y);
    for _ in 0..redone {
        panel.redo();
    }
    for _ in 0..count(Modifiers::COMMAND, Key::Z) {
        panel.undo();
    }
}

impl EditorPanel {
    /// Returns `true` if nothing is selected on the board or the plan.
    pub(super) fn is_nothing_selected(&self) -> bool {
        if self.plan.is_open {
            self.editor.selection().is_empty()
        } else {
            self.selected.is_empty()
        }
    }

    /// Moves what is selected. Taps of one arrow key without a pause are one step of undo.
    pub(super) fn nudge(&mut self, way: Vec2, now: f64) {
        self.commit_drafts();
        let direction = way.normalize();
        let view = self.plan.is_open.then_some(self.plan.view);
        let before = self.nudge.take().filter(|nudge| {
            nudge.direction == direction
                && nudge.view == view
                && now - nudge.time < NUDGE_PAUSE_S
                && nudge.revision == self.editor.revision()
                && nudge.selection == self.editor.selection()
        });
        let is_first = before.is_none();
        let (parts, total) = match before {
            Some(nudge) => (nudge.parts, nudge.total + way),
            None if self.plan.is_open => (self.selected_in_plan(), way),
            None => (self.selected_parts(), way),
        };
        let Some(edit) = self.movement(parts.clone(), total) else {
            return;
        };
        let result = if is_first {
            self.editor.apply(&edit)
        } else {
            self.editor.amend(&edit)
        };
        if result.is_ok() {
            self.nudge = Some(Nudge {
                direction,
                total,
                view,
                parts,
                time: now,
                revision: self.editor.revision(),
                selection: self.editor.selection().to_vec(),
            });
        }
        self.report(result);
    }
}

/// Returns `true` if a question waits for an answer, which gets all keys.
pub(in super::super) fn is_asked(ui: &egui::Ui) -> bool {
    ui.ctx().memory(|memory| memory.top_modal_layer().is_some())
}

/// Copies, cuts and pastes controls as text, which another window or an editor of text takes, too.
fn handle_clipboard(ui: &egui::Ui, panel: &mut EditorPanel) {
    let events = ui.input(|input| input.events.clone());
    for event in events {
        match event {
            Event::Copy => panel.copy(ui.ctx()),
            Event::Cut => panel.cut(ui.ctx()),
            Event::Paste(text) => panel.paste(text),
            _ => {}
        }
    }
}

#[cfg(test)]
mod tests {
    use super::super::tests::{TWO_KEYS, Window};
    use super::*;
    use crate::editor::ControlKind;
    use crate::texts::{Language, set_language, text};

    #[test]
    fn each_of_several_undos_of_one_frame_acts() {
        let mut window = Window::open();
        for _ in 0..2 {
            window.panel().add_control(ControlKind::Key);
        }
        let undo = Event::Key {
            key: Key::Z,
            physical_key: None,
            pressed: true,
            repeat: false,
            modifiers: Modifiers::COMMAND,
        };
        let events = &mut window.harness.input_mut().events;
        events.extend([undo.clone(), undo]);
        window.harness.run_steps(1);
        assert_eq!(window.text(), TWO_KEYS);
    }

    #[test]
    fn the_hint_of_the_board_names_the_steps_of_the_arrow_keys() {
        let fine = format!("{FINE_STEP_MM} mm");
        for language in Language::ALL {
            set_language(language);
            let hint = text("editor-hint").replace(',', ".");
            let grid = text("editor-grid").to_lowercase();
            assert!(hint.contains(&grid) && hint.contains(&fine), "{hint}");
        }
    }
}
