//! Arrangement of several controls of a board: align, distribute, mirror, snap.

use super::draft::{Draft, written};
use super::error::EditError;
use super::fields::can_turn;
use super::geometry::{Extent, extent, set_size_one, shift_one, without_children, wrapped};
use super::part::{ControlKind, Part};
use super::rows::take_out;

/// The line on which parts are aligned.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum AlignEdge {
    /// The left edge of the leftmost.
    Left,
    /// The right edge of the rightmost.
    Right,
    /// The far edge of the farthest.
    Top,
    /// The near edge of the nearest.
    Bottom,
    /// The middle between left and right.
    CenterX,
    /// The middle between near and far.
    CenterY,
}

/// A direction on a board.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum BoardAxis {
    /// Along the rows.
    X,
    /// Away from the wearer.
    Y,
}

/// Numbers that several controls get; `None` leaves those that they have. In millimetres.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct PlaceTo {
    /// Center.
    pub center_mm: [Option<f64>; 2],
    /// Width and depth; a round control has its width as diameter.
    pub size_mm: [Option<f64>; 2],
}

/// Aligns parts along their outlines.
pub(super) fn align(
    draft: &mut Draft,
    parts: &[Part],
    edge: AlignEdge,
) -> Result<Vec<Part>, EditError> {
    let before = draft.text().to_owned();
    let message = "select at least two controls to align them";
    let (aligned, extents) = prepare(draft, parts, 2, message)?;
    let Some(all) = Extent::around(&extents) else {
        return Ok(aligned);
    };
    let (axis, side) = match edge {
        AlignEdge::Left => (0, -1.0),
        AlignEdge::Right => (0, 1.0),
        AlignEdge::CenterX => (0, 0.0),
        AlignEdge::Bottom => (1, -1.0),
        AlignEdge::Top => (1, 1.0),
        AlignEdge::CenterY => (1, 0.0),
    };
    let line = |extent: &Extent| extent.center[axis] + side * extent.half[axis];
    let distance = |extent: &Extent| line(&all) - line(extent);
    let distances: Vec<f64> = extents.iter().map(distance).collect();
    if is_still(&distances) {
        return unchanged(draft, &before, parts);
    }
    shift_along(draft, &aligned, axis, distances)
}

/// Makes the gaps between parts equal.
pub(super) fn distribute(
    draft: &mut Draft,
    parts: &[Part],
    axis: BoardAxis,
) -> Result<Vec<Part>, EditError> {
    let before = draft.text().to_owned();
    let message = "select at least three controls to distribute them";
    let (distributed, extents) = prepare(draft, parts, 3, message)?;
    let axis = axis as usize;
    let mut order: Vec<usize> = (0..distributed.len()).collect();
    order.sort_by(|&a, &b| extents[a].center[axis].total_cmp(&extents[b].center[axis]));
    let (first, last) = (&extents[order[0]], &extents[order[order.len() - 1]]);
    let start = first.center[axis] - first.half[axis];
    let end = last.center[axis] + last.half[axis];
    let widths: f64 = extents.iter().map(|extent| 2.0 * extent.half[axis]).sum();
    let gap = (end - start - widths) / (distributed.len() - 1) as f64;
    let mut distances = vec![0.0; distributed.len()];
    let mut next = start;
    for index in order {
        let extent = &extents[index];
        distances[index] = next + extent.half[axis] - extent.center[axis];
        next += 2.0 * extent.half[axis] + gap;
    }
    if is_still(&distances) {
        return unchanged(draft, &before, parts);
    }
    shift_along(draft, &distributed, axis, distances)
}

/// Mirrors parts about the middle of their common outline. A turned one is turned the other way; its front is not mirrored.
pub(super) fn mirror(
    draft: &mut Draft,
    parts: &[Part],
    axis: BoardAxis,
) -> Result<Vec<Part>, EditError> {
    let message = "select at least one control to mirror it";
    let (parts, extents) = prepare(draft, parts, 1, message)?;
    let Some(all) = Extent::around(&extents) else {
        return Ok(parts);
    };
    for &part in &parts {
        turn_back(draft, part, axis)?;
    }
    let axis = axis as usize;
    let distances = extents
        .iter()
        .map(|extent| 2.0 * (all.center[axis] - extent.center[axis]));
    shift_along(draft, &parts, axis, distances.collect())
}

/// Turns a control to the angles of its mirror image.
fn turn_back(draft: &mut Draft, part: Part, axis: BoardAxis) -> Result<(), EditError> {
    // Negated by subtraction, which makes no −0.
    let back = |degrees: f64| wrapped(0.0 - degrees);
    if matches!(part, Part::Control { kind, .. } if kind == ControlKind::Key) {
        if let Some([x, y, z]) = draft.numbers(part, "rotation_deg")? {
            let turned = match axis {
                BoardAxis::X => [x, back(y), back(z)],
                BoardAxis::Y => [back(x), y, back(z)],
            };
            draft.set_numbers(part, "rotation_deg", turned)?;
        }
    } else if can_turn(part) {
        let old = draft.number(part, "rotation_deg", 0.0)?;
        draft.set_number(part, "rotation_deg", back(old), 0.0)?;
    }
    Ok(())
}

