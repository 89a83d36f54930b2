//! The marks on a control that is drawn with characters: its handle, and the labels of its parts.

use parry3d::math::Vec2;

use super::front::{FrontMark, MarkRole, MarkShape};
use super::terminal::Cell;
use crate::contact::TargetId;
use crate::layout::controls::Handle;
use crate::layout::model::Layout;
use crate::message::escape;

/// Part of a character by which a label between two columns is moved to the left one, whatever the last digit of its position.
const ROUNDING: f32 = 0.01;

/// A mark on a [`Cell`], in characters from the left and the top of its grid.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum CellMark {
    /// A handle that fills this row of the inside.
    Row(usize),
    /// A handle that fills this column of the inside.
    Column(usize),
    /// A round handle on an area.
    Point {
        /// Column of the character.
        column: usize,
        /// Row of the character.
        row: usize,
    },
    /// A mark on the edge, around which a finger turns.
    Rim {
        /// Column of the character.
        column: usize,
        /// Row of the character.
        row: usize,
    },
    /// The label of a part, such as a sector of a menu; the labels of all parts replace the one of the control.
    Label {
        /// Column of the first character.
        column: usize,
        /// Row of the characters.
        row: usize,
        /// The label, cut so that it fits.
        text: String,
    },
}

impl CellMark {
    /// Returns `true` if the mark needs the inside, so that the label of the control has its place in the border.
    pub fn needs_inside(&self) -> bool {
        !matches!(self, Self::Rim { .. } | Self::Label { .. })
    }
}

impl Cell {
    /// Returns the marks on a control; a key, and a cell without an inside, has none. `value` returns the value of a target as for
    /// [`Layout::front_marks`].
    pub fn marks(&self, layout: &Layout, value: impl Fn(TargetId) -> Option<f32>) -> Vec<CellMark> {
        let Some((control, _)) = layout.control_at(self.target) else {
            return Vec::new();
        };
        if self.width < 3 || self.height < 3 {
            return Vec::new();
        }
        let value = |target| value(target).or_else(|| layout.initial_value(target));
        let own = value(self.target);
        match control.kind.handle() {
            Handle::Line { .. } => {
                let direction = track_direction(layout, self.target);
                let handle = own.map(|position| self.handle_on_track(position, direction));
                handle.into_iter().collect()
            }
            Handle::Turn { start, turns, .. } => {
                let mark = own.map(|position| self.rim_mark(start + turns * position));
                mark.into_iter().collect()
            }
            Handle::Pad { .. } => {
                let values: Vec<f32> = control
                    .value_targets()
                    .into_iter()
                    .filter_map(value)
                    .collect();
                match *values {
                    [x, y] => vec![self.point(x.clamp(0.0, 1.0), y.clamp(0.0, 1.0))],
                    _ => Vec::new(),
                }
            }
            Handle::Stick { .. } => self.labels(layout, value),
            Handle::Switch | Handle::Area => Vec::new(),
        }
    }

    /// Returns the handle of a track whose values increase in a direction along the rows of its board.
    fn handle_on_track(&self, value: f32, direction: Vec2) -> CellMark {
        let (width, height) = (self.width - 2, self.height - 2);
        // Characters are twice as high as wide.
        let is_wide = width >= 2 * height;
        let along = if is_wide { direction.x } else { direction.y };
        let value = value.clamp(0.0, 1.0);
        let part = if along < -1e-3 { 1.0 - value } else { value };
        if is_wide {
            CellMark::Column(self.column + 1 + at(width, part))
        } else {
            CellMark::Row(self.row + 1 + at(height, 1.0 - part))
        }
    }

    fn rim_mark(&self, turns: f32) -> CellMark {
        let (sin, cos) = (turns * std::f32::consts::TAU).sin_cos();
        CellMark::Rim {
            column: self.column + at(self.width, (1.0 + sin) / 2.0),
            row: self.row + at(self.height, (1.0 - cos) / 2.0),
        }
    }

    fn point(&self, x: f32, y: f32) -> CellMark {
        CellMark::Point {
            column: self.column + 1 + at(self.width - 2, x),
            row: self.row + 1 + at(self.height - 2, 1.0 - y),
        }
    }

    /// Returns the labels of the parts of a control, if it has several.
    fn labels(&self, layout: &Layout, value: impl Fn(TargetId) -> Option<f32>) -> Vec<CellMark> {
        let marks = layout.front_marks(self.target, value).unwrap_or_default();
        let half = layout
            .face(self.target)
            .map(|face| face.outline.half_extents() * 1e3);
        let label = |mark: FrontMark| match mark.shape {
            MarkShape::Text { center, text, .. }
                if matches!(mark.role, MarkRole::Label | MarkRole::Note) =>
            {
                Some(self.label(center / half?, &text))
            }
            _ => None,
        };
        let labels: Vec<CellMark> = marks.into_iter().filter_map(label).collect();
        if labels.len() > 1 { labels } else { Vec::new() }
    }

