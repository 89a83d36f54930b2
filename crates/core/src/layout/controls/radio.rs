//! Radio groups.

use parry3d::math::Vec2;
use serde::Deserialize;

use super::toggle::toggle_output;
use super::{ControlModel, Front, Handle, KindSpec};
use crate::device::radio::{Radio, RadioOption};
use crate::device::toggle::ToggleOutput;
use crate::document::{DocumentError, Spanned, schema};
use crate::layout::builder::{FaceSpec, LayoutBuilder};
use crate::layout::model::{Control, ControlKind, Face};
use crate::layout::quantity::Offset;
use crate::layout::render::drawing::{Canvas, Words, draw_label, draw_outline, on_page, text_room};
use crate::layout::schema::{Action, Label, OutlineSchema};
use crate::names::UnknownName;

/// The kind, for editors.
pub(crate) const KIND: KindSpec = KindSpec {
    table: "Radio",
    name: "radio group",
    words: ["Radio group", "Grupo de opciones"],
    new: r#"(name: "Choice", options: [(name: "Option 1", at_mm: AT), (name: "Option 2", at_mm: AT_RIGHT)])"#,
};

schema! {
    /// A group of options, of which at most one is on.
    #[derive(Debug, Deserialize)]
    #[serde(rename = "Radio", deny_unknown_fields)]
    pub(in crate::layout) struct RadioSchema<'a> {
        /// Name in messages.
        #[serde(borrow)]
        name: Spanned<'a>,
        /// At least two options.
        #[serde(borrow)]
        options: Vec<RadioOptionSchema<'a>>,
        /// Name of the option that is on at the start; it cannot have a `hold`.
        #[serde(borrow, default)]
        initial: Option<Spanned<'a>>,
    }
}

schema! {
    /// An option of a radio group.
    #[derive(Debug, Deserialize)]
    #[serde(rename = "RadioOption", deny_unknown_fields)]
    struct RadioOptionSchema<'a> {
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
        /// Action that is tapped when it turns on.
        #[serde(borrow, default)]
        tap: Option<Action<'a>>,
    }
}

impl<'a> RadioSchema<'a> {
    /// Adds the group to the current board.
    pub fn build(&self, builder: &mut LayoutBuilder<'a>) -> Result<(), DocumentError> {
        if self.options.len() < 2 {
            let message = format!(
                "the radio group `{}` needs at least two options",
                self.name.text
            );
            return Err(builder.error(self.name.text, message));
        }
        let (mut faces, mut options) = (Vec::new(), Vec::new());
        for option in &self.options {
            let kind = "radio option";
            let output = toggle_output(builder, kind, option.name, option.hold, option.tap)?;
            let face = builder.add_face(FaceSpec {
                size: option.size_mm.unwrap_or(builder.board().size),
                ..builder.face_spec(kind, option.name, &option.label, option.at_mm)
            })?;
            let target = face.target;
            options.push(RadioOption { target, output });
            faces.push(face);
        }
        let initial = self
            .initial
            .map(|name| self.initial_index(builder, name, &options))
            .transpose()?;
        builder.controls.push(Control {
            faces,
            kind: ControlKind::Radio(Radio { options, initial }),
        });
        Ok(())
    }

    /// Returns the index of the option that is on at the start. It cannot hold an action, because only a finger can press.
    fn initial_index(
        &self,
        builder: &LayoutBuilder<'a>,
        name: Spanned<'a>,
        options: &[RadioOption],
    ) -> Result<usize, DocumentError> {
        let name = name.text;
        let names = || self.options.iter().map(|option| option.name.text);
        let Some(index) = names().position(|other| other == name) else {
            return Err(builder.error(name, UnknownName::new("option", name, names())));
        };
        if let ToggleOutput::Hold(_) = options[index].output {
            let message = format!(
                "the radio option `{name}` has a `hold` and cannot be on at the start: only a finger can press"
            );
            return Err(builder.error(name, message));
        }
        Ok(index)
    }
}

impl ControlModel for Radio {
    fn handle(&self) -> Handle {
        Handle::Switch
    }

    fn set_value(&mut self, front: usize, value: f32) {
        self.initial = (value > 0.5).then_some(front);
    }

    fn describe(&self, words: &Words) -> Vec<String> {
        let options = self.options.iter();
        options
            .map(|option| format!("option{}", words.switched(option.output)))
            .collect()
    }

    fn draw_below(&self, faces: &[Face], canvas: &mut Canvas) {
        draw_link(faces, canvas);
    }

    fn draw(&self, front: &Front, canvas: &mut Canvas) {
        draw_option(front.face, self.initial == Some(front.index), canvas);
    }
}

/// Draws an option.
fn draw_option(face: &Face, is_on: bool, canvas: &mut Canvas) {
    let room = text_room(&face.outline);
    draw_outline("well", &face.outline, 0.0, canvas);
    let radius = (room.y * 0.42).min(room.x * 0.4).min(3.4);
    let at = Vec2::NEG_Y * (room.y - radius - 0.3);
    canvas.circle("metal", at, radius);
    canvas.circle("cap", at, radius * 0.78);
    if is_on {
        canvas.circle("lit", at, radius * 0.48);
    }
    let top = at.y + radius + 0.2;
    let half = Vec2::new(room.x, (room.y - top) / 2.0);
    let center = Vec2::Y * (room.y + top) / 2.0;
    draw_label("label", &face.label, center, half, canvas);
}

/// Draws a line through the options of a group, below their fronts.
fn draw_link(faces: &[Face], canvas: &mut Canvas) {
    let centers: Vec<Vec2> = faces
        .iter()
        .map(|face| on_page(face.outline.center))
        .collect();
    canvas.polyline("spoke", &centers);
}