/// Moves centers to the nearest crossing of a grid.
pub(super) fn snap(
    draft: &mut Draft,
    parts: &[Part],
    grid_mm: f64,
) -> Result<Vec<Part>, EditError> {
    if !(0.01..=500.0).contains(&grid_mm) {
        return Err(EditError::Selection(
            "the grid must be 0.01 to 500 mm wide; set another width",
        ));
    }
    let parts = take_out(draft, &without_children(parts), true)?;
    for &part in &parts {
        let Some([x, y]) = draft.numbers(part, "at_mm")? else {
            return Err(super::geometry::unsupported(part, "snapped to a grid", ""));
        };
        let distance = |value: f64| (value / grid_mm).round() * grid_mm - value;
        shift_one(draft, part, [distance(x), distance(y), 0.0])?;
    }
    draft.commit()?;
    Ok(parts)
}

/// Sets positions and sizes of controls.
pub(super) fn place(
    draft: &mut Draft,
    parts: &[Part],
    to: &PlaceTo,
) -> Result<Vec<Part>, EditError> {
    // A row stays one while its keys stay beside each other.
    let keeps_rows = to.center_mm[0].is_none();
    let parts = take_out(draft, &without_children(parts), keeps_rows)?;
    if to.size_mm != [None; 2] {
        for &part in &parts {
            set_size_one(draft, part, to.size_mm)?;
        }
        draft.commit()?;
    }
    if to.center_mm != [None; 2] {
        for &part in &parts {
            let Some(old) = draft.numbers::<2>(part, "at_mm")? else {
                return Err(super::geometry::unsupported(part, "placed", ""));
            };
            let by = [0, 1].map(|axis| to.center_mm[axis].map_or(0.0, |new| new - old[axis]));
            shift_one(draft, part, [by[0], by[1], 0.0])?;
        }
        draft.commit()?;
    }
    Ok(parts)
}

/// Returns the parts after keys were taken out of their rows, and their outlines.
pub(super) fn prepare(
    draft: &mut Draft,
    parts: &[Part],
    minimum: usize,
    message: &'static str,
) -> Result<(Vec<Part>, Vec<Extent>), EditError> {
    let parts = take_out(draft, &without_children(parts), true)?;
    if parts.len() < minimum {
        return Err(EditError::Selection(message));
    }
    if parts
        .iter()
        .any(|part| part.board().is_none() || part.board() != parts[0].board())
    {
        let reason = "these parts are not all on one board; select controls of one board";
        return Err(EditError::Selection(reason));
    }
    let extents: Result<_, _> = parts.iter().map(|part| extent(draft, *part)).collect();
    Ok((parts, extents?))
}

/// Returns `true` if all distances are too short to be written.
fn is_still(distances: &[f64]) -> bool {
    distances.iter().all(|distance| written(*distance) == "0")
}

/// Returns to the text before, in which keys are in their rows: nothing moves.
fn unchanged(draft: &mut Draft, before: &str, parts: &[Part]) -> Result<Vec<Part>, EditError> {
    *draft = Draft::new(before)?;
    Ok(parts.to_vec())
}

fn shift_along(
    draft: &mut Draft,
    parts: &[Part],
    axis: usize,
    distances: Vec<f64>,
) -> Result<Vec<Part>, EditError> {
    for (part, distance) in parts.iter().zip(distances) {
        let mut by = [0.0; 3];
        by[axis] = distance;
        shift_one(draft, *part, by)?;
    }
    draft.commit()?;
    Ok(parts.to_vec())
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::editing::{Edit, edit};

    fn mirrored(text: &str, axis: BoardAxis) -> String {
        let key = |index| Part::control(0, ControlKind::Key, index);
        let parts = vec![key(0), key(1)];
        edit(text, &Edit::Mirror { parts, axis }).unwrap().text
    }

    #[test]
    fn mirrored_keys_exchange_their_sides_and_turn_the_other_way() {
        let text = "Layout(name: \"a\", boards: [(pose: (anchor: elbow), keys: [\n\
            (code: \"A\", at_mm: (0, 0), rotation_deg: (5, 0, 90)), // left\n\
            (code: \"B\", at_mm: (50, 7), size_mm: Box(30, 17))])])";
        let across = mirrored(text, BoardAxis::X);
        // The outlines go from -8.5 to 65 mm.
        let expected = text
            .replace("(50, 7)", "(6.5, 7)")
            .replace("(0, 0)", "(56.5, 0)")
            .replace("(5, 0, 90)", "(5, 0, -90)");
        assert_eq!(across, expected);
        assert_eq!(mirrored(&across, BoardAxis::X), text);
        let along = mirrored(text, BoardAxis::Y);
        let nearer = text
            .replace("(50, 7)", "(50, 0)")
            .replace("(0, 0)", "(0, 7)")
            .replace("(5, 0, 90)", "(-5, 0, -90)");
        assert_eq!(along, nearer);
    }

    #[test]
    fn keys_that_are_arranged_already_stay_in_their_row() {
        let text = "Layout(name: \"a\", boards: [(pose: (anchor: elbow), \
            rows: [(at_mm: (0, 0), keys: \"A B C D\")])])";
        let key = |column| Part::RowKey {
            board: 0,
            row: 0,
            column,
        };
        let parts = vec![key(0), key(1), key(2)];
        let align = |edge| Edit::Align {
            parts: parts.clone(),
            edge,
        };
        let distribute = Edit::Distribute {
            parts: parts.clone(),
            axis: BoardAxis::X,
        };
        for arranged in [align(AlignEdge::Top), distribute] {
            let edited = edit(text, &arranged).unwrap();
            assert_eq!(edited.text, text);
            assert!(edited.patches.is_empty());
            assert_eq!(edited.parts, parts);
        }
        let moved = edit(text, &align(AlignEdge::Left)).unwrap();
        assert_ne!(moved.text, text);
    }
}
