//! Joysticks: a gate with four directions, and the cap of the stick.

use std::f32::consts::FRAC_PI_2;

use parry3d::math::Vec2;

use super::{draw_fitted, draw_label, draw_outline};
use crate::device::joystick::Joystick;
use crate::layout::model::{Face, Layout, action_label};
use crate::layout::render::svg::canvas::Canvas;

/// The radius of the cap as a fraction of the outline.
const CAP: f32 = 0.66;

/// Draws a stick in the middle of its gate.
pub fn draw(layout: &Layout, joystick: &Joystick, face: &Face, canvas: &mut Canvas) {
    let radius = face.outline.half_extents().x * 1e3;
    draw_outline("well", &face.outline, 0.0, canvas);
    canvas.circle("metal", Vec2::ZERO, radius * CAP);
    canvas.circle("cap", Vec2::ZERO, radius * (CAP - 0.08));
    let labels = joystick.direction_keys.map(|keys| {
        keys.map(|action| action_label(action, &layout.layers, &layout.texts).to_owned())
    });
    // Up, down, left, right, as in the file; on the page y points down.
    let directions = [Vec2::NEG_Y, Vec2::Y, Vec2::NEG_X, Vec2::X];
    for (index, direction) in directions.into_iter().enumerate() {
        let middle = direction * radius * (CAP + 1.0) / 2.0;
        match &labels {
            Some(labels) => {
                let half = Vec2::splat(radius * (1.0 - CAP) * 0.48);
                draw_fitted("label", &labels[index], middle, half, 4.0, canvas);
            }
            None => draw_arrow(middle, direction, radius * 0.1, canvas),
        }
    }
    let half = Vec2::new(CAP * 0.84, CAP * 0.42) * radius;
    draw_label("label", &face.label, Vec2::ZERO, half, canvas);
}

fn draw_arrow(at: Vec2, direction: Vec2, size: f32, canvas: &mut Canvas) {
    let across = Vec2::from_angle(FRAC_PI_2).rotate(direction);
    let tip = at + direction * size * 0.5;
    let wings = [-1.0, 1.0].map(|side| at - direction * size * 0.5 + across * side * size);
    canvas.polyline("icon", &[wings[0], tip, wings[1]]);
}
