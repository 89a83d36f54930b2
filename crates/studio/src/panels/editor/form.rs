//! The form of the selection: geometry, fields, binding.

use std::collections::BTreeSet;
use std::ops::RangeInclusive;

use eframe::egui::{self, DragValue};

use super::drafts::{Drafts, GeometryDraft};
use super::{EditorPanel, bar, binding, field_row, rounded, several, steps};
use crate::canvas::ItemShape;
use crate::editor::{ControlKind, Edit, FieldSpec, FieldType, Part, fields_of};
use crate::panels::{is_other_number, typed_number};
use crate::texts::{text, text_with};

/// Decimals of a number that is shown.
const DECIMALS: usize = 2;

/// Range of a position on a board, in millimetres.
pub(super) const POSITION_RANGE: RangeInclusive<f64> = -2000.0..=2000.0;

/// Range of a size, in millimetres.
pub(super) const SIZE_RANGE: RangeInclusive<f64> = 1.0..=500.0;

/// Fields that the geometry above them shows.
const GEOMETRY_FIELDS: [&str; 5] = ["at_mm", "size_mm", "length_mm", "width_mm", "diameter_mm"];

/// The form between two frames.
#[derive(Default)]
pub(super) struct FormState {
    /// The values that are typed.
    pub drafts: Drafts,
    /// A number that is being dragged.
    pub dragged: Option<DraggedField>,
    /// A field had the focus in the last frame.
    pub has_focus: bool,
}

/// A number that is being dragged.
#[derive(Clone)]
pub(super) struct DraggedField {
    /// Name of its field.
    pub name: &'static str,
    /// The parts as they were before.
    pub parts: Vec<Part>,
    /// The field was written before.
    pub was_written: bool,
    /// Revision of the text after the drag so far. With another one the last edit does not belong to the drag.
    pub revision: u64,
}

pub(super) fn show(ui: &mut egui::Ui, panel: &mut EditorPanel) {
    ui.add_space(4.0);
    panel.form.has_focus = false;
    panel.follow_selection();
    let parts = panel.editor.selection().to_vec();
    let Some(&first) = parts.first() else {
        ui.weak(text("editor-nothing-selected"));
        return;
    };
    match parts.len() {
        1 => ui.strong(title(panel, first)),
        count => ui.strong(text_with(
            "editor-several-selected",
            &[("count", count.into())],
        )),
    };
    if panel.selected.len() > 1 {
        several::show(ui, panel)
    } else {
        show_geometry(ui, panel)
    }
    if let (Part::Sequence(_), 1) = (first, parts.len()) {
        steps::show(ui, panel, first);
        return;
    }
    if parts.len() == 1 {
        binding::show(ui, panel, first);
    }
    show_fields(ui, panel, &parts);
}

fn title(panel: &EditorPanel, part: Part) -> String {
    let name = panel.editor.part_name(part).unwrap_or_default();
    title_of(words(part), &name)
}

/// Returns the kind and the name of a part; the name alone if it begins with the kind, as the names of new controls do.
fn title_of(kind: &str, name: &str) -> String {
    if name.to_lowercase().starts_with(&kind.to_lowercase()) {
        name.to_owned()
    } else {
        format!("{kind} {name}")
    }
}

/// Returns the words for a part.
fn words(part: Part) -> &'static str {
    text(match part {
        Part::Layout => "editor-layout",
        Part::Board(_) => "editor-new-board",
        Part::Row { .. } => "editor-row",
        Part::RowKey { .. } => return bar::kind_words(ControlKind::Key),
        Part::Control { kind, .. } => return bar::kind_words(kind),
        Part::RadioOption { .. } => "editor-option",
        Part::Trigger(_) => "editor-new-trigger",
        Part::Pointer => "editor-pointer",
        Part::Space(_) => "editor-new-space",
        Part::SpaceTarget { .. } => "editor-target",
        Part::Layer(_) => "editor-new-layer",
        Part::Chord(_) => "editor-chord",
        Part::Sequence(_) => "editor-new-sequence",
    })
}

