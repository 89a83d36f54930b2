//! Sliders, and the tracks of sliders and levers.

use serde::Deserialize;

use super::value_output::{ValueOutputSchema, kept_output};
use crate::contact::TargetId;
use crate::contact::surface::DRAG_MARGIN;
use crate::device::slider::{GrabMode, Slider, Track};
use crate::document::{DocumentError, Spanned, schema};
use crate::layout::builder::{FaceSpec, LayoutBuilder};
use crate::layout::model::{Control, ControlKind};
use crate::layout::quantity::{Fraction, Offset, Rotation, Size, Steps};
use crate::layout::schema::{Label, OutlineSchema};

schema! {
    /// A slider along a straight track.
    #[derive(Debug, Deserialize)]
    #[serde(rename = "Slider", deny_unknown_fields)]
    pub(in crate::layout) struct SliderSchema<'a> {
        /// Name.
        #[serde(borrow)]
        name: Spanned<'a>,
        /// Text drawn on it. Default: the name.
        #[serde(default)]
        label: Option<Label>,
        /// Center of the track.
        at_mm: (Offset, Offset),
        /// Length of the track; its ends are 0 and 1.
        length_mm: Size,
        /// Width of the track.
        #[serde(default)]
        width_mm: Size,
        /// Direction of the track, counter-clockwise: 0 points to the right, 90 away from you.
        #[serde(default)]
        rotation_deg: Rotation,
        /// Reaction of the handle to a press.
        #[serde(default)]
        grab: GrabModeSchema,
        /// Number of steps. A hysteresis of a tenth of a step prevents flicker between two steps. Default: continuous.
        #[serde(default)]
        steps: Option<Steps>,
        /// Initial value. Default: 0.
        #[serde(default)]
        initial: Option<Fraction>,
        /// Output of the value. Default: none.
        #[serde(borrow, default)]
        output: Option<ValueOutputSchema<'a>>,
    }
}

schema! {
    /// The reaction of a handle to a press.
    #[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Deserialize)]
    #[serde(rename = "GrabMode")]
    enum GrabModeSchema {
        /// The handle jumps to the finger.
        #[default]
        Absolute,
        /// The handle moves as far as the finger.
        Relative,
    }
}

/// The track of a slider or lever.
pub(super) struct TrackSpec<'s, 'a> {
    /// For messages.
    pub kind: &'static str,
    pub name: Spanned<'a>,
    pub label: &'s Option<Label>,
    pub at_mm: (Offset, Offset),
    pub length_mm: Size,
    pub width_mm: Size,
    pub rotation_deg: Rotation,
}

impl<'a> SliderSchema<'a> {
    /// Adds the slider to the current board.
    pub fn build(&self, builder: &mut LayoutBuilder<'a>) -> Result<(), DocumentError> {
        let output = kept_output(builder, self.output)?;
        let half_length = builder.board().metres(self.length_mm.get()) / 2.0;
        let track = TrackSpec {
            kind: "slider",
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
            track: Track::Straight,
            grab: match self.grab {
                GrabModeSchema::Absolute => GrabMode::Absolute,
                GrabModeSchema::Relative => GrabMode::Relative,
            },
            steps: self.steps.map(|steps| steps.get() as u16),
            initial: self.initial.map_or(0.0, |initial| initial.get() as f32),
            springs_back: false,
            output,
        })
    }
}

/// Adds a track to the current board, and the slider or lever on it.
pub(super) fn add_track<'a>(
    builder: &mut LayoutBuilder<'a>,
    track: TrackSpec<'_, 'a>,
    slider: impl FnOnce(TargetId) -> Slider,
) -> Result<(), DocumentError> {
    let face = builder.add_face(FaceSpec {
        rotation: track.rotation_deg.get().to_radians() as f32,
        size: OutlineSchema::Box(track.length_mm, track.width_mm),
        margin: DRAG_MARGIN,
        ..builder.face_spec(track.kind, track.name, track.label, track.at_mm)
    })?;
    let target = face.target;
    builder.add_control(Control {
        faces: vec![face],
        kind: ControlKind::Slider(slider(target)),
    });
    Ok(())
}
