//! Boards with their keys and controls.

use std::collections::BTreeMap;

use parry3d::math::{Pose, Vec2, Vec3};

use super::Canvas;
use super::labels::{Turn, add_label, board_turn};
use crate::marks::{FrontView, add_marks, valued_marks};
use crate::model::StudioModel;
use crate::picture::{Color, convex_hull};
use ademan_core::contact::TargetId;
use ademan_core::contact::surface::{Shape, Surface, Target};
use ademan_core::layout::{FrontMark, Layout};

/// The lowest key, in metres: a key with less travel would look like a drawing.
const MIN_KEY_HEIGHT: f32 = 0.004;

/// The edge of the plate around the keys, in metres.
const BOARD_MARGIN: f32 = 0.005;

/// The largest deviation of fronts from a plane for which a plate is drawn, in metres.
const FLATNESS: f32 = 0.002;

/// The largest distance from the fronts to the plate, in metres.
const MAX_PLATE_DEPTH: f32 = 0.006;

/// Size of a key on the screen below which it is a flat rectangle, in points.
const MIN_DETAIL_PT: f32 = 9.0;

/// Width of the edge of a key in high contrast, in points.
const EDGE_WIDTH: f32 = 1.5;

/// Sides of a quarter of a disc, which look round at any size.
const DISC_STEPS: usize = 16;

/// Signs of the corners of a box, in the order of its outline.
const CORNERS: [(f32, f32); 4] = [(1.0, 1.0), (-1.0, 1.0), (-1.0, -1.0), (1.0, -1.0)];

/// The state of a control that is seen.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct FrontState<'a> {
    /// It is pressed or selected.
    is_lit: bool,
    /// Depth of its front, as a fraction of its travel.
    depth: f32,
    /// The values that handles and numbers show; `None` for the initial values without numbers.
    values: Option<&'a BTreeMap<TargetId, f32>>,
}

impl<'a> FrontState<'a> {
    /// Returns the state of a control that no finger touches, with these values.
    pub fn at_rest(values: Option<&'a BTreeMap<TargetId, f32>>) -> Self {
        Self {
            values,
            ..Self::default()
        }
    }
}

/// Adds a board, if its pose is known.
pub(super) fn add_board(canvas: &mut Canvas, model: &StudioModel, index: usize) {
    let Some(world_from_board) = model.world_from_board(index) else {
        return;
    };
    let layout = &model.view.layout;
    add_plate(canvas, &world_from_board, &layout.scene.surfaces()[index]);
    let state = |id: TargetId| {
        let contact = model.contact_with(id);
        FrontState {
            is_lit: contact.is_some_and(|contact| contact.is_pressed)
                || model.view.state.selected.contains(&id),
            depth: contact.map_or(0.0, |contact| contact.depth),
            values: Some(&model.values),
        }
    };
    add_controls(canvas, layout, index, &world_from_board, state);
}

/// Adds the keys and controls of a board, from the farthest to the nearest.
pub(super) fn add_controls<'a>(
    canvas: &mut Canvas,
    layout: &Layout,
    index: usize,
    world_from_board: &Pose,
    state: impl Fn(TargetId) -> FrontState<'a>,
) {
    let surface = &layout.scene.surfaces()[index];
    let mut keys: Vec<_> = surface
        .targets()
        .filter_map(|(id, target)| {
            let world_from_target = *world_from_board * target.surface_from_target;
            let center = canvas.project(world_from_target.translation)?;
            let radius = half_extents(target).length() * 2.0 * center.scale;
            let is_seen = canvas.is_seen(center.position, radius);
            is_seen.then_some((center, id, target, world_from_target))
        })
        .collect();
    keys.sort_by(|a, b| b.0.depth.total_cmp(&a.0.depth));
    let detailed = keys
        .iter()
        .filter(|(center, _, target, _)| has_detail(target, center.scale));
    let turn = board_turn(canvas, detailed.map(|(_, _, target, pose)| (*target, pose)));
    for (_, id, target, world_from_target) in keys {
        let front = Front {
            id,
            target,
            label_turn: turn,
        };
        add_key(canvas, layout, &front, &world_from_target, state(id));
    }
}

/// Adds the plate below the keys of a flat board.
fn add_plate(canvas: &mut Canvas, world_from_board: &Pose, surface: &Surface) {
    let targets = || surface.targets().map(|(_, target)| target);
    let height = |target: &Target| target.surface_from_target.translation.z;
    let (low, high) = targets().fold((f32::MAX, f32::MIN), |(low, high), target| {
        (low.min(height(target)), high.max(height(target)))
    });
    if high - low > FLATNESS || high < low {
        return;
    }
    let corners = targets().flat_map(|target| {
        let grown = corners_with_margin(target, BOARD_MARGIN);
        grown.map(Vec3::truncate)
    });
    let z = low
        - targets()
            .map(key_height)
            .fold(0.0, f32::max)
            .min(MAX_PLATE_DEPTH);
    let corners = convex_hull(corners.collect());
    let corners = corners.iter().map(|corner| {
        let projected = canvas.project(*world_from_board * corner.extend(z))?;
        Some(projected.position)
    });
    if let Some(corners) = corners.collect::<Option<Vec<_>>>() {
        let color = canvas.colors.board;
        canvas.picture.hide_labels(&corners);
        canvas.picture.below.add_flat_polygon(&corners, color);
    }
}

/// A key or control of a board.
struct Front<'a> {
    id: TargetId,
    target: &'a Target,
    /// The turn of the labels of the board.
    label_turn: Option<Turn>,
}

