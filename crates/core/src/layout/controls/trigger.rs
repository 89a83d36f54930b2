//! Triggers: hand postures, and buttons of a glove, with an action or a value.

use serde::Deserialize;

use super::value_output::{ValueOutputSchema, value_output};
use crate::device::trigger::{MAX_TRIGGERS, Measure, Trigger};
use crate::document::{DocumentError, Spanned, schema};
use crate::hand::{Dof, Finger, Input, Side};
use crate::layout::builder::LayoutBuilder;
use crate::layout::quantity::{FingertipGap, InputValue, JointAngle, metres};
use crate::layout::schema::Action;
use crate::names::UnknownName;

/// Default gaps at which a pinch turns on and off, in millimetres: the thresholds of Ultraleap's hand tracking.
const PINCH_MM: (f64, f64) = (25.0, 30.0);

/// Default values at which an input of the glove turns on and off.
const INPUT: (f64, f64) = (0.5, 0.4);

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
        /// Action while it is on.
        #[serde(borrow, default)]
        action: Option<Action<'a>>,
        /// Output of the value.
        #[serde(borrow, default)]
        output: Option<ValueOutputSchema<'a>>,
    }
}

schema! {
    /// The quantity that a trigger measures, the thresholds, and the range of its value.
    #[derive(Debug, Deserialize)]
    #[serde(rename = "Measure", deny_unknown_fields)]
    enum MeasureSchema<'a> {
        /// A joint angle.
        Angle {
            /// Name of the degree of freedom, such as `wrist-flexion`.
            #[serde(borrow)]
            dof: Spanned<'a>,
            /// Angle at which it turns on.
            on_deg: JointAngle,
            /// Angle at which it turns off; above `on_deg` it is on below.
            off_deg: JointAngle,
            /// Quantity at which the value is 0. Without it the value is 1 while the trigger is on.
            #[serde(default)]
            zero_deg: Option<JointAngle>,
            /// Quantity at which the value is 1.
            #[serde(default)]
            full_deg: Option<JointAngle>,
        },
        /// The distance between the fingertips of a finger and the thumb.
        Pinch {
            /// Name of the finger.
            #[serde(borrow)]
            finger: Spanned<'a>,
            /// Distance between the centers of the fingertips at which it turns on. Default: 25.
            #[serde(default)]
            on_mm: Option<FingertipGap>,
            /// Distance at which it turns off. Default: 30.
            #[serde(default)]
            off_mm: Option<FingertipGap>,
            /// Quantity at which the value is 0. Without it the value is 1 while the trigger is on.
            #[serde(default)]
            zero_mm: Option<FingertipGap>,
            /// Quantity at which the value is 1.
            #[serde(default)]
            full_mm: Option<FingertipGap>,
        },
        /// A stick, trigger or button of the glove.
        Input {
            /// `stick-x`, `stick-y`, `stick-button`, `trigger`, `trigger-button`, `button-a`, `button-b`, `grab`, `pinch`,
            /// `menu` or `calibrate` of a glove that has them.
            #[serde(borrow)]
            name: Spanned<'a>,
            /// Value at which it turns on: a button is 0 or 1, a stick -1 to 1. Default: 0.5.
            #[serde(default)]
            on: Option<InputValue>,
            /// Value at which it turns off. Default: 0.4.
            #[serde(default)]
            off: Option<InputValue>,
            /// Quantity at which the value is 0. Without it the value is 1 while the trigger is on.
            #[serde(default)]
            zero: Option<InputValue>,
            /// Quantity at which the value is 1.
            #[serde(default)]
            full: Option<InputValue>,
        },
    }
}

/// The numbers of a trigger in the unit of the file.
struct Thresholds {
    /// The end of the names of their fields.
    unit: &'static str,
    on: f64,
    off: f64,
    zero: Option<f64>,
    full: Option<f64>,
}

