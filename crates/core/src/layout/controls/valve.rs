//! Valves.

use std::f64::consts::TAU;

use serde::Deserialize;

use super::KindSpec;
use super::knob::{DialSpec, add_dial};
use super::value_output::{ValueOutputSchema, kept_output};
use crate::device::knob::KnobRange;
use crate::document::{DocumentError, Spanned, ranged_numbers, schema};
use crate::layout::builder::LayoutBuilder;
use crate::layout::quantity::{Fraction, Offset, Size, Steps, Turns};
use crate::layout::schema::Label;

/// The kind, for editors.
pub(crate) const KIND: KindSpec = KindSpec {
    table: "Valve",
    name: "valve",
    words: ["Valve", "Válvula"],
    new: r#"(name: "Valve", at_mm: AT, diameter_mm: 60)"#,
};

ranged_numbers! {
    /// Rotation of a valve per rotation of a hand that pinches it, as a factor.
    TwistGain = "a twist gain", 0.1 ..= 20.0, "", or 1.0;
}

schema! {
    /// A valve: a knob with several turns between its ends. With a spring it is a steering wheel.
    #[derive(Debug, Deserialize)]
    #[serde(rename = "Valve", deny_unknown_fields)]
    pub(in crate::layout) struct ValveSchema<'a> {
        /// Name.
        #[serde(borrow)]
        name: Spanned<'a>,
        /// Text drawn on it. Default: the name.
        #[serde(default)]
        label: Option<Label>,
        /// Center.
        at_mm: (Offset, Offset),
        /// Diameter of the wheel.
        diameter_mm: Size,
        /// Full turns between the ends.
        #[serde(default)]
        turns: Turns,
        /// Number of steps. Default: continuous.
        #[serde(default)]
        steps: Option<Steps>,
        /// Initial value, and rest position of the spring. Default: 0.
        #[serde(default)]
        initial: Option<Fraction>,
        /// The wheel returns to `initial` when it is released.
        #[serde(default)]
        springs_back: bool,
        /// Rotation of the wheel per rotation of a hand that pinches it.
        #[serde(default)]
        twist_gain: TwistGain,
        /// Output of the value.
        #[serde(borrow, default)]
        output: Option<ValueOutputSchema<'a>>,
    }
}

impl<'a> ValveSchema<'a> {
    /// Adds the valve to the current board.
    pub fn build(&self, builder: &mut LayoutBuilder<'a>) -> Result<(), DocumentError> {
        let output = kept_output(builder, self.output)?;
        let dial = DialSpec {
            kind: "valve",
            name: self.name,
            label: &self.label,
            at_mm: self.at_mm,
            diameter_mm: self.diameter_mm,
            range: KnobRange::Limited((self.turns.get() * TAU) as f32),
            steps: self.steps,
            initial: self.initial,
            springs_back: self.springs_back,
            twist_gain: self.twist_gain.get() as f32,
            output,
        };
        add_dial(builder, dial)
    }
}
