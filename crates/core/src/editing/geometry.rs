//! Positions and sizes of parts: move, resize, turn, tilt.

use super::draft::{Draft, written};
use super::error::EditError;
use super::fields::{can_turn, field_row, table_of};
use super::part::{ControlKind, Part};
use super::rows::{SourceRow, take_out};
use crate::document::Node;
use crate::layout::quantity::Size;

/// The outline of a part in row coordinates of its board, in millimetres.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Extent {
    /// Center.
    pub center: [f64; 2],
    /// Half extents of the rectangle around it.
    pub half: [f64; 2],
}

/// The place of a control as written in the file.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Place {
    /// Center in row coordinates of its board.
    pub center_mm: [f64; 2],
    /// Width and depth before the rotation; a round control has its diameter in both.
    pub size_mm: [f64; 2],
    /// Rotation about the center, counter-clockwise.
    pub rotation_deg: f64,
    /// `true` if the outline is a disc.
    pub is_round: bool,
}

/// The fields with the size of a part.
enum SizeFields {
    /// `size_mm`, which defaults to the size of the board.
    Outline,
    /// A length and a width.
    Track,
    /// A diameter.
    Diameter,
    /// The `shape` of a target in space.
    Volume,
}

/// Moves parts.
pub(super) fn shift(
    draft: &mut Draft,
    parts: &[Part],
    by_mm: [f64; 3],
) -> Result<Vec<Part>, EditError> {
    let parts = take_out(draft, &without_children(parts), true)?;
    for part in &parts {
        shift_one(draft, *part, by_mm)?;
    }
    draft.commit()?;
    Ok(parts)
}

pub(super) fn shift_one(draft: &mut Draft, part: Part, by: [f64; 3]) -> Result<(), EditError> {
    if let Some(options) = draft.radio_options(part) {
        return options
            .into_iter()
            .try_for_each(|option| shift_one(draft, option, by));
    }
    let [right, forward, up] = by;
    match part {
        Part::Board(_) | Part::Space(_) => shift_pose(draft, part, by),
        Part::SpaceTarget { .. } => {
            let [x, y, z] = required(draft.numbers(part, "at_mm")?)?;
            draft.set_numbers(part, "at_mm", [x + right, y + up, z - forward])
        }
        Part::Control {
            kind: ControlKind::Key,
            ..
        } => {
            shift_face(draft, part, right, forward)?;
            let lift = draft.number(part, "lift_mm", 0.0)?;
            draft.set_number(part, "lift_mm", lift + up, 0.0)
        }
        Part::Row { .. } | Part::Control { .. } | Part::RadioOption { .. } if up == 0.0 => {
            shift_face(draft, part, right, forward)
        }
        _ => Err(unsupported(
            part,
            "moved",
            match up {
                0.0 => "",
                _ => " off its board; move the board",
            },
        )),
    }
}

fn shift_face(draft: &mut Draft, part: Part, x: f64, y: f64) -> Result<(), EditError> {
    let at: [f64; 2] = required(draft.numbers(part, "at_mm")?)?;
    draft.set_numbers(part, "at_mm", [at[0] + x, at[1] + y])
}

/// Moves a board along its bearing, as the fields of its pose are defined.
fn shift_pose(
    draft: &mut Draft,
    part: Part,
    [right, forward, up]: [f64; 3],
) -> Result<(), EditError> {
    if right != 0.0 {
        if matches!(part, Part::Space(_)) {
            return Err(unsupported(
                part,
                "moved to the side",
                "; turn it about its anchor",
            ));
        }
        let old = draft.number(part, "pose.right_mm", 0.0)?;
        draft.set_number(part, "pose.right_mm", old + right, 0.0)?;
    }
    if forward != 0.0 {
        let default = arc_radius(draft, part)?;
        let old = draft.number(part, "pose.forward_mm", default)?;
        draft.set_number(part, "pose.forward_mm", old + forward, default)?;
    }
    let old = draft.number(part, "pose.height_mm", 0.0)?;
    draft.set_number(part, "pose.height_mm", old + up, 0.0)
}

/// Returns the radius of a board on arcs, which is the default of its `forward_mm`; 0 for any other part.
pub(super) fn arc_radius(draft: &Draft, part: Part) -> Result<f64, EditError> {
    let shape = draft.field(part, "shape");
    if shape.is_some_and(|shape| shape.name(draft.text()) == Some("Arc")) {
        draft.number(part, "shape.radius_mm", 0.0)
    } else {
        Ok(0.0)
    }
}

