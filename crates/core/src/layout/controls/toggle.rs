//! Toggle switches.

use serde::Deserialize;

use crate::device::toggle::{Toggle, ToggleOutput};
use crate::document::{DocumentError, Spanned, schema};
use crate::layout::builder::{FaceSpec, LayoutBuilder};
use crate::layout::model::{Control, ControlKind};
use crate::layout::quantity::Offset;
use crate::layout::schema::{Action, Label, OutlineSchema};

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
        let face = builder.add_face(FaceSpec {
            size: self.size_mm.unwrap_or(builder.board().size),
            ..builder.face_spec("toggle switch", self.name, &self.label, self.at_mm)
        })?;
        let toggle = Toggle {
            target: face.target,
            output,
        };
        builder.add_control(Control {
            faces: vec![face],
            kind: ControlKind::Toggle(toggle),
        });
        Ok(())
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
