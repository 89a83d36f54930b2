//! What values drive, as written → checked.

use serde::Deserialize;

use crate::device::Axis;
use crate::device::drive::Drive;
use crate::layout::LayoutError;
use crate::layout::check::Checked;
use crate::layout::number::{Clicks, Pixels, Steps};
use crate::layout::text::Word;
use crate::layout::written::Does;
use crate::names::UnknownName;

/// What the value of a control drives, beside being told.
#[derive(Clone, Copy, Debug, PartialEq, Deserialize)]
#[serde(deny_unknown_fields)]
pub enum Drives<'a> {
    /// An axis by its name.
    #[serde(borrow)]
    Axis(Word<'a>),
    /// The wheel, sideways: clicks to the right for the whole range.
    ScrollX(Clicks),
    /// The wheel: clicks up for the whole range.
    ScrollY(Clicks),
    /// The pointer: pixels to the right for the whole range.
    MoveX(Pixels),
    /// The pointer: pixels up for the whole range.
    MoveY(Pixels),
    /// Taps on the way up and down.
    Taps {
        /// At each step up.
        #[serde(borrow)]
        more: Does<'a>,
        /// At each step down.
        #[serde(borrow)]
        less: Does<'a>,
        /// How many steps the whole range has.
        steps: Steps,
    },
}

impl<'a> Checked<'a> {
    /// What a value drives; nothing but itself where nothing is said.
    pub(in crate::layout) fn drive(
        &mut self,
        drives: Option<Drives<'a>>,
    ) -> Result<Drive, LayoutError> {
        Ok(match drives {
            None => Drive::Told,
            Some(Drives::Axis(name)) => Drive::Axis(self.axis(name)?),
            Some(Drives::ScrollX(clicks)) => Drive::ScrollX(clicks.get() as f32),
            Some(Drives::ScrollY(clicks)) => Drive::ScrollY(clicks.get() as f32),
            Some(Drives::MoveX(pixels)) => Drive::MoveX(pixels.get() as f32),
            Some(Drives::MoveY(pixels)) => Drive::MoveY(pixels.get() as f32),
            Some(Drives::Taps { more, less, steps }) => Drive::Taps {
                more: self.action(more, None)?,
                less: self.action(less, None)?,
                steps: steps.get() as u16,
            },
        })
    }

    /// The axis of that name.
    pub(in crate::layout) fn axis(&self, name: Word<'a>) -> Result<Axis, LayoutError> {
        let parsed = name.0.parse();
        parsed.map_err(|error: UnknownName| self.document.error(name.0, error))
    }
}
