//! A layout as JSON: the geometry of its targets, for programs.

use ademan::contact::surface::{Anchor, Shape, Surface};
use ademan::device::KeyAction;
use ademan::layout::{Board, Face, Layout};
use serde::Serialize;

#[derive(Serialize)]
struct LayoutJson<'a> {
    name: &'a str,
    description: &'a str,
    layers: &'a [String],
    boards: Vec<BoardJson<'a>>,
}

#[derive(Serialize)]
struct BoardJson<'a> {
    anchor: Option<&'static str>,
    hand: Option<&'static str>,
    targets: Vec<TargetJson<'a>>,
}

/// A target. Fields that do not apply are `null`.
#[derive(Serialize)]
struct TargetJson<'a> {
    name: &'a str,
    label: &'a str,
    /// In the plane of the board, unrolled if it is curved: x to the right along the rows, y away from the wearer.
    center_m: [f32; 2],
    /// Width and depth of a box.
    size_m: Option<[f32; 2]>,
    /// Radius of a disc.
    radius_m: Option<f32>,
    /// Counter-clockwise.
    rotation_rad: f32,
    /// The center of the front from the anchor of the board, in the axes of the world: x to the right, y up, z backward.
    position_m: Option<[f32; 3]>,
    travel_m: Option<f32>,
    /// The depth at which it counts as pressed.
    press_depth_m: Option<f32>,
    /// The key that is pressed in the base layer.
    key: Option<&'static str>,
    /// The finger that the layout assigns.
    finger: Option<&'static str>,
}

/// Returns the boards of a layout with their targets. Lengths are in metres, angles in radians.
pub fn from_layout(layout: &Layout) -> String {
    let boards = layout.boards.iter().map(|board| board_json(layout, board));
    let value = LayoutJson {
        name: &layout.name,
        description: &layout.description,
        layers: &layout.layers,
        boards: boards.collect(),
    };
    let mut text =
        serde_json::to_string_pretty(&value).expect("texts and numbers can be written as JSON");
    text.push('\n');
    text
}

fn board_json<'a>(layout: &'a Layout, board: &Board) -> BoardJson<'a> {
    let mut faces = layout.faces(board);
    let surface = faces.find_map(|face| Some(layout.scene.target(face.target)?.0));
    BoardJson {
        anchor: surface.map(anchor),
        hand: surface.and_then(Surface::side).map(|side| side.name()),
        targets: layout
            .faces(board)
            .map(|face| target_json(layout, face))
            .collect(),
    }
}

fn anchor(surface: &Surface) -> &'static str {
    match surface.anchor() {
        Anchor::World => "world",
        Anchor::Joint(joint) => joint.name(),
        Anchor::Start => "start",
        Anchor::OtherHand => "other",
        Anchor::Body(point) => point.name(),
    }
}

fn target_json<'a>(layout: &'a Layout, face: &'a Face) -> TargetJson<'a> {
    let (size, radius) = match face.outline.shape {
        Shape::Box(half) => (Some((2.0 * half).to_array()), None),
        Shape::Disc(radius) => (None, Some(radius)),
    };
    let placed = layout.scene.target(face.target);
    let position = placed.map(|(surface, target)| {
        surface.anchor_from_surface() * target.surface_from_target.translation
    });
    let key = match layout.key_at(face.target).and_then(|key| key.action(0)) {
        Some(KeyAction::Key(code) | KeyAction::Modifier(code, _)) => Some(code.name()),
        _ => None,
    };
    TargetJson {
        name: &face.name,
        label: &face.label,
        center_m: face.outline.center.to_array(),
        size_m: size,
        radius_m: radius,
        rotation_rad: face.outline.rotation,
        position_m: position.map(|center| center.to_array()),
        travel_m: placed.map(|(_, target)| target.travel),
        press_depth_m: placed.map(|(_, target)| target.travel * target.press_at),
        key,
        finger: layout.scene.finger(face.target).map(|finger| finger.name()),
    }
}
