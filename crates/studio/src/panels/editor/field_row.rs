//! One field of the selected parts: its name, its value, and a button that restores the default.

use std::ops::RangeInclusive;

use eframe::egui::{self, DragValue, Event};

use super::EditorPanel;
use super::form::DraggedField;
use super::mixed::is_mixed;
use crate::canvas::plan::at_start;
use crate::editor::{ANCHOR, Edit, FieldSpec, FieldType, Part};
use crate::panels::{is_other_number, typed_number};
use crate::texts::text;
use ademan_core::document::{quote, read_tree};

/// Decimals of a number that is shown.
const DECIMALS: usize = 3;

/// The default of a field that a part must have.
const REQUIRED: &str = "required";

/// Width of a text, in points.
const TEXT_WIDTH: f32 = 150.0;

/// Shows content in a cell of a grid. Its widgets have ids of the field, wherever the field is in its list.
fn in_cell(ui: &mut egui::Ui, name: &str, content: impl FnOnce(&mut egui::Ui)) {
    let builder = egui::UiBuilder::new()
        .scope_id(ui.scope_id().with(name))
        .layout(egui::Layout::top_down(egui::Align::Min));
    ui.scope_builder(builder, content);
}

/// Shows the row of a field: name, value, and the button that removes the field unless the part must have it.
pub(super) fn show(ui: &mut egui::Ui, panel: &mut EditorPanel, parts: &[Part], field: &FieldSpec) {
    let first = parts[0];
    let written = panel.editor.own_value(first, field.name);
    let written = written.map(str::to_owned);
    let is_mixed = is_mixed(panel, parts, field.name);
    let label = ui.label(display_name(field.name));
    let label = label.on_hover_text(format!("{}: {}", field.name, field.help));
    in_cell(ui, field.name, |cell| {
        let state = (written.as_deref(), is_mixed);
        show_value(cell, panel, parts, (field, label.id), state);
    });
    // Without a field that it must have, a part cannot be read.
    let can_remove = written.is_some() && field.name != "name" && field.default != REQUIRED;
    if is_mixed {
        ui.weak(text("editor-mixed"));
    } else if can_remove && small_button(ui, "×", text("editor-remove-field")) {
        set(panel, parts, field.name, None);
    }
}

/// Shows a button with a sign, whose name is its hint. Returns `true` if it is clicked.
pub(super) fn small_button(ui: &mut egui::Ui, sign: &str, name: &str) -> bool {
    let button = ui.small_button(sign).on_hover_text(name);
    button.widget_info(|| egui::WidgetInfo::labeled(egui::Role::Button, true, name));
    button.clicked()
}

/// Shows the value of a field as it is written, or its default.
fn show_value(
    ui: &mut egui::Ui,
    panel: &mut EditorPanel,
    parts: &[Part],
    (field, label): (&FieldSpec, egui::Id),
    (written, is_mixed): (Option<&str>, bool),
) {
    let default = panel.editor.default_of(parts[0], field);
    let shown = written.unwrap_or(&default);
    let empty = text_hint(&default, is_mixed);
    match field.field_type {
        FieldType::Number { min, max, is_whole } => {
            let old = number_in(shown);
            let hint = match old {
                _ if is_mixed => Some(text("editor-mixed").to_owned()),
                Some(_) => None,
                None => Some(default.clone()),
            };
            let number = Number {
                name: field.name,
                label,
                old: old.unwrap_or_else(|| first_number(shown).unwrap_or(min).clamp(min, max)),
                hint,
                range: min..=max,
                speed: ((max - min) / 500.0).clamp(0.005, 1.0),
                decimals: if is_whole { 0 } else { DECIMALS },
                unit: field.unit,
            };
            number_cell(ui, panel, parts, &number, |parts, number| Edit::SetField {
                parts,
                field: field.name.to_owned(),
                value: Some(number.to_string()),
            });
        }
        FieldType::Bool => {
            let mut is_on = shown == "true";
            let checkbox = egui::Checkbox::new(&mut is_on, "").indeterminate(is_mixed);
            if ui.add(checkbox).labelled_by(label).changed() {
                set(panel, parts, field.name, Some(is_on.to_string()));
            }
        }
        FieldType::Choice(choices) => {
            let shown = if is_mixed { "" } else { shown };
            let listed = with_default(choices, &default);
            let name = display_name(field.name);
            if let Some(chosen) = show_choice(ui, (field.name, &name), shown, &listed) {
                let is_choice = choices.contains(&chosen.as_str());
                set(panel, parts, field.name, is_choice.then_some(chosen));
            }
        }
        FieldType::Text => {
            let value = written.filter(|_| !is_mixed);
            let value = unquoted(value.unwrap_or_default());
            show_text(ui, panel, parts, (field, &default, empty), &value, true);
        }
        FieldType::Point { .. }
        | FieldType::Outline
        | FieldType::Output
        | FieldType::Ron
        | FieldType::Action => {
            let value = written.filter(|_| !is_mixed).unwrap_or_default();
            show_text(ui, panel, parts, (field, &default, empty), value, false);
        }
    }
}

