//! Positions and sizes of several selected controls: a number that all have, or one that all get.

use std::ops::RangeInclusive;

use eframe::egui;

use super::EditorPanel;
use super::field_row::{self, number_cell};
use super::form::{POSITION_RANGE, SIZE_RANGE};
use crate::canvas::ItemShape;
use crate::editor::{Edit, Part, PlaceTo};
use crate::texts::text;

/// The largest number of controls that are compared for each frame.
const MAX_COMPARED: usize = 1000;

/// A number of a control: its name for edits, its words, its range, its value, and the edit that sets it.
struct Number {
    id: &'static str,
    words: &'static str,
    range: RangeInclusive<f64>,
    value: fn(&ItemShape) -> f32,
    place: fn(f64) -> PlaceTo,
}

/// Returns the numbers that are shown.
fn numbers() -> [Number; 4] {
    [
        Number {
            id: "several-x",
            words: "X",
            range: POSITION_RANGE,
            value: |shape| shape.center.x,
            place: |x| PlaceTo {
                center_mm: [Some(x), None],
                ..PlaceTo::default()
            },
        },
        Number {
            id: "several-y",
            words: "Y",
            range: POSITION_RANGE,
            value: |shape| shape.center.y,
            place: |y| PlaceTo {
                center_mm: [None, Some(y)],
                ..PlaceTo::default()
            },
        },
        Number {
            id: "several-width",
            words: text("editor-width"),
            range: SIZE_RANGE,
            value: |shape| shape.half.x * 2.0,
            place: |width| PlaceTo {
                size_mm: [Some(width), None],
                ..PlaceTo::default()
            },
        },
        Number {
            id: "several-depth",
            words: text("editor-depth"),
            range: SIZE_RANGE,
            value: |shape| shape.half.y * 2.0,
            place: |depth| PlaceTo {
                size_mm: [None, Some(depth)],
                ..PlaceTo::default()
            },
        },
    ]
}

/// Returns the number that all have, if they have one.
fn common(mut values: impl Iterator<Item = f32>) -> Option<f32> {
    let first = values.next()?;
    values
        .all(|value| (value - first).abs() < 5e-3)
        .then_some(first)
}

pub(super) fn show(ui: &mut egui::Ui, panel: &mut EditorPanel) {
    let parts = panel.selected_parts();
    egui::Grid::new("several").num_columns(4).show(ui, |ui| {
        for (index, number) in numbers().iter().enumerate() {
            show_number(ui, panel, &parts, number);
            if index % 2 == 1 {
                ui.end_row();
            }
        }
    });
}

fn show_number(ui: &mut egui::Ui, panel: &mut EditorPanel, parts: &[Part], number: &Number) {
    let items = &panel.items.items;
    let dragged = &panel.preview.shapes;
    let shape = |index: usize| {
        let dragged = dragged.iter().find(|(own, _)| *own == index);
        dragged
            .map(|(_, shape)| *shape)
            .or_else(|| items.get(index).map(|item| item.shape))
    };
    let shapes = panel.selected.iter().take(MAX_COMPARED).filter_map(shape);
    let values: Vec<f32> = shapes
        .map(|selected_shape| (number.value)(&selected_shape))
        .collect();
    let shared = common(values.iter().copied());
    let first = values.first().copied().unwrap_or_default();
    let label = ui.label(number.words);
    let cell = field_row::Number {
        name: number.id,
        label: label.id,
        old: f64::from((shared.unwrap_or(first) * 100.0).round()) / 100.0,
        hint: shared.is_none().then(|| text("editor-mixed").to_owned()),
        range: number.range.clone(),
        speed: 0.1,
        decimals: 2,
        unit: " mm",
    };
    let place = number.place;
    number_cell(ui, panel, parts, &cell, |parts, typed| Edit::Place {
        parts,
        place: place(typed),
    });
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_number_is_shown_if_all_have_it() {
        assert_eq!(common([3.0, 3.001].into_iter()), Some(3.0));
        assert_eq!(common([3.0, 4.0].into_iter()), None);
        assert_eq!(common([].into_iter()), None);
    }
}
