//! Touchscreens and touchpads.

use parry3d::math::Vec2;
use serde::Deserialize;

use super::{ControlModel, Front, Handle, KindSpec};
use crate::contact::surface::Shape;
use crate::device::touch_surface::{TouchMode, TouchSurface, TouchpadSettings};
use crate::document::{DocumentError, Spanned, schema};
use crate::layout::builder::{FaceSpec, LayoutBuilder};
use crate::layout::model::{ControlKind, Face};
use crate::layout::quantity::{Acceleration, MmPerDetent, Offset, PixelsPerMm};
use crate::layout::render::drawing::{Canvas, Words, draw_label, draw_outline};
use crate::layout::schema::{Label, OutlineSchema};

/// The kind, for editors.
pub(crate) const KIND: KindSpec = KindSpec {
    table: "TouchSurface",
    name: "touch surface",
    words: ["Touch surface", "Superficie táctil"],
    new: r#"(name: "Touchpad", at_mm: AT, size_mm: Box(80, 50), mode: Touchpad)"#,
};

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
        let spec = FaceSpec {
            size: self.size_mm,
            ..builder.face_spec("touch surface", self.name, &self.label, self.at_mm)
        };
        builder.add_single_face(spec, |target| {
            ControlKind::TouchSurface(TouchSurface { target, mode })
        })
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

impl ControlModel for TouchSurface {
    fn handle(&self) -> Handle {
        Handle::Area
    }

    fn describe(&self, _: &Words) -> Vec<String> {
        let description = match self.mode {
            TouchMode::Touchscreen(_) => "touchscreen: absolute pointer, left button",
            TouchMode::Touchpad(_) => "touchpad: pointer, clicks, drag, wheel",
        };
        vec![description.into()]
    }

    fn draw(&self, front: &Front, canvas: &mut Canvas) {
        draw_surface(self, front.face, canvas);
    }
}

/// Draws a touchscreen or touchpad.
fn draw_surface(surface: &TouchSurface, face: &Face, canvas: &mut Canvas) {
    let half = face.outline.half_extents() * 1e3;
    let size = half.min_element();
    match surface.mode {
        TouchMode::Touchscreen(_) => {
            draw_outline("metal", &face.outline, 0.0, canvas);
            draw_outline("well", &face.outline, (size * 0.08).min(2.5), canvas);
            draw_cursor(half * 0.55, size * 0.14, canvas);
        }
        TouchMode::Touchpad(_) => {
            draw_outline("skirt", &face.outline, 0.0, canvas);
            draw_outline("well", &face.outline, (size * 0.03).min(0.8), canvas);
            draw_finger(Vec2::Y * size * 0.34, size * 0.13, canvas);
        }
    }
    let room = Vec2::new(half.x * 0.8, size * 0.2);
    draw_label("label", &face.label, Vec2::NEG_Y * size * 0.4, room, canvas);
}

/// Draws the arrow of a mouse pointer.
fn draw_cursor(at: Vec2, size: f32, canvas: &mut Canvas) {
    let outline = [
        (0.0, 0.0),
        (0.0, 1.4),
        (0.35, 1.1),
        (0.6, 1.6),
        (0.8, 1.5),
        (0.55, 1.0),
        (1.0, 0.95),
    ];
    let points = outline.map(|(x, y)| at + Vec2::new(x - 0.5, y - 0.8) * size);
    canvas.polygon("cap", &points);
}

/// Draws a fingertip with arrows to both sides and up and down.
fn draw_finger(at: Vec2, size: f32, canvas: &mut Canvas) {
    canvas.circle("icon", at, size * 0.8);
    for direction in [Vec2::X, Vec2::NEG_X, Vec2::Y, Vec2::NEG_Y] {
        let tip = at + direction * size * 1.9;
        canvas.line("icon", [at + direction * size * 1.1, tip]);
        let wings =
            [-1.0, 1.0].map(|side| tip + (direction.perp() * side - direction) * size * 0.4);
        canvas.polyline("icon", &[wings[0], tip, wings[1]]);
    }
}
