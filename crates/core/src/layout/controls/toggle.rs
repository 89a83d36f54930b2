//! Toggle switches.

use parry3d::math::Vec2;
use serde::Deserialize;

use super::{ControlModel, Front, Handle, KindSpec};

use crate::device::toggle::{Toggle, ToggleOutput};
use crate::document::{DocumentError, Spanned, schema};
use crate::layout::builder::{FaceSpec, LayoutBuilder};
use crate::layout::model::{ControlKind, Face};
use crate::layout::quantity::Offset;
use crate::layout::render::drawing::{Canvas, Words, draw_label, draw_outline, text_room};
use crate::layout::schema::{Action, Label, OutlineSchema};

/// The kind, for editors.
pub(crate) const KIND: KindSpec = KindSpec {
    table: "Toggle",
    name: "toggle switch",
    words: ["Toggle switch", "Interruptor"],
    new: r#"(name: "Switch", at_mm: AT)"#,
};

schema! {
    /// A toggle switch: each poke turns it on or off.
    #[derive(Debug, Deserialize)]
    #[serde(rename = "Toggle", deny_unknown_fields)]
    pub(in crate::layout) struct ToggleSchema<'a> {
        /// Name.
        #[serde(borrow)]
        name: Spanned<'a>,
        /// Text drawn on it. Default: the name.
        #[serde(default)]
        label: Option<Label>,
        /// Center.
        at_mm: (Offset, Offset),
        /// Outline. Default: as the board.
        #[serde(default)]
        size_mm: Option<OutlineSchema>,
        /// Action that lasts while it is on.
        #[serde(borrow, default)]
        hold: Option<Action<'a>>,
        /// Action that is tapped at each change.
        #[serde(borrow, default)]
        tap: Option<Action<'a>>,
    }
}

impl<'a> ToggleSchema<'a> {
    /// Adds the switch to the current board.
    pub fn build(&self, builder: &mut LayoutBuilder<'a>) -> Result<(), DocumentError> {
        let output = toggle_output(builder, "toggle switch", self.name, self.hold, self.tap)?;
        let spec = FaceSpec {
            size: self.size_mm.unwrap_or(builder.board().size),
            ..builder.face_spec("toggle switch", self.name, &self.label, self.at_mm)
        };
        builder.add_single_face(spec, |target| {
            ControlKind::Toggle(Toggle { target, output })
        })
    }
}

/// Returns the output of a control that is on or off, which is built without one if it is wrong. `kind` names it in messages.
pub(super) fn toggle_output<'a>(
    builder: &mut LayoutBuilder<'a>,
    kind: &str,
    name: Spanned<'a>,
    hold: Option<Action<'a>>,
    tap: Option<Action<'a>>,
) -> Result<ToggleOutput, DocumentError> {
    let output = match (hold, tap) {
        (None, None) => Ok(ToggleOutput::ValueOnly),
        (Some(action), None) => builder.action(action, None).map(ToggleOutput::Hold),
        (None, Some(action)) => builder.action(action, None).map(ToggleOutput::Tap),
        (Some(_), Some(_)) => {
            let message = format!(
                "the {kind} `{}` has both `hold` and `tap`, remove one of them",
                name.text
            );
            Err(builder.error(name.text, message))
        }
    };
    let output = builder.keep_error(output)?;
    Ok(output.unwrap_or(ToggleOutput::ValueOnly))
}

impl ControlModel for Toggle {
    fn handle(&self) -> Handle {
        Handle::Switch
    }

    fn initial_value(&self, _: usize) -> Option<f32> {
        Some(0.0)
    }

    fn value_number(&self, _: usize) -> Option<f32> {
        None
    }

    fn describe(&self, words: &Words) -> Vec<String> {
        vec![format!("switch{}", words.switched(self.output))]
    }

    fn draw(&self, front: &Front, canvas: &mut Canvas) {
        draw_switch(front.face, front.is_on, canvas);
    }
}

/// Draws a switch.
fn draw_switch(face: &Face, is_on: bool, canvas: &mut Canvas) {
    let room = text_room(&face.outline);
    draw_outline("well", &face.outline, 0.0, canvas);
    let height = (room.y * 0.4).min(room.x * 0.45).min(3.4);
    let rocker = Vec2::new(height * 1.9, height);
    let at = Vec2::NEG_Y * (room.y - height - 0.3);
    canvas.rect("metal", at, rocker, height);
    let side = if is_on { 1.0 } else { -1.0 };
    let end = at + Vec2::X * side * (rocker.x - height);
    canvas.circle(if is_on { "lit" } else { "cap" }, end, height * 0.8);
    let top = at.y + height + 0.2;
    let half = Vec2::new(room.x, (room.y - top) / 2.0);
    let center = Vec2::Y * (room.y + top) / 2.0;
    draw_label("label", &face.label, center, half, canvas);
}
