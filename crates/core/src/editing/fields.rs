//! The fields of parts: their types and ranges for forms, and their values in the text.

use std::collections::BTreeMap;
use std::sync::LazyLock;

use super::draft::Draft;
use super::error::EditError;
use super::part::{ControlKind, Part};
use super::rename::rename;
use super::rows::take_out;
use crate::document::{Row, Shape, Table, quote, quoted_content, read_tree};
use crate::layout::field_tables;

/// A field that a part can have.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct FieldSpec {
    /// Name, as [`Edit::SetField`](super::Edit::SetField) expects it. It ends with the unit: `_mm`, `_deg`, `_ms`.
    pub name: &'static str,
    /// Type of its value.
    pub field_type: FieldType,
    /// Unit as it is written after a number, with its blank, such as ` mm`; empty without one.
    pub unit: &'static str,
    /// The value if the field is not written, as its description gives it; empty if there is none.
    pub default: &'static str,
    /// Description, a sentence without its full stop.
    pub help: &'static str,
}

/// The type of the value of a field.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum FieldType {
    /// A number.
    Number {
        /// Smallest value.
        min: f64,
        /// Largest value.
        max: f64,
        /// `true` if it has no fraction.
        is_whole: bool,
    },
    /// `true` or `false`; the default is `false`.
    Bool,
    /// A text in quotes.
    Text,
    /// One of these words, as they are written. The fields in the parentheses after a word are edited separately.
    Choice(&'static [&'static str]),
    /// Numbers in parentheses.
    Point {
        /// Number of coordinates.
        count: usize,
    },
    /// `Box(width, depth)` or `Disc(diameter)`.
    Outline,
    /// An action, which [`Edit::Bind`](super::Edit::Bind) sets in a [`Slot::Field`](super::Slot::Field).
    Action,
    /// An output of a value: `Axis("LeftX")`, `ScrollY(24)`, `Taps(…)`.
    Output,
    /// Any other RON text.
    Ron,
}

/// Returns the tables of a layout file.
fn tables() -> &'static [Table] {
    static TABLES: LazyLock<Vec<Table>> = LazyLock::new(field_tables);
    &TABLES
}

/// Returns the row of a field.
pub(super) fn field_row(table: &str, field: &str) -> Option<&'static Row> {
    let table = tables().iter().find(|other| other.name == table)?;
    table.rows.iter().find(|row| row.name == field)
}

/// Returns the name of the table with the fields of a part.
pub(super) const fn table_of(part: Part) -> &'static str {
    match part {
        Part::Layout => "Layout",
        Part::Board(_) => "Board",
        Part::Row { .. } => "Row",
        Part::RowKey { .. } => ControlKind::Key.spec().table,
        Part::Control { kind, .. } => kind.spec().table,
        Part::RadioOption { .. } => "RadioOption",
        Part::Trigger(_) => "Trigger",
        Part::Pointer => "Pointer",
        Part::Space(_) => "Space",
        Part::SpaceTarget { .. } => "Target",
        Part::Layer(_) => "Layer",
        Part::Chord(_) => "Chord",
        Part::Sequence(_) => "Step",
    }
}

/// Returns `true` if the file gives a part a rotation in the plane of its board.
pub fn can_turn(part: Part) -> bool {
    let is_on_board = matches!(part, Part::RowKey { .. } | Part::Control { .. });
    is_on_board && field_row(table_of(part), "rotation_deg").is_some()
}

/// Returns the fields that a part can have, its name and position first, without the lists of other parts. The fields of a
/// sequence are the kinds of its steps, each with one value.
pub fn fields_of(part: Part) -> Vec<FieldSpec> {
    static FIELDS: LazyLock<BTreeMap<&str, Vec<FieldSpec>>> = LazyLock::new(|| {
        let tables = tables().iter();
        tables.map(|table| (table.name, fields(table))).collect()
    });
    FIELDS.get(table_of(part)).cloned().unwrap_or_default()
}

/// Radius of a board that becomes curved, in millimetres.
const NEW_RADIUS_MM: u32 = 320;

