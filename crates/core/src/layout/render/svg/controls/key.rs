//! Keys: a cap with its label, its labels in other layers, and its second function.

use parry3d::math::Vec2;

use super::{draw_fitted, draw_outline, half_and_radius, text_room};
use crate::device::KeyAction;
use crate::layout::Outline;
use crate::layout::model::{Key, Layout};
use crate::layout::render::svg::canvas::{Align, Canvas};
use crate::layout::render::svg::text::width_em;
use crate::layout::render::words::key_notes;

/// The font size of the labels in other layers and of notes, in millimetres.
const SMALL_SIZE: f32 = 2.8;

/// The height of a front with room for small text above or below the label, in millimetres.
const MIN_HEIGHT_FOR_SMALL: f32 = 11.0;

/// Draws a key with all that is written on it.
pub fn draw(layout: &Layout, key: &Key, canvas: &mut Canvas) {
    let is_special = matches!(
        key.action(0),
        Some(KeyAction::Modifier(..) | KeyAction::Layer(..) | KeyAction::Command(_))
    );
    let outline = &key.face.outline;
    draw_cap(if is_special { "tinted" } else { "cap" }, outline, canvas);
    let room = text_room(outline);
    let layers: Vec<&str> = (1..layout.layers.len())
        .filter_map(|layer| layout.label_in_layer(key, layer))
        .collect();
    let notes = key_notes(layout, key).join(", ");
    let has_room = room.y * 2.0 >= MIN_HEIGHT_FOR_SMALL;
    let above = has_room && !layers.is_empty();
    let below = has_room && !notes.is_empty();
    let strip = SMALL_SIZE * 1.15;
    let height = 2.0 * room.y - strip * f32::from(u8::from(above) + u8::from(below));
    let center = Vec2::Y * strip * (f32::from(u8::from(above)) - f32::from(u8::from(below))) / 2.0;
    let half = Vec2::new(room.x, height / 2.0);
    super::draw_label("label", &key.face.label, center, half, canvas);
    if above {
        let text = first_words(&layers, 2.0 * room.x);
        let at = Vec2::new(room.x - 0.7, -room.y + strip / 2.0 + 0.5);
        canvas.text("layer", at, Align::End, SMALL_SIZE, &text);
    }
    if below {
        let at = Vec2::new(0.0, room.y - strip / 2.0);
        let notes_half = Vec2::new(room.x, strip / 2.0);
        draw_fitted("muted", &notes, at, notes_half, SMALL_SIZE, canvas);
    }
}

/// Draws the cap of a key: its front inside the lower edge of its skirt.
pub fn draw_cap(class: &str, outline: &Outline, canvas: &mut Canvas) {
    let (half, _) = half_and_radius(outline);
    draw_outline("skirt", outline, 0.0, canvas);
    draw_outline(class, outline, (half.min_element() * 0.1).min(0.9), canvas);
}

/// Returns as many of the texts as fit into a width, with an ellipsis for the rest.
fn first_words(texts: &[&str], width: f32) -> String {
    let fits = |text: &str| width_em(text) * SMALL_SIZE <= width;
    let candidates = (1..=texts.len()).rev().map(|count| {
        let rest = if count < texts.len() { " …" } else { "" };
        texts[..count].join(" ") + rest
    });
    candidates
        .into_iter()
        .find(|text| fits(text))
        .unwrap_or_else(|| "…".into())
}
