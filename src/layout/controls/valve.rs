//! Valves as written → checked.

use std::f64::consts::TAU;

use serde::Deserialize;

use super::Drives;
use super::knob::RoundSpot;
use crate::device::knob::{Knob, KnobRange};
use crate::document::DocumentError;
use crate::layout::builder::Checked;
use crate::layout::ranged::{Distance, Share, Size, Steps, Turns};
use crate::layout::schema::Board;
use crate::layout::text::{Label, Spanned};

/// A valve as it stands in the file.
#[derive(Debug, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Valve<'a> {
    /// What it is called.
    #[serde(borrow)]
    pub name: Spanned<'a>,
    /// What is drawn on it; else its name.
    #[serde(default)]
    pub label: Option<Label>,
    /// Its middle.
    pub at_mm: (Distance, Distance),
    /// The diameter of its wheel.
    pub diameter_mm: Size,
    /// How many full turns it has between its ends.
    #[serde(default)]
    pub turns: Turns,
    /// Its value is on one of so many steps.
    #[serde(default)]
    pub steps: Option<Steps>,
    /// Where it stands at first; else at the beginning.
    #[serde(default)]
    pub start: Option<Share>,
    /// What its value drives.
    #[serde(borrow, default)]
    pub drives: Option<Drives<'a>>,
}

impl<'a> Checked<'a> {
    /// Adds a valve to the board that is being added.
    pub(in crate::layout) fn add_valve(
        &mut self,
        board: &Board<'a>,
        written: &Valve<'a>,
    ) -> Result<(), DocumentError> {
        let drive = self.drive(written.drives)?;
        let spot = RoundSpot {
            what: "valve",
            name: written.name,
            label: Label::or_name(&written.label, written.name),
            at_mm: written.at_mm,
            diameter_mm: written.diameter_mm,
        };
        self.add_round(board, spot, |target| Knob {
            target,
            radius: board.metres(written.diameter_mm.get()) / 2.0,
            range: KnobRange::Limited((written.turns.get() * TAU) as f32),
            steps: written.steps.map(|steps| steps.get() as u16),
            initial: written.start.map_or(0.0, |start| start.get() as f32),
            output: drive,
        })
    }
}
