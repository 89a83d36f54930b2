//! Touch surfaces as written → checked.

use serde::Deserialize;

use super::{Control, ControlKind};
use crate::contact::surface::{Shape, TREMOR_MARGIN};
use crate::device::touch_surface::{self, TouchMode, TouchpadSettings};
use crate::document::DocumentError;
use crate::layout::builder::{Checked, Spot};
use crate::layout::model::metres2;
use crate::layout::placement;
use crate::layout::ranged::{Acceleration, Distance, ScrollWay, Speed};
use crate::layout::schema::{Board, Outline};
use crate::layout::text::{Label, Spanned};

/// A touch surface as it stands in the file.
#[derive(Debug, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct TouchSurface<'a> {
    /// What it is called.
    #[serde(borrow)]
    pub name: Spanned<'a>,
    /// What is drawn on it; else its name.
    #[serde(default)]
    pub label: Option<Label>,
    /// Its middle.
    pub at_mm: (Distance, Distance),
    /// Its outline, a box.
    pub size_mm: Outline,
    /// What touching it does.
    pub mode: Mode,
    /// Pad: how fast the pointer goes.
    #[serde(default)]
    pub px_per_mm: Option<Speed>,
    /// Pad: how much faster it goes with a quick finger.
    #[serde(default)]
    pub acceleration: Option<Acceleration>,
    /// Pad: how far two fingers go for a click of the wheel.
    #[serde(default)]
    pub scroll_mm: Option<ScrollWay>,
    /// Pad: whether the page goes along with the fingers.
    #[serde(default)]
    pub natural: Option<bool>,
}

/// What touching a surface does.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Deserialize)]
pub enum Mode {
    /// The pointer goes to where the finger is.
    Screen,
    /// The pointer goes the way that the finger goes.
    Pad,
}

impl<'a> Checked<'a> {
    /// Adds a touch surface to the board that is being added.
    pub(in crate::layout) fn add_touch_surface(
        &mut self,
        board: &Board<'a>,
        written: &TouchSurface<'a>,
    ) -> Result<(), DocumentError> {
        let name = written.name;
        let Shape::Box(half) = placement::shape(written.size_mm, board.place.scale.get() as f32)
        else {
            let message = format!("the touch surface `{}` must be a Box", name.0);
            return Err(self.document.error_at(name.0, message));
        };
        let mode = match written.mode {
            Mode::Screen => {
                self.refuse_pad_fields(written)?;
                TouchMode::Touchscreen(half)
            }
            Mode::Pad => TouchMode::Touchpad(pad(written)),
        };
        let front = self.put(
            &board.form,
            Spot {
                what: "touch surface",
                word: name,
                name: name.0,
                label: Label::or_name(&written.label, name),
                at: metres2(written.at_mm),
                turn: 0.0,
                size: written.size_mm,
                travel: board.travel_mm,
                press: board.press_share,
                release: board.release_share,
                margin: TREMOR_MARGIN,
            },
        )?;
        let target = front.target;
        self.controls.push(Control {
            faces: vec![front],
            kind: ControlKind::TouchSurface(touch_surface::TouchSurface { target, mode }),
        });
        Ok(())
    }

    fn refuse_pad_fields(&self, written: &TouchSurface<'a>) -> Result<(), DocumentError> {
        let fields = [
            ("px_per_mm", written.px_per_mm.is_some()),
            ("acceleration", written.acceleration.is_some()),
            ("scroll_mm", written.scroll_mm.is_some()),
            ("natural", written.natural.is_some()),
        ];
        let Some((field, _)) = fields.iter().find(|(_, is_there)| *is_there) else {
            return Ok(());
        };
        let name = written.name.0;
        let message =
            format!("the touch surface `{name}` is a Screen, `{field}` is for a Pad, leave it out");
        Err(self.document.error_at(name, message))
    }
}

fn pad(written: &TouchSurface) -> TouchpadSettings {
    let per_metre = |per_millimetre: f64| (per_millimetre * 1e3) as f32;
    TouchpadSettings {
        px_per_m: per_metre(written.px_per_mm.unwrap_or_default().get()),
        acceleration: written.acceleration.unwrap_or_default().get() as f32,
        detents_per_m: per_metre(written.scroll_mm.unwrap_or_default().get().recip()),
        natural_scrolling: written.natural.unwrap_or_default(),
    }
}
