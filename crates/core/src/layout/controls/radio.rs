//! Radio groups.

use serde::Deserialize;

use super::toggle::toggle_output;
use crate::device::radio::{Radio, RadioOption};
use crate::device::toggle::ToggleOutput;
use crate::document::{DocumentError, Spanned, schema};
use crate::layout::builder::{FaceSpec, LayoutBuilder};
use crate::layout::model::{Control, ControlKind};
use crate::layout::quantity::Offset;
use crate::layout::schema::{Action, Label, OutlineSchema};
use crate::names::UnknownName;

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
        builder.add_control(Control {
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
