//! Joysticks.

use std::f32::consts::FRAC_PI_2;

use parry3d::math::Vec2;
use serde::Deserialize;

use super::value_output::axis;
use super::{ControlModel, Front, Handle, KindSpec};
use crate::contact::surface::DRAG_MARGIN;
use crate::device::joystick::Joystick;
use crate::device::{Axis, KeyAction};
use crate::document::{DocumentError, Spanned, schema};
use crate::layout::builder::{FaceSpec, LayoutBuilder};
use crate::layout::model::{ControlKind, Face, Layout};
use crate::layout::quantity::{
    MaxDeflection, Offset, Size, StickDeadZone, StickExponent, StickSpeed, Travel,
};
use crate::layout::render::drawing::{Canvas, Words, draw_fitted, draw_label, draw_outline};
use crate::layout::schema::{Action, Label, OutlineSchema};

/// The minimum travel of a joystick with a push action, in millimetres. With less, every touch would be a push.
const MIN_PUSH_TRAVEL_MM: f64 = 10.0;

/// The kind, for editors.
pub(crate) const KIND: KindSpec = KindSpec {
    table: "Joystick",
    name: "joystick",
    words: ["Joystick", "Joystick"],
    new: r#"(name: "Joystick", at_mm: AT, diameter_mm: 30, pointer_px_per_s: 800)"#,
};

schema! {
    /// A joystick that springs back to its center.
    #[derive(Debug, Deserialize)]
    #[serde(rename = "Joystick", deny_unknown_fields)]
    pub(in crate::layout) struct JoystickSchema<'a> {
        /// Name.
        #[serde(borrow)]
        name: Spanned<'a>,
        /// Text drawn on it. Default: the name.
        #[serde(default)]
        label: Option<Label>,
        /// Center of the cap.
        at_mm: (Offset, Offset),
        /// Diameter of the cap.
        diameter_mm: Size,
        /// Travel; at least 10 with a `push_action`. Default: as the board.
        #[serde(default)]
        travel_mm: Option<Travel>,
        /// Deflection to each side at which the axes reach ±1.
        #[serde(default)]
        max_deflection_mm: MaxDeflection,
        /// Fraction of the deflection within which the axes are 0.
        #[serde(default)]
        dead_zone: StickDeadZone,
        /// Exponent of the response curve outside the dead zone; above 1 it is finer near the center.
        #[serde(default)]
        exponent: StickExponent,
        /// Axes to the right and away from you: `("LeftX", "LeftY")`.
        #[serde(borrow, default)]
        axes: Option<(Spanned<'a>, Spanned<'a>)>,
        /// Actions while it points in a direction, from 0.5 of the deflection until it is back within 0.4.
        #[serde(borrow, default)]
        direction_keys: Option<DirectionKeys<'a>>,
        /// Action while it is pushed in, from 0.9 of the travel until it is back within 0.7.
        #[serde(borrow, default)]
        push_action: Option<Action<'a>>,
        /// Speed of the pointer at full deflection.
        #[serde(default)]
        pointer_px_per_s: Option<StickSpeed>,
    }
}

schema! {
    /// Actions while a joystick points in a direction.
    #[derive(Clone, Copy, Debug, Deserialize)]
    #[serde(deny_unknown_fields)]
    struct DirectionKeys<'a> {
        /// Away from you.
        #[serde(borrow)]
        up: Action<'a>,
        /// Towards you.
        #[serde(borrow)]
        down: Action<'a>,
        /// To the left.
        #[serde(borrow)]
        left: Action<'a>,
        /// To the right.
        #[serde(borrow)]
        right: Action<'a>,
    }
}

impl<'a> JoystickSchema<'a> {
    /// Adds the joystick to the current board.
    pub fn build(&self, builder: &mut LayoutBuilder<'a>) -> Result<(), DocumentError> {
        let axes = self.axes(builder)?;
        let direction_keys = self.direction_keys(builder)?;
        let push_action = self
            .push_action
            .map(|action| builder.action(action, None))
            .transpose()?;
        let travel = self.travel_mm.unwrap_or(builder.board().travel);
        if let Some(message) = self.conflict(travel) {
            return Err(builder.error(self.name.text, message));
        }
        let max_deflection = builder.board().metres(self.max_deflection_mm.get());
        let spec = FaceSpec {
            size: OutlineSchema::Disc(self.diameter_mm),
            travel,
            margin: max_deflection + DRAG_MARGIN,
            ..builder.face_spec("joystick", self.name, &self.label, self.at_mm)
        };
        builder.add_single_face(spec, |target| {
            ControlKind::Joystick(Joystick {
                target,
                max_deflection,
                dead_zone: self.dead_zone.get() as f32,
                curve: self.exponent.get() as f32,
                axes,
                direction_keys,
                push_action,
                pointer_speed_px_s: self
                    .pointer_px_per_s
                    .map_or(0.0, |speed| speed.get() as f32),
            })
        })
    }

