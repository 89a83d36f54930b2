//! Toggle switches: a rocker, and its label.

use parry3d::math::Vec2;

use super::{draw_label, draw_outline, text_room};
use crate::layout::model::Face;
use crate::layout::render::svg::canvas::Canvas;

/// Draws a switch.
pub fn draw(face: &Face, is_on: bool, canvas: &mut Canvas) {
    let room = text_room(&face.outline);
    draw_outline("well", &face.outline, 0.0, canvas);
    let height = (room.y * 0.4).min(room.x * 0.45).min(3.4);
    let rocker = Vec2::new(height * 1.9, height);
    let at = Vec2::NEG_Y * (room.y - height - 0.3);
    canvas.rect("metal", at, rocker, height);
    let side = if is_on { 1.0 } else { -1.0 };
    let end = at + Vec2::X * side * (rocker.x - height);
    canvas.circle(if is_on { "lit" } else { "cap" }, end, height * 0.8);
    let top = at.y + height + 0.2;
    let half = Vec2::new(room.x, (room.y - top) / 2.0);
    let center = Vec2::Y * (room.y + top) / 2.0;
    draw_label("label", &face.label, center, half, canvas);
}
