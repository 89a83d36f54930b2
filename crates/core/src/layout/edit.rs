//! Edits of the board poses in the text of a layout. Everything else in the text stays as it is.

use std::ops::Range;

use super::fit::{Fit, PoseFit};
use super::load::{BoardSchema, LayoutSchema};
use super::quantity::{Offset, Tilt};
use crate::contact::board_pose::BoardPose;
use crate::document::{Document, DocumentError, Item, Node, read_tree};

/// Returns the text with its boards at these poses, one per board, in millimetres and degrees with two decimals. The
/// poses are those for the hands of `fit`, the text is for the design hand.
///
/// Numbers that do not change keep their spelling. The bearing is not edited. Returns an error if the text is not a layout.
pub fn move_boards(
    document: &Document,
    poses: &[BoardPose],
    fit: &Fit,
) -> Result<String, DocumentError> {
    edit_poses(document, |index, board| {
        let pose = poses.get(index)?;
        let fit = fit.of(&board.pose, board.hand);
        let old_pose = board.pose.anchor_from_board(board.shape, &PoseFit::NONE);
        let old_pose = BoardPose::from_pose(&old_pose);
        let offset = |field, old: f32, new: f32, written: Option<Offset>| {
            let (old, new) = (two_decimals(old * 1e3), two_decimals(new * 1e3));
            let (min, max) = (*Offset::RANGE.start(), *Offset::RANGE.end());
            let is_changed = old != new && written.map(Offset::get) != Some(new);
            is_changed.then(|| (field, new.clamp(min, max)))
        };
        let schema = &board.pose;
        let tilt = two_decimals(pose.tilt.to_degrees());
        let is_tilted = tilt != two_decimals(old_pose.tilt.to_degrees());
        let edits = [
            offset(
                "right_mm",
                old_pose.right,
                pose.right - fit.shift.x,
                Some(schema.right_mm),
            ),
            offset(
                "forward_mm",
                old_pose.forward,
                pose.forward + fit.shift.z,
                schema.forward_mm,
            ),
            offset(
                "height_mm",
                old_pose.height,
                pose.height - fit.shift.y,
                Some(schema.height_mm),
            ),
            is_tilted.then(|| {
                let tilt = tilt.clamp(*Tilt::RANGE.start(), *Tilt::RANGE.end());
                ("tilt_deg", tilt)
            }),
        ];
        Some(edits.into_iter().flatten().collect())
    })
}

/// Returns the text with the scale of all boards multiplied by `factor`.
///
/// A scale out of range is written too; reading the text reports it. Returns an error if the text is not a layout.
pub fn scale_boards(document: &Document, factor: f32) -> Result<String, DocumentError> {
    edit_poses(document, |_, board| {
        let scale = board.pose.scale.get() * f64::from(factor);
        Some(vec![("scale", (scale * 1e4).round() / 1e4)])
    })
}

/// A field of a pose and its new value.
type FieldEdit = (&'static str, f64);

fn edit_poses(
    document: &Document,
    edits_of: impl Fn(usize, &BoardSchema) -> Option<Vec<FieldEdit>>,
) -> Result<String, DocumentError> {
    let schema: LayoutSchema = document.parse()?;
    let (text, tree) = (&document.text, tree_of(document)?);
    let mut edits: Vec<(Range<usize>, String)> = Vec::new();
    let boards = schema.boards.iter().zip(items_of(&tree, text, "boards"));
    for (index, (board, item)) in boards.enumerate() {
        let Some(pose) = item.value.field(text, "pose") else {
            continue;
        };
        for (field, value) in edits_of(index, board).unwrap_or_default() {
            if let Some(old) = pose.field(text, field) {
                edits.push((old.range.clone(), value.to_string()));
            } else if let Some(anchor) = pose.field(text, "anchor") {
                let end = anchor.range.end;
                edits.push((end..end, format!(", {field}: {value}")));
            }
        }
    }
    Ok(replace_ranges(text, edits))
}

/// Returns the tree of the text of a file that was read.
pub(super) fn tree_of(document: &Document) -> Result<Node, DocumentError> {
    read_tree(&document.text).ok_or_else(|| {
        let message = "cannot find the fields to edit; write their names without `r#`";
        DocumentError::for_file(&document.file, message)
    })
}

/// Returns the values of a list in a field; none if the field is not written.
pub(super) fn items_of<'t>(node: &'t Node, text: &str, field: &str) -> &'t [Item] {
    node.field(text, field).map_or(&[], Node::items)
}

/// Returns the value of a field, unless it is `None`.
pub(super) fn stated<'t>(node: &'t Node, text: &str, field: &str) -> Option<&'t Node> {
    let value = node.field(text, field)?;
    (value.text(text) != "None").then_some(value)
}

/// Returns the text with these ranges replaced.
pub(super) fn replace_ranges(text: &str, mut edits: Vec<(Range<usize>, String)>) -> String {
    // Backwards, so that the remaining ranges stay valid; insertions at one offset in reverse order, too.
    edits.sort_by_key(|(range, _)| range.start);
    let mut text = text.to_owned();
    for (range, new) in edits.into_iter().rev() {
        text.replace_range(range, &new);
    }
    text
}