    /// Returns the message for a joystick without any output, or with too short a travel for its push action.
    fn conflict(&self, travel: Travel) -> Option<String> {
        let name = self.name.text;
        let has_push_action = self.push_action.is_some();
        let has_output = self.axes.is_some()
            || self.direction_keys.is_some()
            || self.pointer_px_per_s.is_some()
            || has_push_action;
        if !has_output {
            return Some(format!(
                "the joystick `{name}` has no output, add `axes`, `direction_keys`, `push_action` or `pointer_px_per_s`"
            ));
        }
        (has_push_action && travel.get() < MIN_PUSH_TRAVEL_MM).then(|| {
            format!(
                "the joystick `{name}` has a `push_action` and needs a `travel_mm` of at least {MIN_PUSH_TRAVEL_MM}, not {}: \
                 otherwise every touch is a push",
                travel.get()
            )
        })
    }

    fn axes(&self, builder: &mut LayoutBuilder<'a>) -> Result<Option<[Axis; 2]>, DocumentError> {
        let Some((x, y)) = self.axes else {
            return Ok(None);
        };
        let axes = [axis(builder, x)?, axis(builder, y)?];
        let error = |source: &str, what: &str| {
            let message = format!("the joystick `{}` {what}", self.name.text);
            Err(builder.error(source, message))
        };
        for (source, axis) in [x, y].into_iter().zip(axes) {
            if axis.is_trigger() {
                return error(
                    source.text,
                    "has values on both sides of 0, a trigger does not",
                );
            }
        }
        if axes[0] == axes[1] {
            return error(
                y.text,
                "has the same axis in both directions, name two axes",
            );
        }
        for (source, axis) in [x, y].into_iter().zip(axes) {
            builder.claim_axis(axis, source);
        }
        Ok(Some(axes))
    }

    fn direction_keys(
        &self,
        builder: &mut LayoutBuilder<'a>,
    ) -> Result<Option<[KeyAction; 4]>, DocumentError> {
        let Some(keys) = self.direction_keys else {
            return Ok(None);
        };
        Ok(Some([
            builder.action(keys.up, None)?,
            builder.action(keys.down, None)?,
            builder.action(keys.left, None)?,
            builder.action(keys.right, None)?,
        ]))
    }
}

impl ControlModel for Joystick {
    fn handle(&self) -> Handle {
        Handle::Stick {
            half: self.max_deflection,
        }
    }

    fn describe(&self, words: &Words) -> Vec<String> {
        let deflection = self.max_deflection * 1e3;
        let mut parts = vec![format!("joystick, {deflection:.0} mm to each side")];
        if let Some([x, y]) = self.axes {
            parts.push(format!("axes {x} and {y}"));
        }
        if let Some(keys) = self.direction_keys {
            let keys = keys.map(|key| words.action(key)).join(" ");
            parts.push(format!("up, down, left, right: {keys}"));
        }
        if self.pointer_speed_px_s > 0.0 {
            parts.push(format!("pointer {:.0} px/s", self.pointer_speed_px_s));
        }
        if let Some(action) = self.push_action {
            parts.push(format!("push: {}", words.action(action)));
        }
        vec![parts.join(", ")]
    }

    fn draw(&self, front: &Front, canvas: &mut Canvas) {
        draw_joystick(front.layout, self, front.face, canvas);
    }
}

/// The radius of the cap as a fraction of the outline.
const CAP: f32 = 0.66;

/// Draws a stick in the middle of its gate.
fn draw_joystick(layout: &Layout, joystick: &Joystick, face: &Face, canvas: &mut Canvas) {
    let radius = face.outline.half_extents().x * 1e3;
    draw_outline("well", &face.outline, 0.0, canvas);
    canvas.circle("metal", Vec2::ZERO, radius * CAP);
    canvas.circle("cap", Vec2::ZERO, radius * (CAP - 0.08));
    let labels = joystick
        .direction_keys
        .map(|keys| keys.map(|action| layout.action_label(action).to_owned()));
    // Up, down, left, right, as in the file; on the page y points down.
    let directions = [Vec2::NEG_Y, Vec2::Y, Vec2::NEG_X, Vec2::X];
    for (index, direction) in directions.into_iter().enumerate() {
        let middle = direction * radius * (CAP + 1.0) / 2.0;
        match &labels {
            Some(labels) => {
                let half = Vec2::splat(radius * (1.0 - CAP) * 0.48);
                draw_fitted("label", &labels[index], middle, half, 4.0, canvas);
            }
            None => draw_arrow(middle, direction, radius * 0.1, canvas),
        }
    }
    let half = Vec2::new(CAP * 0.84, CAP * 0.42) * radius;
    draw_label("label", &face.label, Vec2::ZERO, half, canvas);
}

fn draw_arrow(at: Vec2, direction: Vec2, size: f32, canvas: &mut Canvas) {
    let across = Vec2::from_angle(FRAC_PI_2).rotate(direction);
    let tip = at + direction * size * 0.5;
    let wings = [-1.0, 1.0].map(|side| at - direction * size * 0.5 + across * side * size);
    canvas.polyline("icon", &[wings[0], tip, wings[1]]);
}
