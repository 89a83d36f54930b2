//! Levers as written → checked.

use serde::Deserialize;

use super::Drives;
use super::slider::TrackSpot;
use crate::device::slider::{GrabMode, Slider, Track};
use crate::device::value_output::ValueOutput;
use crate::document::DocumentError;
use crate::layout::builder::Checked;
use crate::layout::ranged::{Distance, Share, Size, Steps, Throw, Turn};
use crate::layout::schema::Board;
use crate::layout::text::{Label, Spanned};

/// A lever as it stands in the file.
#[derive(Debug, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Lever<'a> {
    /// What it is called.
    #[serde(borrow)]
    pub name: Spanned<'a>,
    /// What is drawn on it; else its name.
    #[serde(default)]
    pub label: Option<Label>,
    /// Where its hinge is: the middle of the way of its handle.
    pub at_mm: (Distance, Distance),
    /// How far its handle goes from one end to the other.
    pub length_mm: Size,
    /// The width of its handle's way.
    #[serde(default)]
    pub width_mm: Size,
    /// How far that lies turned, counter-clockwise: 0 runs to the right, 90 away from the wearer.
    #[serde(default)]
    pub turn_deg: Turn,
    /// How far it turns about its hinge from one end to the other.
    #[serde(default)]
    pub throw_deg: Throw,
    /// It catches in one of so many notches beside the first.
    #[serde(default)]
    pub notches: Option<Steps>,
    /// Where it stands at first, and where it springs back to; else upright.
    #[serde(default)]
    pub rest: Option<Share>,
    /// Whether it springs back when it is let go of.
    #[serde(default)]
    pub springs: bool,
    /// What its value drives.
    #[serde(borrow, default)]
    pub drives: Option<Drives<'a>>,
}

impl<'a> Checked<'a> {
    /// Adds a lever to the board that is being added.
    pub(in crate::layout) fn add_lever(
        &mut self,
        board: &Board<'a>,
        written: &Lever<'a>,
    ) -> Result<(), DocumentError> {
        let drive = self.drive(written.drives)?;
        let notches = written.notches.map(|notches| notches.get() as u16);
        let rest = written.rest.map_or(0.5, |rest| rest.get() as f32);
        if written.springs {
            self.refuse_spring(written.name, rest, notches, drive)?;
        }
        let spot = TrackSpot {
            what: "lever",
            name: written.name,
            label: Label::or_name(&written.label, written.name),
            at_mm: written.at_mm,
            length_mm: written.length_mm,
            width_mm: written.width_mm,
            turn_deg: written.turn_deg,
        };
        self.add_track(board, spot, |target| Slider {
            target,
            half_length: board.metres(written.length_mm.get()) / 2.0,
            track: Track::Hinged(written.throw_deg.get().to_radians() as f32),
            grab: GrabMode::Relative,
            steps: notches,
            initial: rest,
            springs_back: written.springs,
            output: drive,
        })
    }

    /// A spring brings an axis back to 0, so that is where the lever has to rest.
    fn refuse_spring(
        &self,
        name: Spanned<'a>,
        rest: f32,
        notches: Option<u16>,
        drive: ValueOutput,
    ) -> Result<(), DocumentError> {
        let refuse = |message: String| Err(self.document.error_at(name.0, message));
        if let Some(notches) = notches {
            let notch = rest * f32::from(notches);
            if (notch - notch.round()).abs() > 1e-3 {
                return refuse(format!(
                    "the lever `{}` springs back to {rest}, where none of its {notches} notches is",
                    name.0
                ));
            }
        }
        let ValueOutput::Axis(axis) = drive else {
            return Ok(());
        };
        let at_zero = if axis.is_trigger() { 0.0 } else { 0.5 };
        if rest == at_zero {
            return Ok(());
        }
        refuse(format!(
            "the lever `{}` springs back to {rest}, where the axis `{axis}` is not at 0, give it `rest: {at_zero}`",
            name.0
        ))
    }
}
