//! The bar of the layout editor: boards, undo, save, arrangement.

use eframe::egui;

use super::{EditorPanel, icons, palette, plan, repeat};
use crate::editor::{AlignEdge, BoardAxis, ControlKind, Edit, NewPart, Part};
use crate::texts::{Language, language, text, text_with};

/// Distances between positions on the grid, in millimetres.
pub(super) const GRIDS_MM: [f32; 5] = [0.5, 1.0, 2.0, 5.0, 9.5];

/// Alignment of several parts: words, and edge.
pub(super) const ALIGNMENTS: [(&str, AlignEdge); 6] = [
    ("editor-align-left", AlignEdge::Left),
    ("editor-align-center", AlignEdge::CenterX),
    ("editor-align-right", AlignEdge::Right),
    ("editor-align-far", AlignEdge::Top),
    ("editor-align-middle", AlignEdge::CenterY),
    ("editor-align-near", AlignEdge::Bottom),
];

/// Distribution of several parts.
pub(super) const DISTRIBUTIONS: [(&str, BoardAxis); 2] = [
    ("editor-distribute-x", BoardAxis::X),
    ("editor-distribute-y", BoardAxis::Y),
];

/// Mirror images of parts.
pub(super) const MIRRORS: [(&str, BoardAxis); 2] = [
    ("editor-mirror-x", BoardAxis::X),
    ("editor-mirror-y", BoardAxis::Y),
];

/// Parts that are not on a board: words, and what is added.
pub(super) const NEW_PARTS: [(&str, NewPart); 6] = [
    ("editor-new-board", NewPart::Board { right_mm: 0.0 }),
    ("editor-new-layer", NewPart::Layer),
    ("editor-new-sequence", NewPart::Sequence),
    ("editor-new-trigger", NewPart::Trigger),
    ("editor-new-pointer", NewPart::Pointer),
    ("editor-new-space", NewPart::Space),
];

/// Smallest width of a message beside the tools, in points. With less room it has a row of its own.
const MIN_MESSAGE: f32 = 160.0;

pub(super) fn show(ui: &mut egui::Ui, panel: &mut EditorPanel) {
    ui.add_space(3.0);
    ui.horizontal_wrapped(|ui| {
        show_file(ui, panel);
        ui.separator();
        show_history(ui, panel);
        ui.separator();
        show_add(ui, panel);
        show_arrangement(ui, panel);
    });
    ui.horizontal_wrapped(|ui| {
        let is_open = panel.plan.is_open;
        let plan_tab = ui.selectable_label(is_open, text("editor-plan"));
        if plan_tab
            .on_hover_text(text("editor-plan-tab-hint"))
            .clicked()
            && !is_open
        {
            panel.open_plan();
        }
        if is_open {
            plan::show_views(ui, panel);
        }
        ui.separator();
        let tabs = show_boards(ui, panel, !panel.plan.is_open);
        for (board, tab) in tabs.iter().enumerate() {
            if tab.secondary_clicked() {
                panel.show_part(Part::Board(board));
            }
            palette::show_menu(tab, panel);
        }
        ui.separator();
        show_snapping(ui, panel);
        show_trial(ui, panel);
        show_message(ui, panel);
    });
    ui.add_space(2.0);
}

fn show_file(ui: &mut egui::Ui, panel: &mut EditorPanel) {
    ui.strong(panel.marked_name());
    if button(ui, text("editor-open"), text("editor-open-hint"), true) {
        panel.ask_for_layout();
    }
    if button(ui, text("editor-save"), text("editor-save-hint"), true) {
        panel.save();
    }
    if button(
        ui,
        text("editor-save-as"),
        text("editor-save-as-hint"),
        true,
    ) {
        panel.ask_for_path();
    }
}

fn show_history(ui: &mut egui::Ui, panel: &mut EditorPanel) {
    let can_undo = panel.editor.can_undo();
    if button(ui, text("editor-undo"), text("editor-undo-hint"), can_undo) {
        panel.undo();
    }
    let can_redo = panel.editor.can_redo();
    if button(ui, text("editor-redo"), text("editor-redo-hint"), can_redo) {
        panel.redo();
    }
}

