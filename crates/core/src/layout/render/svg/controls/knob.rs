//! Knobs and valves: a dial with a mark at its first position, its range, and a mark for each step.

use std::f32::consts::{FRAC_PI_2, TAU};

use parry3d::math::Vec2;

use super::{draw_fitted, draw_label, draw_outline};
use crate::device::knob::{Knob, KnobRange};
use crate::layout::model::Face;
use crate::layout::render::svg::canvas::Canvas;

/// Fractions of the radius: scale around the dial, rim of the dial, and hub with the label.
const SCALE: f32 = 0.93;
const RIM: f32 = 0.8;
const HUB: f32 = 0.56;

/// The largest number of steps with a mark each.
const MAX_TICKS: u16 = 60;

/// The number of marks around a dial without steps.
const GRIP_TICKS: u16 = 24;

/// The number of spokes of a valve.
const SPOKES: u16 = 5;

/// Draws a dial.
pub fn draw(knob: &Knob, face: &Face, canvas: &mut Canvas) {
    let radius = face.outline.half_extents().x * 1e3;
    draw_outline("well", &face.outline, 0.0, canvas);
    match knob.range {
        KnobRange::Limited(range) if range > TAU * 1.01 => draw_wheel(knob, range, radius, canvas),
        KnobRange::Limited(range) => draw_dial(knob, range, radius, canvas),
        KnobRange::Endless => draw_endless(knob, radius, canvas),
    }
    let half = Vec2::new(HUB * 0.92, HUB * 0.4) * radius;
    draw_label("label", &face.label, Vec2::ZERO, half, canvas);
}

fn draw_dial(knob: &Knob, range: f32, radius: f32, canvas: &mut Canvas) {
    let start = -FRAC_PI_2 - range / 2.0;
    let ends = [start, start + range];
    canvas.arc("range", Vec2::ZERO, radius * SCALE, ends);
    draw_ticks(knob.steps.unwrap_or(1), ends, radius, canvas);
    draw_body(radius, canvas);
    draw_mark(start + range * knob.initial.clamp(0.0, 1.0), radius, canvas);
}

fn draw_endless(knob: &Knob, radius: f32, canvas: &mut Canvas) {
    let ends = [-FRAC_PI_2, -FRAC_PI_2 + TAU];
    canvas.arc("range", Vec2::ZERO, radius * SCALE, ends);
    draw_ticks(knob.steps.unwrap_or(GRIP_TICKS), ends, radius, canvas);
    draw_body(radius, canvas);
    // Its value is a number of turns.
    draw_mark(knob.initial * TAU - FRAC_PI_2, radius, canvas);
}

/// Draws a hand wheel with spokes, and its number of turns.
fn draw_wheel(knob: &Knob, range: f32, radius: f32, canvas: &mut Canvas) {
    canvas.circle("metal", Vec2::ZERO, radius * 0.97);
    canvas.circle("well", Vec2::ZERO, radius * 0.76);
    let turn = knob.initial.clamp(0.0, 1.0) * range - FRAC_PI_2;
    for spoke in 0..SPOKES {
        let angle = turn + (f32::from(spoke) + 0.5) * TAU / f32::from(SPOKES);
        canvas.line("spoke", spoke_ends(angle, radius, [HUB, 0.8]));
    }
    canvas.circle("cap", Vec2::ZERO, radius * HUB);
    canvas.line("on-metal", spoke_ends(turn, radius, [0.8, 0.93]));
    let turns = (range / TAU * 100.0).round() / 100.0;
    let half = Vec2::new(HUB * 0.7, HUB * 0.17) * radius;
    let below = Vec2::Y * radius * HUB * 0.62;
    draw_fitted("muted", &format!("{turns} turns"), below, half, 3.0, canvas);
}

fn draw_body(radius: f32, canvas: &mut Canvas) {
    canvas.circle("metal", Vec2::ZERO, radius * RIM);
    canvas.circle("cap", Vec2::ZERO, radius * HUB);
}

/// Draws the pointer on the rim of the dial.
fn draw_mark(angle: f32, radius: f32, canvas: &mut Canvas) {
    let ends = spoke_ends(angle, radius, [HUB + 0.05, RIM - 0.05]);
    canvas.line("on-metal", ends);
    canvas.line("mark", spoke_ends(angle, radius, [RIM + 0.04, 0.97]));
}

fn draw_ticks(steps: u16, [from, to]: [f32; 2], radius: f32, canvas: &mut Canvas) {
    let steps = if steps > MAX_TICKS { 1 } else { steps.max(1) };
    for step in 0..=steps {
        let angle = from + (to - from) * f32::from(step) / f32::from(steps);
        canvas.line("tick", spoke_ends(angle, radius, [RIM + 0.05, SCALE]));
    }
}

fn spoke_ends(angle: f32, radius: f32, ends: [f32; 2]) -> [Vec2; 2] {
    ends.map(|end| Vec2::from_angle(angle) * radius * end)
}