/// Returns the fields of a table, of its pose, and the radius of its shape.
fn fields(table: &'static Table) -> Vec<FieldSpec> {
    /// The fields that are shown first.
    const FIRST: [&str; 3] = ["name", "label", "at_mm"];
    let has_parts = matches!(table.name, "Layout" | "Board" | "Space");
    let mut fields = Vec::new();
    for row in &table.rows {
        match row.shapes.first() {
            None => {}
            Some(Shape::List(_) | Shape::Map(_)) if has_parts => {}
            Some(Shape::Table("Pointer")) => {}
            Some(Shape::Table("Pose")) if has_parts => {
                let pose = tables().iter().find(|candidate| candidate.name == "Pose");
                let rows = pose.map_or(&[][..], |pose| &pose.rows);
                fields.extend(rows.iter().filter_map(|pose_row| field(pose_row, "pose.")));
            }
            Some(Shape::Table("BoardShape")) => {
                let shape = field(row, "");
                fields.extend(shape.map(|field| FieldSpec {
                    field_type: choice(board_shapes()),
                    ..field
                }));
                let radius = field_row("BoardShape", "Arc(radius_mm)");
                fields.extend(radius.and_then(|radius_row| field(radius_row, "shape.")));
            }
            Some(_) => fields.extend(field(row, "")),
        }
    }
    let rank = |spec: &FieldSpec| {
        let first = FIRST.iter().position(|name| *name == spec.name);
        first.unwrap_or(FIRST.len())
    };
    fields.sort_by_key(rank);
    fields
}

/// Returns the shapes of a board, with a radius that suits a forearm for the curved ones.
fn board_shapes() -> impl Iterator<Item = String> {
    let is_shape = |row: &&Row| !row.name.contains('(');
    let table = tables().iter().find(|table| table.name == "BoardShape");
    let shapes = table.into_iter().flat_map(|table| table.rows.iter());
    shapes.filter(is_shape).map(|row| {
        let radius = format!("{}(radius_mm)", row.name);
        match field_row("BoardShape", &radius) {
            Some(_) => format!("{}(radius_mm: {NEW_RADIUS_MM})", row.name),
            None => row.name.clone(),
        }
    })
}

/// Returns the field of a row.
fn field(row: &'static Row, path: &str) -> Option<FieldSpec> {
    let name = row
        .name
        .split_once('(')
        .map_or(row.name.as_str(), |(_, name)| name);
    let name = format!("{path}{}", name.trim_end_matches(')'));
    let (field_type, unit) = match row.shapes.first()? {
        Shape::Bool => (FieldType::Bool, ""),
        &Shape::Number {
            min,
            max,
            unit,
            is_whole,
            ..
        } => (FieldType::Number { min, max, is_whole }, unit),
        Shape::Text { .. } => (FieldType::Text, ""),
        Shape::Words(words) => {
            let words = words.iter().map(|(word, _)| word.as_str());
            (choice(words.map(str::to_owned)), "")
        }
        Shape::Names(names, _) => (choice(names.iter().map(|word| quote(word))), ""),
        Shape::Tuple(parts) if parts.iter().all(|it| matches!(it, Shape::Number { .. })) => {
            let count = parts.len();
            (FieldType::Point { count }, "")
        }
        Shape::Table("Outline") => (FieldType::Outline, ""),
        Shape::Table("Action") => (FieldType::Action, ""),
        Shape::Table("Output") => (FieldType::Output, ""),
        _ => (FieldType::Ron, ""),
    };
    Some(FieldSpec {
        name: name.leak(),
        field_type,
        unit,
        default: row.default.trim_matches('`'),
        help: &row.meaning,
    })
}

/// Returns a choice of words. The words are leaked: each schema is read once in a run.
fn choice(words: impl Iterator<Item = String>) -> FieldType {
    let words: Vec<&'static str> = words.map(|word| &*word.leak()).collect();
    FieldType::Choice(words.leak())
}

