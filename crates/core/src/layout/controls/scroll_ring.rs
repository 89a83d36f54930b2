//! Scroll rings.

use std::f32::consts::{FRAC_PI_2, TAU};

use parry3d::math::Vec2;
use serde::Deserialize;

use super::value_output::{ValueOutputSchema, kept_output};
use super::{ControlModel, Front, Handle, KindSpec};
use crate::device::scroll_ring::ScrollRing;
use crate::device::value_output::ValueOutput;
use crate::document::{DocumentError, Spanned, ranged_numbers, schema};
use crate::layout::builder::{FaceSpec, LayoutBuilder};
use crate::layout::model::{ControlKind, Face};
use crate::layout::quantity::{Fraction, Offset, Size};
use crate::layout::render::drawing::{Canvas, Words, draw_label, draw_outline};
use crate::layout::schema::{Label, OutlineSchema};

/// The kind, for editors.
pub(crate) const KIND: KindSpec = KindSpec {
    table: "ScrollRing",
    name: "scroll ring",
    words: ["Scroll ring", "Anillo de desplazamiento"],
    new: r#"(name: "Ring", at_mm: AT, diameter_mm: 60, output: ScrollY(-24))"#,
};

ranged_numbers! {
    /// Angle between two detents of a ring, in degrees.
    DetentAngle = "the angle of a detent", 2.0 ..= 180.0, "°", or 15.0;
    /// Diameter of the dead center of a ring, as a fraction of its diameter.
    DeadCenter = "a dead center", 0.1 ..= 0.9, "", or 0.4;
}

schema! {
    /// A ring around which a fingertip slides to scroll, or to send a value. The value is a fraction of a turn and wraps around.
    #[derive(Debug, Deserialize)]
    #[serde(rename = "ScrollRing", deny_unknown_fields)]
    pub(in crate::layout) struct ScrollRingSchema<'a> {
        /// Name.
        #[serde(borrow)]
        name: Spanned<'a>,
        /// Text drawn on it. Default: the name.
        #[serde(default)]
        label: Option<Label>,
        /// Center.
        at_mm: (Offset, Offset),
        /// Outer diameter.
        diameter_mm: Size,
        /// Diameter of the center, in which a fingertip turns nothing, as a fraction of `diameter_mm`.
        #[serde(default)]
        dead_center: DeadCenter,
        /// Angle between two detents; a turn has a whole number of them, the nearest.
        #[serde(default)]
        detent_deg: DetentAngle,
        /// Counter-clockwise increases the value, instead of clockwise.
        #[serde(default)]
        reversed: bool,
        /// Initial value. Default: 0.
        #[serde(default)]
        initial: Option<Fraction>,
        /// Output of a turn; not an axis, which has ends. `ScrollY(-24)` scrolls down with a clockwise finger.
        #[serde(borrow, default)]
        output: Option<ValueOutputSchema<'a>>,
    }
}

impl<'a> ScrollRingSchema<'a> {
    /// Adds the ring to the current board.
    pub fn build(&self, builder: &mut LayoutBuilder<'a>) -> Result<(), DocumentError> {
        let name = self.name.text;
        let detents = (360.0 / self.detent_deg.get()).round() as u16;
        let output = kept_output(builder, self.output)?;
        if let ValueOutput::Axis(axis) = output {
            let message = format!(
                "the scroll ring `{name}` wraps around and cannot output the axis `{axis}`, which has ends; use a knob"
            );
            return Err(builder.error(name, message));
        }
        let radius = builder.board().metres(self.diameter_mm.get()) / 2.0;
        // Without the margin of sliders: a finger that leaves the ring releases it.
        let spec = FaceSpec {
            size: OutlineSchema::Disc(self.diameter_mm),
            ..builder.face_spec("scroll ring", self.name, &self.label, self.at_mm)
        };
        builder.add_single_face(spec, |target| {
            ControlKind::ScrollRing(ScrollRing {
                target,
                radius,
                dead_radius: radius * self.dead_center.get() as f32,
                detents,
                is_reversed: self.reversed,
                initial: self.initial.map_or(0.0, |initial| initial.get() as f32),
                output,
            })
        })
    }
}

impl ControlModel for ScrollRing {
    fn handle(&self) -> Handle {
        Handle::Turn {
            radius: (self.radius + self.dead_radius) / 2.0,
            is_endless: false,
            start: 0.0,
            turns: if self.is_reversed { -1.0 } else { 1.0 },
        }
    }

    fn initial_value(&self, _: usize) -> Option<f32> {
        Some(self.initial)
    }

    fn set_value(&mut self, _: usize, value: f32) {
        self.initial = value;
    }

    fn describe(&self, words: &Words) -> Vec<String> {
        let direction = if self.is_reversed { ", reversed" } else { "" };
        let output = words.value_output(self.output);
        vec![format!(
            "scroll ring, {} detents a turn{direction}{output}",
            self.detents
        )]
    }

    fn draw(&self, front: &Front, canvas: &mut Canvas) {
        draw_ring(self, front.face, canvas);
    }
}

/// The largest number of detents with a mark each.
const MAX_TICKS: u16 = 60;

/// Draws a ring with a mark for each detent, a bead at its value, and its label in the dead center.
fn draw_ring(ring: &ScrollRing, face: &Face, canvas: &mut Canvas) {
    let (outer, inner) = (ring.radius * 1e3, ring.dead_radius * 1e3);
    let middle = (outer + inner) / 2.0;
    draw_outline("metal", &face.outline, 0.0, canvas);
    if ring.detents <= MAX_TICKS {
        for detent in 0..ring.detents {
            let angle = f32::from(detent) / f32::from(ring.detents) * TAU - FRAC_PI_2;
            let direction = Vec2::from_angle(angle);
            let ends = [outer * 0.97, outer - (outer - inner) * 0.22];
            canvas.line("on-metal", ends.map(|end| direction * end));
        }
    }
    canvas.circle("well", Vec2::ZERO, inner);
    let turn = if ring.is_reversed {
        -ring.initial
    } else {
        ring.initial
    };
    let bead = Vec2::from_angle(turn * TAU - FRAC_PI_2) * (middle - (outer - inner) * 0.12);
    canvas.circle("cap", bead, (outer - inner) * 0.2);
    canvas.circle("lit", bead, (outer - inner) * 0.1);
    let room = Vec2::new(inner * 0.85, inner * 0.4);
    draw_label("label", &face.label, Vec2::ZERO, room, canvas);
}
