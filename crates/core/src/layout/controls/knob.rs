//! Knobs, and the dials of knobs and valves.

use std::f32::consts::{FRAC_PI_2, TAU};

use parry3d::math::Vec2;
use serde::Deserialize;

use super::value_output::{ValueOutputSchema, check_rest, kept_output};
use super::{ControlModel, Front, Handle, KindSpec};
use crate::contact::surface::DRAG_MARGIN;
use crate::device::knob::{self, Knob};
use crate::device::value_output::ValueOutput;
use crate::document::{DocumentError, Spanned, schema};
use crate::layout::builder::{FaceSpec, LayoutBuilder};
use crate::layout::model::{ControlKind, Face};
use crate::layout::quantity::{Fraction, KnobRange, Offset, Size, Steps};
use crate::layout::render::drawing::{Canvas, Words, draw_fitted, draw_label, draw_outline};
use crate::layout::schema::{Label, OutlineSchema};

/// The kind, for editors.
pub(crate) const KIND: KindSpec = KindSpec {
    table: "Knob",
    name: "knob",
    words: ["Knob", "Perilla"],
    new: r#"(name: "Knob", at_mm: AT, diameter_mm: 40)"#,
};

schema! {
    /// A knob, limited or endless.
    #[derive(Debug, Deserialize)]
    #[serde(rename = "Knob", deny_unknown_fields)]
    pub(in crate::layout) struct KnobSchema<'a> {
        /// Name.
        #[serde(borrow)]
        name: Spanned<'a>,
        /// Text drawn on it. Default: the name.
        #[serde(default)]
        label: Option<Label>,
        /// Center.
        at_mm: (Offset, Offset),
        /// Diameter.
        diameter_mm: Size,
        /// Angle between its ends.
        #[serde(default)]
        range_deg: Option<KnobRange>,
        /// The knob has no ends: the value counts turns, and the output cannot be an axis.
        #[serde(default)]
        endless: bool,
        /// Number of steps of the range, or of a turn if it is endless. Default: continuous.
        #[serde(default)]
        steps: Option<Steps>,
        /// Initial value, and rest position of the spring. Default: 0.
        #[serde(default)]
        initial: Option<Fraction>,
        /// The knob returns to `initial` when it is released.
        #[serde(default)]
        springs_back: bool,
        /// Output of the value, per turn if it is endless.
        #[serde(borrow, default)]
        output: Option<ValueOutputSchema<'a>>,
    }
}

/// Radius at which a finger holds the rim, as a fraction of the radius.
const GRIP: f32 = 0.8;

/// The dial of a knob or valve.
pub(super) struct DialSpec<'s, 'a> {
    /// The kind in messages.
    pub kind: &'static str,
    pub name: Spanned<'a>,
    pub label: &'s Option<Label>,
    pub at_mm: (Offset, Offset),
    pub diameter_mm: Size,
    pub range: knob::KnobRange,
    pub steps: Option<Steps>,
    pub initial: Option<Fraction>,
    pub springs_back: bool,
    pub twist_gain: f32,
    pub output: ValueOutput,
}

impl<'a> KnobSchema<'a> {
    /// Adds the knob to the current board.
    pub fn build(&self, builder: &mut LayoutBuilder<'a>) -> Result<(), DocumentError> {
        let output = kept_output(builder, self.output)?;
        let range = if self.endless {
            self.reject_range(builder, output)?;
            knob::KnobRange::Endless
        } else {
            let degrees = self.range_deg.unwrap_or_default().get();
            knob::KnobRange::Limited(degrees.to_radians() as f32)
        };
        let dial = DialSpec {
            kind: "knob",
            name: self.name,
            label: &self.label,
            at_mm: self.at_mm,
            diameter_mm: self.diameter_mm,
            range,
            steps: self.steps,
            initial: self.initial,
            springs_back: self.springs_back,
            twist_gain: 1.0,
            output,
        };
        add_dial(builder, dial)
    }

    /// Rejects settings of an endless knob that need a range.
    fn reject_range(
        &self,
        builder: &LayoutBuilder<'a>,
        output: ValueOutput,
    ) -> Result<(), DocumentError> {
        let name = self.name.text;
        let what = match (output, self.range_deg, self.initial) {
            _ if self.springs_back => "spring back",
            (ValueOutput::Axis(_), ..) => "output an axis, which has ends",
            (_, Some(_), _) => "have a `range_deg`",
            (_, _, Some(_)) => "have an `initial` value: it counts turns from 0",
            _ => return Ok(()),
        };
        let message = format!("the knob `{name}` is endless and cannot {what}");
        Err(builder.error(name, message))
    }
}

