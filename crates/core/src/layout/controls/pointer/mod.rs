//! The arm as a pointer.

mod arm;
mod describe;
mod gestures;
mod modes;

pub(in crate::layout) use describe::describe;

use parry3d::math::Vec2;
use serde::Deserialize;

use self::gestures::{ClickSchema, DwellClickSchema, GestureSchema, PinchGapsSchema, ScrollSchema};
use self::modes::PointingModeSchema;
use super::value_output::{ValueOutputSchema, value_output};
use crate::device::pointer::{ArmAxes, CursorOutput, PointerSettings};
use crate::device::value_output::ValueOutput;
use crate::document::{DocumentError, schema};
use crate::estimate::OneEuroSettings;
use crate::hand::Side;
use crate::layout::builder::LayoutBuilder;
use crate::layout::model::POINTER;
use crate::layout::quantity::{
    Beta, CursorSpeed, Cutoff, Gain, MaxStep, PixelDistance, PrecisionFactor, ScreenSize,
};
use crate::layout::schema::PoseSchema;

/// Default size of the screen, in pixels.
const SCREEN_PX: Vec2 = Vec2::new(1920.0, 1080.0);

/// Default drag threshold, in pixels: 3 mm of the hand if the screen is some 200 mm wide for it.
const DRAG_THRESHOLD_PX: f32 = 30.0;

/// The maximum number of knots of an acceleration curve.
const MAX_KNOTS: usize = 8;

schema! {
    /// The arm as a pointer.
    #[derive(Debug, Deserialize)]
    #[serde(rename = "Pointer", deny_unknown_fields)]
    pub(in crate::layout) struct PointerSchema<'a> {
        /// The hand that points. Default: the first that is seen.
        #[serde(default)]
        hand: Option<Side>,
        /// Relation between the hand and the cursor.
        #[serde(borrow)]
        mode: PointingModeSchema<'a>,
        /// Events that move the cursor. Default: `Absolute`; `Relative` in `Rate`.
        #[serde(default)]
        output: Option<CursorOutputSchema>,
        /// Size of the screen: the full range of the pointer. All pixels refer to it. Default: (1920, 1080).
        #[serde(default)]
        screen_px: Option<(ScreenSize, ScreenSize)>,
        /// Maximum motion per reading; the rest follows with the next reading.
        #[serde(default)]
        max_step_px: MaxStep,
        /// Smoothing of the position; does not apply to `Rate`. Default: `Default`.
        #[serde(default)]
        smoothing: SmoothingSchema,
        /// Motion of the hand before the cursor follows, against tremor.
        #[serde(default)]
        dead_zone_px: PixelDistance,
        /// With `output: Relative`: up to 8 pairs of a speed and the gain at that speed, interpolated linearly.
        #[serde(default)]
        acceleration: Vec<(CursorSpeed, Gain)>,
        /// The cursor is slow while this gesture is held.
        #[serde(default)]
        precision: Option<GestureSchema>,
        /// Gain while `precision` is held.
        #[serde(default)]
        precision_factor: PrecisionFactor,
        /// The cursor moves only while this gesture is held; required by `Arm`.
        #[serde(default)]
        clutch: Option<GestureSchema>,
        /// Distances of a pinch. Default: (on: 25, off: 30, near: 45).
        #[serde(default)]
        pinch_mm: Option<PinchGapsSchema>,
        /// Up to 8 gestures with actions; an action lasts as long as its gesture.
        #[serde(borrow, default)]
        clicks: Vec<ClickSchema<'a>>,
        /// Taps where the cursor rests, once until it leaves the circle.
        #[serde(borrow, default)]
        dwell: Option<DwellClickSchema<'a>>,
        /// Motion of the hand during a click before the cursor follows. Default: 30.
        #[serde(default)]
        drag_threshold_px: Option<PixelDistance>,
        /// Scrolls by motion of the hand while a gesture is held.
        #[serde(default)]
        scroll: Option<ScrollSchema>,
        /// Output of the third axis of `Joint` or `Direct`.
        #[serde(borrow, default)]
        z_output: Option<ValueOutputSchema<'a>>,
    }
}

