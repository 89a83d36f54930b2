//! Radio groups as written → checked.

use serde::Deserialize;

use super::{Control, ControlKind};
use crate::contact::surface::TREMOR_MARGIN;
use crate::device::radio;
use crate::device::toggle::ToggleOutput;
use crate::document::DocumentError;
use crate::layout::builder::{Checked, Spot};
use crate::layout::model::metres2;
use crate::layout::ranged::Distance;
use crate::layout::schema::{Board, Does, Outline};
use crate::layout::text::{Label, Spanned};
use crate::names::UnknownName;

/// A radio group as it stands in the file.
#[derive(Debug, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Radio<'a> {
    /// What messages call it.
    #[serde(borrow)]
    pub name: Spanned<'a>,
    /// What it can be switched to; at least two.
    #[serde(borrow)]
    pub options: Vec<RadioOption<'a>>,
    /// The option that is on at the start.
    #[serde(borrow, default)]
    pub starts: Option<Spanned<'a>>,
}

/// An option as it stands in the file.
#[derive(Debug, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct RadioOption<'a> {
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
    /// What is tapped when it goes on.
    #[serde(borrow, default)]
    pub taps: Option<Does<'a>>,
}

impl<'a> Checked<'a> {
    /// Adds a radio group to the board that is being added.
    pub(in crate::layout) fn add_radio(
        &mut self,
        board: &Board<'a>,
        written: &Radio<'a>,
    ) -> Result<(), DocumentError> {
        if written.options.len() < 2 {
            let message = format!(
                "the radio group `{}` needs at least two options to switch between",
                written.name.0
            );
            return Err(self.document.error_at(written.name.0, message));
        }
        let (mut fronts, mut options) = (Vec::new(), Vec::new());
        for option in &written.options {
            let name = option.name;
            let output = self.toggle_output("radio option", name, option.holds, option.taps)?;
            let front = self.put(
                &board.form,
                Spot {
                    what: "radio option",
                    word: name,
                    name: name.0,
                    label: Label::or_name(&option.label, name),
                    at: metres2(option.at_mm),
                    turn: 0.0,
                    size: option.size_mm.unwrap_or(board.size_mm),
                    travel: board.travel_mm,
                    press: board.press_share,
                    release: board.release_share,
                    margin: TREMOR_MARGIN,
                },
            )?;
            let target = front.target;
            options.push(radio::RadioOption { target, output });
            fronts.push(front);
        }
        let starts = written
            .starts
            .map(|name| self.start_of(written, name, &options))
            .transpose()?;
        self.controls.push(Control {
            faces: fronts,
            kind: ControlKind::Radio(radio::Radio {
                options,
                initial: starts,
            }),
        });
        Ok(())
    }

    /// The place of the option that is on at the start: one that holds nothing, as no finger has
    /// pressed it yet.
    fn start_of(
        &self,
        written: &Radio<'a>,
        name: Spanned<'a>,
        options: &[radio::RadioOption],
    ) -> Result<usize, DocumentError> {
        let names = || written.options.iter().map(|option| option.name.0);
        let Some(place) = names().position(|other| other == name.0) else {
            let error = UnknownName::new("option", name.0, names());
            return Err(self.document.error_at(name.0, error));
        };
        if let ToggleOutput::Hold(_) = options[place].output {
            let message = format!(
                "the radio option `{}` cannot be on at the start: what it holds is pressed by a finger only",
                name.0
            );
            return Err(self.document.error_at(name.0, message));
        }
        Ok(place)
    }
}
