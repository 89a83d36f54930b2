//! The fronts of keys and other controls: what all kinds have in common.

mod key;

pub use key::draw as draw_key;
pub use key::draw_cap;

use parry3d::math::Vec2;

use super::canvas::{Align, Canvas, Placement};
use super::text::{FittedText, LINE_HEIGHT, fit, width_em};
use crate::contact::surface::Shape;
use crate::layout::Outline;
use crate::layout::controls::Front;
use crate::layout::model::{Control, ControlKind, Face, Layout};

/// The maximum font size of a label, in millimetres.
const MAX_LABEL_SIZE: f32 = 5.2;

/// The part of a front that its label uses, as a fraction of the room.
const LABEL_FILL: f32 = 0.94;

/// Draws a control other than a key on its board.
pub fn draw(layout: &Layout, control: &Control, canvas: &mut Canvas) {
    let model = control.kind.model();
    model.draw_below(&control.faces, canvas);
    for (index, face) in control.faces.iter().enumerate() {
        let mut front = Canvas::default();
        draw_front(layout, &control.kind, index, false, face, &mut front);
        canvas.group(placement(&face.outline), Some(&face.name), &front);
    }
}

/// Draws one front of a control, in its own axes. `index` is the index of the front, and `is_on` the state of a toggle switch.
pub fn draw_front(
    layout: &Layout,
    kind: &ControlKind,
    index: usize,
    is_on: bool,
    face: &Face,
    canvas: &mut Canvas,
) {
    let front = Front {
        layout,
        face,
        index,
        is_on,
    };
    kind.model().draw(&front, canvas);
}

/// Draws a cap with a label and nothing else.
pub fn draw_labelled_cap(class: &str, label: &str, face: &Face, canvas: &mut Canvas) {
    draw_cap(class, &face.outline, canvas);
    draw_label("label", label, Vec2::ZERO, text_room(&face.outline), canvas);
}

/// Returns the placement of an outline on its board.
pub fn placement(outline: &Outline) -> Placement {
    Placement {
        at: on_page(outline.center),
        // A subtraction, because a negated 0 is written as -0.
        degrees: 0.0 - outline.rotation.to_degrees(),
        scale: 1.0,
    }
}

/// Returns the position on the page of a point on a board: millimetres, y down.
pub fn on_page(point: Vec2) -> Vec2 {
    Vec2::new(point.x, -point.y) * 1e3
}

/// Returns half the width and height of an outline, in millimetres, and the radius of its corners.
fn half_and_radius(outline: &Outline) -> (Vec2, f32) {
    let half = outline.half_extents() * 1e3;
    match outline.shape {
        Shape::Disc(_) => (half, half.x),
        Shape::Box(_) => (half, half.min_element().min(1.8)),
    }
}

/// Returns the room for text on a front, in millimetres: half the width and height of a rectangle inside it.
pub fn text_room(outline: &Outline) -> Vec2 {
    let half = outline.half_extents() * 1e3;
    match outline.shape {
        Shape::Disc(_) => half * Vec2::new(0.82, 0.56),
        Shape::Box(_) => half * LABEL_FILL - 0.6_f32.min(half.min_element() * 0.1),
    }
}

/// Draws the outline of a front.
pub fn draw_outline(class: &str, outline: &Outline, inset: f32, canvas: &mut Canvas) {
    let (half, radius) = half_and_radius(outline);
    let half = (half - inset).max(Vec2::splat(0.1));
    match outline.shape {
        Shape::Disc(_) => canvas.circle(class, Vec2::ZERO, half.x),
        Shape::Box(_) => canvas.rect(class, Vec2::ZERO, half, radius),
    }
}

/// Draws a label inside a rectangle, in one line or two.
pub fn draw_label(class: &str, label: &str, center: Vec2, half: Vec2, canvas: &mut Canvas) {
    draw_fitted(class, label, center, half, MAX_LABEL_SIZE, canvas);
}

/// Returns half the width and height of a label as it is drawn inside a rectangle.
pub fn label_half(label: &str, half: Vec2) -> Vec2 {
    let fitted = fit(label, 2.0 * half, MAX_LABEL_SIZE);
    let widths = fitted.lines.iter().map(|line| width_em(line));
    let lines = fitted.lines.len() as f32;
    Vec2::new(widths.fold(0.0, f32::max), lines * LINE_HEIGHT) * fitted.size / 2.0
}

/// Draws a text inside a rectangle, with a maximum size.
pub fn draw_fitted(
    class: &str,
    text: &str,
    center: Vec2,
    half: Vec2,
    max_size: f32,
    canvas: &mut Canvas,
) {
    let fitted = fit(text, 2.0 * half, max_size);
    draw_lines(class, &fitted, center, Align::Middle, canvas);
}

/// Draws the lines of a text about the height of a point, at which they begin, end or have their middle.
pub fn draw_lines(class: &str, text: &FittedText, at: Vec2, align: Align, canvas: &mut Canvas) {
    let middle = (text.lines.len() as f32 - 1.0) / 2.0;
    for (index, line) in text.lines.iter().enumerate() {
        let offset = (index as f32 - middle) * text.size * LINE_HEIGHT;
        canvas.text(class, at + Vec2::Y * offset, align, text.size, line);
    }
}
