//! The board of the editor with a color over each control: how often it was missed.

use eframe::egui;

use super::super::PanelContext;
use super::super::editor::{BoardHeat, EditorPanel, show_boards, show_heat, show_message};
use super::LabState;
use crate::texts::text;

pub(super) fn show(
    ui: &mut egui::Ui,
    state: &LabState,
    editor: &mut EditorPanel,
    context: &PanelContext,
) {
    ui.add_space(4.0);
    ui.horizontal_wrapped(|ui| {
        ui.add_space(6.0);
        ui.strong(editor.editor.name().to_owned());
        show_boards(ui, editor, true);
        show_message(ui, editor);
    });
    let heats = match &state.shown {
        // The controls of another text are others.
        Some(shown) if shown.outcome.is_of(editor.editor.text()) => &shown.heats[..],
        _ => &[],
    };
    let hint = match (heats.is_empty(), &state.shown) {
        (false, _) => text("lab-heat-hint"),
        (true, Some(_)) => text("lab-stale"),
        (true, None) => text("lab-no-results"),
    };
    show_heat(ui, editor, context, BoardHeat { heats, hint });
}