schema! {
    /// The events that move the cursor.
    #[derive(Clone, Copy, Debug, PartialEq, Eq, Deserialize)]
    #[serde(rename = "CursorOutput")]
    enum CursorOutputSchema {
        /// Positions on the screen.
        Absolute,
        /// Motion in pixels, as a mouse.
        Relative,
        /// No events, for targets in space.
        Off,
    }
}

schema! {
    /// Smoothing of the position of the cursor.
    #[derive(Clone, Copy, Debug, Default, PartialEq, Deserialize)]
    #[serde(rename = "Smoothing", deny_unknown_fields)]
    enum SmoothingSchema {
        /// A 1-Euro filter with default settings, `OneEuro(min_cutoff_hz: 1, beta: 0.01)`.
        #[default]
        Default,
        /// No smoothing.
        Off,
        /// A 1-Euro filter.
        OneEuro {
            /// Cutoff at rest.
            min_cutoff_hz: Cutoff,
            /// Increase of the cutoff with speed, in Hz per px/s, so that motion does not lag.
            beta: Beta,
        },
    }
}

impl<'a> PointerSchema<'a> {
    /// Adds the pointer.
    pub fn build(&self, builder: &mut LayoutBuilder<'a>) -> Result<(), DocumentError> {
        let source = source(builder);
        let target = builder.add_target("target", POINTER, source)?;
        let output = self.output.unwrap_or(match self.mode {
            PointingModeSchema::Rate { .. } => CursorOutputSchema::Relative,
            PointingModeSchema::Arm { .. } => CursorOutputSchema::Off,
            _ => CursorOutputSchema::Absolute,
        });
        if let Some(message) = self.conflict(output) {
            return Err(builder.error(source, message));
        }
        let error = |message: String| builder.error(source, message);
        let gesture = |gesture: GestureSchema| gesture.check().map_err(error);
        let fit = |pose: &PoseSchema| builder.pose_fit(pose, self.hand);
        let mode = self.mode.check(fit).map_err(error)?;
        let precision_gesture = self.precision.map(gesture).transpose()?;
        let clutch = self.clutch.map(gesture).transpose()?;
        let pinch = self.pinch_mm.map(|gaps| gaps.check().map_err(error));
        let scroll = self.scroll.map(|scroll| scroll.check().map_err(error));
        let settings = PointerSettings {
            target,
            side: self.hand,
            mode,
            output: output.into(),
            screen_px: self.screen_px.map_or(SCREEN_PX, |(width, height)| {
                Vec2::new(width.get() as f32, height.get() as f32)
            }),
            max_step_px: self.max_step_px.get() as f32,
            smoothing: self.smoothing.into(),
            dead_zone_px: self.dead_zone_px.get() as f32,
            acceleration: self
                .acceleration
                .iter()
                .map(|(speed, gain)| (speed.get() as f32, gain.get() as f32))
                .collect(),
            precision_factor: self.precision_factor.get() as f32,
            precision_gesture,
            clutch,
            pinch: pinch.transpose()?.unwrap_or_default(),
            scroll: scroll.transpose()?,
            drag_threshold_px: self
                .drag_threshold_px
                .map_or(DRAG_THRESHOLD_PX, |distance| distance.get() as f32),
            clicks: gestures::clicks(builder, source, &self.clicks)?,
            dwell: self
                .dwell
                .as_ref()
                .map(|dwell| dwell.build(builder))
                .transpose()?,
            depth: self.depth(builder)?,
            axes: self.axes(builder)?,
        };
        builder.pointer = Some(settings);
        Ok(())
    }

    /// Returns the message for settings that contradict each other.
    fn conflict(&self, output: CursorOutputSchema) -> Option<String> {
        let gestures = [
            self.clutch,
            self.precision,
            self.scroll.map(|scroll| scroll.gesture),
        ];
        gestures::duplicate(&self.clicks, gestures.into_iter().flatten())
            .or_else(|| self.acceleration_conflict(output))
            .or_else(|| self.z_output_conflict())
            .or_else(|| self.arm_conflict(output))
    }

