//! Touchscreens and touchpads.

use serde::Deserialize;

use crate::contact::surface::Shape;
use crate::device::touch_surface::{TouchMode, TouchSurface, TouchpadSettings};
use crate::document::{DocumentError, Spanned, schema};
use crate::layout::builder::{FaceSpec, LayoutBuilder};
use crate::layout::model::{Control, ControlKind};
use crate::layout::quantity::{Acceleration, MmPerDetent, Offset, PixelsPerMm};
use crate::layout::schema::{Label, OutlineSchema};

schema! {
    /// A touchscreen or touchpad.
    #[derive(Debug, Deserialize)]
    #[serde(rename = "TouchSurface", deny_unknown_fields)]
    pub(in crate::layout) struct TouchSurfaceSchema<'a> {
        /// Name.
        #[serde(borrow)]
        name: Spanned<'a>,
        /// Text drawn on it. Default: the name.
        #[serde(default)]
        label: Option<Label>,
        /// Center.
        at_mm: (Offset, Offset),
        /// Outline, a `Box`.
        size_mm: OutlineSchema,
        /// Absolute or relative pointing.
        mode: TouchModeSchema,
        /// Touchpad: pointer motion with a slow finger.
        #[serde(default)]
        px_per_mm: Option<PixelsPerMm>,
        /// Touchpad: from 250 mm/s on the pointer moves `1 + acceleration` times as far; below, the factor increases with
        /// the speed.
        #[serde(default)]
        acceleration: Option<Acceleration>,
        /// Touchpad: motion of two fingers per detent of the wheel.
        #[serde(default)]
        mm_per_detent: Option<MmPerDetent>,
        /// Touchpad: the content follows the fingers, instead of the wheel.
        #[serde(default)]
        natural_scrolling: Option<bool>,
    }
}

schema! {
    /// The kind of a touch surface.
    #[derive(Clone, Copy, Debug, PartialEq, Eq, Deserialize)]
    #[serde(rename = "TouchMode")]
    enum TouchModeSchema {
        /// The pointer jumps to the finger.
        Touchscreen,
        /// The pointer moves with the finger.
        Touchpad,
    }
}

impl<'a> TouchSurfaceSchema<'a> {
    /// Adds the surface to the current board.
    pub fn build(&self, builder: &mut LayoutBuilder<'a>) -> Result<(), DocumentError> {
        let Shape::Box(half) = self.size_mm.shape(builder.board().scale) else {
            let message = format!("the touch surface `{}` must be a Box", self.name.text);
            return Err(builder.error(self.name.text, message));
        };
        let mode = match self.mode {
            TouchModeSchema::Touchscreen => {
                self.reject_touchpad_fields(builder)?;
                TouchMode::Touchscreen(half)
            }
            TouchModeSchema::Touchpad => TouchMode::Touchpad(self.touchpad_settings()),
        };
        let face = builder.add_face(FaceSpec {
            size: self.size_mm,
            ..builder.face_spec("touch surface", self.name, &self.label, self.at_mm)
        })?;
        let surface = TouchSurface {
            target: face.target,
            mode,
        };
        builder.add_control(Control {
            faces: vec![face],
            kind: ControlKind::TouchSurface(surface),
        });
        Ok(())
    }

    fn reject_touchpad_fields(&self, builder: &LayoutBuilder<'a>) -> Result<(), DocumentError> {
        let fields = [
            ("px_per_mm", self.px_per_mm.is_some()),
            ("acceleration", self.acceleration.is_some()),
            ("mm_per_detent", self.mm_per_detent.is_some()),
            ("natural_scrolling", self.natural_scrolling.is_some()),
        ];
        let Some((field, _)) = fields.iter().find(|(_, is_present)| *is_present) else {
            return Ok(());
        };
        let name = self.name.text;
        let message = format!(
            "the touch surface `{name}` is a Touchscreen, remove `{field}`, which is for a Touchpad"
        );
        Err(builder.error(name, message))
    }

    fn touchpad_settings(&self) -> TouchpadSettings {
        let per_m = |per_mm: f64| (per_mm * 1e3) as f32;
        TouchpadSettings {
            px_per_m: per_m(self.px_per_mm.unwrap_or_default().get()),
            acceleration: self.acceleration.unwrap_or_default().get() as f32,
            detents_per_m: per_m(self.mm_per_detent.unwrap_or_default().get().recip()),
            natural_scrolling: self.natural_scrolling.unwrap_or_default(),
        }
    }
}
