//! Scaling of controls about a point of their common outline.

use super::arrange::prepare;
use super::draft::Draft;
use super::error::EditError;
use super::geometry::{Extent, is_round, required, rotation, set_size, size, unsupported};
use super::part::Part;
use crate::layout::quantity::{Pitch, Size};

/// A scaling about a point.
#[derive(Clone, Copy)]
struct Scaling {
    about: [f64; 2],
    factors: [f64; 2],
}

/// Scales positions and sizes of controls of one board. `fixed` is a point of their common outline as in [`Edit::Resize`](super::Edit).
pub(super) fn scale(
    draft: &mut Draft,
    parts: &[Part],
    factors: [f64; 2],
    fixed: [f64; 2],
) -> Result<Vec<Part>, EditError> {
    if !factors
        .iter()
        .all(|factor| factor.is_finite() && *factor > 0.0)
    {
        let message = "controls are scaled by factors above 0; choose other factors";
        return Err(EditError::Selection(message));
    }
    let message = "select at least one control to scale it";
    let (parts, extents) = prepare(draft, parts, 1, message)?;
    let Some(all) = Extent::around(&extents) else {
        return Ok(parts);
    };
    let scaling = Scaling {
        about: [0, 1].map(|axis| all.center[axis] + fixed[axis] * all.half[axis]),
        factors,
    };
    for &part in &parts {
        scale_one(draft, part, scaling)?;
    }
    draft.commit()?;
    Ok(parts)
}

fn scale_one(draft: &mut Draft, part: Part, scaling: Scaling) -> Result<(), EditError> {
    if let Some(options) = draft.radio_options(part) {
        return options
            .into_iter()
            .try_for_each(|option| scale_one(draft, option, scaling));
    }
    let Scaling { about, factors } = scaling;
    let old = size(draft, part)?.ok_or_else(|| unsupported(part, "resized", ""))?;
    let own = if is_round(draft, part) {
        // A disc stays a disc; the smaller factor keeps it off its neighbors.
        [factors[0].min(factors[1]); 2]
    } else {
        own_factors(rotation(draft, part)?, factors)
    };
    let limit = |value: f64| value.clamp(*Size::RANGE.start(), *Size::RANGE.end());
    set_size(draft, part, [0, 1].map(|axis| limit(old[axis] * own[axis])))?;
    if let Part::Row { board, .. } = part {
        let default = Pitch::default().get();
        let of_board = draft.number(Part::Board(board), "pitch_mm", default)?;
        let pitch = draft.number(part, "pitch_mm", of_board)? * factors[0];
        let pitch = pitch.clamp(*Pitch::RANGE.start(), *Pitch::RANGE.end());
        draft.set_number(part, "pitch_mm", pitch, of_board)?;
    }
    let at: [f64; 2] = required(draft.numbers(part, "at_mm")?)?;
    let scaled = |axis: usize| about[axis] + (at[axis] - about[axis]) * factors[axis];
    draft.set_numbers(part, "at_mm", [0, 1].map(scaled))
}

/// Returns the factors along the axes of a part that is turned: by how much the scaling lengthens each of them.
fn own_factors(rotation_deg: f64, [x, y]: [f64; 2]) -> [f64; 2] {
    let (sin, cos) = rotation_deg.to_radians().sin_cos();
    [(x * cos).hypot(y * sin), (x * sin).hypot(y * cos)]
}

#[cfg(test)]
mod tests {
    use super::super::part::ControlKind;
    use super::*;
    use crate::editing::{Edit, edit};

    fn text(controls: &str) -> String {
        format!("Layout(name: \"a\", boards: [(pose: (anchor: elbow), {controls})])")
    }

    fn scaled(controls: &str, parts: &[Part], factors: [f64; 2], fixed: [f64; 2]) -> String {
        let parts = parts.to_vec();
        let scale = Edit::Scale {
            parts,
            factors,
            fixed,
        };
        edit(&text(controls), &scale).unwrap().text
    }

    #[test]
    fn positions_and_sizes_are_scaled_about_the_opposite_corner() {
        // The outlines go from −10 to 60 mm and from −10 to 15 mm.
        let keys = [
            Part::control(0, ControlKind::Key, 0),
            Part::control(0, ControlKind::Key, 1),
            Part::control(0, ControlKind::Key, 2),
        ];
        let written = scaled(
            "keys: [(code: \"A\", at_mm: (0, 0), size_mm: Box(20, 20)),
            (code: \"B\", at_mm: (50, 5), size_mm: Disc(20)),
            (code: \"C\", at_mm: (30, 0), size_mm: Box(10, 20), rotation_deg: (0, 0, 90))]",
            &keys,
            [2.0, 1.5],
            [-1.0, -1.0],
        );
        let expected = text(
            "keys: [(code: \"A\", at_mm: (10, 5), size_mm: Box(40, 30)),
            (code: \"B\", at_mm: (110, 12.5), size_mm: Disc(30)),
            (code: \"C\", at_mm: (70, 5), size_mm: Box(15, 40), rotation_deg: (0, 0, 90))]",
        );
        assert_eq!(written, expected);
    }

    #[test]
    fn a_whole_row_stays_one_and_its_pitch_is_scaled() {
        let keys: Vec<Part> = (0..3)
            .map(|column| Part::RowKey {
                board: 0,
                row: 0,
                column,
            })
            .collect();
        let row = "rows: [(at_mm: (0, 0), keys: \"A B C\")]";
        let wider = scaled(row, &keys, [2.0, 1.0], [-1.0, 0.0]);
        // Keys of 17 mm at 19 mm: the left edge is at −8.5 mm.
        let expected =
            text("rows: [(at_mm: (8.5, 0), keys: \"A B C\", size_mm: Box(34, 17), pitch_mm: 38)]");
        assert_eq!(wider, expected);
    }

    #[test]
    fn the_options_of_a_radio_group_are_scaled() {
        let radio = Part::control(0, ControlKind::Radio, 0);
        let options = "radios: [(options: [(name: \"a\", at_mm: (0, 0), size_mm: Box(10, 10)), \
            (name: \"b\", at_mm: (20, 0), size_mm: Box(10, 10))])]";
        let smaller = scaled(options, &[radio], [0.5, 0.5], [0.0, 0.0]);
        let expected = text(options)
            .replace("Box(10, 10)", "Box(5, 5)")
            .replace("at_mm: (0, 0)", "at_mm: (5, 0)")
            .replace("at_mm: (20, 0)", "at_mm: (15, 0)");
        assert_eq!(smaller, expected);
    }

    #[test]
    fn sizes_stay_within_the_format_and_factors_are_positive() {
        let key = Part::control(0, ControlKind::Key, 0);
        let one = "keys: [(code: \"A\", at_mm: (0, 0), size_mm: Box(20, 20))]";
        let smallest = scaled(one, &[key], [0.001, 100.0], [0.0, 0.0]);
        assert!(smallest.contains("Box(1, 500)"), "{smallest}");
        for factors in [[0.0, 1.0], [1.0, -2.0], [f64::NAN, 1.0]] {
            let (parts, fixed) = (vec![key], [0.0, 0.0]);
            let scale = Edit::Scale {
                parts,
                factors,
                fixed,
            };
            assert!(edit(&text(one), &scale).is_err(), "{factors:?}");
        }
    }
}
