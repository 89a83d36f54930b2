//! Radio groups: an option with a ring, filled if it is on at the start.

use parry3d::math::Vec2;

use super::{draw_label, draw_outline, on_page, text_room};
use crate::layout::model::Face;
use crate::layout::render::svg::canvas::Canvas;

/// Draws an option.
pub fn draw(face: &Face, is_on: bool, canvas: &mut Canvas) {
    let room = text_room(&face.outline);
    draw_outline("well", &face.outline, 0.0, canvas);
    let radius = (room.y * 0.42).min(room.x * 0.4).min(3.4);
    let at = Vec2::NEG_Y * (room.y - radius - 0.3);
    canvas.circle("metal", at, radius);
    canvas.circle("cap", at, radius * 0.78);
    if is_on {
        canvas.circle("lit", at, radius * 0.48);
    }
    let top = at.y + radius + 0.2;
    let half = Vec2::new(room.x, (room.y - top) / 2.0);
    let center = Vec2::Y * (room.y + top) / 2.0;
    draw_label("label", &face.label, center, half, canvas);
}

/// Draws a line through the options of a group, below their fronts.
pub fn draw_link(faces: &[Face], canvas: &mut Canvas) {
    let centers: Vec<Vec2> = faces
        .iter()
        .map(|face| on_page(face.outline.center))
        .collect();
    canvas.polyline("spoke", &centers);
}