/// Shows position, size and angle of the selected item; all are edited as the handles of the canvas do.
fn show_geometry(ui: &mut egui::Ui, panel: &mut EditorPanel) {
    let Some(index) = panel.selected.single() else {
        return;
    };
    let (Some(item), Some(part)) = (panel.items.items.get(index), panel.parts.get(index)) else {
        return;
    };
    let (old, can_turn, part) = (item.shape, item.can_turn, *part);
    let draft = panel.form.drafts.geometry.as_ref();
    let draft = draft.filter(|draft| draft.index == index);
    let typed = draft.map(|draft| draft.shape);
    // While the item is dragged, the numbers are those under the mouse.
    let mut dragged = panel.preview.shapes.iter();
    let dragged = dragged.find(|(own, _)| *own == index);
    let mut shape = typed.or(dragged.map(|(_, shape)| *shape)).unwrap_or(old);
    let usage = show_numbers(ui, &mut shape, can_turn);
    panel.form.has_focus |= usage.is_active;
    if !usage.is_active && typed.is_none() {
        return;
    }
    let edits = part.map_or_else(Vec::new, |part| geometry_edits(part, &old, &shape));
    panel.form.drafts.geometry = Some(GeometryDraft {
        index,
        shape,
        edits,
    });
    panel.preview.shapes = vec![(index, shape)];
    if usage.is_left || !usage.is_active {
        panel.commit_drafts();
    }
}

/// The use of the numbers of an item in a picture.
#[derive(Default)]
struct NumberUse {
    /// A number has the focus or is dragged.
    is_active: bool,
    /// The focus has left a number, or a drag has ended.
    is_left: bool,
}

/// Shows the numbers of an item, and changes it as they are changed.
fn show_numbers(ui: &mut egui::Ui, shape: &mut ItemShape, can_turn: bool) -> NumberUse {
    let mut usage = NumberUse::default();
    egui::Grid::new("editor geometry")
        .num_columns(4)
        .show(ui, |ui| {
            let mut number =
                |grid: &mut egui::Ui, name: &str, value: &mut f32, range, suffix: &str| {
                    let label = grid.label(name);
                    let drag = DragValue::new(value).speed(0.1).max_decimals(DECIMALS);
                    let drag = drag.custom_parser(typed_number);
                    // A value of the file beyond the range stays until it is changed.
                    let drag = drag.range(range).clamp_existing_to_range(false);
                    let drag = grid.add(drag.suffix(suffix)).labelled_by(label.id);
                    usage.is_active |= drag.dragged() || drag.has_focus();
                    usage.is_left |= drag.lost_focus() || drag.drag_stopped();
                };
            number(ui, "X", &mut shape.center.x, POSITION_RANGE, " mm");
            number(ui, "Y", &mut shape.center.y, POSITION_RANGE, " mm");
            ui.end_row();
            let mut size = shape.half * 2.0;
            if shape.is_disc {
                let diameter = text("editor-diameter");
                number(ui, diameter, &mut size.x, SIZE_RANGE, " mm");
                size.y = size.x;
            } else {
                let (width, depth) = (text("editor-width"), text("editor-depth"));
                number(ui, width, &mut size.x, SIZE_RANGE, " mm");
                number(ui, depth, &mut size.y, SIZE_RANGE, " mm");
            }
            shape.half = size / 2.0;
            ui.end_row();
            if can_turn {
                let angle = &mut shape.rotation_deg;
                number(ui, text("editor-angle"), angle, -180.0..=180.0, "°");
                ui.end_row();
            }
        });
    usage
}

/// Returns the edits that lead from a shape to another one: none, or one each of position, size and angle.
fn geometry_edits(part: Part, old: &ItemShape, new: &ItemShape) -> Vec<Edit> {
    // A field that is left without a change rounds its number to what it shows.
    let changed = |before: f32, after: f32| {
        if is_other_number(before.into(), after.into(), DECIMALS) {
            rounded(after - before)
        } else {
            0.0
        }
    };
    let by = [
        changed(old.center.x, new.center.x),
        changed(old.center.y, new.center.y),
    ];
    let (old_size, new_size) = (old.half * 2.0, new.half * 2.0);
    let wider = [
        changed(old_size.x, new_size.x),
        changed(old_size.y, new_size.y),
    ];
    let turned = changed(old.rotation_deg, new.rotation_deg);
    let mut edits = Vec::new();
    if by != [0.0; 2] {
        edits.push(Edit::Move {
            parts: vec![part],
            by_mm: [by[0], by[1], 0.0],
        });
    }
    if wider != [0.0; 2] {
        edits.push(Edit::Resize {
            parts: vec![part],
            by_mm: wider,
            fixed: [0.0, 0.0],
        });
    }
    if turned != 0.0 {
        edits.push(Edit::Turn {
            parts: vec![part],
            degrees: turned,
        });
    }
    edits
}

