//! Saving, the questions before something is lost, and changes by other programs.

use std::mem;
use std::path::PathBuf;
use std::time::Duration;

use eframe::egui::{self, Key};

use super::EditorPanel;
use crate::editor::{Change, Edit, FileState, Resolution, SaveError, Severity};
use crate::texts::text;

/// Time between two looks at the file.
const POLL_PERIOD: Duration = Duration::from_millis(500);

/// A name that is written to save a copy.
#[derive(Default)]
pub(super) struct SaveAs {
    pub path: String,
    /// The file exists; a second click replaces it.
    may_replace: bool,
    /// The window closes after the copy is saved.
    then_close: bool,
    /// The field has had the focus, which it gets at first.
    is_begun: bool,
    /// The field or one of its buttons had the focus in the last frame.
    pub has_focus: bool,
}

/// A save of a layout with errors, until it is answered.
#[derive(Default)]
pub(super) struct SaveQuestion {
    /// The window closes after the save.
    then_close: bool,
}

/// The largest number of errors that the question about a save lists.
const MAX_LISTED: usize = 4;

/// Draws what needs an answer.
pub(super) fn show(ui: &mut egui::Ui, panel: &mut EditorPanel) {
    poll(ui, panel);
    show_recovery(ui, panel);
    if panel.editor.conflict().is_some() {
        ask(ui, |ui| {
            ui.colored_label(ui.visuals().warn_fg_color, text("editor-changed-outside"));
            if ui.button(text("editor-keep-mine")).clicked() {
                panel.editor.resolve(Resolution::KeepMine);
                panel.message = None;
            }
            if ui.button(text("editor-take-theirs")).clicked() {
                panel.editor.resolve(Resolution::TakeTheirs);
                panel.message = None;
            }
        });
    }
    show_save_question(ui, panel);
    if panel.save_as.is_some() {
        ask(ui, |ui| show_save_as(ui, panel));
    }
}

fn ask(ui: &mut egui::Ui, content: impl FnOnce(&mut egui::Ui)) {
    ui.separator();
    ui.horizontal_wrapped(content);
    ui.add_space(3.0);
}

fn poll(ui: &egui::Ui, panel: &mut EditorPanel) {
    let now = ui.input(|input| input.time);
    // A drag ends before the file is read again, and both changes are merged then.
    if now < panel.next_poll || panel.is_dragging(ui) {
        return;
    }
    panel.next_poll = now + POLL_PERIOD.as_secs_f64();
    if panel.editor.has_changed_outside() {
        // The change may give the part that is typed for another place.
        panel.commit_drafts();
    }
    match panel.editor.poll() {
        Some(Change::Reloaded) => panel.message = Some(Ok(text("editor-reloaded"))),
        Some(Change::Merged) => panel.message = Some(Ok(text("editor-merged"))),
        Some(Change::Unreadable(error)) => panel.message = Some(Err(error.to_string())),
        Some(Change::Conflict) | None => {}
    }
    if let Some(error) = panel.editor.recovery_error() {
        panel.message = Some(Err(error));
    }
}

fn show_recovery(ui: &mut egui::Ui, panel: &mut EditorPanel) {
    if panel.editor.found_work().is_none() {
        return;
    }
    ask(ui, |ui| {
        ui.colored_label(ui.visuals().warn_fg_color, text("editor-recovered"));
        if ui.button(text("editor-restore")).clicked() {
            panel.commit_drafts();
            panel.editor.restore_found_work();
        }
        if ui.button(text("editor-discard")).clicked() {
            panel.editor.discard_found_work();
        }
    });
}

