//! Copies of controls along an arc of a circle.

use super::draft::Draft;
use super::duplicate::{MAX_COPIES, duplicate};
use super::error::EditError;
use super::fields::can_turn;
use super::geometry::{Extent, extent, place, turn, unsupported, without_children};
use super::part::{ControlKind, Part};
use super::rows::SourceRow;

/// Range of the radius, in millimetres, to either side.
const RADII_MM: std::ops::RangeInclusive<f64> = 1.0..=10_000.0;

/// A circle, in row coordinates.
struct Circle {
    center: [f64; 2],
    /// Angle from one copy to the next, counter-clockwise, in degrees.
    step_deg: f64,
}

/// Copies controls along an arc. Returns the originals and the copies.
pub(super) fn repeat_along_arc(
    draft: &mut Draft,
    parts: &[Part],
    count: usize,
    step_deg: f64,
    radius_mm: f64,
) -> Result<Vec<Part>, EditError> {
    let parts = controls(draft, parts)?;
    let copies = count.saturating_sub(1).saturating_mul(parts.len());
    if copies == 0 || copies > MAX_COPIES {
        let message = "a repetition makes 1 to 400 copies; choose another number";
        return Err(EditError::Selection(message));
    }
    if !RADII_MM.contains(&radius_mm.abs()) || !(step_deg * count as f64).is_finite() {
        let message = "the radius of a repetition is 1 to 10 000 mm; choose another one";
        return Err(EditError::Selection(message));
    }
    let places: Result<Vec<([f64; 2], f64)>, EditError> =
        parts.iter().map(|part| middle(draft, *part)).collect();
    let places = places?;
    let circle = Circle::new(&places, step_deg, radius_mm);
    let mut all = parts.clone();
    for copy in 1..count {
        let degrees = circle.step_deg * copy as f64;
        for (part, (at, _)) in parts.iter().zip(&places) {
            let copied = duplicate(draft, &[*part], circle.displacement(*at, degrees))?;
            let turned: Vec<Part> = copied.iter().copied().filter(|it| can_turn(*it)).collect();
            turn(draft, &turned, degrees)?;
            all.extend(copied);
        }
    }
    Ok(all)
}

/// Returns the controls of parts; of a row its keys, which are turned one by one.
fn controls(draft: &Draft, parts: &[Part]) -> Result<Vec<Part>, EditError> {
    let mut controls = Vec::new();
    for part in without_children(parts) {
        match part {
            Part::Row { board, row } => {
                let columns = 0..SourceRow::read(draft, board, row)?.len();
                controls.extend(columns.map(|column| Part::RowKey { board, row, column }));
            }
            Part::RowKey { .. } | Part::Control { .. } | Part::RadioOption { .. } => {
                controls.push(part);
            }
            _ => return Err(unsupported(part, "repeated along an arc", "")),
        }
    }
    Ok(controls)
}

/// Returns the center of a control, and its rotation in degrees.
fn middle(draft: &Draft, part: Part) -> Result<([f64; 2], f64), EditError> {
    if let Part::Control {
        kind: ControlKind::Radio,
        ..
    } = part
    {
        return Ok((extent(draft, part)?.center, 0.0));
    }
    let place = place(draft, part)?;
    Ok((place.center_mm, place.rotation_deg))
}

impl Circle {
    /// Returns the circle through the middle of controls, with its center at their near side, or at the far side of a negative radius.
    ///
    /// The near side of a control that is turned is turned with it: the last copy continues along the same circle.
    fn new(places: &[([f64; 2], f64)], step_deg: f64, radius_mm: f64) -> Self {
        let points = places.iter().map(|(at, _)| Extent {
            center: *at,
            half: [0.0; 2],
        });
        let all = Extent::around(&points.collect::<Vec<_>>());
        let middle = all.map_or([0.0; 2], |all| all.center);
        let first = places.first().map_or(0.0, |(_, degrees)| *degrees);
        let is_common = places.iter().all(|(_, degrees)| *degrees == first);
        let [x, y] = turned([0.0, radius_mm], if is_common { first } else { 0.0 });
        Self {
            center: [middle[0] - x, middle[1] - y],
            step_deg: -step_deg * radius_mm.signum(),
        }
    }

