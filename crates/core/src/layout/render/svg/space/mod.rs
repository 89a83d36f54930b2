//! Boards, pointers and targets in space: from above, from the right, and from the wearer.

mod figure;
mod gauge;
mod scene;

use parry3d::math::Vec2;

use self::figure::{ALL, Scene, View};
use super::canvas::{Align, Canvas, Placement};
use super::page::CAPTION_SIZE;
use super::scale_bar;
use crate::device::pointer::PointingMode;
use crate::layout::model::Layout;
use crate::layout::render::wearer::Wearer;

/// The largest scale of a view, as a fraction of the real size.
const MAX_SCALE: f32 = 0.35;

/// The smallest scale at which views are drawn side by side, if they could be larger one below the other.
const MIN_ROW_SCALE: f32 = 0.18;

/// The largest height of a view, in millimetres.
const MAX_HEIGHT: f32 = 100.0;

/// The room for the texts at the sides of a view, in millimetres.
const SIDES: f32 = 14.0;

/// The distance between two views, in millimetres.
const GAP: f32 = 10.0;

/// Draws all views of a layout within `width` millimetres. Returns `None` if there is nothing in space.
pub fn draw(layout: &Layout, wearer: &Wearer, width: f32) -> Option<Canvas> {
    let mut parts = Vec::new();
    let mode = layout.pointer.as_ref().map(|pointer| &pointer.mode);
    parts.extend(mode.and_then(gauge::draw));
    if let Some(PointingMode::Joint(joint)) = mode {
        let scene = scene::around_cursor(joint, &layout.spaces);
        parts.push(draw_views(&scene, ALL, width));
    }
    let scene = scene::around_wearer(layout, wearer);
    if !scene.figures.is_empty() {
        let has_volumes = scene.figures.iter().any(|(class, _)| *class == "volume");
        let views = if has_volumes { ALL } else { &ALL[..2] };
        parts.push(draw_views(&scene, views, width));
    }
    stack(parts)
}

/// Draws views side by side at one scale, in as many lines as they need, and a scale bar.
fn draw_views(scene: &Scene, views: &[View], width: f32) -> Canvas {
    let sizes: Vec<Vec2> = views.iter().map(|view| scene.size(*view)).collect();
    let largest = sizes.iter().copied().fold(Vec2::ONE, Vec2::max);
    let scale = (1..=views.len())
        .rev()
        .map(|count| row_scale(&sizes, count, width))
        .find(|scale| *scale >= MIN_ROW_SCALE)
        .unwrap_or((width - SIDES) / largest.x);
    let scale = scale.min(MAX_SCALE).min(MAX_HEIGHT / largest.y);
    let mut canvas = Canvas::default();
    let mut corner = Vec2::ZERO;
    let mut line_height: f32 = 0.0;
    for view in views {
        let drawing = scene.draw(*view, scale);
        let (min, max) = drawing.bounds();
        let size = max - min;
        if corner.x > 0.0 && corner.x + size.x > width {
            corner = Vec2::new(0.0, corner.y + line_height + GAP);
            line_height = 0.0;
        }
        canvas.group(Placement::at(corner - min), Some(view.name()), &drawing);
        let below = corner + Vec2::new(size.x / 2.0, size.y + 4.0);
        canvas.text("muted", below, Align::Middle, CAPTION_SIZE, view.name());
        corner.x += size.x + GAP;
        line_height = line_height.max(size.y + 6.0);
    }
    let (min, max) = canvas.bounds();
    let bar_at = Vec2::new(min.x, max.y + 4.0);
    scale_bar::draw(scale, width, &mut canvas, bar_at);
    canvas
}

/// Returns the largest scale at which any `count` views that follow each other fit into a row.
fn row_scale(sizes: &[Vec2], count: usize, width: f32) -> f32 {
    let rows = sizes.windows(count);
    let widths = rows.map(|row| row.iter().map(|size| size.x).sum());
    let widest: f32 = widths.fold(1.0, f32::max);
    (width - (GAP + SIDES) * count as f32) / widest
}

/// Returns drawings one below the other, or `None` without any.
fn stack(parts: Vec<Canvas>) -> Option<Canvas> {
    if parts.is_empty() {
        return None;
    }
    let mut stack = Canvas::default();
    let mut top = 0.0;
    for part in parts {
        let (min, max) = part.bounds();
        let at = Vec2::new(-min.x, top - min.y);
        stack.group(Placement::at(at), None, &part);
        top += max.y - min.y + GAP;
    }
    Some(stack)
}
