//! Sliders as written → checked.

use serde::Deserialize;

use super::{Control, ControlKind, Drives};
use crate::contact::TargetId;
use crate::contact::surface::DRAG_MARGIN;
use crate::device::slider::{self, Track};
use crate::document::DocumentError;
use crate::layout::builder::{Checked, Spot};
use crate::layout::model::metres2;
use crate::layout::ranged::{Distance, Share, Size, Steps, Turn};
use crate::layout::schema::{Board, Outline};
use crate::layout::text::{Label, Spanned};

/// A slider as it stands in the file.
#[derive(Debug, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Slider<'a> {
    /// What it is called.
    #[serde(borrow)]
    pub name: Spanned<'a>,
    /// What is drawn on it; else its name.
    #[serde(default)]
    pub label: Option<Label>,
    /// The middle of its track.
    pub at_mm: (Distance, Distance),
    /// The length of its track.
    pub length_mm: Size,
    /// The width of its track.
    #[serde(default)]
    pub width_mm: Size,
    /// How far the track lies turned, counter-clockwise: 0 runs to the right, 90 away from the wearer.
    #[serde(default)]
    pub turn_deg: Turn,
    /// What a press does to the handle.
    #[serde(default)]
    pub grab: Grab,
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

/// What a press does to the handle.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Deserialize)]
pub enum Grab {
    /// It comes to the fingertip.
    #[default]
    Anywhere,
    /// It stays where it is.
    Relative,
}

/// The track of a slider or lever on its board.
pub(super) struct TrackSpot<'a> {
    pub(super) what: &'static str,
    pub(super) name: Spanned<'a>,
    pub(super) label: String,
    pub(super) at_mm: (Distance, Distance),
    pub(super) length_mm: Size,
    pub(super) width_mm: Size,
    pub(super) turn_deg: Turn,
}

impl<'a> Checked<'a> {
    /// Adds a slider to the board that is being added.
    pub(in crate::layout) fn add_slider(
        &mut self,
        board: &Board<'a>,
        written: &Slider<'a>,
    ) -> Result<(), DocumentError> {
        let drive = self.drive(written.drives)?;
        let spot = TrackSpot {
            what: "slider",
            name: written.name,
            label: Label::or_name(&written.label, written.name),
            at_mm: written.at_mm,
            length_mm: written.length_mm,
            width_mm: written.width_mm,
            turn_deg: written.turn_deg,
        };
        self.add_track(board, spot, |target| slider::Slider {
            target,
            half_length: board.metres(written.length_mm.get()) / 2.0,
            track: Track::Straight,
            grab: match written.grab {
                Grab::Anywhere => slider::GrabMode::Absolute,
                Grab::Relative => slider::GrabMode::Relative,
            },
            steps: written.steps.map(|steps| steps.get() as u16),
            initial: written.start.map_or(0.0, |start| start.get() as f32),
            springs_back: false,
            output: drive,
        })
    }

    /// Puts a track on the board that is being added, and what moves along it.
    pub(super) fn add_track(
        &mut self,
        board: &Board<'a>,
        spot: TrackSpot<'a>,
        slider: impl FnOnce(TargetId) -> slider::Slider,
    ) -> Result<(), DocumentError> {
        let front = self.put(
            &board.form,
            Spot {
                what: spot.what,
                word: spot.name,
                name: spot.name.0,
                label: spot.label,
                at: metres2(spot.at_mm),
                turn: spot.turn_deg.get().to_radians() as f32,
                size: Outline::Box(spot.length_mm, spot.width_mm),
                travel: board.travel_mm,
                press: board.press_share,
                release: board.release_share,
                margin: DRAG_MARGIN,
            },
        )?;
        let target = front.target;
        self.controls.push(Control {
            faces: vec![front],
            kind: ControlKind::Slider(slider(target)),
        });
        Ok(())
    }
}
