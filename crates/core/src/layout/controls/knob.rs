//! Knobs, and the dials of knobs and valves.

use serde::Deserialize;

use super::value_output::{ValueOutputSchema, kept_output};
use crate::contact::TargetId;
use crate::contact::surface::DRAG_MARGIN;
use crate::device::knob::{self, Knob};
use crate::device::value_output::ValueOutput;
use crate::document::{DocumentError, Spanned, schema};
use crate::layout::builder::{FaceSpec, LayoutBuilder};
use crate::layout::model::{Control, ControlKind};
use crate::layout::quantity::{Fraction, KnobRange, Offset, Size, Steps};
use crate::layout::schema::{Label, OutlineSchema};

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
        /// Initial value. Default: 0.
        #[serde(default)]
        initial: Option<Fraction>,
        /// Output of the value, per turn if it is endless.
        #[serde(borrow, default)]
        output: Option<ValueOutputSchema<'a>>,
    }
}

/// The dial of a knob or valve.
pub(super) struct DialSpec<'s, 'a> {
    /// For messages.
    pub kind: &'static str,
    pub name: Spanned<'a>,
    pub label: &'s Option<Label>,
    pub at_mm: (Offset, Offset),
    pub diameter_mm: Size,
}

impl<'a> KnobSchema<'a> {
    /// Adds the knob to the current board.
    pub fn build(&self, builder: &mut LayoutBuilder<'a>) -> Result<(), DocumentError> {
        let output = kept_output(builder, self.output)?;
        let range = match self.endless {
            true => {
                self.reject_range(builder, output)?;
                knob::KnobRange::Endless
            }
            false => {
                let degrees = self.range_deg.unwrap_or_default().get();
                knob::KnobRange::Limited(degrees.to_radians() as f32)
            }
        };
        let dial = DialSpec {
            kind: "knob",
            name: self.name,
            label: &self.label,
            at_mm: self.at_mm,
            diameter_mm: self.diameter_mm,
        };
        add_dial(builder, dial, |target, radius| Knob {
            target,
            radius,
            range,
            steps: self.steps.map(|steps| steps.get() as u16),
            initial: self.initial.map_or(0.0, |initial| initial.get() as f32),
            output,
        })
    }

    /// Rejects settings of an endless knob that need a range.
    fn reject_range(
        &self,
        builder: &LayoutBuilder<'a>,
        output: ValueOutput,
    ) -> Result<(), DocumentError> {
        let name = self.name.text;
        let what = match (output, self.range_deg, self.initial) {
            (ValueOutput::Axis(_), ..) => "output an axis, which has ends",
            (_, Some(_), _) => "have a `range_deg`",
            (_, _, Some(_)) => "have an `initial` value: it counts turns from 0",
            _ => return Ok(()),
        };
        let message = format!("the knob `{name}` is endless and cannot {what}");
        Err(builder.error(name, message))
    }
}

/// Adds a dial to the current board, and the knob, which gets the radius in metres.
pub(super) fn add_dial<'a>(
    builder: &mut LayoutBuilder<'a>,
    dial: DialSpec<'_, 'a>,
    knob: impl FnOnce(TargetId, f32) -> Knob,
) -> Result<(), DocumentError> {
    let radius = builder.board().metres(dial.diameter_mm.get()) / 2.0;
    let face = builder.add_face(FaceSpec {
        size: OutlineSchema::Disc(dial.diameter_mm),
        margin: DRAG_MARGIN,
        ..builder.face_spec(dial.kind, dial.name, dial.label, dial.at_mm)
    })?;
    let target = face.target;
    builder.add_control(Control {
        faces: vec![face],
        kind: ControlKind::Knob(knob(target, radius)),
    });
    Ok(())
}
