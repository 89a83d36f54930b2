//! The boards of a layout in the plane, in which keys are moved.

use ademan_core::contact::TargetId;
use ademan_core::contact::surface::Shape;
use ademan_core::document::read_tree;
use ademan_core::editing::{
    EditError, Part, delete_parts, duplicate_parts, move_parts, part_of, targets,
};
use ademan_core::hand::Side;
use ademan_core::layout::{Board, Face, Layout};
use serde::{Deserialize, Serialize};

const MM_PER_METRE: f32 = 1e3;

/// A board with its faces, in row coordinates.
#[derive(Serialize)]
pub struct PlanBoard<'a> {
    /// The hand that it is for; `None` if both may touch it.
    side: Option<Side>,
    faces: Vec<PlanFace<'a>>,
}

/// A face in row coordinates, in millimetres: x along its row, y away from the wearer.
#[derive(Serialize)]
struct PlanFace<'a> {
    id: TargetId,
    name: &'a str,
    label: &'a str,
    at_mm: [f32; 2],
    half_mm: [f32; 2],
    is_round: bool,
}

/// An edit of the parts of targets.
#[derive(Clone, Copy, Debug, PartialEq, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum PlanEdit {
    /// Moves them: to the right and away from the wearer, in millimetres of the file.
    Move {
        /// Distances.
        by_mm: [f64; 2],
    },
    /// Deletes them.
    Delete,
    /// Copies them beside themselves.
    Duplicate,
}

/// Distance between a part and its copy, in millimetres.
const COPY_OFFSET_MM: [f64; 2] = [0.0, -21.0];

/// Returns the boards of a layout.
pub fn plan(layout: &Layout) -> Vec<PlanBoard<'_>> {
    let boards = layout.boards.iter().zip(layout.scene.surfaces());
    boards
        .map(|(board, surface)| PlanBoard {
            side: surface.side(),
            faces: layout.faces(board).map(|it| plan_face(board, it)).collect(),
        })
        .collect()
}

fn plan_face<'a>(board: &Board, face: &'a Face) -> PlanFace<'a> {
    PlanFace {
        id: face.target,
        name: &face.name,
        label: &face.label,
        at_mm: (face.row_position * MM_PER_METRE).to_array(),
        half_mm: (board.row_half_extents(face) * MM_PER_METRE).to_array(),
        is_round: matches!(face.outline.shape, Shape::Disc(_)),
    }
}

/// Returns the text after an edit of the parts of targets. `text` is the file of the layout with these targets.
pub fn edit_targets(
    text: &str,
    ids: &[TargetId],
    plan_edit: PlanEdit,
) -> Result<String, EditError> {
    let tree = read_tree(text).ok_or(EditError::Unreadable)?;
    let all = targets(text, &tree);
    let parts: Vec<Part> = ids.iter().filter_map(|&id| part_of(&all, id)).collect();
    let edited = match plan_edit {
        PlanEdit::Move { by_mm: [x, y] } => move_parts(text, &parts, [x, y, 0.0]),
        PlanEdit::Delete => delete_parts(text, &parts),
        PlanEdit::Duplicate => duplicate_parts(text, &parts, COPY_OFFSET_MM),
    };
    edited.map(|edited| edited.text)
}
