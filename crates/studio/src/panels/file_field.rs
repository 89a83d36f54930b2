//! A field for the path of a file, with a button.

use eframe::egui::{self, Key};

use crate::texts::text;

/// Shows the field below its label, `width` points wide with its button. `label` and `button` are keys of texts. Returns the path that
/// the button or Enter confirms.
pub(super) fn show(
    ui: &mut egui::Ui,
    width: f32,
    label: &'static str,
    button: &'static str,
    path: &mut String,
) -> Option<String> {
    let label = ui.label(text(label));
    let row = ui.horizontal(|ui| {
        let field = egui::TextEdit::singleline(path).desired_width(width - 70.0);
        let field = ui.add(field).labelled_by(label.id);
        let is_entered = field.lost_focus() && ui.input(|input| input.key_pressed(Key::Enter));
        let is_opened = ui.button(text(button)).clicked();
        is_entered || is_opened
    });
    let path = path.trim();
    (row.inner && !path.is_empty()).then(|| path.to_owned())
}