    /// Returns the displacement of a point that turns about the center.
    fn displacement(&self, at: [f64; 2], degrees: f64) -> [f64; 2] {
        let from = [0, 1].map(|axis| at[axis] - self.center[axis]);
        let to = turned(from, degrees);
        [0, 1].map(|axis| to[axis] - from[axis])
    }
}

/// Returns a vector that is turned counter-clockwise.
fn turned([x, y]: [f64; 2], degrees: f64) -> [f64; 2] {
    let (sin, cos) = degrees.to_radians().sin_cos();
    [x * cos - y * sin, x * sin + y * cos]
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::editing::{Edit, Edited, edit};
    use crate::layout::Layout;

    const KEY: Part = Part::control(0, ControlKind::Key, 0);

    fn repeated(
        controls: &str,
        parts: &[Part],
        count: usize,
        (step_deg, radius_mm): (f64, f64),
    ) -> Result<Edited, EditError> {
        let text = format!("Layout(name: \"a\", boards: [(pose: (anchor: elbow), {controls})])");
        let repeat = Edit::RepeatAlongArc {
            parts: parts.to_vec(),
            count,
            step_deg,
            radius_mm,
        };
        edit(&text, &repeat)
    }

    #[test]
    fn copies_go_to_the_right_around_the_near_side_and_turn_with_the_arc() {
        let key = "keys: [(code: \"A\", at_mm: (10, 50))]";
        let edited = repeated(key, &[KEY], 3, (90.0, 100.0)).unwrap();
        // The center of the circle is at (10, −50).
        for copy in [
            "name: \"A 2\", at_mm: (110, -50), rotation_deg: (0, 0, -90)",
            "name: \"A 3\", at_mm: (10, -150), rotation_deg: (0, 0, -180)",
        ] {
            assert!(edited.text.contains(copy), "{}", edited.text);
        }
        assert_eq!(edited.parts.len(), 3, "all are selected");
        let bowl = repeated(key, &[KEY], 2, (90.0, -100.0)).unwrap();
        let copy = "at_mm: (110, 150), rotation_deg: (0, 0, 90)";
        assert!(bowl.text.contains(copy), "{}", bowl.text);
    }

    #[test]
    fn a_copy_goes_on_along_the_circle_of_its_original() {
        let key = "keys: [(code: \"A\", at_mm: (110, -50), rotation_deg: (0, 0, -90))]";
        let edited = repeated(key, &[KEY], 2, (90.0, 100.0)).unwrap();
        let copy = "at_mm: (10, -150), rotation_deg: (0, 0, -180)";
        assert!(edited.text.contains(copy), "{}", edited.text);
    }

    #[test]
    fn keys_of_a_row_become_single_keys_and_a_round_control_is_not_turned() {
        let controls = "rows: [(at_mm: (0, 40), keys: \"A B\")], \
            knobs: [(name: \"Volume\", at_mm: (9.5, 80), diameter_mm: 30)]";
        let parts = [
            Part::Row { board: 0, row: 0 },
            Part::control(0, ControlKind::Knob, 0),
        ];
        let edited = repeated(controls, &parts, 2, (30.0, 200.0)).unwrap();
        let layout = Layout::parse(&edited.text, "a.ron").unwrap();
        let all = layout.target_names();
        let names: Vec<&str> = all.iter().collect();
        assert_eq!(names, ["A", "B", "A 2", "B 2", "Volume", "Volume 2"]);
        let turned = edited.text.matches("rotation_deg: (0, 0, -30)").count();
        assert_eq!(turned, 2, "{}", edited.text);
        // The middle of the centers is (9.5, 60), the center of the circle (9.5, −140).
        let knob = "name: \"Volume 2\", at_mm: (119.5, 50.53)";
        assert!(edited.text.contains(knob), "{}", edited.text);
    }

    #[test]
    fn numbers_without_a_meaning_and_boards_are_refused() {
        let key = "keys: [(code: \"A\", at_mm: (0, 0))]";
        for (count, numbers) in [
            (1, (30.0, 100.0)),
            (402, (30.0, 100.0)),
            (3, (30.0, 0.0)),
            (3, (f64::NAN, 100.0)),
            (3, (30.0, f64::INFINITY)),
        ] {
            let refused = repeated(key, &[KEY], count, numbers);
            assert!(refused.is_err(), "{count} {numbers:?}");
        }
        assert!(repeated(key, &[Part::Board(0)], 2, (30.0, 100.0)).is_err());
    }
}
