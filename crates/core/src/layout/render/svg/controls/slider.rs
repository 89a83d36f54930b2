//! Sliders and levers: a groove, a handle at its first position, and a mark for each step.

use std::f32::consts::FRAC_PI_2;

use parry3d::math::Vec2;

use super::{draw_label, draw_outline};
use crate::device::slider::{Slider, Track};
use crate::layout::model::Face;
use crate::layout::render::svg::canvas::{Canvas, Placement};

/// The maximum height of a line of text, in millimetres.
const MAX_STRIP: f32 = 5.0;

/// The largest number of steps with a mark each.
const MAX_TICKS: u16 = 50;

/// Draws a track along X with its handle.
pub fn draw(slider: &Slider, face: &Face, canvas: &mut Canvas) {
    let half = face.outline.half_extents() * 1e3;
    draw_outline("well", &face.outline, 0.0, canvas);
    let strip = (half.y * 0.6).min(MAX_STRIP).min(half.x * 0.5);
    // The label is upright to within an eighth of a turn: beside a track along it, or at the near end of one across it.
    let quarter_turns = (face.outline.rotation / FRAC_PI_2).round();
    let is_across = quarter_turns.rem_euclid(2.0) == 1.0;
    let down = if quarter_turns.rem_euclid(4.0) >= 2.0 {
        -1.0
    } else {
        1.0
    };
    let (lane, room) = match is_across {
        true => (0.0, half.y),
        false => (-down * strip * 0.5, half.y - strip * 0.5),
    };
    let handle = handle_half(slider, half, room);
    let margin = handle.x + 1.0;
    let mut ends = [-half.x + margin, half.x - margin];
    if is_across {
        let label_at = Vec2::X * -down * (half.x - strip * 0.5 - 0.8);
        let room = Vec2::new(half.y - 0.8, strip / 2.0);
        draw_turned_label(face, label_at, room, canvas);
        ends[usize::from(down < 0.0)] += down * strip;
    } else {
        let label_at = Vec2::Y * down * (half.y - strip * 0.5 - 0.4);
        let room = Vec2::new(half.x - 1.2, strip / 2.0);
        draw_turned_label(face, label_at, room, canvas);
    }
    let track = DrawnTrack { ends, lane, room };
    track.draw_groove(slider, canvas);
    track.draw_handle(slider, handle, canvas);
}

/// Returns half the length along the track and half the width of a handle.
fn handle_half(slider: &Slider, half: Vec2, room: f32) -> Vec2 {
    let length = (room * 0.36).min(half.x * 0.16).min(4.0);
    match slider.track {
        Track::Straight => Vec2::new(length, room * 0.72),
        Track::Hinged(_) => Vec2::splat((room * 0.72).min(length * 1.7)),
    }
}

/// A track on its front, in millimetres.
struct DrawnTrack {
    /// The positions of the values 0 and 1 along X.
    ends: [f32; 2],
    /// The position of the track along Y.
    lane: f32,
    /// Half of the width for ticks and handle.
    room: f32,
}

impl DrawnTrack {
    fn draw_groove(&self, slider: &Slider, canvas: &mut Canvas) {
        let [low, high] = self.ends;
        let center = Vec2::new((low + high) / 2.0, self.lane);
        let (class, width) = match slider.track {
            Track::Straight => ("groove", (self.room * 0.12).clamp(0.3, 1.1)),
            Track::Hinged(_) => ("slot", self.room * 0.3),
        };
        let half = Vec2::new((high - low) / 2.0 + width, width);
        canvas.rect(class, center, half, width);
        let Some(steps) = slider.steps.filter(|steps| *steps <= MAX_TICKS) else {
            return;
        };
        for step in 0..=steps {
            let x = self.position(slider, f32::from(step) / f32::from(steps));
            for side in [-1.0, 1.0] {
                let tick = [0.6, 0.85].map(|y| Vec2::new(x, self.lane + side * y * self.room));
                canvas.line("tick", tick);
            }
        }
    }

    /// Draws the handle; that of a lever is a ball on an arm from the hinge.
    fn draw_handle(&self, slider: &Slider, half: Vec2, canvas: &mut Canvas) {
        let at = Vec2::new(self.position(slider, slider.initial), self.lane);
        match slider.track {
            Track::Straight => {
                canvas.rect("metal", at, half, half.x * 0.45);
                let notch = [-0.75, 0.75].map(|y| at + Vec2::Y * y * half.y);
                canvas.line("on-metal", notch);
            }
            Track::Hinged(_) => {
                let hinge = Vec2::new((self.ends[0] + self.ends[1]) / 2.0, self.lane);
                canvas.circle("metal", hinge, half.y * 0.4);
                canvas.line("spoke", [hinge, at]);
                canvas.circle("metal", at, half.y);
                canvas.circle("on-metal", at, half.y * 0.55);
                if slider.springs_back {
                    draw_spring(at, half.y, canvas);
                }
            }
        }
    }

    fn position(&self, slider: &Slider, value: f32) -> f32 {
        let [low, high] = self.ends;
        let t = (slider.track.position(value) + 1.0) / 2.0;
        low + (high - low) * t.clamp(0.0, 1.0)
    }
}

/// Draws arrows along the track, from both sides towards the position to which a spring returns the handle.
fn draw_spring(at: Vec2, radius: f32, canvas: &mut Canvas) {
    for side in [-1.0, 1.0] {
        for distance in [1.5, 1.9] {
            let tip = at + Vec2::X * side * radius * distance;
            let wings = [-1.0, 1.0].map(|y| tip + Vec2::new(side * 0.35, y * 0.35) * radius);
            canvas.polyline("icon", &[wings[0], tip, wings[1]]);
        }
    }
}

fn draw_turned_label(face: &Face, at: Vec2, half: Vec2, canvas: &mut Canvas) {
    let mut label = Canvas::default();
    draw_label("label", &face.label, Vec2::ZERO, half, &mut label);
    let quarter_turns = (face.outline.rotation / FRAC_PI_2).round();
    let placement = Placement {
        degrees: quarter_turns * 90.0,
        ..Placement::at(at)
    };
    canvas.group(placement, None, &label);
}
