//! The trial of the edited text in the running session.

use std::time::Duration;

use eframe::egui;

use super::super::PanelContext;
use super::EditorPanel;
use crate::editor::EditorTrial;
use crate::typing::Typing;

/// Makes the running session use the text while it is edited; only on request if the session types into other programs.
pub(in super::super) fn advance_trial(
    ui: &egui::Ui,
    panel: &mut EditorPanel,
    context: &PanelContext,
) {
    let Some(session) = context.trial else {
        return;
    };
    let editor = &panel.editor;
    let left = panel.left_trial.take();
    let trial = panel.trial.get_or_insert_with(|| {
        let is_on = Typing::new(context.session) == Typing::Nowhere;
        match left {
            Some(left) => left.go_on(editor, is_on),
            None => EditorTrial::new(&context.session.view.layout, editor, is_on),
        }
    });
    let now = Duration::from_secs_f64(ui.input(|input| input.time));
    if let Some(refusal) = trial.advance(now, editor, session) {
        panel.message = Some(Err(refusal));
    }
}
