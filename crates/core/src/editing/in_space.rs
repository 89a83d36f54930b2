//! Boards and targets in space, moved along the axes of the world and turned where they are.

use super::draft::Draft;
use super::error::EditError;
use super::geometry::{arc_radius, shift_one, unsupported, without_children, wrapped};
use super::part::Part;

/// Moves boards and targets in space: to the right, away from the wearer and up, whatever their bearings are.
pub(super) fn shift(
    draft: &mut Draft,
    parts: &[Part],
    by_mm: [f64; 3],
) -> Result<Vec<Part>, EditError> {
    let parts = without_children(parts);
    for &part in &parts {
        let own = match part {
            Part::Board(_) => along_bearing(by_mm, bearing(draft, part)?),
            Part::SpaceTarget { space, .. } => {
                let space = Part::Space(space);
                let [right, forward, up] = along_bearing(by_mm, bearing(draft, space)?);
                let (sin, cos) = tilt(draft, space)?.sin_cos();
                [right, up * sin + forward * cos, up * cos - forward * sin]
            }
            _ => return Err(unsupported(part, "moved in space", "; move its board")),
        };
        shift_one(draft, part, own)?;
    }
    draft.commit()?;
    Ok(parts)
}

/// Turns boards counter-clockwise as seen from above: a board on arcs about the center of its arcs, any other about its (0, 0).
pub(super) fn turn(
    draft: &mut Draft,
    parts: &[Part],
    degrees: f64,
) -> Result<Vec<Part>, EditError> {
    let parts = without_children(parts);
    for &part in &parts {
        let Part::Board(_) = part else {
            return Err(unsupported(part, "turned in space", "; turn its board"));
        };
        let old = draft.number(part, "pose.bearing_deg", 0.0)?;
        let new = wrapped(old - degrees);
        let radius = arc_radius(draft, part)?;
        let right = draft.number(part, "pose.right_mm", 0.0)?;
        let forward = draft.number(part, "pose.forward_mm", radius)?;
        let to_center = radius * tilt(draft, part)?.cos();
        let pivot = [right, forward - to_center, 0.0];
        let turned = along_bearing(pivot, (new - old).to_radians());
        let by = [turned[0] - pivot[0], turned[1] - pivot[1], 0.0];
        draft.set_number(part, "pose.bearing_deg", new, 0.0)?;
        shift_one(draft, part, by)?;
    }
    draft.commit()?;
    Ok(parts)
}

/// Returns the bearing of a board or space, in radians.
fn bearing(draft: &Draft, part: Part) -> Result<f64, EditError> {
    let bearing = draft.number(part, "pose.bearing_deg", 0.0)?;
    Ok(bearing.to_radians())
}

fn tilt(draft: &Draft, part: Part) -> Result<f64, EditError> {
    Ok(draft.number(part, "pose.tilt_deg", 0.0)?.to_radians())
}

/// Returns a displacement along the axes of a bearing in radians: to its right, forward, up.
fn along_bearing([right, forward, up]: [f64; 3], bearing: f64) -> [f64; 3] {
    let (sin, cos) = bearing.sin_cos();
    [right * cos - forward * sin, right * sin + forward * cos, up]
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::contact::surface::Surface;
    use crate::editing::{Edit, edit};
    use crate::layout::Layout;
    use parry3d::math::Vec3;

    fn text(pose: &str, shape: &str) -> String {
        format!(
            "// mine\nLayout(name: \"a\", boards: [(\n    pose: (anchor: elbow, {pose}), // here\n    \
             {shape}keys: [(code: \"A\", at_mm: (0, 0))])])"
        )
    }

    fn edited(text: &str, change: &Edit) -> String {
        edit(text, change).unwrap().text
    }

    fn surface(text: &str) -> Surface {
        let layout = Layout::parse(text, "a.ron").unwrap();
        layout.scene.surfaces()[0].clone()
    }

    #[test]
    fn a_board_moves_by_millimetres_of_the_world_whatever_its_bearing_is() {
        let by_mm = [10.0, -4.0, 3.0];
        let parts = vec![Part::Board(0)];
        let shift = Edit::MoveInSpace { parts, by_mm };
        for bearing in [0, 35, 90, -120, 180] {
            let before = text(
                &format!("bearing_deg: {bearing}, forward_mm: 320, tilt_deg: 30"),
                "",
            );
            let after = edited(&before, &shift);
            let origin = |text: &str| surface(text).anchor_from_surface().translation * 1e3;
            let moved = origin(&after) - origin(&before);
            assert!(
                moved.distance(Vec3::new(10.0, 3.0, 4.0)) < 0.02,
                "{bearing}: {moved}"
            );
        }
        let plain = text("forward_mm: 320", "");
        let expected = text("forward_mm: 316, right_mm: 10, height_mm: 3", "");
        assert_eq!(edited(&plain, &shift), expected);
    }

    #[test]
    fn a_target_moves_in_the_frame_of_its_space() {
        let text = "Layout(name: \"a\", spaces: [(pose: (anchor: elbow, bearing_deg: 90, tilt_deg: 90), targets: [\n    \
             (name: \"b\", at_mm: (1, 2, 3), shape: Ball(20)), // b\n])])";
        let parts = vec![Part::SpaceTarget { space: 0, index: 0 }];
        let shift = Edit::MoveInSpace {
            parts,
            by_mm: [10.0, 0.0, 5.0],
        };
        let after = edited(text, &shift);
        // To the right of the world is forward of the bearing, which the tilt turns up.
        let center = |layout_text: &str| {
            let layout = Layout::parse(layout_text, "a.ron").unwrap();
            let space = &layout.spaces[0].space;
            let volume = space.volumes.iter().next().unwrap();
            space.frame.anchor_from_frame * volume.center * 1e3
        };
        let moved = center(&after) - center(text);
        assert!(moved.distance(Vec3::new(10.0, 5.0, 0.0)) < 0.02, "{moved}");
        assert!(after.contains("// b"), "{after}");
    }

    #[test]
    fn a_board_turns_about_its_origin_and_an_arc_about_its_center() {
        let turn = Edit::TurnInSpace {
            parts: vec![Part::Board(0)],
            degrees: 20.0,
        };
        let flat = text("bearing_deg: 35, forward_mm: 320, right_mm: 40", "");
        let [before, after] = [flat.clone(), edited(&flat, &turn)].map(|text| surface(&text));
        let [before, after] = [before, after].map(|surface| surface.anchor_from_surface());
        assert!(before.translation.distance(after.translation) < 2e-5);
        let angle = before.rotation.angle_between(after.rotation);
        assert!((angle.to_degrees() - 20.0).abs() < 1e-2, "{angle}");
        let arc = text(
            "bearing_deg: 35, height_mm: -45",
            "shape: Arc(radius_mm: 320),\n    ",
        );
        let expected = arc.replace("bearing_deg: 35", "bearing_deg: 15");
        assert_eq!(edited(&arc, &turn), expected);
    }

    #[test]
    fn a_key_is_not_moved_in_space() {
        let parts = vec![Part::Row { board: 0, row: 0 }];
        let by_mm = [1.0; 3];
        let error = edit(
            &text("forward_mm: 1", ""),
            &Edit::MoveInSpace { parts, by_mm },
        );
        let error = error.unwrap_err().to_string();
        assert_eq!(error, "this row cannot be moved in space; move its board");
    }
}
