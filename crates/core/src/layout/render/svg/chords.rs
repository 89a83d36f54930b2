//! Chords: the keys of each on a small board, with the action.

use parry3d::math::Vec2;

use super::canvas::{Align, Canvas, Placement};
use super::controls::{draw_lines, on_page, placement};
use super::text::fit;
use crate::contact::TargetId;
use crate::layout::model::{Face, Layout};
use crate::layout::render::words;

/// The largest number of chord keys that a small board shows clearly.
const MAX_KEYS: usize = 12;

/// The size of a small board, in millimetres.
const BOARD_SIZE: Vec2 = Vec2::new(15.0, 16.0);

/// The room for the action beside a small board, in millimetres.
const ACTION_WIDTH: f32 = 13.0;

/// The size of the heading of a layer, and its height with the gap below, in millimetres.
const HEADING_SIZE: f32 = 3.2;
const HEADING_HEIGHT: f32 = 6.0;

/// Draws the chords of a layer in lines of `width` millimetres. Returns `None` without chords, or with too many keys to tell
/// apart.
pub fn draw(layout: &Layout, layer: usize, width: f32) -> Option<Canvas> {
    let in_layer = words::chords(layout, layer);
    let faces: Vec<&Face> = layout
        .keys
        .iter()
        .map(|key| &key.face)
        .filter(|face| layout.is_chord_key(face.target))
        .collect();
    if in_layer.is_empty() || faces.len() > MAX_KEYS {
        return None;
    }
    let mut chords = Canvas::default();
    let mut top = 0.0;
    if layer > 0 {
        let name = format!("Chords of the layer {}", layout.layers[layer]);
        let at = Vec2::new(0.0, 2.0);
        chords.text("label", at, Align::Start, HEADING_SIZE, &name);
        top = HEADING_HEIGHT;
    }
    let cell = Vec2::new(BOARD_SIZE.x + ACTION_WIDTH + 3.0, BOARD_SIZE.y + 4.0);
    let columns = ((width / cell.x) as usize).max(1);
    for (index, words) in in_layer.iter().enumerate() {
        let corner = cell * Vec2::new((index % columns) as f32, (index / columns) as f32);
        let corner = corner + Vec2::Y * top;
        draw_board(&faces, &words.chord.keys, corner, &mut chords);
        let at = corner + Vec2::new(BOARD_SIZE.x + 2.0, BOARD_SIZE.y / 2.0);
        let half = Vec2::new(ACTION_WIDTH, BOARD_SIZE.y) / 2.0;
        let action = fit(&words.action, 2.0 * half, 5.2);
        draw_lines("label", &action, at, Align::Start, &mut chords);
    }
    Some(chords)
}

fn draw_board(faces: &[&Face], pressed: &[TargetId], corner: Vec2, chords: &mut Canvas) {
    let mut board = Canvas::default();
    for face in faces {
        let class = if pressed.contains(&face.target) {
            "lit"
        } else {
            "well"
        };
        let mut front = Canvas::default();
        let half = face.outline.half_extents() * 1e3;
        front.rect(class, Vec2::ZERO, half, half.min_element() * 0.5);
        board.group(placement(&face.outline), None, &front);
        board.cover(on_page(face.outline.center), Vec2::ZERO);
    }
    let (min, max) = board.bounds();
    let scale = (BOARD_SIZE / (max - min).max(Vec2::splat(0.1))).min_element();
    let middle = corner + BOARD_SIZE / 2.0;
    let placement = Placement {
        at: middle - (min + max) / 2.0 * scale,
        degrees: 0.0,
        scale,
    };
    chords.group(placement, None, &board);
}