    fn acceleration_conflict(&self, output: CursorOutputSchema) -> Option<String> {
        let knots = &self.acceleration;
        if !knots.is_empty() && output != CursorOutputSchema::Relative {
            return Some("`acceleration` is for a pointer with `output: Relative`".into());
        }
        if knots.len() > MAX_KNOTS {
            return Some(format!("`acceleration` has at most {MAX_KNOTS} knots"));
        }
        knots
            .windows(2)
            .any(|pair| pair[0].0 >= pair[1].0)
            .then(|| "the speeds of `acceleration` must increase from knot to knot".into())
    }

    fn z_output_conflict(&self) -> Option<String> {
        let has_z = matches!(
            self.mode,
            PointingModeSchema::Direct { .. } | PointingModeSchema::Joint { z: Some(_), .. }
        );
        (self.z_output.is_some() && !has_z)
            .then(|| "`z_output` is for `Direct`, and for `Joint` with a `z`".into())
    }

    fn arm_conflict(&self, output: CursorOutputSchema) -> Option<String> {
        let PointingModeSchema::Arm { axes, .. } = &self.mode else {
            return None;
        };
        if axes.is_empty() {
            return Some("`Arm` has no `axes`".into());
        }
        if self.clutch.is_none() {
            return Some("`Arm` needs a `clutch`: its axes rest until the clutch is held".into());
        }
        let moves_cursor =
            output != CursorOutputSchema::Off || self.scroll.is_some() || self.dwell.is_some();
        moves_cursor.then(|| "`Arm` moves no cursor, remove `output`, `scroll` and `dwell`".into())
    }

    fn axes(&self, builder: &mut LayoutBuilder<'a>) -> Result<ArmAxes, DocumentError> {
        match &self.mode {
            PointingModeSchema::Arm {
                axes,
                dead_zone,
                exponent,
                ..
            } => arm::arm_axes(builder, axes, *dead_zone, *exponent),
            _ => Ok(ArmAxes::default()),
        }
    }

    fn depth(&self, builder: &mut LayoutBuilder<'a>) -> Result<Option<ValueOutput>, DocumentError> {
        match self.z_output {
            None => Ok(None),
            output => value_output(builder, output).map(Some),
        }
    }
}

/// Returns the field name `pointer` in the file, for errors about the pointer as a whole.
fn source<'a>(builder: &LayoutBuilder<'a>) -> &'a str {
    let text = &builder.document.text;
    let is_field = |offset: &usize| {
        text[..*offset]
            .trim_end_matches([' ', '\t'])
            .ends_with(['\n', '(', ','])
    };
    let mut offsets = text.match_indices("pointer:").map(|(offset, _)| offset);
    match offsets.find(is_field) {
        Some(offset) => &text[offset..offset + POINTER.len()],
        None => builder.name.text,
    }
}

impl From<CursorOutputSchema> for CursorOutput {
    fn from(schema: CursorOutputSchema) -> Self {
        match schema {
            CursorOutputSchema::Absolute => Self::Absolute,
            CursorOutputSchema::Relative => Self::Relative,
            CursorOutputSchema::Off => Self::None,
        }
    }
}

impl From<SmoothingSchema> for Option<OneEuroSettings> {
    fn from(schema: SmoothingSchema) -> Self {
        let (min_cutoff_hz, beta) = match schema {
            SmoothingSchema::Off => return None,
            // 0.01 Hz per px/s is 0.1 Hz per mm/s if 1 mm of the hand is 10 px: a lag of 12 ms.
            SmoothingSchema::Default => (1.0, 0.01),
            SmoothingSchema::OneEuro {
                min_cutoff_hz,
                beta,
            } => (min_cutoff_hz.get(), beta.get()),
        };
        Some(OneEuroSettings {
            min_cutoff_hz,
            beta,
            derivative_cutoff_hz: 1.0,
        })
    }
}