    /// Returns a label at a part of the half extents, −1..=1: to the right, away from the wearer.
    fn label(&self, center: Vec2, text: &str) -> CellMark {
        // From the left edge of the inside, in characters.
        let middle = (1.0 + center.x) / 2.0 * (self.width - 2) as f32;
        // It is as far from the edge at its side as at the other one.
        let room = 2.0 * middle.min((self.width - 2) as f32 - middle);
        let text = escape(text);
        let length = text.chars().count().min(room.round().max(0.0) as usize);
        let start = (middle - length as f32 / 2.0 - ROUNDING).round().max(0.0);
        CellMark::Label {
            column: self.column + 1 + start as usize,
            row: self.row + 1 + at(self.height - 2, (1.0 - center.y) / 2.0),
            text: text.chars().take(length).collect(),
        }
    }
}

/// Returns the index of the character at a part of a length, 0..=1.
fn at(length: usize, part: f32) -> usize {
    (part * length.saturating_sub(1) as f32).round() as usize
}

/// Returns the direction in which the values of a control on a track increase, in row coordinates.
fn track_direction(layout: &Layout, target: TargetId) -> Vec2 {
    let mut boards = layout.boards.iter();
    let board = boards.find(|board| layout.faces(board).any(|face| face.target == target));
    let face = layout.face(target);
    let rotation = board.zip(face).map_or(0.0, |(board, face)| {
        face.outline.rotation - board.shape.row_rotation(face.row_position)
    });
    Vec2::from_angle(rotation)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::layout::KeySize;

    fn marks(controls: &str, value: Option<f32>) -> (Cell, Vec<CellMark>) {
        let text = format!("Layout(name: \"a\", boards: [(pose: (anchor: elbow), {controls})])");
        let layout = Layout::parse(&text, "a.ron").unwrap();
        let cell = layout.grids(KeySize::Labelled)[0].cells[0];
        let marks = cell.marks(&layout, |_| value);
        (cell, marks)
    }

    #[test]
    fn a_handle_is_where_its_value_is() {
        let slider = "sliders: [(name: \"s\", at_mm: (0, 0), length_mm: 100, width_mm: 20)]";
        let (cell, at_end) = marks(slider, Some(1.0));
        assert_eq!(at_end, [CellMark::Column(cell.width - 2)]);
        assert_eq!(marks(slider, Some(0.0)).1, [CellMark::Column(1)]);
        assert_eq!(
            marks(slider, None).1,
            [CellMark::Column(1)],
            "the value at the start"
        );
        let turned = |degrees: i32, value: f32| {
            let text = slider.replace("width_mm", &format!("rotation_deg: {degrees}, width_mm"));
            marks(&text, Some(value))
        };
        let (upright, at_top) = turned(90, 1.0);
        assert_eq!(at_top, [CellMark::Row(1)]);
        assert_eq!(turned(90, 0.0).1, [CellMark::Row(upright.height - 2)]);
        assert_eq!(turned(180, 1.0).1, [CellMark::Column(1)]);
        assert_eq!(turned(-90, 1.0).1, [CellMark::Row(upright.height - 2)]);
    }

    #[test]
    fn a_pad_has_a_round_handle_and_a_knob_a_mark_on_its_rim() {
        let pad = "xy_pads: [(name: \"p\", at_mm: (0, 0), size_mm: Box(100, 60))]";
        let (cell, corner) = marks(pad, Some(1.0));
        let expected = CellMark::Point {
            column: cell.width - 2,
            row: 1,
        };
        assert_eq!(corner, [expected]);
        let knob = "knobs: [(name: \"k\", at_mm: (0, 0), diameter_mm: 40, range_deg: 270)]";
        let (round, top) = marks(knob, Some(0.5));
        let [CellMark::Rim { column, row: 0 }] = top[..] else {
            panic!("{top:?}");
        };
        assert!(
            column.abs_diff(round.width / 2) <= 1,
            "{column} of {}",
            round.width
        );
    }

    #[test]
    fn the_sectors_of_a_menu_have_their_labels_inside_it() {
        let menu = "radial_menus: [(name: \"m\", at_mm: (0, 0), diameter_mm: 60, sectors: [(name: \"up\", tap: Key(\"A\")), \
                    (name: \"right-handed\", tap: Key(\"D\")), (name: \"down\", tap: Key(\"B\"))])]";
        let (cell, labels) = marks(menu, None);
        let texts = labels.iter().map(|label| match label {
            CellMark::Label { column, row, text } => {
                assert!(
                    *column >= 1 && column + text.chars().count() < cell.width,
                    "{label:?}"
                );
                assert!((1..cell.height - 1).contains(row), "{label:?}");
                text.as_str()
            }
            other => panic!("{other:?}"),
        });
        let texts: Vec<&str> = texts.collect();
        let [up, right, down, hub] = texts[..] else {
            panic!("{texts:?}");
        };
        assert_eq!([up, down, hub], ["up", "down", "m"]);
        assert!(
            "right-handed".starts_with(right) && !right.is_empty(),
            "{right}"
        );
    }
}
