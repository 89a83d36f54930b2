//! XY pads.

use parry3d::math::Vec2;
use serde::Deserialize;

use super::value_output::{ValueOutputSchema, check_rest, kept_output};
use super::{ControlModel, Front, Handle, KindSpec};
use crate::contact::TargetId;
use crate::contact::surface::{DRAG_MARGIN, Shape};
use crate::device::value_output::NamedValue;
use crate::device::xy_pad::{PadAxis, XyPad};
use crate::document::{DocumentError, Spanned, schema};
use crate::layout::builder::{FaceSpec, LayoutBuilder};
use crate::layout::model::{ControlKind, Face};
use crate::layout::quantity::{Fraction, Offset, Steps};
use crate::layout::render::drawing::{Canvas, Words, draw_label, draw_outline, label_half};
use crate::layout::schema::{Label, OutlineSchema};

/// The kind, for editors.
pub(crate) const KIND: KindSpec = KindSpec {
    table: "XyPad",
    name: "XY pad",
    words: ["XY pad", "Panel XY"],
    new: r#"(name: "XY", at_mm: AT, size_mm: Box(60, 60))"#,
};

/// The words after the name of a pad in the names of its values.
pub(crate) const DIRECTIONS: [&str; 2] = ["x", "y"];

schema! {
    /// A pad with two values: the position of the finger to the right and away from you. `NAME x` and `NAME y` are their names.
    #[derive(Debug, Deserialize)]
    #[serde(rename = "XyPad", deny_unknown_fields)]
    pub(in crate::layout) struct XyPadSchema<'a> {
        /// Name.
        #[serde(borrow)]
        name: Spanned<'a>,
        /// Text drawn on it. Default: the name.
        #[serde(default)]
        label: Option<Label>,
        /// Center.
        at_mm: (Offset, Offset),
        /// Outline, a `Box`; its edges are 0 and 1.
        size_mm: OutlineSchema,
        /// Settings of the value to the right. Default: `()`.
        #[serde(borrow, default)]
        x: PadValueSchema<'a>,
        /// Settings of the value away from you. Default: `()`.
        #[serde(borrow, default)]
        y: PadValueSchema<'a>,
        /// Both values return to `initial` when it is released.
        #[serde(default)]
        springs_back: bool,
    }
}

schema! {
    /// A value of an XY pad.
    #[derive(Clone, Copy, Debug, Default, PartialEq, Deserialize)]
    #[serde(rename = "PadValue", deny_unknown_fields)]
    struct PadValueSchema<'a> {
        /// Number of steps. Default: continuous.
        #[serde(default)]
        steps: Option<Steps>,
        /// Initial value, and rest position of the spring. Default: 0.5, the middle.
        #[serde(default)]
        initial: Option<Fraction>,
        /// Output of the value. Default: none.
        #[serde(borrow, default)]
        output: Option<ValueOutputSchema<'a>>,
    }
}

impl<'a> XyPadSchema<'a> {
    /// Adds the pad to the current board.
    pub fn build(&self, builder: &mut LayoutBuilder<'a>) -> Result<(), DocumentError> {
        let Shape::Box(half_extents) = self.size_mm.shape(builder.board().scale) else {
            let message = format!("the XY pad `{}` must be a Box", self.name.text);
            return Err(builder.error(self.name.text, message));
        };
        let axes = [self.axis(self.x, builder)?, self.axis(self.y, builder)?];
        let spec = FaceSpec {
            size: self.size_mm,
            margin: DRAG_MARGIN,
            ..builder.face_spec("XY pad", self.name, &self.label, self.at_mm)
        };
        // The builder numbers the values after all targets that fingertips touch.
        let values = DIRECTIONS.map(|direction| NamedValue {
            name: format!("{} {direction}", self.name.text),
            target: TargetId(u32::MAX),
        });
        builder.add_single_face(spec, |target| {
            ControlKind::XyPad(XyPad {
                target,
                half_extents,
                values,
                axes,
                springs_back: self.springs_back,
            })
        })
    }

    fn axis(
        &self,
        value: PadValueSchema<'a>,
        builder: &mut LayoutBuilder<'a>,
    ) -> Result<PadAxis, DocumentError> {
        let output = kept_output(builder, value.output)?;
        let initial = value.initial.map_or(0.5, |initial| initial.get() as f32);
        let steps = value.steps.map(|steps| steps.get() as u16);
        if self.springs_back {
            let rest = ("initial", initial);
            let steps = steps.map(|steps| (steps, "steps"));
            check_rest(builder, "XY pad", self.name, rest, steps, output)?;
        }
        Ok(PadAxis {
            steps,
            initial,
            output,
        })
    }
}