fn add_key(canvas: &mut Canvas, layout: &Layout, front: &Front, pose: &Pose, state: FrontState) {
    let &Front {
        id,
        target,
        label_turn,
    } = front;
    let is_lit = state.is_lit;
    let depth = state.depth * target.travel;
    let center = *pose * Vec3::new(0.0, 0.0, -depth);
    let Some(projected) = canvas.project(center) else {
        return;
    };
    let colors = canvas.colors;
    let (face, side, label) = if is_lit {
        (colors.lit, colors.lit_side, colors.lit_label)
    } else {
        (colors.key, colors.key_side, colors.label)
    };
    let is_turned_away = (pose.rotation * Vec3::Z).dot(canvas.projection.to_eye(center)) <= 0.0;
    if !has_detail(target, projected.scale) {
        if !is_turned_away {
            add_small_key(
                canvas,
                target,
                &Pose::from_parts(center, pose.rotation),
                (face, side),
            );
        }
        return;
    }
    let outline = outline(target);
    let at = |point: Vec2, z: f32| {
        let on_screen = canvas.project(*pose * point.extend(z))?;
        Some(on_screen.position)
    };
    let edge: Option<Vec<Vec2>> = outline.iter().map(|&point| at(point, -depth)).collect();
    let Some(edge) = edge else {
        return;
    };
    let back = |point: &Vec2| at(*point * 1.04, -key_height(target));
    let Some(back) = outline.iter().map(back).collect::<Option<Vec<_>>>() else {
        return;
    };
    let hull = convex_hull(edge.iter().chain(&back).copied().collect());
    canvas.picture.hide_labels(&hull);
    canvas.picture.below.add_flat_polygon(&hull, side);
    if is_turned_away {
        return;
    }
    canvas.picture.below.add_flat_polygon(&edge, face);
    if colors.has_high_contrast() {
        add_edge(canvas, &edge, side);
    }
    let marks = match state.values {
        Some(values) => valued_marks(layout, id, values, projected.scale * 1e-3),
        None => layout.front_marks(id, |_| None),
    };
    if let Some(marks) = marks {
        let pose = Pose::from_parts(center, pose.rotation);
        add_front(canvas, &marks, &pose, projected.scale, is_lit);
    } else if let Some(text) = layout.face(id).map(|shown| &shown.label) {
        let pose = Pose::from_parts(center, pose.rotation);
        add_label(canvas, (text, label), (target, &pose), label_turn);
    }
}

/// Adds lines around the front of a key: without a plate behind it, its color is nearly the background in high contrast.
fn add_edge(canvas: &mut Canvas, corners: &[Vec2], color: Color) {
    let next = corners.iter().cycle().skip(1);
    for (&from, &to) in corners.iter().zip(next) {
        let line = [(from, color), (to, color)];
        canvas.picture.below.add_line(line, EDGE_WIDTH);
    }
}

/// Adds the marks on the front of a control.
fn add_front(canvas: &mut Canvas, marks: &[FrontMark], front: &Pose, scale: f32, is_lit: bool) {
    let projection = canvas.projection;
    let to_screen = |point: Vec2| {
        let projected = projection.project(*front * (point * 1e-3).extend(0.0))?;
        Some(projected.position)
    };
    let view = FrontView {
        to_screen: &to_screen,
        scale: scale * 1e-3,
        colors: canvas.colors,
        is_lit,
        heat: 0.0,
    };
    add_marks(&mut canvas.picture, marks, &view);
}

/// Adds a key that is small on the screen: its front, as a rectangle. A layout may have thousands of them. `side` is the color of its edge.
fn add_small_key(canvas: &mut Canvas, target: &Target, front: &Pose, (face, side): (Color, Color)) {
    let half = half_extents(target);
    let corners = CORNERS.map(|(x, y)| {
        let corner = canvas.project(*front * Vec3::new(x * half.x, y * half.y, 0.0));
        corner.map(|corner| corner.position)
    });
    if let [Some(a), Some(b), Some(c), Some(d)] = corners {
        let edge = [a, b, c, d];
        canvas.picture.below.add_plain_polygon(&edge, face);
        if canvas.colors.has_high_contrast() {
            add_edge(canvas, &edge, side);
        }
    }
}

/// Returns the corners of the box around a front, on the surface.
pub(crate) fn corners(target: &Target) -> [Vec3; 4] {
    corners_with_margin(target, 0.0)
}

fn corners_with_margin(target: &Target, margin: f32) -> [Vec3; 4] {
    let half = half_extents(target) + margin;
    CORNERS.map(|(x, y)| target.surface_from_target * Vec3::new(x * half.x, y * half.y, 0.0))
}

fn key_height(target: &Target) -> f32 {
    target.travel.max(MIN_KEY_HEIGHT)
}

/// Returns `true` if a front is more than a flat rectangle at a number of points per metre.
fn has_detail(target: &Target, scale: f32) -> bool {
    2.0 * half_extents(target).min_element() * scale >= MIN_DETAIL_PT
}

pub(super) fn half_extents(target: &Target) -> Vec2 {
    match target.shape {
        Shape::Box(half) => half,
        Shape::Disc(radius) => Vec2::splat(radius),
    }
}

/// Returns the outline of a front: a box with round corners, or a disc.
fn outline(target: &Target) -> Vec<Vec2> {
    let (half, radius, steps) = match target.shape {
        Shape::Box(half) => (half, 0.22 * half.min_element(), 3),
        Shape::Disc(radius) => (Vec2::splat(radius), radius, DISC_STEPS),
    };
    let mut points = Vec::with_capacity(CORNERS.len() * (steps + 1));
    for (corner, (x, y)) in CORNERS.into_iter().enumerate() {
        for step in 0..=steps {
            let turn = corner as f32 + step as f32 / steps as f32;
            let round = Vec2::from_angle(turn * std::f32::consts::FRAC_PI_2) * radius;
            points.push(Vec2::new(x, y) * (half - radius) + round);
        }
    }
    points
}