impl<'a> TriggerSchema<'a> {
    /// Adds the trigger.
    pub fn build(&self, builder: &mut LayoutBuilder<'a>) -> Result<(), DocumentError> {
        let name = self.name.text;
        let target = builder.add_target("trigger", name, name)?;
        if builder.trigger_count() == MAX_TRIGGERS {
            let message = format!("a layout has at most {MAX_TRIGGERS} triggers");
            return Err(builder.error(name, message));
        }
        let (measure, thresholds) = self.when.check(builder)?;
        let range = thresholds
            .range(name)
            .map_err(|message| builder.error(name, message))?;
        let to_si = |value: f64| match measure {
            Measure::Angle(_) => value.to_radians() as f32,
            Measure::Pinch(_) => metres(value),
            Measure::Input(_) => value as f32,
        };
        let side = self
            .hand
            .map(|hand| parse::<Side>(builder, hand))
            .transpose()?;
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
            range: range.map(|(zero, full)| (to_si(zero), to_si(full))),
            action,
            output,
        };
        builder.add_trigger(name, trigger);
        Ok(())
    }
}

impl MeasureSchema<'_> {
    fn check(&self, builder: &LayoutBuilder) -> Result<(Measure, Thresholds), DocumentError> {
        let millimetres = |gap: Option<FingertipGap>| gap.map(FingertipGap::get);
        Ok(match *self {
            Self::Angle {
                dof,
                on_deg,
                off_deg,
                zero_deg,
                full_deg,
            } => {
                let thresholds = Thresholds {
                    unit: "_deg",
                    on: on_deg.get(),
                    off: off_deg.get(),
                    zero: zero_deg.map(JointAngle::get),
                    full: full_deg.map(JointAngle::get),
                };
                (Measure::Angle(parse::<Dof>(builder, dof)?), thresholds)
            }
            Self::Pinch {
                finger,
                on_mm,
                off_mm,
                zero_mm,
                full_mm,
            } => {
                let thresholds = Thresholds {
                    unit: "_mm",
                    on: millimetres(on_mm).unwrap_or(PINCH_MM.0),
                    off: millimetres(off_mm).unwrap_or(PINCH_MM.1),
                    zero: millimetres(zero_mm),
                    full: millimetres(full_mm),
                };
                let source = finger.text;
                let finger = parse::<Finger>(builder, finger)?;
                if finger == Finger::Thumb {
                    let message = "the thumb pinches with another finger, name that finger";
                    return Err(builder.error(source, message));
                }
                (Measure::Pinch(finger), thresholds)
            }
            Self::Input {
                name,
                on,
                off,
                zero,
                full,
            } => {
                let value = |value: Option<InputValue>| value.map(InputValue::get);
                let thresholds = Thresholds {
                    unit: "",
                    on: value(on).unwrap_or(INPUT.0),
                    off: value(off).unwrap_or(INPUT.1),
                    zero: value(zero),
                    full: value(full),
                };
                (Measure::Input(parse::<Input>(builder, name)?), thresholds)
            }
        })
    }
}

impl Thresholds {
    /// Returns the quantities at value 0 and 1, if the trigger has a value. Rejects thresholds that contradict each other.
    fn range(&self, name: &str) -> Result<Option<(f64, f64)>, String> {
        let Thresholds { unit, on, off, .. } = *self;
        if on == off {
            return Err(format!(
                "the trigger `{name}` turns on and off at {on}, set different values for on{unit} and off{unit}"
            ));
        }
        match (self.zero, self.full) {
            (None, None) => Ok(None),
            (Some(zero), Some(full)) if zero != full => Ok(Some((zero, full))),
            (Some(zero), Some(_)) => Err(format!(
                "the value of the trigger `{name}` is 0 and 1 at {zero}, set different values for zero{unit} and full{unit}"
            )),
            _ => Err(format!(
                "the trigger `{name}` has only one of zero{unit} and full{unit}, set both or none"
            )),
        }
    }
}

fn parse<T: std::str::FromStr<Err = UnknownName>>(
    builder: &LayoutBuilder,
    name: Spanned,
) -> Result<T, DocumentError> {
    let parsed = name.text.parse();
    parsed.map_err(|error| builder.error(name.text, error))
}