impl ControlModel for XyPad {
    fn handle(&self) -> Handle {
        Handle::Pad {
            half: self.half_extents,
        }
    }

    fn values(&self) -> &[NamedValue] {
        &self.values
    }

    fn values_mut(&mut self) -> &mut [NamedValue] {
        &mut self.values
    }

    fn initial_value(&self, index: usize) -> Option<f32> {
        Some(self.axes.get(index)?.initial)
    }

    fn set_value(&mut self, index: usize, value: f32) {
        if let Some(axis) = self.axes.get_mut(index) {
            axis.initial = value;
        }
    }

    fn describe(&self, words: &Words) -> Vec<String> {
        let spring = if self.springs_back {
            ", springs back"
        } else {
            ""
        };
        let directions = ["to the right", "up"].into_iter();
        let values = self.values.iter().zip(&self.axes).zip(directions);
        let values = values.map(|((value, axis), direction)| {
            let steps = axis.steps.map(|steps| format!(", {steps} steps"));
            let output = words.value_output(axis.output);
            let name = &value.name;
            format!("; {name} {direction}{}{output}", steps.unwrap_or_default())
        });
        vec![format!("XY pad{spring}{}", values.collect::<String>())]
    }

    fn draw(&self, front: &Front, canvas: &mut Canvas) {
        draw_pad(self, front.face, canvas);
    }
}

/// The largest number of steps with a mark each.
const MAX_TICKS: u16 = 50;

/// The distance between the label and the lines, as a part of half the smaller side.
const LABEL_GAP: f32 = 0.02;

/// Draws a pad with its handle, and lines through it to the edges.
fn draw_pad(pad: &XyPad, face: &Face, canvas: &mut Canvas) {
    let half = face.outline.half_extents() * 1e3;
    let size = half.min_element();
    let radius = (size * 0.12).min(4.0);
    draw_outline("skirt", &face.outline, 0.0, canvas);
    let rim = (size * 0.03).min(0.8);
    draw_outline("well", &face.outline, rim, canvas);
    // In a corner, which the lines seldom reach.
    let room = Vec2::new(half.x * 0.42, size * 0.1);
    let label_at = Vec2::new(-half.x * 0.5, -half.y + size * 0.18);
    draw_label("label", &face.label, label_at, room, canvas);
    let well = half - rim;
    let inner = half - radius - (size * 0.05).min(1.0);
    for (component, axis) in pad.axes.iter().enumerate() {
        let Some(steps) = axis.steps.filter(|steps| *steps <= MAX_TICKS) else {
            continue;
        };
        for step in 0..=steps {
            let along = inner[component] * (2.0 * f32::from(step) / f32::from(steps) - 1.0);
            let ends = [0.94, 0.99].map(|part| match component {
                0 => Vec2::new(along, half.y * part),
                _ => Vec2::new(-half.x * part, -along),
            });
            canvas.line("tick", ends);
        }
    }
    let [x, y] = pad
        .axes
        .map(|axis| 2.0 * axis.initial.clamp(0.0, 1.0) - 1.0);
    let at = Vec2::new(x, -y) * inner;
    let label_half = label_half(&face.label, room) + size * LABEL_GAP;
    draw_cross(at, well, (label_at, label_half), canvas);
    canvas.circle("metal", at, radius);
    canvas.circle("on-metal", at, radius * 0.5);
    if pad.springs_back {
        draw_spring(at, radius, half, canvas);
    }
}

/// Draws lines through a point to the edges of a well, which leave out the label: its center, and half of its room.
fn draw_cross(at: Vec2, well: Vec2, (label, half): (Vec2, Vec2), canvas: &mut Canvas) {
    for axis in [0, 1] {
        let end = |along: f32| {
            let mut end = at;
            end[axis] = along;
            end
        };
        let mut draw = |from: f32, to: f32| {
            if from < to {
                canvas.line("tick", [from, to].map(end));
            }
        };
        let across = 1 - axis;
        if (at[across] - label[across]).abs() < half[across] {
            draw(-well[axis], label[axis] - half[axis]);
            draw(label[axis] + half[axis], well[axis]);
        } else {
            draw(-well[axis], well[axis]);
        }
    }
}

/// Draws arrows toward the position to which a spring returns the handle, from each side that has room.
fn draw_spring(at: Vec2, radius: f32, half: Vec2, canvas: &mut Canvas) {
    for direction in [Vec2::X, Vec2::NEG_X, Vec2::Y, Vec2::NEG_Y] {
        let tip = at + direction * radius * 1.5;
        if tip.abs().cmpgt(half - radius * 0.35).any() {
            continue;
        }
        let wing = |side: f32| tip + (direction + direction.perp() * side) * radius * 0.35;
        canvas.polyline("icon", &[wing(-1.0), tip, wing(1.0)]);
    }
}
