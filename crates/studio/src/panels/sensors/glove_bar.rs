//! The file of the glove: undo, redo, save, and the question before a file is replaced.

use eframe::egui;

use crate::glove_editor::GloveEditor;
use crate::panels::PanelContext;
use crate::sensor_control::SensorControl;
use crate::texts::{text, text_with};
use ademan_core::message::escape_path;

pub(super) fn show(ui: &mut egui::Ui, context: &mut PanelContext) {
    let sensors = &mut *context.sensors;
    let Some(editor) = &sensors.editor else {
        return;
    };
    let (name, is_changed) = (editor.glove().name.clone(), editor.is_changed());
    let (can_undo, can_redo) = (editor.can_undo(), editor.can_redo());
    let mark = if is_changed {
        text("glove-unsaved")
    } else {
        ""
    };
    ui.add(egui::Label::new(format!("{name} {mark}")).truncate());
    ui.horizontal(|ui| {
        let mut button = |is_enabled, words, hint: &str| {
            let button = ui.add_enabled(is_enabled, egui::Button::new(words));
            button.on_hover_text(hint).clicked()
        };
        let file = sensors.file().map(escape_path);
        if button(is_changed, text("glove-save"), &file.unwrap_or_default()) {
            sensors.save(false);
        }
        if button(can_undo, text("glove-undo"), text("glove-undo-hint")) {
            sensors.edit(GloveEditor::undo);
        }
        if button(can_redo, text("glove-redo"), text("glove-redo-hint")) {
            sensors.edit(GloveEditor::redo);
        }
    });
    show_question(ui, sensors);
    if let Some(notice) = &sensors.notice {
        ui.weak(notice);
    }
    if let Some(message) = &sensors.message {
        ui.colored_label(ui.visuals().error_fg_color, message);
    }
}

/// Shows the question whether to replace a file, if there is one. Returns `true` if the file was saved.
pub(in crate::panels) fn show_question(ui: &mut egui::Ui, sensors: &mut SensorControl) -> bool {
    let (Some(file), Some(backup)) = (sensors.question(), sensors.backup()) else {
        return false;
    };
    let [file, backup] = [file, &*backup].map(escape_path);
    let values = [("file", file.into()), ("backup", backup.into())];
    let question = text_with("glove-replace", &values);
    let mut is_saved = false;
    egui::Frame::group(ui.style()).show(ui, |ui| {
        ui.label(question);
        ui.horizontal(|ui| {
            if ui.button(text("button-replace")).clicked() {
                is_saved = sensors.save(true);
            }
            if ui.button(text("button-cancel")).clicked() {
                sensors.keep_file();
            }
        });
    });
    is_saved
}