/// Changes sizes around a fixed point.
pub(super) fn resize(
    draft: &mut Draft,
    parts: &[Part],
    by_mm: [f64; 2],
    fixed: [f64; 2],
) -> Result<Vec<Part>, EditError> {
    let parts = take_out(draft, &without_children(parts), true)?;
    for &part in &parts {
        let old = size(draft, part)?.ok_or_else(|| unsupported(part, "resized", ""))?;
        let limit = |value: f64| value.clamp(*Size::RANGE.start(), *Size::RANGE.end());
        let new = if is_round(draft, part) {
            [limit(old[0] + by_mm[0]); 2]
        } else {
            [limit(old[0] + by_mm[0]), limit(old[1] + by_mm[1])]
        };
        set_size(draft, part, new)?;
        let (sin, cos) = rotation(draft, part)?.to_radians().sin_cos();
        let x = -fixed[0] * (new[0] - old[0]) / 2.0;
        let y = -fixed[1] * (new[1] - old[1]) / 2.0;
        shift_one(draft, part, [x * cos - y * sin, x * sin + y * cos, 0.0])?;
    }
    draft.commit()?;
    Ok(parts)
}

/// Sets width and depth of a part about its center, each if it is given.
pub(super) fn set_size_one(
    draft: &mut Draft,
    part: Part,
    new_mm: [Option<f64>; 2],
) -> Result<(), EditError> {
    let old = size(draft, part)?.ok_or_else(|| unsupported(part, "resized", ""))?;
    let limit = |value: f64| value.clamp(*Size::RANGE.start(), *Size::RANGE.end());
    let new = [0, 1].map(|axis| limit(new_mm[axis].unwrap_or(old[axis])));
    let new = if is_round(draft, part) {
        [new_mm[0].or(new_mm[1]).map_or(old[0], limit); 2]
    } else {
        new
    };
    set_size(draft, part, new)
}

/// Turns parts counter-clockwise.
pub(super) fn turn(
    draft: &mut Draft,
    parts: &[Part],
    degrees: f64,
) -> Result<Vec<Part>, EditError> {
    let parts = take_out(draft, &without_children(parts), false)?;
    for &part in &parts {
        match part {
            Part::Board(_) | Part::Space(_) => {
                let old = draft.number(part, "pose.bearing_deg", 0.0)?;
                draft.set_number(part, "pose.bearing_deg", wrapped(old - degrees), 0.0)?;
            }
            Part::Control {
                kind: ControlKind::Key,
                ..
            } => {
                let [x, y, z] = draft.numbers(part, "rotation_deg")?.unwrap_or_default();
                draft.set_numbers(part, "rotation_deg", [x, y, wrapped(z + degrees)])?;
            }
            _ if can_turn(part) => {
                let old = draft.number(part, "rotation_deg", 0.0)?;
                draft.set_number(part, "rotation_deg", wrapped(old + degrees), 0.0)?;
            }
            _ => {
                return Err(unsupported(
                    part,
                    "turned",
                    "; turn its board, or use another control",
                ));
            }
        }
    }
    draft.commit()?;
    Ok(parts)
}

/// Lifts the far sides of parts.
pub(super) fn tilt(
    draft: &mut Draft,
    parts: &[Part],
    degrees: f64,
) -> Result<Vec<Part>, EditError> {
    let parts = take_out(draft, &without_children(parts), false)?;
    for &part in &parts {
        match part {
            Part::Board(_) | Part::Space(_) => {
                let tilt = draft.number(part, "pose.tilt_deg", 0.0)? + degrees;
                draft.set_number(part, "pose.tilt_deg", tilt.clamp(-90.0, 90.0), 0.0)?;
            }
            Part::Control {
                kind: ControlKind::Key,
                ..
            } => {
                let [x, y, z] = draft.numbers(part, "rotation_deg")?.unwrap_or_default();
                draft.set_numbers(part, "rotation_deg", [wrapped(x + degrees), y, z])?;
            }
            _ => return Err(unsupported(part, "tilted", "; tilt its board")),
        }
    }
    draft.commit()?;
    Ok(parts)
}

