//! Outputs of controls with a value.

use serde::Deserialize;

use crate::device::Axis;
use crate::device::value_output::ValueOutput;
use crate::document::{DocumentError, Spanned, schema};
use crate::layout::builder::LayoutBuilder;
use crate::layout::quantity::{FullRangeDetents, FullRangePixels, Steps};
use crate::layout::schema::Action;
use crate::names::UnknownName;

schema! {
    /// The output of a control with a value, in addition to the value itself.
    #[derive(Clone, Copy, Debug, PartialEq, Deserialize)]
    #[serde(rename = "Output", deny_unknown_fields)]
    pub(in crate::layout) enum ValueOutputSchema<'a> {
        /// An axis of a gamepad or 6-DoF device, from -1 to 1; a trigger, throttle or brake from 0 to 1.
        #[serde(borrow)]
        Axis(Spanned<'a>),
        /// Scrolls this number of detents to the right for the full range.
        ScrollX(FullRangeDetents),
        /// Scrolls this number of detents up for the full range.
        ScrollY(FullRangeDetents),
        /// Moves the pointer to the right for the full range.
        MoveX(FullRangePixels),
        /// Moves the pointer up for the full range.
        MoveY(FullRangePixels),
        /// Taps at each step.
        Taps {
            /// Action at each step up.
            #[serde(borrow)]
            increase: Action<'a>,
            /// Action at each step down.
            #[serde(borrow)]
            decrease: Action<'a>,
            /// Steps of the full range.
            steps: Steps,
        },
    }
}

/// As [`value_output`], but a control with a wrong output is built without one, and its error is kept.
pub(super) fn kept_output<'a>(
    builder: &mut LayoutBuilder<'a>,
    output: Option<ValueOutputSchema<'a>>,
) -> Result<ValueOutput, DocumentError> {
    let output = value_output(builder, output);
    let output = builder.keep_error(output)?;
    Ok(output.unwrap_or(ValueOutput::ValueOnly))
}

/// Returns the checked output.
pub(in crate::layout) fn value_output<'a>(
    builder: &mut LayoutBuilder<'a>,
    output: Option<ValueOutputSchema<'a>>,
) -> Result<ValueOutput, DocumentError> {
    let Some(output) = output else {
        return Ok(ValueOutput::ValueOnly);
    };
    Ok(match output {
        ValueOutputSchema::Axis(name) => {
            let axis = axis(builder, name)?;
            builder.claim_axis(axis, name);
            ValueOutput::Axis(axis)
        }
        ValueOutputSchema::ScrollX(detents) => ValueOutput::ScrollX(detents.get() as f32),
        ValueOutputSchema::ScrollY(detents) => ValueOutput::ScrollY(detents.get() as f32),
        ValueOutputSchema::MoveX(pixels) => ValueOutput::MoveX(pixels.get() as f32),
        ValueOutputSchema::MoveY(pixels) => ValueOutput::MoveY(pixels.get() as f32),
        ValueOutputSchema::Taps {
            increase,
            decrease,
            steps,
        } => ValueOutput::Taps {
            increase: builder.action(increase, None)?,
            decrease: builder.action(decrease, None)?,
            steps: steps.get() as u16,
        },
    })
}

/// Rejects a spring-loaded control that cannot rest at the value of a field: between two of its steps, or with its axis off 0.
pub(super) fn check_rest(
    builder: &LayoutBuilder,
    kind: &str,
    name: Spanned,
    (field, rest): (&str, f32),
    steps: Option<(u16, &str)>,
    output: ValueOutput,
) -> Result<(), DocumentError> {
    let control = format!("the {kind} `{}` springs back to {rest}", name.text);
    if let Some((steps, unit)) = steps {
        let step = rest * f32::from(steps);
        if (step - step.round()).abs() > 1e-3 {
            let message = format!("{control}, which is at none of its {steps} {unit}");
            return Err(builder.error(name.text, message));
        }
    }
    let ValueOutput::Axis(axis) = output else {
        return Ok(());
    };
    let at_zero = if axis.is_trigger() { 0.0 } else { 0.5 };
    if rest == at_zero {
        return Ok(());
    }
    let message =
        format!("{control}, where the axis `{axis}` is not at 0, set `{field}: {at_zero}`");
    Err(builder.error(name.text, message))
}

/// Parses the name of an axis.
pub(super) fn axis(builder: &LayoutBuilder, name: Spanned) -> Result<Axis, DocumentError> {
    let axis = name.text.parse();
    axis.map_err(|error: UnknownName| builder.error(name.text, error))
}
