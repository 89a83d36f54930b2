//! One field of the selected parts: its name, its value, and a button that restores the default.

use eframe::egui::{self, DragValue};

use super::EditorPanel;
use crate::editor::{Edit, FieldSpec, FieldType, Part, quoted};
use crate::panels::is_other_number;
use crate::texts::text;

/// Decimals of a number that is shown.
const DECIMALS: usize = 3;

/// The largest number of parts whose values are compared for each picture.
const MAX_COMPARED: usize = 200;

/// Width of a text, in points.
const TEXT_WIDTH: f32 = 150.0;

pub(super) fn show(ui: &mut egui::Ui, panel: &mut EditorPanel, parts: &[Part], field: &FieldSpec) {
    let first = parts[0];
    let is_row_key = matches!(first, Part::RowKey { .. });
    // The text of a key in a row is the row: the key has no fields of its own.
    let written = panel.editor.value(first, field.name).map(str::to_owned);
    let written = written.filter(|_| !is_row_key);
    let is_mixed = is_mixed(panel, parts, field.name);
    let label = ui.label(display_name(field.name));
    let label = label.on_hover_text(format!("{}: {}", field.name, field.help));
    match field.field_type {
        FieldType::Number { min, max } => {
            let value = written.as_deref().and_then(|value| value.parse().ok());
            let default = field.default.parse().ok();
            let old: f64 = value.or(default).unwrap_or(min);
            let mut number = old;
            let drag = DragValue::new(&mut number).range(min..=max);
            let drag = if is_mixed {
                drag.custom_formatter(|_, _| text("editor-mixed").to_owned())
            } else {
                drag.suffix(field.unit)
            };
            let speed = ((max - min) / 500.0).clamp(0.005, 1.0);
            let drag = ui
                .add(drag.speed(speed).max_decimals(DECIMALS))
                .labelled_by(label.id);
            if drag.changed() && is_other_number(old, number, DECIMALS) {
                let number = (number * 1000.0).round() / 1000.0;
                set_while_dragged(panel, parts, field.name, &number.to_string());
            }
            if !drag.dragged() && panel.is_field_dragged(field.name) {
                panel.form.dragged = None;
            }
        }
        FieldType::Bool => {
            let mut is_on = written.as_deref() == Some("true");
            let checkbox = egui::Checkbox::new(&mut is_on, "").indeterminate(is_mixed);
            if ui.add(checkbox).labelled_by(label.id).changed() {
                set(panel, parts, field.name, Some(is_on.to_string()));
            }
        }
        FieldType::Choice(choices) => {
            let shown = written.as_deref().unwrap_or(field.default);
            let shown = if is_mixed { "" } else { shown };
            if let Some(chosen) = show_choice(ui, field.name, shown, choices) {
                set(panel, parts, field.name, Some(chosen));
            }
        }
        FieldType::Text => {
            let value = written.as_deref().filter(|_| !is_mixed);
            let value = unquoted(value.unwrap_or_default());
            show_text(ui, panel, parts, field, &value, true);
        }
        FieldType::Point { .. }
        | FieldType::Outline
        | FieldType::Output
        | FieldType::Ron
        | FieldType::Action => {
            let value = written.clone().filter(|_| !is_mixed).unwrap_or_default();
            show_text(ui, panel, parts, field, &value, false);
        }
    }
    if is_mixed {
        ui.weak(text("editor-mixed"));
    } else if written.is_some() && field.name != "name" {
        let remove = ui
            .small_button("×")
            .on_hover_text(text("editor-remove-field"));
        remove.widget_info(|| {
            let name = text("editor-remove-field");
            egui::WidgetInfo::labeled(egui::Role::Button, true, name)
        });
        if remove.clicked() {
            set(panel, parts, field.name, None);
        }
    }
}

/// Returns the value that was chosen.
pub(super) fn show_choice(
    ui: &mut egui::Ui,
    name: &str,
    shown: &str,
    choices: &[&str],
) -> Option<String> {
    let word = |value: &str| {
        let end = value.find('(').unwrap_or(value.len());
        value[..end].trim_matches('"').to_owned()
    };
    let shown = word(shown);
    let mut chosen = None;
    let list = egui::ComboBox::from_id_salt(name).selected_text(&shown);
    list.show_ui(ui, |ui| {
        for choice in choices {
            let is_shown = word(choice) == shown;
            if ui.selectable_label(is_shown, word(choice)).clicked() && !is_shown {
                chosen = Some((*choice).to_owned());
            }
        }
    });
    chosen
}

