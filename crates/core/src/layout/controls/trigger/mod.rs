//! Triggers: postures, shapes and motions of a hand, buttons of a glove, and sequences of them, with an action or a value.

mod measure;

use std::time::Duration;

use serde::Deserialize;

use self::measure::MeasureSchema;
use super::value_output::{ValueOutputSchema, value_output};
use crate::device::trigger::{MAX_TRIGGERS, Measure, Steps, Trigger};
use crate::document::{DocumentError, Spanned, schema};
use crate::hand::{Input, Side};
use crate::layout::builder::LayoutBuilder;
use crate::layout::quantity::{CoolDown, TriggerHold, duration, metres};
use crate::layout::schema::Action;
use crate::layout::shape::ShapeSchema;
use crate::names::UnknownName;

/// Default times for which a hand shape is held and of its cool-down, in milliseconds.
const SHAPE_MS: (f64, f64) = (300.0, 300.0);

/// Default cool-down of a motion, in milliseconds: the hand swings back.
const MOTION_COOL_DOWN_MS: f64 = 600.0;

schema! {
    /// A hand posture with an action or a value.
    #[derive(Debug, Deserialize)]
    #[serde(rename = "Trigger", deny_unknown_fields)]
    pub(in crate::layout) struct TriggerSchema<'a> {
        /// Name.
        #[serde(borrow)]
        name: Spanned<'a>,
        /// `"left"` or `"right"`. Default: either.
        #[serde(borrow, default)]
        hand: Option<Spanned<'a>>,
        /// Button of the glove that has to be held, such as `"button-b"`: without it the trigger is off.
        #[serde(borrow, default)]
        held: Option<Spanned<'a>>,
        /// The quantity that is measured, and its thresholds.
        #[serde(borrow)]
        when: MeasureSchema<'a>,
        /// Time for which it has to last before it turns on. Default: 0, of a hand shape 300.
        #[serde(default)]
        hold_ms: Option<TriggerHold>,
        /// Time after it turned off in which it does not turn on; swipes of a hand share it. Default: 0, of a hand shape 300, of a
        /// motion 600.
        #[serde(default)]
        cool_down_ms: Option<CoolDown>,
        /// Action while it is on.
        #[serde(borrow, default)]
        action: Option<Action<'a>>,
        /// Output of the value.
        #[serde(borrow, default)]
        output: Option<ValueOutputSchema<'a>>,
        /// Mesh that moves with the value in the 3D view.
        #[serde(borrow, default)]
        shape: Option<ShapeSchema<'a>>,
    }
}

impl<'a> TriggerSchema<'a> {
    /// Adds the trigger.
    pub fn build(&self, builder: &mut LayoutBuilder<'a>) -> Result<(), DocumentError> {
        let name = self.name.text;
        let target = builder.add_target("trigger", name, name)?;
        if builder.triggers.len() == MAX_TRIGGERS {
            let message = format!("a layout has at most {MAX_TRIGGERS} triggers");
            return Err(builder.error(name, message));
        }
        let (measure, thresholds) = self.when.check(name, builder)?;
        let range = thresholds
            .range(name, measure)
            .map_err(|message| builder.error(name, message))?;
        let to_si = |value: f64| match measure {
            Measure::Angle(_) | Measure::Body(_) => value.to_radians() as f32,
            Measure::Pinch(_) | Measure::Swipe(_) => metres(value),
            _ => value as f32,
        };
        let side = self
            .hand
            .map(|hand| parse::<Side>(builder, hand))
            .transpose()?;
        if let Measure::Sequence(steps) = measure {
            check_hands(builder, name, side, &steps)?;
        }
        let held = self.held.map(|held| parse::<Input>(builder, held));
        let action = self
            .action
            .map(|action| builder.action(action, None))
            .transpose()?;
        let output = value_output(builder, self.output)?;
        let trigger = Trigger {
            target,
            side,
            held: held.transpose()?,
            measure,
            on: to_si(thresholds.on),
            off: to_si(thresholds.off),
            hold: self.hold(measure),
            cool_down: self.cool_down(measure),
            range: range.map(|(zero, full)| (to_si(zero), to_si(full))),
            action,
            output,
        };
        if let Some(shape) = &self.shape {
            let shape = shape.build(builder.document)?;
            builder.shapes.push((target, shape));
        }
        builder.triggers.push((name.to_owned(), trigger));
        Ok(())
    }

    fn hold(&self, measure: Measure) -> Duration {
        let default = match measure {
            Measure::HandShape(_) => SHAPE_MS.0,
            _ => 0.0,
        };
        duration(self.hold_ms.map_or(default, TriggerHold::get))
    }

    fn cool_down(&self, measure: Measure) -> Duration {
        let default = match measure {
            Measure::HandShape(_) => SHAPE_MS.1,
            Measure::Swipe(_) | Measure::Shake | Measure::Circle(..) => MOTION_COOL_DOWN_MS,
            _ => 0.0,
        };
        duration(self.cool_down_ms.map_or(default, CoolDown::get))
    }
}

/// Rejects a sequence whose steps are for another hand: it would never be complete.
fn check_hands(
    builder: &LayoutBuilder,
    name: &str,
    side: Option<Side>,
    steps: &Steps,
) -> Result<(), DocumentError> {
    let triggers = builder.triggers.iter();
    let mut steps = triggers.filter(|(_, it)| steps.targets.contains(&Some(it.target)));
    let other = steps.find(|(_, it)| it.side.is_some() && it.side != side);
    other.map_or(Ok(()), |(step, it)| {
        let hand = it.side.map_or("", Side::name);
        let message = format!(
            "the step `{step}` is for the {hand} hand alone, set `hand: \"{hand}\"` for the sequence, too"
        );
        Err(builder.error(name, message))
    })
}

fn parse<T: std::str::FromStr<Err = UnknownName>>(
    builder: &LayoutBuilder,
    name: Spanned,
) -> Result<T, DocumentError> {
    let parsed = name.text.parse();
    parsed.map_err(|error| builder.error(name.text, error))
}
