//! A field for the path of a file or the name of a source, with a button.

use eframe::egui::{self, Key};

use super::look;
use crate::texts::text;

/// Width of the button with the space before it, in points.
const BUTTON_WIDTH: f32 = 70.0;

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
    let field = egui::TextEdit::singleline(path).desired_width(width - BUTTON_WIDTH);
    let row = ui.horizontal(|ui| {
        look::draw_lines(ui);
        is_confirmed(ui, field, &label, button)
    });
    confirmed(row.inner, path)
}

/// Shows the field in a row with its label, which was drawn before, as wide as there is room. `hint` and `button` are keys of texts.
/// Returns the path that the button or Enter confirms.
pub(super) fn show_beside(
    ui: &mut egui::Ui,
    label: &egui::Response,
    (hint, button): (&'static str, &'static str),
    path: &mut String,
) -> Option<String> {
    let field = egui::TextEdit::singleline(path)
        .id(id(hint))
        .hint_text(text(hint))
        .desired_width(ui.available_width() - BUTTON_WIDTH);
    let is_confirmed = is_confirmed(ui, field, label, button);
    confirmed(is_confirmed, path)
}

/// Returns the identity of a field in a row, which may get the focus, by the key of its hint.
pub(super) fn id(hint: &str) -> egui::Id {
    egui::Id::unique(("file_field", hint))
}

fn is_confirmed(
    ui: &mut egui::Ui,
    field: egui::TextEdit,
    label: &egui::Response,
    button: &'static str,
) -> bool {
    let field = ui.add(field).labelled_by(label.id);
    let is_entered = field.lost_focus() && ui.input(|input| input.key_pressed(Key::Enter));
    let is_clicked = ui.button(text(button)).clicked();
    is_entered || is_clicked
}

fn confirmed(is_confirmed: bool, path: &str) -> Option<String> {
    let path = path.trim();
    (is_confirmed && !path.is_empty()).then(|| path.to_owned())
}