fn show_add(ui: &mut egui::Ui, panel: &mut EditorPanel) {
    let row = ui.spacing().interact_size.y + ui.spacing().item_spacing.y;
    // With a row for the line between them, and one for the frame.
    let rows = ControlKind::ALL.len() + NEW_PARTS.len() + 2;
    let window = ui.ctx().content_rect();
    let is_higher = rows as f32 * row > window.height();
    let below = window.max.y - ui.cursor().min.y - 2.0 * row;
    ui.menu_button(text("editor-add"), |menu| {
        if is_higher {
            let area = egui::ScrollArea::vertical().max_height(below);
            area.show(menu, |inner| show_new(inner, panel));
        } else {
            show_new(menu, panel);
        }
    });
    let has_selection = !panel.editor.selection().is_empty();
    if button(
        ui,
        text("editor-duplicate"),
        text("editor-duplicate-hint"),
        has_selection,
    ) {
        panel.duplicate();
    }
    if button(
        ui,
        text("editor-delete"),
        text("editor-delete-hint"),
        has_selection,
    ) {
        panel.delete();
    }
}

/// Shows what can be added, in a menu.
fn show_new(ui: &mut egui::Ui, panel: &mut EditorPanel) {
    for &kind in ControlKind::ALL {
        if ui.button(kind_words(kind)).clicked() {
            panel.add_control(kind);
        }
    }
    ui.separator();
    for (name, part) in NEW_PARTS {
        if ui.button(text(name)).clicked() {
            panel.add(part);
        }
    }
}

/// Returns the words for a kind of control.
pub(super) fn kind_words(kind: ControlKind) -> &'static str {
    let [english, spanish] = kind.spec().words;
    match language() {
        Language::English => english,
        Language::Spanish => spanish,
    }
}

fn show_arrangement(ui: &mut egui::Ui, panel: &mut EditorPanel) {
    let count = panel.selected.len();
    ui.separator();
    for (hint, edge) in ALIGNMENTS {
        if icons::button(ui, icons::alignment(edge), text(hint), count >= 2) {
            let parts = panel.selected_parts();
            panel.apply(&Edit::Align { parts, edge });
        }
    }
    for (hint, axis) in DISTRIBUTIONS {
        if icons::button(ui, icons::distribution(axis), text(hint), count >= 3) {
            let parts = panel.selected_parts();
            panel.apply(&Edit::Distribute { parts, axis });
        }
    }
    for (hint, axis) in MIRRORS {
        if icons::button(ui, icons::mirror(axis), text(hint), count >= 1) {
            let parts = panel.selected_parts();
            panel.apply(&Edit::Mirror { parts, axis });
        }
    }
    repeat::show(ui, panel, count > 0);
}

fn show_snapping(ui: &mut egui::Ui, panel: &mut EditorPanel) {
    ui.checkbox(&mut panel.snaps, text("editor-snap"))
        .on_hover_text(text("editor-snap-hint"));
    let grid = egui::ComboBox::from_id_salt("editor-grid")
        .selected_text(format!("{} mm", panel.grid_mm))
        .width(70.0);
    let shown = grid.show_ui(ui, |ui| {
        for grid_mm in GRIDS_MM {
            ui.selectable_value(&mut panel.grid_mm, grid_mm, format!("{grid_mm} mm"));
        }
    });
    let name = text("editor-grid");
    shown
        .response
        .widget_info(|| egui::WidgetInfo::labeled(egui::Role::ComboBox, true, name));
    ui.checkbox(&mut panel.has_rulers, text("editor-rulers"))
        .on_hover_text(text("editor-rulers-hint"));
    if button(ui, text("editor-fit"), text("editor-fit-hint"), true) {
        panel.show_all();
    }
}