fn show_save_as(ui: &mut egui::Ui, panel: &mut EditorPanel) {
    let Some(mut save_as) = panel.save_as.take() else {
        return;
    };
    let label = ui.label(text("editor-save-path"));
    let field = egui::TextEdit::singleline(&mut save_as.path).desired_width(320.0);
    let field = ui.add(field).labelled_by(label.id);
    if field.changed() {
        save_as.may_replace = false;
    }
    if !mem::replace(&mut save_as.is_begun, true) {
        field.request_focus();
    }
    let is_pressed = |key| ui.input(|input| input.key_pressed(key));
    if save_as.has_focus && is_pressed(Key::Escape) {
        return;
    }
    let path = PathBuf::from(save_as.path.trim());
    let is_file = path.file_name().is_some() && !path.is_dir();
    let is_entered = field.lost_focus() && is_pressed(Key::Enter);
    if is_entered && !is_file {
        field.request_focus();
    }
    let words = match (save_as.may_replace, panel.editor.is_valid()) {
        (true, _) => text("editor-replace"),
        (false, true) => text("editor-save"),
        (false, false) => text("editor-save-anyway"),
    };
    if !panel.editor.is_valid() {
        ui.colored_label(ui.visuals().warn_fg_color, text("editor-cannot-run"));
    }
    let button = ui.add_enabled(is_file, egui::Button::new(words));
    let button = button.on_disabled_hover_text(text("editor-save-needs-name"));
    let is_saved = button.clicked() || is_entered && is_file;
    let cancel = ui.button(text("editor-cancel"));
    if cancel.clicked() {
        return;
    }
    save_as.has_focus = field.has_focus() || button.has_focus() || cancel.has_focus();
    if !is_saved {
        panel.save_as = Some(save_as);
        return;
    }
    if !panel.commit_drafts() {
        panel.save_as = Some(save_as);
        return;
    }
    match panel.editor.save_as(&path, save_as.may_replace) {
        Ok(()) => {
            panel.message = Some(Ok(panel.saved_message()));
            if save_as.then_close {
                close(ui, panel);
            }
        }
        Err(error) => {
            save_as.may_replace = matches!(error, SaveError::Exists(_));
            panel.message = Some(Err(error.to_string()));
            panel.save_as = Some(save_as);
        }
    }
}

/// Asks whether a layout is saved that no session can use.
fn show_save_question(ui: &mut egui::Ui, panel: &mut EditorPanel) {
    let Some(question) = &panel.save_question else {
        return;
    };
    let then_close = question.then_close;
    let problems = panel.editor.problems().iter();
    let errors = problems.filter(|problem| problem.severity == Severity::Error);
    let errors: Vec<String> = errors.map(|problem| problem.message.clone()).collect();
    let modal = egui::Modal::new(egui::Id::unique("save-question"));
    let shown = modal.show(ui.ctx(), |ui| {
        ui.strong(text("editor-cannot-run"));
        for error in errors.iter().take(MAX_LISTED) {
            ui.label(error);
        }
        if errors.len() > MAX_LISTED {
            ui.label("…");
        }
        ui.add_space(8.0);
        ui.horizontal(|ui| {
            if ui.button(text("editor-save-anyway")).clicked() {
                panel.save_question = None;
                if panel.save_as_it_is() && then_close {
                    close(ui, panel);
                }
            }
            if ui.button(text("editor-close-cancel")).clicked() {
                panel.save_question = None;
            }
        });
    });
    if shown.should_close() {
        panel.save_question = None;
    }
}

/// Closes the window. A text that was refused stays in its field, and asks no second time.
fn close(ui: &egui::Ui, panel: &mut EditorPanel) {
    panel.permit_close();
    ui.ctx().send_viewport_cmd(egui::ViewportCommand::Close);
}

/// Asks before the window closes with unsaved work. Returns `true` if the save before that waits for something that only the editor
/// shows, such as the name of a file.
pub(in super::super) fn guard_close(ui: &mut egui::Ui, panel: &mut EditorPanel) -> bool {
    let is_requested = ui.input(|input| input.viewport().close_requested());
    if is_requested {
        panel.commit_drafts();
        // In other tabs it is not looked at.
        panel.next_poll = 0.0;
        poll(ui, panel);
    }
    if is_requested && panel.is_unsaved() && !panel.may_close {
        ui.ctx()
            .send_viewport_cmd(egui::ViewportCommand::CancelClose);
        panel.is_close_asked = true;
    }
    if !panel.is_close_asked {
        return false;
    }
    let mut is_waiting = false;
    let modal = egui::Modal::new(egui::Id::unique("close-question"));
    let shown = modal.show(ui.ctx(), |ui| {
        ui.strong(text("editor-close-question"));
        ui.add_space(8.0);
        ui.horizontal(|ui| {
            if ui.button(text("editor-close-save")).clicked() {
                panel.is_close_asked = false;
                is_waiting = !panel.save();
                if !is_waiting {
                    close(ui, panel);
                } else if let Some(question) = &mut panel.save_question {
                    question.then_close = true;
                } else if let Some(save_as) = &mut panel.save_as {
                    save_as.then_close = true;
                }
            }
            if ui.button(text("editor-close-discard")).clicked() {
                panel.editor.discard_unsaved_work();
                panel.is_close_asked = false;
                close(ui, panel);
            }
            if ui.button(text("editor-close-cancel")).clicked() {
                panel.is_close_asked = false;
            }
        });
    });
    if shown.should_close() {
        panel.is_close_asked = false;
    }
    is_waiting
}