/// Returns the words in a text field without a text: its default, unless the selected parts have several values.
fn text_hint(default: &str, is_mixed: bool) -> &str {
    if is_mixed {
        text("editor-mixed")
    } else if default == REQUIRED {
        ""
    } else {
        default
    }
}

/// Returns the number of a value as a file may have it, such as `4` or `Some(4)`.
fn number_in(value: &str) -> Option<f64> {
    read_tree(value)?.number(value)
}

/// Returns the number at the begin of a description such as `0.25 or 0.4`.
fn first_number(description: &str) -> Option<f64> {
    let word = description.split_whitespace().next()?;
    word.trim_end_matches(',').parse().ok()
}

/// Returns the choices of a field, after the words for its default if that is none of them: it is chosen by removing the field.
fn with_default<'a>(choices: &[&'a str], default: &'a str) -> Vec<&'a str> {
    let is_default = |choice: &&str| word(choice) == word(default);
    let has_words = !["", REQUIRED].contains(&default);
    let is_extra = has_words && !choices.iter().any(is_default);
    let extra = is_extra.then_some(default);
    extra.into_iter().chain(choices.iter().copied()).collect()
}

/// Returns the word of a value, as lists show it.
fn word(value: &str) -> &str {
    let end = value.find('(').unwrap_or(value.len());
    value[..end].trim_matches('"')
}

/// Shows a list by its id and its name for screen readers. Returns the value that was chosen.
pub(super) fn show_choice(
    ui: &mut egui::Ui,
    (id, name): (&str, &str),
    shown: &str,
    choices: &[&str],
) -> Option<String> {
    let shown = word(shown);
    let mut chosen = None;
    let list = egui::ComboBox::from_id_salt(id).selected_text(shown);
    let list = list.show_ui(ui, |ui| {
        for choice in choices {
            let is_shown = word(choice) == shown;
            if ui.selectable_label(is_shown, word(choice)).clicked() && !is_shown {
                chosen = Some((*choice).to_owned());
            }
        }
    });
    list.response.accessible_name(name);
    chosen
}

/// Shows a text that becomes the value when the field is left.
fn show_text(
    ui: &mut egui::Ui,
    panel: &mut EditorPanel,
    parts: &[Part],
    (field, default, hint): (&FieldSpec, &str, &str),
    value: &str,
    is_quoted: bool,
) {
    let name = field.name;
    text_cell(ui, panel, name, (value, hint), |content| {
        let written = match (name, parts) {
            // Without a name, a board has its number.
            ("name", [Part::Board(_)]) if content.is_empty() => None,
            ("name", [part]) if *part != Part::Layout => {
                let part = *part;
                return Edit::Rename {
                    part,
                    name: content,
                };
            }
            _ if content.is_empty() && default != REQUIRED => None,
            _ if is_quoted => Some(quote(&content)),
            _ => Some(content),
        };
        Edit::SetField {
            parts: parts.to_vec(),
            field: name.to_owned(),
            value: written,
        }
    });
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
    panel.form.has_focus |= field.has_focus();
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
    /// The value in the layout, of the first part if several differ, or the one at which a drag begins.
    pub old: f64,
    /// Words in place of the value, as the parts have different ones or none is known.
    pub hint: Option<String>,
    /// The values that can be typed.
    pub range: RangeInclusive<f64>,
    /// Change of a drag by a point.
    pub speed: f64,
    /// Decimals that are shown.
    pub decimals: usize,
    /// The unit, which follows the number.
    pub unit: &'static str,
}

