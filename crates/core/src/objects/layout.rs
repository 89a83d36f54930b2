//! The object of the active layout.

use parry3d::math::Pose;
use serde::Serialize;

use crate::contact::TargetId;
use crate::contact::surface::{Shape, Surface};
use crate::layout::{Board, Layout};

/// Returns the object of a layout, with the line end.
pub fn layout_object(layout: &Layout) -> Vec<u8> {
    let boards = layout.boards.iter().zip(layout.scene.surfaces());
    let object = LayoutObject {
        kind: "layout",
        name: &layout.name,
        boards: boards
            .map(|(board, surface)| board_object(layout, board, surface))
            .collect(),
    };
    let mut bytes = serde_json::to_vec(&object).unwrap_or_default();
    bytes.push(b'\n');
    bytes
}

/// Returns a pose as seven numbers: the position in metres, and the orientation as a quaternion x, y, z, w.
pub(super) fn numbers(pose: &Pose) -> [f32; 7] {
    let ([x, y, z], [i, j, k, w]) = (pose.translation.to_array(), pose.rotation.to_array());
    [x, y, z, i, j, k, w]
}

#[derive(Serialize)]
struct LayoutObject<'a> {
    kind: &'static str,
    name: &'a str,
    boards: Vec<BoardObject<'a>>,
}

#[derive(Serialize)]
struct BoardObject<'a> {
    /// The pose in the world, or relative to the joint that the board follows.
    pose: [f32; 7],
    targets: Vec<TargetObject<'a>>,
}

#[derive(Serialize)]
struct TargetObject<'a> {
    id: TargetId,
    label: &'a str,
    /// The pose of the front on the board.
    pose: [f32; 7],
    /// Half of the width and height, in metres.
    half_m: [f32; 2],
    is_round: bool,
    travel_m: f32,
}

fn board_object<'a>(layout: &'a Layout, board: &Board, surface: &Surface) -> BoardObject<'a> {
    let targets = layout.faces(board).filter_map(|face| {
        let target = surface.target(face.target)?;
        let (half, is_round) = match target.shape {
            Shape::Box(half) => (half.to_array(), false),
            Shape::Disc(radius) => ([radius; 2], true),
        };
        Some(TargetObject {
            id: face.target,
            label: &face.label,
            pose: numbers(&target.surface_from_target),
            half_m: half,
            is_round,
            travel_m: target.travel,
        })
    });
    BoardObject {
        pose: numbers(&surface.anchor_from_surface()),
        targets: targets.collect(),
    }
}