/// Adds a dial to the current board.
pub(super) fn add_dial<'a>(
    builder: &mut LayoutBuilder<'a>,
    dial: DialSpec<'_, 'a>,
) -> Result<(), DocumentError> {
    let steps = dial.steps.map(|steps| steps.get() as u16);
    let initial = dial.initial.map_or(0.0, |initial| initial.get() as f32);
    if dial.springs_back {
        let steps = steps.map(|steps| (steps, "steps"));
        let rest = ("initial", initial);
        check_rest(builder, dial.kind, dial.name, rest, steps, dial.output)?;
    }
    let radius = builder.board().metres(dial.diameter_mm.get()) / 2.0;
    let spec = FaceSpec {
        size: OutlineSchema::Disc(dial.diameter_mm),
        margin: DRAG_MARGIN,
        ..builder.face_spec(dial.kind, dial.name, dial.label, dial.at_mm)
    };
    builder.add_single_face(spec, |target| {
        ControlKind::Knob(Knob {
            target,
            radius,
            range: dial.range,
            steps,
            initial,
            rest: dial.springs_back.then_some(initial),
            twist_gain: dial.twist_gain,
            output: dial.output,
        })
    })
}

/// The largest number of turns of a dial with a scale. One with more is a wheel.
const MAX_DIAL_TURNS: f32 = 1.01;

/// Returns the position of the value 0, in turns clockwise from the top. The middle of a dial and the rest of a wheel are at the top.
fn start_turns(range: f32, rest: Option<f32>) -> f32 {
    let turns = range / TAU;
    if turns > MAX_DIAL_TURNS {
        -rest.unwrap_or(0.0) * turns
    } else {
        -turns / 2.0
    }
}

impl ControlModel for Knob {
    fn handle(&self) -> Handle {
        let (is_endless, start, turns) = match self.range {
            knob::KnobRange::Endless => (true, 0.0, 1.0),
            knob::KnobRange::Limited(range) => (false, start_turns(range, self.rest), range / TAU),
        };
        Handle::Turn {
            radius: self.radius * GRIP,
            is_endless,
            start,
            turns,
        }
    }

    fn initial_value(&self, _: usize) -> Option<f32> {
        Some(self.initial)
    }

    fn set_value(&mut self, _: usize, value: f32) {
        self.initial = value;
    }

    fn describe(&self, words: &Words) -> Vec<String> {
        let kind = match self.range {
            knob::KnobRange::Endless => "endless knob".to_owned(),
            knob::KnobRange::Limited(range) if range / TAU > MAX_DIAL_TURNS => {
                let turns = (range / TAU * 100.0).round() / 100.0;
                format!("valve, {turns} turns")
            }
            knob::KnobRange::Limited(range) => format!("knob, {:.0}°", range.to_degrees()),
        };
        let steps = self.steps.map(|steps| format!(", {steps} steps"));
        let spring = self.rest.map_or("", |_| ", springs back");
        let output = words.value_output(self.output);
        vec![format!(
            "{kind}{}{spring}{output}",
            steps.unwrap_or_default()
        )]
    }

    fn draw(&self, front: &Front, canvas: &mut Canvas) {
        draw_knob(self, front.face, canvas);
    }
}

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
fn draw_knob(knob: &Knob, face: &Face, canvas: &mut Canvas) {
    let radius = face.outline.half_extents().x * 1e3;
    draw_outline("well", &face.outline, 0.0, canvas);
    match knob.range {
        knob::KnobRange::Limited(range) if range / TAU > MAX_DIAL_TURNS => {
            draw_wheel(knob, range, radius, canvas)
        }
        knob::KnobRange::Limited(range) => draw_dial(knob, range, radius, canvas),
        knob::KnobRange::Endless => draw_endless(knob, radius, canvas),
    }
    if let (Some(rest), knob::KnobRange::Limited(range)) = (knob.rest, knob.range) {
        let at = (start_turns(range, knob.rest) + rest * range / TAU) * TAU - FRAC_PI_2;
        // The rim of a wheel is of metal, and a dial has its marks around the rim.
        let is_wheel = range / TAU > MAX_DIAL_TURNS;
        let class = if is_wheel { "on-metal" } else { "icon" };
        draw_spring(class, at, radius, canvas);
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
    let start = start_turns(range, knob.rest) * TAU - FRAC_PI_2;
    let turn = start + knob.initial.clamp(0.0, 1.0) * range;
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

/// Draws arrows along the rim, from both sides towards the position to which a spring returns the mark.
fn draw_spring(class: &str, at: f32, radius: f32, canvas: &mut Canvas) {
    let point = |angle: f32, length: f32| Vec2::from_angle(angle) * radius * length;
    for side in [-1.0, 1.0] {
        for distance in [0.2, 0.32] {
            let wings = [0.84, 0.94].map(|length| point(at + side * (distance + 0.07), length));
            let tip = point(at + side * distance, 0.89);
            canvas.polyline(class, &[wings[0], tip, wings[1]]);
        }
    }
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
