//! The form of a sequence: its name and its steps.

use eframe::egui;

use super::EditorPanel;
use super::field_row::{self, small_button};
use crate::editor::{Edit, FieldSpec, FieldType, Part, Patch, fields_of};
use crate::texts::text;
use ademan_core::document::quote;

/// Width of the kind of a step, in points.
const KIND_WIDTH: f32 = 60.0;

/// The value of a new step.
const NEW_VALUE: &str = "Enter";

/// The number in a new step.
const NEW_NUMBER: f64 = 500.0;

/// Shows the name and the steps of a sequence.
pub(super) fn show(ui: &mut egui::Ui, panel: &mut EditorPanel, part: Part) {
    let kinds = fields_of(part);
    let name = panel.editor.part_name(part).unwrap_or_default();
    ui.horizontal(|ui| {
        ui.label(text("editor-name"));
        field_row::text_cell(ui, panel, "name", (&name, ""), |name| Edit::Rename {
            part,
            name,
        });
    });
    let mut steps = 0;
    while panel.editor.value(part, &steps.to_string()).is_some() {
        ui.push_id(steps, |ui| {
            ui.horizontal(|ui| show_step(ui, panel, (part, steps), &kinds));
        });
        steps += 1;
    }
    if ui.button(text("editor-add-step")).clicked()
        && let Some(kind) = kinds.first()
    {
        set(panel, part, steps, Some(new_step(kind)));
    }
}

fn show_step(
    ui: &mut egui::Ui,
    panel: &mut EditorPanel,
    (part, index): (Part, usize),
    kinds: &[FieldSpec],
) {
    let value = |field: String| panel.editor.value(part, &field).map(str::to_owned);
    let step = value(index.to_string()).unwrap_or_default();
    let argument = value(format!("{index}.0")).unwrap_or_default();
    let kind = kinds.iter().find(|it| step.starts_with(it.name));
    let names: Vec<&str> = kinds.iter().map(|it| it.name).collect();
    let shown = kind.map_or("", |it| it.name);
    ui.spacing_mut().combo_width = KIND_WIDTH;
    let list = ("kind", text("editor-step-kind"));
    if let Some(chosen) = field_row::show_choice(ui, list, shown, &names)
        && let Some(other) = kinds.iter().find(|it| it.name == chosen)
    {
        set(panel, part, index, Some(new_step(other)));
    }
    let Some(kind) = kind else {
        return;
    };
    let content = field_row::unquoted(&argument);
    field_row::text_cell(ui, panel, kind.name, (&content, ""), |new| {
        let new = match kind.field_type {
            FieldType::Number { .. } => new,
            _ => quote(&new),
        };
        step_edit(part, index, Some(format!("{}({new})", kind.name)))
    });
    ui.label(kind.unit.trim()).on_hover_text(kind.help);
    if index > 0 && small_button(ui, "▲", text("editor-step-earlier")) {
        move_earlier(panel, part, index);
    }
    if small_button(ui, "×", text("editor-remove-field")) {
        set(panel, part, index, None);
    }
}

/// Returns a step of a kind with a value that is valid.
fn new_step(kind: &FieldSpec) -> String {
    let value = match kind.field_type {
        FieldType::Number { min, max, .. } => NEW_NUMBER.clamp(min, max).to_string(),
        _ => quote(NEW_VALUE),
    };
    format!("{}({value})", kind.name)
}

fn set(panel: &mut EditorPanel, part: Part, index: usize, value: Option<String>) {
    panel.apply(&step_edit(part, index, value));
}

/// Returns the edit that replaces a step, adds one after the last, or removes one.
fn step_edit(part: Part, index: usize, value: Option<String>) -> Edit {
    Edit::SetField {
        parts: vec![part],
        field: index.to_string(),
        value,
    }
}

/// Exchanges a step with the step before it.
fn move_earlier(panel: &mut EditorPanel, part: Part, index: usize) {
    let editor = &panel.editor;
    let (before, own) = ((index - 1).to_string(), index.to_string());
    let (Some(first), Some(second)) = (
        editor.range_of_value(part, &before),
        editor.range_of_value(part, &own),
    ) else {
        return;
    };
    let mut patch = Patch::default();
    patch.replace(first.clone(), &editor.text()[second.clone()]);
    patch.replace(second, &editor.text()[first]);
    panel.apply(&Edit::ReplaceText(patch));
    panel.editor.select([part]);
}