/// Shows the switch of the trial in the running session.
fn show_trial(ui: &mut egui::Ui, panel: &mut EditorPanel) {
    let Some(trial) = &mut panel.trial else {
        return;
    };
    ui.separator();
    let mut is_on = trial.is_on();
    let switch = ui.checkbox(&mut is_on, text("editor-try"));
    if switch.on_hover_text(text("editor-try-hint")).changed() {
        trial.set_on(is_on);
    }
}

impl EditorPanel {
    /// Returns the name of a board, or its number.
    pub(super) fn board_name(&self, board: usize) -> String {
        let name = self.editor.part_name(Part::Board(board));
        name.unwrap_or_else(|| text_with("editor-board", &[("number", (board + 1).into())]))
    }
}

/// Shows a tab for each board. `is_shown`: one of them is on the canvas. Returns the tabs.
pub fn show_boards(
    ui: &mut egui::Ui,
    panel: &mut EditorPanel,
    is_shown: bool,
) -> Vec<egui::Response> {
    let boards = 0..panel.editor.count("boards");
    let tabs = boards.map(|board| {
        let name = panel.board_name(board);
        let tab = ui.selectable_label(is_shown && panel.board == board, name);
        if tab.clicked() {
            panel.leave_plan(board);
        }
        tab
    });
    tabs.collect()
}

/// Shows the result of the last operation.
pub fn show_message(ui: &mut egui::Ui, panel: &EditorPanel) {
    // One line, so that a message does not move the board.
    let (message, color) = match &panel.message {
        Some(Ok(message)) => (*message, ui.visuals().weak_text_color()),
        Some(Err(message)) => (message.as_str(), ui.visuals().warn_fg_color),
        None => return,
    };
    let words = egui::RichText::new(message).color(color);
    let rest = ui.available_size_before_wrap().x - 1.0;
    let label = if rest < MIN_MESSAGE {
        egui::Label::new(words).truncate()
    } else {
        // In a row that wraps, a label may be as wide as the row, and takes a row of its own then.
        let truncate = Some(egui::TextWrapMode::Truncate);
        let words = egui::WidgetText::from(words);
        egui::Label::new(words.into_galley(ui, truncate, rest, egui::TextStyle::Body))
    };
    // A label that is shortened has its whole text as its hint.
    ui.add(label);
}

/// Shows a button with a hint. Returns `true` if it was clicked.
fn button(ui: &mut egui::Ui, name: &str, hint: &str, is_enabled: bool) -> bool {
    let button = ui.add_enabled(is_enabled, egui::Button::new(name));
    button.on_hover_text(hint).clicked()
}

#[cfg(test)]
mod tests {
    use eframe::egui::accesskit::Role;
    use egui_kittest::kittest::Queryable;

    use super::super::tests::{TWO_KEYS, Window};
    use super::*;

    #[test]
    fn all_that_can_be_added_is_reached_in_a_low_window() {
        let mut window = Window::on_text(TWO_KEYS, 320.0);
        window.click_button(text("editor-add"));
        window.harness.run_steps(2);
        let name = text("editor-new-space");
        let last = window.harness.get_by_role_and_label(Role::Button, name);
        last.scroll_to_me();
        window.harness.run_steps(3);
        let shown = window.harness.get_by_role_and_label(Role::Button, name);
        let entry = shown.rect();
        let screen = window.harness.ctx.content_rect();
        assert!(screen.contains_rect(entry), "{entry} in {screen}");
        window.click(entry.center());
        assert_eq!(window.panel().editor.count("spaces"), 1);
    }

    #[test]
    fn a_long_message_is_in_the_row_of_the_tools() {
        let mut window = Window::open();
        let message = ["as much as has no room in one row"; 20].join(", ");
        window.panel().message = Some(Err(message.clone()));
        window.harness.run_steps(2);
        let tool = window.harness.get_by_label(text("editor-rulers")).rect();
        let shown = window.harness.get_by_label(&message).rect();
        let middle = shown.center().y;
        assert!(tool.y_range().contains(middle), "{shown} beside {tool}");
        assert!(shown.min.x > tool.max.x, "{shown} beside {tool}");
    }
}