/// Rounds to two decimals. 0 has no sign.
fn two_decimals(value: f32) -> f64 {
    (f64::from(value) * 100.0).round() / 100.0 + 0.0
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::hand::Side;
    use crate::kinematics::{ArmModel, BoneLengths};
    use crate::layout::Layout;

    const COMMENTED: &str = r#"#![enable(implicit_some)]
// mine
Layout(
    name: "a // no comment", // here
    boards: [
        (
            pose: Pose( // there
                anchor: /* the */ elbow /* joint */, // of the arm
                height_mm: -45.0 /* below */,
                /* forward_mm: 1, */ forward_mm: Some(300), // ahead
            ),
            rows: [(at_mm: (0, 0), keys: "A B")],
        ),
        (rows: [(at_mm: (0, 0), keys: "C")], pose: (anchor:world)),
    ],
)
"#;

    fn document(text: &str) -> Document {
        Document::new("a.ron", text)
    }

    fn poses(text: &str) -> Vec<BoardPose> {
        let layout = Layout::parse(text, "a.ron").unwrap_or_else(|error| panic!("{error}"));
        let surfaces = layout.scene.surfaces().iter();
        surfaces
            .map(|surface| BoardPose::from_pose(&surface.anchor_from_surface()))
            .collect()
    }

    #[test]
    fn only_numbers_change_and_comments_stay() {
        let mut new_poses = poses(COMMENTED);
        new_poses[0].height = -0.0512;
        new_poses[0].forward = 0.2;
        new_poses[1].tilt = 0.5_f32.to_radians();
        new_poses[1].right = -0.01;
        let text = move_boards(&document(COMMENTED), &new_poses, &Fit::default()).unwrap();
        let expected = COMMENTED
            .replace("-45.0 ", "-51.2 ")
            .replace("Some(300)", "Some(200)")
            .replace("anchor:world", "anchor:world, right_mm: -10, tilt_deg: 0.5");
        assert_eq!(text, expected);
        let larger = scale_boards(&document(&text), 1.25).unwrap();
        let largest = scale_boards(&document(&larger), 1.2).unwrap();
        let expected = expected
            .replace("elbow /*", "elbow, scale: 1.5 /*")
            .replace("anchor:world", "anchor:world, scale: 1.5");
        assert_eq!(largest, expected);
    }

    #[test]
    fn a_number_that_does_not_change_keeps_its_spelling() {
        let text = COMMENTED.replace("-45.0", "-45.00123");
        assert_eq!(
            move_boards(&document(&text), &poses(&text), &Fit::default()).unwrap(),
            text
        );
    }

    #[test]
    fn a_number_that_is_none_is_replaced() {
        let text = COMMENTED.replace("Some(300)", "None");
        let mut new_poses = poses(&text);
        new_poses[0].forward = 0.2;
        let moved = move_boards(&document(&text), &new_poses, &Fit::default()).unwrap();
        assert_eq!(moved, COMMENTED.replace("Some(300)", "200"));
    }

    #[test]
    fn a_board_for_another_hand_moves_by_the_same_distance_in_the_file() {
        let bones = BoneLengths::from_hand_and_forearm(0.19, 0.27).unwrap();
        let arm = ArmModel::anthropometric(Side::Right, &bones).unwrap();
        let fit = Fit::new(&arm, None).unwrap();
        let layout = Layout::for_hands(document(COMMENTED), fit).unwrap();
        let surfaces = layout.scene.surfaces().iter();
        let mut poses: Vec<BoardPose> = surfaces
            .map(|surface| BoardPose::from_pose(&surface.anchor_from_surface()))
            .collect();
        let same = move_boards(&document(COMMENTED), &poses, &fit).unwrap();
        assert_eq!(same, COMMENTED);
        poses[0].forward += 0.01;
        let moved = move_boards(&document(COMMENTED), &poses, &fit).unwrap();
        assert_eq!(moved, COMMENTED.replace("Some(300)", "Some(310)"));
    }

    #[test]
    fn a_layout_without_boards_is_not_changed() {
        let ray = Document::shipped("ray").unwrap();
        assert_eq!(
            move_boards(&ray, &[], &Fit::default()).as_ref(),
            Ok(&ray.text)
        );
        assert_eq!(scale_boards(&ray, 2.0).as_ref(), Ok(&ray.text));
    }

    #[test]
    fn every_written_pose_is_read_back() {
        let mut random = fastrand::Rng::with_seed(11);
        let mut between = |min: f32, max: f32| min + (max - min) * random.f32();
        for _ in 0..500 {
            let bearing = between(-180.0, 180.0);
            let text =
                COMMENTED.replace("height_mm", &format!("bearing_deg: {bearing}, height_mm"));
            let mut expected = poses(&text);
            for pose in &mut expected {
                pose.right = between(-2.0, 2.0);
                pose.height = between(-2.0, 2.0);
                pose.forward = between(-2.0, 2.0);
                pose.tilt = between(-90.0, 90.0).to_radians();
            }
            let edited = move_boards(&document(&text), &expected, &Fit::default()).unwrap();
            for (read, wanted) in poses(&edited).iter().zip(&expected) {
                let error = (read.to_pose().translation - wanted.to_pose().translation).abs();
                assert!(error.max_element() < 1e-5, "{read:?} for {wanted:?}");
                assert!((read.tilt - wanted.tilt).abs() < 1e-4);
            }
            let again = move_boards(&document(&edited), &expected, &Fit::default()).unwrap();
            assert_eq!(again, edited, "a second edit changes nothing");
        }
    }
}
