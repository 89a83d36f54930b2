//! The handles of a selected board: one that turns it, one that tilts it, one that bends it.

use parry3d::math::{Vec2, Vec3};

use super::{PlanBoard, PlanItem, PlanView};
use crate::canvas::bend;
use ademan_core::contact::board_pose::BoardPose;
use ademan_core::layout::BoardShape;

/// Distance of a handle from its board, in points.
const DISTANCE: f32 = 22.0;

/// Distance from the middle of a handle at which it is hit, in points.
const HIT_RADIUS: f32 = 9.0;

/// Distance of the handle of a bend from the outermost key, in millimetres.
const BEND_MARGIN_MM: f32 = 12.0;

/// The smallest part of a direction, or of the plane of a bend, that a view must show for a handle that changes it.
const LEAST_SHOWN: f32 = 0.4;

/// To the right and away from the wearer.
const GROUND: [Vec3; 2] = [Vec3::X, Vec3::NEG_Z];

/// The number of radii that are tried before the best one is refined.
const RADII: usize = 160;

/// A handle of a board.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum PlanHandle {
    /// Turns the board about the vertical.
    Turn,
    /// Lifts its far side.
    Tilt,
    /// Sets its radius.
    Bend,
}

/// Returns the handles of an item that a view shows, with their positions, at a zoom in points per millimetre.
pub fn handles(item: &PlanItem, view: PlanView, scale: f32) -> Vec<(PlanHandle, Vec2)> {
    let Some(board) = item.board() else {
        return Vec::new();
    };
    let kinds = [PlanHandle::Turn, PlanHandle::Tilt, PlanHandle::Bend];
    let position = |kind| Some((kind, position(board, view, scale, kind)?));
    kinds.into_iter().filter_map(position).collect()
}

/// Returns the handle of an item at a point.
pub fn handle_at(item: &PlanItem, view: PlanView, point: Vec2, scale: f32) -> Option<PlanHandle> {
    let mut handles = handles(item, view, scale).into_iter();
    handles.find_map(|(handle, at)| ((at - point).length() * scale <= HIT_RADIUS).then_some(handle))
}

fn position(board: &PlanBoard, view: PlanView, scale: f32, handle: PlanHandle) -> Option<Vec2> {
    match handle {
        PlanHandle::Turn => {
            shown_plane(view, GROUND)?;
            Some(beyond(board, view, view.flatten(forward(board)), scale))
        }
        PlanHandle::Tilt => {
            shown_plane(view, [forward(board), Vec3::Y])?;
            let away = board.pose.rotation * Vec3::Y;
            Some(beyond(board, view, view.flatten(away), scale))
        }
        PlanHandle::Bend => {
            let bend = bend_directions(board.shape)?;
            shown_plane(view, bend.map(|it| board.pose.rotation * it))?;
            let radius = drawn_radius_mm(board.shape)?;
            Some(bend_end(board, view, radius))
        }
    }
}

/// Returns the direction of the bearing of a board in the world.
fn forward(board: &PlanBoard) -> Vec3 {
    let (sin, cos) = BoardPose::from_pose(&board.pose).bearing.sin_cos();
    Vec3::new(sin, 0.0, -cos)
}

/// Returns the point beyond a board in a direction from its origin.
fn beyond(board: &PlanBoard, view: PlanView, direction: Vec2, scale: f32) -> Vec2 {
    let direction = direction.normalize_or(Vec2::Y);
    let origin = view.flatten(board.pose.translation);
    let outline = board.outline();
    let reach = outline.map(|point| (view.flatten(point) - origin).dot(direction));
    origin + direction * (reach.fold(0.0, f32::max) + DISTANCE / scale)
}

/// Returns the point about which a board turns: the center of its arcs, or its origin.
pub fn pivot(board: &PlanBoard, view: PlanView) -> Vec2 {
    let pivot = match board.shape {
        BoardShape::Arc(radius) => Vec3::NEG_Y * radius,
        _ => Vec3::ZERO,
    };
    view.flatten(board.pose * pivot)
}

/// Returns two directions of a plane as they are on a picture, per metre; `None` if the view shows too little of the plane.
fn shown_plane(view: PlanView, plane: [Vec3; 2]) -> Option<[Vec2; 2]> {
    let [first, second] = plane.map(|direction| view.flatten(direction) / 1e3);
    (first.perp_dot(second).abs() >= LEAST_SHOWN).then_some([first, second])
}

