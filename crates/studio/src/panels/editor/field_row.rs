//! One field of the selected parts: its name, its value, and a button that restores the default.

use std::ops::RangeInclusive;

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
            let number = Number {
                name: field.name,
                label: label.id,
                old,
                is_mixed,
                range: min..=max,
                speed: ((max - min) / 500.0).clamp(0.005, 1.0),
                decimals: DECIMALS,
                unit: field.unit,
            };
            number_cell(ui, panel, parts, &number, |parts, number| Edit::SetField {
                parts,
                field: field.name.to_owned(),
                value: Some(number.to_string()),
            });
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
    text_cell(
        ui,
        panel,
        name,
        (value, hint.unwrap_or_default()),
        |content| {
            let written = match (name, parts) {
                ("name", [part]) if *part != Part::Layout => {
                    let part = *part;
                    return Edit::Rename {
                        part,
                        name: content,
                    };
                }
                _ if content.is_empty() => None,
                _ if is_quoted => Some(quoted(&content)),
                _ => Some(content),
            };
            Edit::SetField {
                parts: parts.to_vec(),
                field: name.to_owned(),
                value: written,
            }
        },
    );
}

/// Shows a text, and a hint while it is empty. When the field is left, the text becomes an edit if it was changed; a text that is
/// refused stays.
pub(super) fn text_cell(
    ui: &mut egui::Ui,
    panel: &mut EditorPanel,
    name: &str,
    (value, hint): (&str, &str),
    edit: impl FnOnce(String) -> Edit,
) {
    let id = ui.scope_id().with(name);
    let drafts = &panel.form.drafts;
    let mut content = drafts.content(id).unwrap_or(value).to_owned();
    let refusal = drafts.refusal(id).map(str::to_owned);
    let mut field = egui::TextEdit::singleline(&mut content).hint_text(hint);
    if refusal.is_some() {
        field = field.text_color(ui.visuals().error_fg_color);
    }
    // A grid gives a field the width that its column had before.
    let mut field = ui.add_sized([TEXT_WIDTH, ui.spacing().interact_size.y], field);
    field.widget_info(|| egui::WidgetInfo::labeled(egui::Role::TextInput, true, name));
    if let Some(reason) = refusal {
        field = field.on_hover_text(reason);
    }
    if !field.has_focus() && !field.lost_focus() {
        return;
    }
    let edit = (content != value).then(|| edit(content.clone()));
    panel.form.drafts.set_text(id, content, edit);
    if field.lost_focus() {
        panel.form.drafts.retry(id);
        panel.commit_drafts();
    }
}

/// A number of the form.
pub(super) struct Number {
    /// Its name for edits.
    pub name: &'static str,
    /// The label that names it.
    pub label: egui::Id,
    /// The value in the layout, of the first part if several differ.
    pub old: f64,
    /// The parts have different values.
    pub is_mixed: bool,
    /// The values that can be typed.
    pub range: RangeInclusive<f64>,
    /// Change of a drag by a point.
    pub speed: f64,
    /// Decimals that are shown.
    pub decimals: usize,
    /// The unit, which stands behind the number.
    pub unit: &'static str,
}

impl Number {
    fn drag_value<'a>(&self, shown: &'a mut f64) -> DragValue<'a> {
        let drag = DragValue::new(shown).speed(self.speed);
        // A value of the file beyond the range stays until it is changed.
        let drag = drag
            .range(self.range.clone())
            .clamp_existing_to_range(false);
        let drag = drag.max_decimals(self.decimals);
        if self.is_mixed {
            drag.custom_formatter(|_, _| text("editor-mixed").to_owned())
        } else {
            drag.suffix(self.unit)
        }
    }
}

/// Shows a number. What is typed becomes an edit when the field is left; a drag makes its edit at once, in one step of undo.
pub(super) fn number_cell(
    ui: &mut egui::Ui,
    panel: &mut EditorPanel,
    parts: &[Part],
    number: &Number,
    edit: impl Fn(Vec<Part>, f64) -> Edit,
) {
    let id = ui.scope_id().with(number.name);
    let typed = panel.form.drafts.content(id);
    let typed = typed.and_then(|content| content.parse().ok());
    let mut shown = typed.unwrap_or(number.old);
    let drag = ui.add(number.drag_value(&mut shown));
    let drag = drag.labelled_by(number.label);
    // A number that the first of several parts has may be new to the others.
    let is_changed = is_other_number(number.old, shown, number.decimals)
        || number.is_mixed && drag.lost_focus() && typed.is_some();
    let new = (shown * 1000.0).round() / 1000.0;
    if drag.has_focus() || typed.is_some() {
        let edit = is_changed.then(|| edit(parts.to_vec(), new));
        panel.form.drafts.set_number(id, shown, edit);
        if !drag.has_focus() {
            panel.commit_drafts();
        }
    } else if drag.changed() && is_changed {
        edit_while_dragged(panel, parts, number.name, |parts| edit(parts, new));
    }
    if !drag.dragged() && panel.is_field_dragged(number.name) {
        panel.form.dragged = None;
    }
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
    fn is_field_dragged(&self, field: &str) -> bool {
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

/// Makes the edit of a number; all values of one drag are one step of undo.
fn edit_while_dragged(
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