/// Keeps what is typed or dragged in the recovery file, as it would be in the text.
pub(in super::super) fn keep_unfinished(ui: &egui::Ui, panel: &mut EditorPanel) {
    let now = ui.input(|input| input.time);
    if now < panel.next_keep || panel.may_close {
        if panel.form.drafts.has_changes() || panel.gesture.is_some() {
            ui.ctx().request_repaint_after(POLL_PERIOD);
        }
        return;
    }
    panel.next_keep = now + POLL_PERIOD.as_secs_f64();
    let edits = panel.unfinished_edits();
    let kept = (panel.editor.revision(), edits);
    let (_, kept_edits) = &panel.kept;
    let is_new = panel.kept != kept && !(kept.1.is_empty() && kept_edits.is_empty());
    if is_new {
        panel.editor.keep_with(&kept.1);
        panel.kept = kept;
    }
}

impl EditorPanel {
    /// Returns `true` while a button of the mouse is down or its drag is not finished.
    fn is_dragging(&mut self, ui: &egui::Ui) -> bool {
        let is_down = ui.input(|input| input.pointer.any_down());
        if !is_down {
            // Its row may have gone during the drag.
            self.form.dragged = None;
        }
        is_down
            || self.gesture.is_some()
            || self.dragged_radius.is_some()
            || self.form.dragged.is_some()
            || self.plan.is_dragging()
    }

    /// Returns the edits of everything that is typed or dragged and is not in the text yet.
    fn unfinished_edits(&self) -> Vec<Edit> {
        let mut edits = self.form.drafts.edits();
        edits.extend(self.edit_of_drag());
        edits
    }

    /// Writes the file, or asks for one, or whether a layout that cannot be used is saved. Returns `false` if the text is not saved
    /// yet.
    pub(super) fn save(&mut self) -> bool {
        if !self.commit_drafts() {
            return false;
        }
        if !self.editor.is_valid() && self.editor.path().is_some() {
            self.save_question = Some(SaveQuestion::default());
            return false;
        }
        self.save_as_it_is()
    }

    /// Returns the message after a save.
    fn saved_message(&self) -> &'static str {
        if self.editor.is_valid() {
            text("editor-saved")
        } else {
            text("editor-saved-with-errors")
        }
    }

    fn save_as_it_is(&mut self) -> bool {
        match self.editor.save() {
            Ok(()) => {
                self.message = Some(Ok(self.saved_message()));
                true
            }
            Err(error) => {
                if matches!(error, SaveError::NoFile) {
                    self.ask_for_path();
                }
                self.message = Some(Err(error.to_string()));
                false
            }
        }
    }

    /// Asks for the name of a copy. A name that is being written stays, and gets the focus.
    pub(super) fn ask_for_path(&mut self) {
        if let Some(save_as) = &mut self.save_as {
            save_as.is_begun = false;
            return;
        }
        let path = match self.editor.path() {
            Some(path) => path.to_string_lossy().into_owned(),
            None => format!("my-{}.ron", self.last_name().trim_end_matches(".ron")),
        };
        self.save_as = Some(SaveAs {
            path,
            ..SaveAs::default()
        });
    }

    /// Returns the last part of the name of the layout, which may be a path of another system.
    pub(super) fn last_name(&self) -> &str {
        let name = self.editor.name().rsplit(['/', '\\']).next();
        name.unwrap_or_default()
    }

    /// Returns `true` if unsaved work would be lost with another layout in place of this one.
    pub fn would_lose_work(&self) -> bool {
        self.is_unsaved() && !self.editor.keeps_unsaved_work()
    }

    /// Returns `true` while the question is shown whether unsaved work is saved before the window closes.
    pub fn asks_before_close(&self) -> bool {
        self.is_close_asked
    }

    /// Asks again before the window closes, which something else has kept open, and keeps unsaved work again.
    pub fn stay_open(&mut self) {
        if mem::take(&mut self.may_close) {
            self.editor.keep_with(&[]);
        }
    }

    /// Lets the window close without a question.
    pub fn permit_close(&mut self) {
        self.may_close = true;
    }

    /// Returns `true` if closing the window would lose work, such as a value that is typed. An untouched copy of a shipped layout is
    /// none.
    pub fn is_unsaved(&self) -> bool {
        if self.form.drafts.has_changes() {
            return true;
        }
        match self.editor.file_state() {
            FileState::Saved => false,
            FileState::Modified => true,
            FileState::Unsaved => self.editor.is_modified(),
        }
    }
}