/// Returns the rectangle around a part of a board.
pub(super) fn extent(draft: &Draft, part: Part) -> Result<Extent, EditError> {
    if let Some(options) = draft.radio_options(part) {
        let extents = options.into_iter().map(|option| extent(draft, option));
        let extents: Vec<Extent> = extents.collect::<Result<_, _>>()?;
        return Extent::around(&extents).ok_or(EditError::NoPart("radio option"));
    }
    let size = size(draft, part)?.ok_or_else(|| unsupported(part, "arranged", ""))?;
    let at: [f64; 2] = required(draft.numbers(part, "at_mm")?)?;
    if let Part::Row { board, row } = part {
        let row = SourceRow::read(draft, board, row)?;
        let last = row.center(row.len().saturating_sub(1));
        return Ok(Extent {
            center: [(at[0] + last[0]) / 2.0, at[1]],
            half: [(last[0] - at[0] + size[0]) / 2.0, size[1] / 2.0],
        });
    }
    let (sin, cos) = if is_round(draft, part) {
        (0.0, 1.0)
    } else {
        rotation(draft, part)?.to_radians().sin_cos()
    };
    let [width, depth] = size;
    Ok(Extent {
        center: at,
        half: [
            (width * cos.abs() + depth * sin.abs()) / 2.0,
            (width * sin.abs() + depth * cos.abs()) / 2.0,
        ],
    })
}

/// Returns the places of controls of a text as written, without those that have none.
pub fn places(text: &str, parts: Vec<Part>) -> Vec<(Part, Place)> {
    let Ok(draft) = Draft::new(text) else {
        return Vec::new();
    };
    let place = |part| Some((part, place(&draft, part).ok()?));
    parts.into_iter().filter_map(place).collect()
}

pub(super) fn place(draft: &Draft, part: Part) -> Result<Place, EditError> {
    let (own, center) = match part {
        Part::RowKey { board, row, column } => {
            let source = SourceRow::read(draft, board, row)?;
            (Part::Row { board, row }, source.center(column))
        }
        _ => (part, required(draft.numbers(part, "at_mm")?)?),
    };
    let size = size(draft, own)?.ok_or_else(|| unsupported(part, "drawn", ""))?;
    Ok(Place {
        center_mm: center,
        size_mm: size,
        rotation_deg: rotation(draft, own)?,
        is_round: is_round(draft, own),
    })
}

impl Extent {
    /// Returns the rectangle around several.
    pub fn around(extents: &[Self]) -> Option<Self> {
        let corner = |axis: usize, sign: f64| {
            let edges = extents
                .iter()
                .map(|it| sign * it.center[axis] + it.half[axis]);
            Some(sign * edges.reduce(f64::max)?)
        };
        let [low, high] = [-1.0, 1.0].map(|sign| Some([corner(0, sign)?, corner(1, sign)?]));
        let (low, high) = (low?, high?);
        let axes = [0, 1];
        Some(Self {
            center: axes.map(|axis| (low[axis] + high[axis]) / 2.0),
            half: axes.map(|axis| (high[axis] - low[axis]) / 2.0),
        })
    }
}

/// Leaves out parts whose row, radio group or board is among the parts, too.
pub(super) fn without_children(parts: &[Part]) -> Vec<Part> {
    let all: std::collections::BTreeSet<Part> = parts.iter().copied().collect();
    let ancestors = |part: &Part| std::iter::successors(part.parent(), |part| part.parent());
    let mut kept: Vec<Part> = Vec::new();
    let mut seen = std::collections::BTreeSet::new();
    for part in parts {
        if !ancestors(part).any(|part| all.contains(&part)) && seen.insert(*part) {
            kept.push(*part);
        }
    }
    kept
}

fn size_fields(part: Part) -> Option<SizeFields> {
    if matches!(part, Part::SpaceTarget { .. }) {
        return Some(SizeFields::Volume);
    }
    let (Part::Row { .. } | Part::RadioOption { .. } | Part::Control { .. }) = part else {
        return None;
    };
    let has = |name| field_row(table_of(part), name).is_some();
    [
        ("diameter_mm", SizeFields::Diameter),
        ("length_mm", SizeFields::Track),
        ("size_mm", SizeFields::Outline),
    ]
    .into_iter()
    .find_map(|(name, fields)| has(name).then_some(fields))
}

/// Returns the value with the outline: the part's own, or its board's.
fn outline(draft: &Draft, part: Part) -> Option<&Node> {
    let own = draft.field(part, "size_mm");
    own.or_else(|| draft.field(Part::Board(part.board()?), "size_mm"))
}

pub(super) fn is_round(draft: &Draft, part: Part) -> bool {
    match size_fields(part) {
        Some(SizeFields::Diameter) => true,
        Some(SizeFields::Outline) => {
            outline(draft, part).is_some_and(|outline| outline.name(draft.text()) == Some("Disc"))
        }
        Some(SizeFields::Volume) => draft
            .field(part, "shape")
            .is_some_and(|shape| shape.name(draft.text()) == Some("Ball")),
        _ => false,
    }
}