/// Returns a vector on the picture as parts of two directions on it.
fn parts_of([first, second]: [Vec2; 2], way: Vec2) -> Vec2 {
    Vec2::new(way.perp_dot(second), first.perp_dot(way)) / first.perp_dot(second)
}

/// Returns the angle about the vertical by which a board turns between two points, counter-clockwise as seen from above.
pub fn turned_deg(board: &PlanBoard, view: PlanView, points: [Vec2; 2]) -> Option<f32> {
    let ground = shown_plane(view, GROUND)?;
    let pivot = pivot(board, view);
    let [from, to] = points.map(|point| parts_of(ground, point - pivot));
    Some(from.angle_to(to).to_degrees())
}

/// Returns the tilt with which the far side of a board points to a point, −90..=90°.
pub fn tilt_deg(board: &PlanBoard, view: PlanView, point: Vec2) -> Option<f32> {
    let upright = shown_plane(view, [forward(board), Vec3::Y])?;
    let way = parts_of(upright, point - view.flatten(board.pose.translation));
    let tilt = way.y.atan2(way.x).to_degrees();
    Some(tilt.clamp(-90.0, 90.0))
}

/// Returns the directions in the frame of a board along its bent rows or columns, and to which their ends bend.
const fn bend_directions(shape: BoardShape) -> Option<[Vec3; 2]> {
    match shape {
        BoardShape::Flat => None,
        BoardShape::Arc(_) => Some([Vec3::X, Vec3::NEG_Y]),
        BoardShape::CurvedRows(_) => Some([Vec3::X, Vec3::Z]),
        BoardShape::CurvedColumns(_) => Some([Vec3::Y, Vec3::Z]),
    }
}

/// Returns the radius of a board in the layout, in millimetres.
pub fn drawn_radius_mm(shape: BoardShape) -> Option<f32> {
    match shape {
        BoardShape::Flat => None,
        BoardShape::Arc(radius)
        | BoardShape::CurvedRows(radius)
        | BoardShape::CurvedColumns(radius) => Some(radius * 1e3),
    }
}

/// Returns the bent row or column through the origin of a board, as a line of points on the picture.
pub fn bend_curve(board: &PlanBoard, view: PlanView, radius_mm: f32) -> Vec<Vec2> {
    let reach = |low: f32, high: f32| low.abs().max(high.abs()) + BEND_MARGIN_MM;
    let (low, high) = (board.rows.min, board.rows.max);
    let half = match board.shape {
        BoardShape::CurvedColumns(_) => reach(low.y, high.y),
        _ => reach(low.x, high.x),
    };
    // A board at the distance of its radius moves with it.
    let old = drawn_radius_mm(board.shape).unwrap_or(radius_mm);
    let moved = if board.is_at_radius {
        forward(board) * ((radius_mm - old) / 1e3)
    } else {
        Vec3::ZERO
    };
    let curve = bend::curve(radius_mm, half).into_iter();
    let points = curve.map(|at| match board.shape {
        BoardShape::CurvedRows(_) => Vec3::new(at.x, 0.0, -at.y),
        BoardShape::CurvedColumns(_) => Vec3::new(0.0, at.x, -at.y),
        _ => at.extend(0.0),
    });
    points
        .map(|at| view.flatten(board.pose * (at / 1e3) + moved))
        .collect()
}

fn bend_end(board: &PlanBoard, view: PlanView, radius_mm: f32) -> Vec2 {
    let curve = bend_curve(board, view, radius_mm);
    curve.last().copied().unwrap_or_default()
}

/// Returns the radius with which the handle of a bend is nearest to a point, in millimetres.
pub fn radius_at(board: &PlanBoard, view: PlanView, point: Vec2) -> f32 {
    let distance = |radius: f32| (bend_end(board, view, radius) - point).length();
    let (low, high) = bend::RADII;
    let ratio = (high / low).powf(1.0 / RADII as f32);
    let radii = (0..=RADII as i32).map(|step| low * ratio.powi(step));
    let best = radii.min_by(|a, b| distance(*a).total_cmp(&distance(*b)));
    let best = best.unwrap_or(low);
    let (mut low, mut high) = ((best / ratio).max(low), (best * ratio).min(high));
    for _ in 0..30 {
        let (a, b) = (low + (high - low) / 3.0, high - (high - low) / 3.0);
        if distance(a) < distance(b) {
            high = b;
        } else {
            low = a;
        }
    }
    (low + high) / 2.0
}
