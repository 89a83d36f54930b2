//! Levers.

use serde::Deserialize;

use super::KindSpec;
use super::slider::{TrackSpec, add_track};
use super::value_output::{ValueOutputSchema, kept_output};
use crate::device::slider::{GrabMode, Slider, Track};
use crate::device::value_output::ValueOutput;
use crate::document::{DocumentError, Spanned, schema};
use crate::layout::builder::LayoutBuilder;
use crate::layout::quantity::{Fraction, Offset, Rotation, Size, Steps, Throw};
use crate::layout::schema::Label;

/// The kind, for editors.
pub(crate) const KIND: KindSpec = KindSpec {
    table: "Lever",
    name: "lever",
    words: ["Lever", "Palanca"],
    new: r#"(name: "Lever", at_mm: AT, length_mm: 60, rotation_deg: 90)"#,
};

schema! {
    /// A lever about a hinge at the center of its track.
    #[derive(Debug, Deserialize)]
    #[serde(rename = "Lever", deny_unknown_fields)]
    pub(in crate::layout) struct LeverSchema<'a> {
        /// Name.
        #[serde(borrow)]
        name: Spanned<'a>,
        /// Text drawn on it. Default: the name.
        #[serde(default)]
        label: Option<Label>,
        /// Position of the hinge, the center of the track.
        at_mm: (Offset, Offset),
        /// Distance of the handle from one end to the other.
        length_mm: Size,
        /// Width of the track.
        #[serde(default)]
        width_mm: Size,
        /// Direction of the track, counter-clockwise: 0 points to the right, 90 away from you.
        #[serde(default)]
        rotation_deg: Rotation,
        /// Angle about the hinge from one end to the other.
        #[serde(default)]
        throw_deg: Throw,
        /// Number of detents after the first. Default: continuous.
        #[serde(default)]
        detents: Option<Steps>,
        /// Initial value, and rest position of the spring. Default: 0.5.
        #[serde(default)]
        rest: Option<Fraction>,
        /// The handle returns to `rest` when it is released.
        #[serde(default)]
        springs_back: bool,
        /// Output of the value.
        #[serde(borrow, default)]
        output: Option<ValueOutputSchema<'a>>,
    }
}

impl<'a> LeverSchema<'a> {
    /// Adds the lever to the current board.
    pub fn build(&self, builder: &mut LayoutBuilder<'a>) -> Result<(), DocumentError> {
        let output = kept_output(builder, self.output)?;
        let detents = self.detents.map(|detents| detents.get() as u16);
        let rest = self.rest.map_or(0.5, |rest| rest.get() as f32);
        if self.springs_back
            && let Some(message) = self.rest_conflict(rest, detents, output)
        {
            return Err(builder.error(self.name.text, message));
        }
        let half_length = builder.board().metres(self.length_mm.get()) / 2.0;
        let track = TrackSpec {
            kind: "lever",
            name: self.name,
            label: &self.label,
            at_mm: self.at_mm,
            length_mm: self.length_mm,
            width_mm: self.width_mm,
            rotation_deg: self.rotation_deg,
        };
        add_track(builder, track, |target| Slider {
            target,
            half_length,
            track: Track::Hinged(self.throw_deg.get().to_radians() as f32),
            grab: GrabMode::Relative,
            steps: detents,
            initial: rest,
            springs_back: self.springs_back,
            output,
        })
    }

    /// Returns the message if a spring-loaded lever cannot rest at this value: between detents, or with its axis off 0.
    fn rest_conflict(
        &self,
        rest: f32,
        detents: Option<u16>,
        output: ValueOutput,
    ) -> Option<String> {
        let name = self.name.text;
        if let Some(detents) = detents {
            let detent = rest * f32::from(detents);
            if (detent - detent.round()).abs() > 1e-3 {
                return Some(format!(
                    "the lever `{name}` springs back to {rest}, which is at none of its {detents} detents"
                ));
            }
        }
        let ValueOutput::Axis(axis) = output else {
            return None;
        };
        let at_zero = if axis.is_trigger() { 0.0 } else { 0.5 };
        (rest != at_zero).then(|| {
            format!(
                "the lever `{name}` springs back to {rest}, where the axis `{axis}` is not at 0, set `rest: {at_zero}`"
            )
        })
    }
}
