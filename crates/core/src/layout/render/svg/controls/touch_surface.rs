//! Touchscreens with a cursor, and touchpads with a finger that moves.

use parry3d::math::Vec2;

use super::{draw_label, draw_outline};
use crate::device::touch_surface::{TouchMode, TouchSurface};
use crate::layout::model::Face;
use crate::layout::render::svg::canvas::Canvas;

/// Draws a touchscreen or touchpad.
pub fn draw(surface: &TouchSurface, face: &Face, canvas: &mut Canvas) {
    let half = face.outline.half_extents() * 1e3;
    let size = half.min_element();
    match surface.mode {
        TouchMode::Touchscreen(_) => {
            draw_outline("metal", &face.outline, 0.0, canvas);
            draw_outline("well", &face.outline, (size * 0.08).min(2.5), canvas);
            draw_cursor(half * 0.55, size * 0.14, canvas);
        }
        TouchMode::Touchpad(_) => {
            draw_outline("skirt", &face.outline, 0.0, canvas);
            draw_outline("well", &face.outline, (size * 0.03).min(0.8), canvas);
            draw_finger(Vec2::Y * size * 0.34, size * 0.13, canvas);
        }
    }
    let room = Vec2::new(half.x * 0.8, size * 0.2);
    draw_label("label", &face.label, Vec2::NEG_Y * size * 0.4, room, canvas);
}

/// Draws the arrow of a mouse pointer.
fn draw_cursor(at: Vec2, size: f32, canvas: &mut Canvas) {
    let outline = [
        (0.0, 0.0),
        (0.0, 1.4),
        (0.35, 1.1),
        (0.6, 1.6),
        (0.8, 1.5),
        (0.55, 1.0),
        (1.0, 0.95),
    ];
    let points = outline.map(|(x, y)| at + Vec2::new(x - 0.5, y - 0.8) * size);
    canvas.polygon("cap", &points);
}

/// Draws a fingertip with arrows to both sides and up and down.
fn draw_finger(at: Vec2, size: f32, canvas: &mut Canvas) {
    canvas.circle("icon", at, size * 0.8);
    for direction in [Vec2::X, Vec2::NEG_X, Vec2::Y, Vec2::NEG_Y] {
        let tip = at + direction * size * 1.9;
        canvas.line("icon", [at + direction * size * 1.1, tip]);
        let wings =
            [-1.0, 1.0].map(|side| tip + (direction.perp() * side - direction) * size * 0.4);
        canvas.polyline("icon", &[wings[0], tip, wings[1]]);
    }
}
