//! The question before the window closes while the calibration of the glove is not saved.

use eframe::egui;

use super::table::SENSORS;
use super::{PanelContext, PanelState, WatchChange, Workspace};
use crate::texts::text;

/// The question between two frames.
#[derive(Default)]
pub(super) struct CloseQuestion {
    is_asked: bool,
    /// The window may close without the calibration.
    may_close: bool,
}

impl CloseQuestion {
    /// Lets the window close without a question.
    pub fn permit_close(&mut self) {
        self.may_close = true;
    }
}

/// An answer to the question.
#[derive(Clone, Copy)]
enum Answer {
    Save,
    Discard,
    Stay,
}

/// Asks before the window closes, unless the editor asks about its layout first.
pub(super) fn guard(ui: &egui::Ui, state: &mut PanelState, context: &mut PanelContext) {
    let is_changed = context.sensors.is_unsaved();
    let is_requested = ui.input(|input| input.viewport().close_requested());
    let layout_asks = match &state.editor {
        Some(Ok(layout)) => layout.asks_before_close(),
        Some(Err(_)) | None => false,
    };
    let question = &mut state.close_question;
    if is_requested && is_changed && !question.may_close && !layout_asks {
        let cancel = egui::ViewportCommand::CancelClose;
        ui.ctx().send_viewport_cmd(cancel);
        question.is_asked = true;
    }
    if !question.is_asked {
        return;
    }
    let Some(answer) = show(ui) else {
        return;
    };
    question.is_asked = false;
    let is_saved = matches!(answer, Answer::Save) && context.sensors.save(false);
    if is_saved || matches!(answer, Answer::Discard) {
        question.permit_close();
        ui.ctx().send_viewport_cmd(egui::ViewportCommand::Close);
        return;
    }
    if let Some(Ok(layout)) = &mut state.editor {
        layout.stay_open();
    }
    if matches!(answer, Answer::Save) {
        // The question whether a file is replaced, or the reason why it cannot be written, is there.
        state.workspace = Workspace::Hand;
        if context.watched.is_some() {
            // The panel is of the session.
            *context.watch = Some(WatchChange::End);
        }
        if !state.shows(SENSORS) {
            state.toggle(SENSORS);
        }
    }
}

/// Shows the question. Returns the answer, once there is one.
fn show(ui: &egui::Ui) -> Option<Answer> {
    let mut answer = None;
    let modal = egui::Modal::new(egui::Id::unique("glove-close-question"));
    let shown = modal.show(ui.ctx(), |content| {
        content.strong(text("glove-close-question"));
        content.add_space(8.0);
        content.horizontal(|row| {
            for (name, own) in [
                ("editor-close-save", Answer::Save),
                ("editor-close-discard", Answer::Discard),
                ("editor-close-cancel", Answer::Stay),
            ] {
                if row.button(text(name)).clicked() {
                    answer = Some(own);
                }
            }
        });
    });
    answer.or(shown.should_close().then_some(Answer::Stay))
}