/// Returns width and depth of the controls of a board that have no size of their own.
pub(super) fn default_size(draft: &Draft, board: usize) -> Result<[f64; 2], EditError> {
    match draft.field(Part::Board(board), "size_mm") {
        Some(outline) => size_of(draft, outline, "size_mm"),
        None => Ok([Size::default().get(); 2]),
    }
}

/// Returns width and depth of an outline or a volume, as the value of a field.
fn size_of(draft: &Draft, outline: &Node, field: &str) -> Result<[f64; 2], EditError> {
    let items = outline.items().iter();
    let numbers: Option<Vec<f64>> = items.map(|item| item.value.number(draft.text())).collect();
    match numbers.as_deref() {
        Some([diameter]) => Ok([*diameter; 2]),
        Some([width, depth]) => Ok([*width, *depth]),
        Some([width, _, depth]) => Ok([*width, *depth]),
        _ => Err(EditError::Field(field.to_owned())),
    }
}

/// Returns width and depth before the rotation.
pub(super) fn size(draft: &Draft, part: Part) -> Result<Option<[f64; 2]>, EditError> {
    let default = Size::default().get();
    let Some(fields) = size_fields(part) else {
        return Ok(None);
    };
    Ok(Some(match fields {
        SizeFields::Outline => match outline(draft, part) {
            Some(outline) => size_of(draft, outline, "size_mm")?,
            None => [default; 2],
        },
        SizeFields::Volume => {
            let shape = draft.field(part, "shape");
            let shape = shape.ok_or_else(|| EditError::Field("shape".into()))?;
            size_of(draft, shape, "shape")?
        }
        SizeFields::Track => [
            draft.number(part, "length_mm", default)?,
            draft.number(part, "width_mm", default)?,
        ],
        SizeFields::Diameter => [draft.number(part, "diameter_mm", default)?; 2],
    }))
}

pub(super) fn set_size(draft: &mut Draft, part: Part, new: [f64; 2]) -> Result<(), EditError> {
    let [width, depth] = new;
    let default = Size::default().get();
    match size_fields(part) {
        Some(SizeFields::Track) => {
            draft.set_number(part, "length_mm", width, default)?;
            draft.set_number(part, "width_mm", depth, default)
        }
        Some(SizeFields::Diameter) => draft.set_number(part, "diameter_mm", width, default),
        Some(SizeFields::Volume) => {
            draft.set_number(part, "shape.0", width, default)?;
            if is_round(draft, part) {
                Ok(())
            } else {
                draft.set_number(part, "shape.2", depth, default)
            }
        }
        _ if draft.field(part, "size_mm").is_some() => {
            draft.set_number(part, "size_mm.0", width, default)?;
            if is_round(draft, part) {
                Ok(())
            } else {
                draft.set_number(part, "size_mm.1", depth, default)
            }
        }
        _ => {
            let value = if is_round(draft, part) {
                format!("Disc({})", written(width))
            } else {
                format!("Box({}, {})", written(width), written(depth))
            };
            draft.set(part, "size_mm", &value)
        }
    }
}

/// Returns the rotation in the plane of the board, in degrees.
pub(super) fn rotation(draft: &Draft, part: Part) -> Result<f64, EditError> {
    match part {
        Part::Control {
            kind: ControlKind::Key,
            ..
        } => {
            let [_, _, z] = draft.numbers(part, "rotation_deg")?.unwrap_or_default();
            Ok(z)
        }
        _ if can_turn(part) => draft.number(part, "rotation_deg", 0.0),
        _ => Ok(0.0),
    }
}

/// Returns an angle from −180° to 180°.
pub(super) fn wrapped(degrees: f64) -> f64 {
    if (-180.0..=180.0).contains(&degrees) {
        degrees
    } else {
        (degrees + 180.0).rem_euclid(360.0) - 180.0
    }
}

pub(super) fn required<const N: usize>(numbers: Option<[f64; N]>) -> Result<[f64; N], EditError> {
    numbers.ok_or_else(|| EditError::Field("at_mm".into()))
}

pub(super) fn unsupported(part: Part, verb: &'static str, remedy: &'static str) -> EditError {
    EditError::Unsupported {
        kind: part.kind_name(),
        verb,
        remedy,
    }
}
