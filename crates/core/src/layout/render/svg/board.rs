//! Boards from the front, to scale: all controls, the reach of the hand, the pose in words, and a scale bar.

use parry3d::math::Vec2;

use super::canvas::{Align, Canvas, Placement};
use super::controls::{self, draw_cap, on_page, placement};
use super::page::{CAPTION_SIZE, draw_paragraph};
use super::scale_bar;
use crate::contact::surface::Shape;
use crate::layout::model::{Board, Face, Layout};
use crate::layout::render::wearer::{ReachArea, Wearer};
use crate::layout::render::words;

/// The width of the panel around the fronts, in millimetres.
const PANEL_MARGIN: f32 = 5.0;

/// The radius of the corners of the panel, in millimetres.
const PANEL_RADIUS: f32 = 2.0;

/// The minimum width of the text below a board, in millimetres.
const MIN_TEXT_WIDTH: f32 = 170.0;

/// Draws a board with all its controls, and describes it below.
pub fn draw(layout: &Layout, index: usize, wearer: &Wearer) -> Canvas {
    let board = &layout.boards[index];
    let mut view = Canvas::default();
    draw_panel(layout, board, &mut view);
    for area in wearer.areas.iter().filter(|area| area.board == index) {
        draw_reach("reach", area, &mut view);
    }
    for key in &layout.keys[board.keys.clone()] {
        let mut front = Canvas::default();
        controls::draw_key(layout, key, &mut front);
        view.group(placement(&key.face.outline), Some(&key.face.name), &front);
    }
    for control in &layout.controls[board.controls.clone()] {
        controls::draw(layout, control, &mut view);
    }
    for area in wearer.areas.iter().filter(|area| area.board == index) {
        draw_reach("reach-edge", area, &mut view);
    }
    for face in layout.faces(board) {
        if wearer.is_out_of_reach(&face.name) {
            draw_frame("out", face, &mut view);
        }
        if wearer.is_faulty(face.target) {
            draw_frame("fault", face, &mut view);
        }
    }
    draw_caption(layout, index, wearer, &mut view);
    view
}

/// Draws a board as it is in a layer: the keys that the layer changes with their labels, all other fronts without.
pub fn draw_layer(layout: &Layout, index: usize, layer: usize) -> Canvas {
    let board = &layout.boards[index];
    let mut view = Canvas::default();
    draw_panel(layout, board, &mut view);
    for key in &layout.keys[board.keys.clone()] {
        let mut front = Canvas::default();
        match layout.label_in_layer(key, layer) {
            Some(label) => controls::draw_labelled_cap("tinted", label, &key.face, &mut front),
            None => draw_cap("well", &key.face.outline, &mut front),
        }
        view.group(placement(&key.face.outline), Some(&key.face.name), &front);
    }
    for control in &layout.controls[board.controls.clone()] {
        for face in &control.faces {
            let mut front = Canvas::default();
            draw_cap("well", &face.outline, &mut front);
            view.group(placement(&face.outline), Some(&face.name), &front);
        }
    }
    view
}

fn draw_panel(layout: &Layout, board: &Board, view: &mut Canvas) {
    let (min, max) = layout.extent(board);
    let half = (max - min) * 1e3 / 2.0 + PANEL_MARGIN;
    view.rect("panel", on_page((min + max) / 2.0), half, PANEL_RADIUS);
}

fn draw_reach(class: &str, area: &ReachArea, view: &mut Canvas) {
    let outlines = area.outlines.iter();
    let outlines: Vec<Vec<Vec2>> = outlines
        .map(|outline| outline.iter().copied().map(on_page).collect())
        .collect();
    view.outlines(class, outlines.iter().map(Vec::as_slice));
}

fn draw_frame(class: &str, face: &Face, view: &mut Canvas) {
    let half = face.outline.half_extents() * 1e3;
    let mut frame = Canvas::default();
    match face.outline.shape {
        Shape::Disc(_) => frame.circle(class, Vec2::ZERO, half.x),
        Shape::Box(_) => frame.rect(class, Vec2::ZERO, half, 1.8),
    }
    view.group(placement(&face.outline), None, &frame);
}

fn draw_caption(layout: &Layout, index: usize, wearer: &Wearer, view: &mut Canvas) {
    let (min, max) = view.bounds();
    let width = (max.x - min.x).max(MIN_TEXT_WIDTH);
    let bar_at = Vec2::new(min.x, max.y + 5.0);
    let bar = scale_bar::draw(1.0, width, view, bar_at);
    let surface = &layout.scene.surfaces()[index];
    let mut texts = vec![words::board(&layout.boards[index], surface)];
    if wearer.areas.iter().any(|area| area.board == index) {
        texts.push("Shaded: within reach of the index finger".into());
    }
    let mut at = Vec2::new(min.x + bar + 4.0, bar_at.y);
    for text in texts {
        at.y = draw_paragraph("muted", &text, at, width - bar - 4.0, CAPTION_SIZE, view);
    }
    let faces = layout.faces(&layout.boards[index]);
    let unreached: Vec<String> = faces
        .filter_map(|face| {
            let mut all = wearer.out_of_reach.iter();
            let (_, metres) = all.find(|(name, _)| *name == face.name)?;
            Some(if metres.is_finite() {
                format!("{} by {:.0} mm", face.name, metres * 1e3)
            } else {
                face.name.clone()
            })
        })
        .collect();
    if !unreached.is_empty() {
        let text = format!("Out of reach: {}", unreached.join(", "));
        draw_paragraph("warning", &text, at, width - bar - 4.0, CAPTION_SIZE, view);
    }
}

/// Draws the boards that a layer changes side by side below its name.
pub fn draw_layer_row(layout: &Layout, layer: usize, scale: f32) -> Canvas {
    /// The distance between two boards, in millimetres.
    const GAP: f32 = 4.0;
    let mut row = Canvas::default();
    let mut left = 0.0;
    for (index, board) in layout.boards.iter().enumerate() {
        let mut keys = layout.keys[board.keys.clone()].iter();
        if !keys.any(|key| layout.label_in_layer(key, layer).is_some()) {
            continue;
        }
        let drawn = draw_layer(layout, index, layer);
        let (min, _) = drawn.bounds();
        let placement = Placement {
            at: Vec2::new(left, 6.0) - min * scale,
            degrees: 0.0,
            scale,
        };
        row.group(placement, None, &drawn);
        left += drawn.size().x * scale + GAP;
    }
    let name = format!("Layer: {}", layout.layers[layer]);
    row.text(
        "label",
        Vec2::new(0.0, 2.0),
        Align::Start,
        CAPTION_SIZE,
        &name,
    );
    row
}
