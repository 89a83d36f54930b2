//! Knobs as written → checked.

use serde::Deserialize;

use super::{Control, ControlKind, Drives};
use crate::contact::TargetId;
use crate::contact::surface::DRAG_MARGIN;
use crate::device::knob::{self, KnobRange};
use crate::device::value_output::ValueOutput;
use crate::document::DocumentError;
use crate::layout::builder::{Checked, Spot};
use crate::layout::model::metres2;
use crate::layout::ranged::{Distance, KnobRangeDegrees, Share, Size, Steps};
use crate::layout::schema::{Board, Outline};
use crate::layout::text::{Label, Spanned};

/// A knob as it stands in the file.
#[derive(Debug, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Knob<'a> {
    /// What it is called.
    #[serde(borrow)]
    pub name: Spanned<'a>,
    /// What is drawn on it; else its name.
    #[serde(default)]
    pub label: Option<Label>,
    /// Its middle.
    pub at_mm: (Distance, Distance),
    /// Its diameter.
    pub diameter_mm: Size,
    /// How far it turns between its ends; else by the default.
    #[serde(default)]
    pub range_deg: Option<KnobRangeDegrees>,
    /// Whether it has no ends.
    #[serde(default)]
    pub endless: bool,
    /// Its value is on one of so many steps of the range, or of a turn when it is endless.
    #[serde(default)]
    pub steps: Option<Steps>,
    /// Where it stands at first; else at the beginning.
    #[serde(default)]
    pub start: Option<Share>,
    /// What its value drives.
    #[serde(borrow, default)]
    pub drives: Option<Drives<'a>>,
}

/// The front of a knob or valve on its board.
pub(super) struct RoundSpot<'a> {
    pub(super) what: &'static str,
    pub(super) name: Spanned<'a>,
    pub(super) label: String,
    pub(super) at_mm: (Distance, Distance),
    pub(super) diameter_mm: Size,
}

impl<'a> Checked<'a> {
    /// Adds a knob to the board that is being added.
    pub(in crate::layout) fn add_knob(
        &mut self,
        board: &Board<'a>,
        written: &Knob<'a>,
    ) -> Result<(), DocumentError> {
        let drive = self.drive(written.drives)?;
        if written.endless {
            self.refuse_ends(written, drive)?;
        }
        let range = match written.endless {
            true => KnobRange::Endless,
            false => {
                let degrees = written.range_deg.unwrap_or_default().get();
                KnobRange::Limited(degrees.to_radians() as f32)
            }
        };
        let spot = RoundSpot {
            what: "knob",
            name: written.name,
            label: Label::or_name(&written.label, written.name),
            at_mm: written.at_mm,
            diameter_mm: written.diameter_mm,
        };
        self.add_round(board, spot, |target| knob::Knob {
            target,
            radius: board.metres(written.diameter_mm.get()) / 2.0,
            range,
            steps: written.steps.map(|steps| steps.get() as u16),
            initial: written.start.map_or(0.0, |start| start.get() as f32),
            output: drive,
        })
    }

    /// Refuses what needs ends on a knob that has none.
    fn refuse_ends(&self, written: &Knob<'a>, drive: ValueOutput) -> Result<(), DocumentError> {
        let name = written.name.0;
        let what = match (drive, written.range_deg, written.start) {
            (ValueOutput::Axis(_), ..) => "drive an axis, which has ends",
            (_, Some(_), _) => "have a `range_deg`",
            (_, _, Some(_)) => "have a `start`: it counts its turns from there",
            _ => return Ok(()),
        };
        let message = format!("the knob `{name}` is endless and cannot {what}");
        Err(self.document.error_at(name, message))
    }

    /// Puts the front of a knob on the board that is being added, and the knob itself.
    pub(super) fn add_round(
        &mut self,
        board: &Board<'a>,
        spot: RoundSpot<'a>,
        knob: impl FnOnce(TargetId) -> knob::Knob,
    ) -> Result<(), DocumentError> {
        let front = self.put(
            &board.form,
            Spot {
                what: spot.what,
                word: spot.name,
                name: spot.name.0,
                label: spot.label,
                at: metres2(spot.at_mm),
                turn: 0.0,
                size: Outline::Disc(spot.diameter_mm),
                travel: board.travel_mm,
                press: board.press_share,
                release: board.release_share,
                margin: DRAG_MARGIN,
            },
        )?;
        let target = front.target;
        self.controls.push(Control {
            faces: vec![front],
            kind: ControlKind::Knob(knob(target)),
        });
        Ok(())
    }
}