/// Shows a text that becomes the value when the field is left.
fn show_text(
    ui: &mut egui::Ui,
    panel: &mut EditorPanel,
    parts: &[Part],
    field: &FieldSpec,
    value: &str,
    is_quoted: bool,
) {
    let name = field.name;
    let hint = Some(field.default).filter(|default| *default != "required");
    let Some(content) = text_cell(ui, panel, name, value, hint.unwrap_or_default()) else {
        return;
    };
    match (name, parts) {
        ("name", [part]) if *part != Part::Layout => panel.apply(&Edit::Rename {
            part: *part,
            name: content,
        }),
        _ if content.is_empty() => set(panel, parts, name, None),
        _ if is_quoted => set(panel, parts, name, Some(quoted(&content))),
        _ => set(panel, parts, name, Some(content)),
    }
}

/// Shows a text. Returns it when the field is left, if it was changed.
pub(super) fn text_cell(
    ui: &mut egui::Ui,
    panel: &mut EditorPanel,
    name: &str,
    value: &str,
    hint: &str,
) -> Option<String> {
    let id = ui.scope_id().with(name);
    let written = panel.form.text.clone().filter(|(own, _)| *own == id);
    let mut content = written.map_or_else(|| value.to_owned(), |(_, content)| content);
    let edit = egui::TextEdit::singleline(&mut content).hint_text(hint);
    // A grid gives a field the width that its column had before.
    let edit = ui.add_sized([TEXT_WIDTH, ui.spacing().interact_size.y], edit);
    edit.widget_info(|| egui::WidgetInfo::labeled(egui::Role::TextInput, true, name));
    if edit.has_focus() {
        panel.form.text = Some((id, content));
    } else if edit.lost_focus() {
        panel.form.text = None;
        return Some(content).filter(|content| content != value);
    }
    None
}

fn set(panel: &mut EditorPanel, parts: &[Part], field: &str, value: Option<String>) {
    panel.apply(&Edit::SetField {
        parts: parts.to_vec(),
        field: field.to_owned(),
        value,
    });
}

impl EditorPanel {
    /// Returns `true` while a number of this name is dragged.
    pub(super) fn is_field_dragged(&self, field: &str) -> bool {
        let dragged = self.form.dragged.as_ref();
        dragged.is_some_and(|(name, _)| *name == field)
    }
}

/// Returns whether parts have different values in a field.
fn is_mixed(panel: &EditorPanel, parts: &[Part], field: &str) -> bool {
    let value = |part: &Part| match part {
        // The text of a key in a row is the row.
        Part::RowKey { .. } => None,
        _ => panel.editor.value(*part, field),
    };
    let compared = &parts[..parts.len().min(MAX_COMPARED)];
    compared
        .windows(2)
        .any(|pair| value(&pair[0]) != value(&pair[1]))
}

fn set_while_dragged(panel: &mut EditorPanel, parts: &[Part], field: &'static str, value: &str) {
    edit_while_dragged(panel, parts, field, |parts| Edit::SetField {
        parts,
        field: field.to_owned(),
        value: Some(value.to_owned()),
    });
}

/// Makes the edit of a number; all values of one drag are one step of undo.
pub(super) fn edit_while_dragged(
    panel: &mut EditorPanel,
    parts: &[Part],
    field: &'static str,
    edit: impl Fn(Vec<Part>) -> Edit,
) {
    let before = panel.form.dragged.clone();
    let before = before.filter(|(name, _)| *name == field);
    let result = match before {
        Some((_, dragged_parts)) => panel.editor.amend(&edit(dragged_parts)),
        None => {
            panel.form.dragged = Some((field, parts.to_vec()));
            panel.editor.apply(&edit(parts.to_vec()))
        }
    };
    panel.report(result);
}

/// Returns the content of a text in quotes; any other value as it is.
pub(super) fn unquoted(written: &str) -> String {
    ron::from_str(written).unwrap_or_else(|_| written.trim_matches('"').to_owned())
}

/// Returns the name of a field as it is shown: without its unit, which stands behind its number.
fn display_name(field: &str) -> String {
    const UNITS: [&str; 6] = ["_mm_per_s", "_px_per_s", "_mm", "_deg", "_ms", "_hz"];
    let name = UNITS.iter().find_map(|unit| field.strip_suffix(unit));
    name.unwrap_or(field).replace('_', " ").replace('.', " · ")
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_name_of_a_field_is_shown_without_its_unit() {
        assert_eq!(display_name("travel_mm"), "travel");
        assert_eq!(display_name("pose.tilt_deg"), "pose · tilt");
        assert_eq!(display_name("press_at"), "press at");
    }
}