impl Number {
    fn drag_value<'a>(&self, shown: &'a mut f64) -> DragValue<'a> {
        let drag = DragValue::new(shown).speed(self.speed);
        let drag = drag.custom_parser(typed_number);
        // A value of the file beyond the range stays until it is changed.
        let drag = drag
            .range(self.range.clone())
            .clamp_existing_to_range(false);
        let drag = drag.max_decimals(self.decimals);
        match self.hint.clone() {
            Some(hint) => drag.custom_formatter(move |_, _| hint.clone()),
            None => drag.suffix(self.unit),
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
    panel.form.has_focus |= drag.has_focus();
    // A number that is typed in place of words is new, even if it is the one at which a drag begins.
    let is_changed = is_other_number(number.old, shown, number.decimals)
        || number.hint.is_some() && typed.is_some();
    let new = (shown * 1000.0).round() / 1000.0;
    // A field that is only passed through changes nothing.
    if typed.is_some() || drag.has_focus() && (drag.changed() || has_typed(ui)) {
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

/// Returns `true` if a digit was typed or pasted since the last frame.
fn has_typed(ui: &egui::Ui) -> bool {
    let has_digit = |event: &Event| match event {
        Event::Text(content) | Event::Paste(content) => {
            content.contains(|c: char| c.is_ascii_digit())
        }
        _ => false,
    };
    ui.input(|input| input.events.iter().any(has_digit))
}

fn set(panel: &mut EditorPanel, parts: &[Part], field: &str, value: Option<String>) {
    if let Some(anchor) = value.as_deref().filter(|_| field == ANCHOR) {
        set_anchor(panel, parts, anchor);
        return;
    }
    panel.apply(&Edit::SetField {
        parts: parts.to_vec(),
        field: field.to_owned(),
        value,
    });
}

/// Sets the anchor of parts. Boards stay where they are.
fn set_anchor(panel: &mut EditorPanel, parts: &[Part], anchor: &str) {
    panel.commit_drafts();
    let reach = panel.reach.as_ref().zip(panel.editor.layout());
    let hands = reach.map(|(reach, layout)| at_start(reach.hands_at_rest(layout)));
    let hands = hands.unwrap_or_default();
    let result = panel.editor.set_anchor(parts, anchor, &hands);
    panel.report(result);
}

impl EditorPanel {
    /// Returns `true` while a number of this name is dragged.
    fn is_field_dragged(&self, field: &str) -> bool {
        let dragged = self.form.dragged.as_ref();
        dragged.is_some_and(|dragged| dragged.name == field)
    }
}

/// Makes the edit of a number; all values of one drag are one step of undo.
fn edit_while_dragged(
    panel: &mut EditorPanel,
    parts: &[Part],
    field: &'static str,
    edit: impl Fn(Vec<Part>) -> Edit,
) {
    let revision = panel.editor.revision();
    let before = panel.form.dragged.clone();
    let before = before.filter(|dragged| dragged.name == field && dragged.revision == revision);
    let dragged = before.unwrap_or_else(|| DraggedField {
        name: field,
        parts: parts.to_vec(),
        was_written: panel.editor.own_value(parts[0], field).is_some(),
        revision: 0,
    });
    let edit = edit(dragged.parts.clone());
    let result = if dragged.revision == revision {
        panel.editor.amend(&edit)
    } else {
        panel.editor.apply(&edit)
    };
    if result.is_ok() {
        panel.form.dragged = Some(DraggedField {
            revision: panel.editor.revision(),
            ..dragged
        });
    }
    panel.report(result);
}

/// Returns the content of a text in quotes; any other value as it is.
pub(super) fn unquoted(written: &str) -> String {
    ron::from_str(written).unwrap_or_else(|_| written.trim_matches('"').to_owned())
}

/// Returns the name of a field as it is shown: without its unit, which follows its number.
fn display_name(field: &str) -> String {
    const UNITS: [&str; 6] = ["_mm_per_s", "_px_per_s", "_mm", "_deg", "_ms", "_hz"];
    let name = UNITS.iter().find_map(|unit| field.strip_suffix(unit));
    name.unwrap_or(field).replace('_', " ").replace('.', " · ")
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_list_has_its_default_once_even_if_that_is_no_value() {
        let fields = crate::editor::fields_of(crate::editor::tests::key(0));
        let finger = fields.iter().find(|field| field.name == "finger").unwrap();
        let FieldType::Choice(fingers) = finger.field_type else {
            panic!("{finger:?}");
        };
        let listed = with_default(fingers, finger.default);
        assert_eq!(listed[..2], ["none", "\"thumb\""]);
        assert_eq!(listed[1..], *fingers);
        let shapes = ["Flat", "Arc(radius_mm: 320)"];
        for default in ["Flat", "Arc", "required"] {
            assert_eq!(with_default(&shapes, default), shapes, "{default}");
        }
    }

    #[test]
    fn a_number_is_shown_however_it_is_written() {
        for (value, expected) in [
            ("4", Some(4.0)),
            ("-2.50", Some(-2.5)),
            ("Some(4)", Some(4.0)),
            ("0.25 or 0.4", None),
            ("as the board", None),
            ("", None),
        ] {
            assert_eq!(number_in(value), expected, "{value}");
        }
    }

    #[test]
    fn a_text_field_of_several_values_does_not_show_the_default() {
        assert_eq!(text_hint("none", true), text("editor-mixed"));
        assert_eq!(text_hint("none", false), "none");
        assert_eq!(text_hint(REQUIRED, false), "");
    }

    #[test]
    fn the_name_of_a_field_is_shown_without_its_unit() {
        assert_eq!(display_name("travel_mm"), "travel");
        assert_eq!(display_name("pose.tilt_deg"), "pose · tilt");
        assert_eq!(display_name("press_at"), "press at");
    }
}
