//! Levers.

use serde::Deserialize;

use super::KindSpec;
use super::value_output::{ValueOutputSchema, check_rest, kept_output};
use crate::contact::surface::DRAG_MARGIN;
use crate::device::slider::{GrabMode, Slider, Track};
use crate::document::{DocumentError, Spanned, schema};
use crate::layout::builder::{FaceSpec, LayoutBuilder};
use crate::layout::model::ControlKind;
use crate::layout::quantity::{Fraction, Offset, Rotation, Size, Steps, Throw};
use crate::layout::schema::{Label, OutlineSchema};

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
        if self.springs_back {
            let steps = detents.map(|detents| (detents, "detents"));
            check_rest(builder, "lever", self.name, ("rest", rest), steps, output)?;
        }
        let half_length = builder.board().metres(self.length_mm.get()) / 2.0;
        let spec = FaceSpec {
            rotation: self.rotation_deg.get().to_radians() as f32,
            size: OutlineSchema::Box(self.length_mm, self.width_mm),
            margin: DRAG_MARGIN,
            ..builder.face_spec("lever", self.name, &self.label, self.at_mm)
        };
        builder.add_single_face(spec, |target| {
            ControlKind::Slider(Slider {
                target,
                half_length,
                track: Track::Hinged(self.throw_deg.get().to_radians() as f32),
                grab: GrabMode::Relative,
                steps: detents,
                initial: rest,
                springs_back: self.springs_back,
                output,
            })
        })
    }
}
