//! Toggle switches as written → checked.

use serde::Deserialize;

use super::{Control, ControlKind};
use crate::contact::surface::TREMOR_MARGIN;
use crate::device::toggle::{self, ToggleOutput};
use crate::document::DocumentError;
use crate::layout::builder::{Checked, Spot};
use crate::layout::model::metres2;
use crate::layout::ranged::Distance;
use crate::layout::schema::{Board, Does, Outline};
use crate::layout::text::{Label, Spanned};

/// A toggle switch as it stands in the file.
#[derive(Debug, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Toggle<'a> {
    /// What it is called.
    #[serde(borrow)]
    pub name: Spanned<'a>,
    /// What is drawn on it; else its name.
    #[serde(default)]
    pub label: Option<Label>,
    /// Its middle.
    pub at_mm: (Distance, Distance),
    /// Its outline; else as the board says.
    #[serde(default)]
    pub size_mm: Option<Outline>,
    /// What is pressed as long as it is on.
    #[serde(borrow, default)]
    pub holds: Option<Does<'a>>,
    /// What is tapped at each change.
    #[serde(borrow, default)]
    pub taps: Option<Does<'a>>,
}

impl<'a> Checked<'a> {
    /// Adds a toggle switch to the board that is being added.
    pub(in crate::layout) fn add_toggle(
        &mut self,
        board: &Board<'a>,
        written: &Toggle<'a>,
    ) -> Result<(), DocumentError> {
        let name = written.name;
        let output = self.toggle_output("toggle switch", name, written.holds, written.taps)?;
        let front = self.put(
            &board.form,
            Spot {
                what: "toggle switch",
                word: name,
                name: name.0,
                label: Label::or_name(&written.label, name),
                at: metres2(written.at_mm),
                turn: 0.0,
                size: written.size_mm.unwrap_or(board.size_mm),
                travel: board.travel_mm,
                press: board.press_share,
                release: board.release_share,
                margin: TREMOR_MARGIN,
            },
        )?;
        let target = front.target;
        self.controls.push(Control {
            faces: vec![front],
            kind: ControlKind::Toggle(toggle::Toggle { target, output }),
        });
        Ok(())
    }

    /// What goes on with a control of the kind `what` that is on or off.
    pub(super) fn toggle_output(
        &mut self,
        what: &str,
        name: Spanned<'a>,
        holds: Option<Does<'a>>,
        taps: Option<Does<'a>>,
    ) -> Result<ToggleOutput, DocumentError> {
        Ok(match (holds, taps) {
            (None, None) => ToggleOutput::ValueOnly,
            (Some(does), None) => ToggleOutput::Hold(self.action(does, None)?),
            (None, Some(does)) => ToggleOutput::Tap(self.action(does, None)?),
            (Some(_), Some(_)) => {
                let message = format!(
                    "the {what} `{}` has both `holds` and `taps`, leave one of them out",
                    name.0
                );
                return Err(self.document.error_at(name.0, message));
            }
        })
    }
}