/// Writes or removes a field of parts.
pub(super) fn set_field(
    draft: &mut Draft,
    parts: &[Part],
    name: &str,
    value: Option<&str>,
) -> Result<Vec<Part>, EditError> {
    // A comment after the value would hide what follows it in its line.
    let is_only_value =
        |text: &str| read_tree(text).is_some_and(|node| node.text(text) == text.trim());
    if let Some(value) = value
        && !is_only_value(value)
    {
        return Err(EditError::Value(value.to_owned()));
    }
    if let (&[part], "name", Some(new)) = (parts, name, value.and_then(quoted_content))
        && part != Part::Layout
    {
        return rename(draft, part, new);
    }
    let parts = take_out(draft, parts, false)?;
    for part in &parts {
        match value {
            Some(value) => draft.set(*part, name, value)?,
            None => draft.unset(*part, name)?,
        }
    }
    draft.commit()?;
    Ok(parts)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::editing::{Edit, NewPart, edit};
    use crate::layout::Layout;

    const BOARD: &str = "Layout(name: \"a\", boards: [(pose: (anchor: elbow), keys: [(code: \"A\", at_mm: (0, 0))])])";

    #[test]
    fn a_new_control_of_each_kind_is_valid_and_has_the_fields_of_its_schema() {
        for &kind in ControlKind::ALL {
            let new = NewPart::Control {
                board: 0,
                kind,
                at_mm: [0.0, 120.0],
                binding: None,
            };
            let edited = edit(BOARD, &Edit::Add(new)).unwrap();
            Layout::parse(&edited.text, "a.ron").unwrap_or_else(|error| panic!("{error}"));
            let fields = fields_of(edited.parts[0]);
            assert_eq!(fields[0].name, "name", "{kind:?}");
            let table = tables()
                .iter()
                .find(|table| table.name == kind.spec().table);
            let names = fields.iter().map(|field| field.name);
            for row in &table.unwrap().rows {
                assert!(
                    names.clone().any(|name| name == row.name),
                    "{kind:?}: {}",
                    row.name
                );
            }
            assert!(
                fields.iter().all(|field| !field.help.is_empty()),
                "{kind:?}"
            );
        }
    }

    #[test]
    fn a_field_has_the_range_the_unit_and_the_default_of_its_schema() {
        let of_board = fields_of(Part::Board(0));
        let field = |name: &str| of_board.iter().find(|field| field.name == name).copied();
        let pitch = field("pitch_mm").unwrap();
        let number = FieldType::Number {
            min: 1.0,
            max: 500.0,
            is_whole: false,
        };
        assert_eq!(
            (pitch.field_type, pitch.unit, pitch.default),
            (number, " mm", "19")
        );
        assert_eq!(
            field("hand").unwrap().field_type,
            FieldType::Choice(&["\"left\"", "\"right\""])
        );
        assert_eq!(
            field("pose.fit").unwrap().field_type,
            FieldType::Choice(&["Hand", "Off"])
        );
        assert!(field("shape.radius_mm").is_some());
        let shape = field("shape").unwrap();
        assert_eq!(
            (shape.default, field("pose.fit").unwrap().default),
            ("Flat", "Hand")
        );
        let FieldType::Choice(shapes) = shape.field_type else {
            panic!("{shape:?}");
        };
        for shape_name in shapes {
            let parts = vec![Part::Board(0)];
            let (path, value) = ("shape".to_owned(), Some((*shape_name).to_owned()));
            let edited = edit(
                BOARD,
                &Edit::SetField {
                    parts,
                    field: path,
                    value,
                },
            )
            .unwrap();
            Layout::parse(&edited.text, "a.ron").unwrap_or_else(|error| panic!("{error}"));
        }
        assert_eq!(field("keys"), None, "keys are parts of their own");
    }

    #[test]
    fn a_value_with_a_comment_around_it_is_refused() {
        let set = |value: &str| {
            let key = Part::control(0, ControlKind::Key, 0);
            let set = Edit::SetField {
                parts: vec![key],
                field: "code".to_owned(),
                value: Some(value.to_owned()),
            };
            edit(BOARD, &set).map(|edited| edited.text)
        };
        for value in ["\"B\" // b", "\"B\" // b\n", "/* b */ \"B\"", ""] {
            let error = set(value).unwrap_err();
            assert!(matches!(error, EditError::Value(_)), "{value}: {error}");
        }
        assert!(set(" \"B // b\" ").unwrap().contains("\"B // b\""));
    }
}
