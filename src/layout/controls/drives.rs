//! What values drive, as written → checked.

use serde::Deserialize;

use crate::device::Axis;
use crate::device::value_output::ValueOutput;
use crate::document::DocumentError;
use crate::layout::builder::Checked;
use crate::layout::ranged::{Clicks, Pixels, Steps};
use crate::layout::schema::Does;
use crate::layout::text::Spanned;
use crate::names::UnknownName;

/// What the value of a control drives, beside being told.
#[derive(Clone, Copy, Debug, PartialEq, Deserialize)]
#[serde(deny_unknown_fields)]
pub enum Drives<'a> {
    /// An axis by its name.
    #[serde(borrow)]
    Axis(Spanned<'a>),
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
    ) -> Result<ValueOutput, DocumentError> {
        Ok(match drives {
            None => ValueOutput::ValueOnly,
            Some(Drives::Axis(name)) => ValueOutput::Axis(self.axis(name)?),
            Some(Drives::ScrollX(clicks)) => ValueOutput::ScrollX(clicks.get() as f32),
            Some(Drives::ScrollY(clicks)) => ValueOutput::ScrollY(clicks.get() as f32),
            Some(Drives::MoveX(pixels)) => ValueOutput::MoveX(pixels.get() as f32),
            Some(Drives::MoveY(pixels)) => ValueOutput::MoveY(pixels.get() as f32),
            Some(Drives::Taps { more, less, steps }) => ValueOutput::Taps {
                increase: self.action(more, None)?,
                decrease: self.action(less, None)?,
                steps: steps.get() as u16,
            },
        })
    }

    /// The axis of that name.
    pub(in crate::layout) fn axis(&self, name: Spanned<'a>) -> Result<Axis, DocumentError> {
        let parsed = name.0.parse();
        parsed.map_err(|error: UnknownName| self.document.error_at(name.0, error))
    }
}