/// Shows the fields that all selected parts have: those that are written, then the others folded.
fn show_fields(ui: &mut egui::Ui, panel: &mut EditorPanel, parts: &[Part]) {
    let first = parts[0];
    let has_shapes = !panel.selected.is_empty();
    let mut fields = common_fields(parts);
    fields.retain(|field| {
        let is_shown_above = has_shapes && GEOMETRY_FIELDS.contains(&field.name);
        field.field_type != FieldType::Action && !is_shown_above
    });
    // A board that is flat has no radius.
    fields.retain(|field| {
        let group = field.name.rsplit_once('.').map(|(group, _)| group);
        group.is_none_or(|group| {
            let value = panel.editor.value(first, group);
            value.is_some_and(|value| value.contains('('))
        })
    });
    let is_written = |asked: &EditorPanel, field: &FieldSpec| {
        let dragged = asked.form.dragged.as_ref();
        // A field stays under the mouse while it is dragged.
        if let Some(dragged) = dragged.filter(|dragged| dragged.name == field.name) {
            return dragged.was_written;
        }
        field.name == "name" || asked.editor.own_value(first, field.name).is_some()
    };
    let (written, unwritten): (Vec<FieldSpec>, Vec<FieldSpec>) = fields
        .into_iter()
        .partition(|field| is_written(panel, field));
    ui.add_space(6.0);
    field_rows(ui, panel, parts, &written, "editor written");
    if !unwritten.is_empty() {
        ui.collapsing(text("editor-optional"), |ui| {
            field_rows(ui, panel, parts, &unwritten, "editor unwritten");
        });
    }
}

/// Returns the fields that all of several parts have; each has a name of its own. One part has all of its fields.
fn common_fields(parts: &[Part]) -> Vec<FieldSpec> {
    let Some((first, others)) = parts.split_first() else {
        return Vec::new();
    };
    let mut fields = fields_of(*first);
    fields.retain(|field| others.is_empty() || field.name != "name");
    // Thousands of keys may be selected: the fields of a kind are looked up once.
    let mut kinds = BTreeSet::from([first.kind_name()]);
    for part in others {
        if kinds.insert(part.kind_name()) {
            let own = fields_of(*part);
            fields.retain(|field| own.contains(field));
        }
    }
    fields
}

fn field_rows(
    ui: &mut egui::Ui,
    panel: &mut EditorPanel,
    parts: &[Part],
    fields: &[FieldSpec],
    id: &str,
) {
    egui::Grid::new(id).num_columns(3).show(ui, |ui| {
        for field in fields {
            field_row::show(ui, panel, parts, field);
            ui.end_row();
        }
    });
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::editor::tests::{control, key};

    #[test]
    fn only_fields_that_all_selected_parts_have_are_shown() {
        let names = |parts: &[Part]| -> Vec<&'static str> {
            let fields = common_fields(parts).into_iter();
            fields.map(|field| field.name).collect()
        };
        let keys: Vec<Part> = (0..200).map(key).collect();
        let of_keys = names(&keys);
        assert!(of_keys.contains(&"lift_mm") && !of_keys.contains(&"name"));
        assert!(names(&keys[..1]).contains(&"name"));
        let knob = control(ControlKind::Knob, 0);
        let of_both = names(&[&keys[..], &[knob][..]].concat());
        assert!(!of_both.contains(&"lift_mm"), "a knob has no such field");
    }

    #[test]
    fn the_kind_of_a_part_is_not_written_twice() {
        assert_eq!(title_of("Knob", "Knob 2"), "Knob 2");
        assert_eq!(title_of("Knob", "volume"), "Knob volume");
    }
}
