//! Scale bars.

use parry3d::math::Vec2;

use super::canvas::{Align, Canvas};
use super::page::CAPTION_SIZE;

/// Lengths of scale bars, in millimetres.
const LENGTHS: [f32; 8] = [10.0, 20.0, 50.0, 100.0, 200.0, 500.0, 1000.0, 2000.0];

/// The minimum length on the page, in millimetres.
const MIN_LENGTH: f32 = 20.0;

/// Draws a bar with its length, which is a round number of millimetres, and returns its width on the page.
///
/// `scale` is the length on the page of a millimetre. The bar is not longer than half of `width`, unless it is the shortest.
pub fn draw(scale: f32, width: f32, canvas: &mut Canvas, at: Vec2) -> f32 {
    let fits = |length: &&f32| (MIN_LENGTH..=width / 2.0).contains(&(**length * scale));
    let length = LENGTHS.iter().find(fits).copied();
    let length = length.unwrap_or(MIN_LENGTH / scale.max(1e-3));
    let end = at + Vec2::X * length * scale;
    canvas.line("bar", [at, end]);
    for tick in [at, end] {
        canvas.line("bar", [-1.2, 1.2].map(|y| tick + Vec2::Y * y));
    }
    let text = format!("{length:.0} mm");
    let middle = (at + end) / 2.0 + Vec2::Y * 3.4;
    canvas.text("muted", middle, Align::Middle, CAPTION_SIZE, &text);
    length * scale
}
