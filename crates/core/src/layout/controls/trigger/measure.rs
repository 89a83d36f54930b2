//! The quantities that triggers measure, and their thresholds.

use serde::Deserialize;

use super::parse;
use crate::device::trigger::{
    CircleDirection, CirclePoint, HandShape, MAX_STEPS, Measure, Steps, SwipeDirection,
};
use crate::document::{DocumentError, Spanned, schema};
use crate::hand::{BodyAngle, Dof, Finger, Input};
use crate::layout::builder::LayoutBuilder;
use crate::layout::quantity::{
    CircleTurns, Confidence, FingertipGap, InputValue, JointAngle, Reversals, StepGap,
    SwipeDistance, duration,
};
use crate::names::UnknownName;

/// Default gaps at which a pinch turns on and off, in millimetres: the thresholds of Ultraleap's hand tracking.
const PINCH_MM: (f64, f64) = (25.0, 30.0);

/// Default values at which an input of the glove turns on and off.
const INPUT: (f64, f64) = (0.5, 0.4);

/// Default angles of the body, in degrees.
const BODY_DEG: (f64, f64) = (15.0, 10.0);

/// Default confidences at which a hand shape turns on and off.
const CONFIDENCE: (f64, f64) = (0.8, 0.5);

/// Default distances at which a swipe turns on and off, in millimetres: hands that type or reach for something are slower than 1 m/s.
const SWIPE_MM: (f64, f64) = (200.0, 50.0);

/// Default reversals at which a shake turns on and off.
const SHAKE: (f64, f64) = (4.0, 1.0);

/// Default turns at which a circle turns on and off: the ends of a circle do not meet exactly.
const CIRCLE: (f64, f64) = (0.8, 0.4);

/// Fractions of the steps of a sequence at which it turns on and off.
const SEQUENCE: (f64, f64) = (1.0, 0.9);

/// Default time from one step of a sequence to the next, in milliseconds.
const WITHIN_MS: f64 = 1000.0;

schema! {
    /// The quantity that a trigger measures, the thresholds, and the range of its value.
    #[derive(Debug, Deserialize)]
    #[serde(rename = "Measure", deny_unknown_fields)]
    pub(super) enum MeasureSchema<'a> {
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
        /// A shape of the hand, in whatever direction it points. Its confidence is 0 to 1, as the finger that fits least has it.
        HandShape {
            /// The shape. An open hand counts within 1 s after a closed one, because a hand at rest is open, too.
            name: HandShape,
            /// Confidence at which it turns on. Default: 0.8.
            #[serde(default)]
            on: Option<Confidence>,
            /// Confidence at which it turns off. Default: 0.5.
            #[serde(default)]
            off: Option<Confidence>,
            /// Quantity at which the value is 0. Without it the value is 1 while the trigger is on.
            #[serde(default)]
            zero: Option<Confidence>,
            /// Quantity at which the value is 1.
            #[serde(default)]
            full: Option<Confidence>,
        },
        /// A fast, straight motion of the palm.
        Swipe {
            /// The direction, as the wearer sees it.
            direction: SwipeDirection,
            /// Distance within 200 ms at which it turns on. Default: 200.
            #[serde(default)]
            on_mm: Option<SwipeDistance>,
            /// Distance within 200 ms at which it turns off. Default: 50.
            #[serde(default)]
            off_mm: Option<SwipeDistance>,
        },
        /// A motion of the palm back and forth, by 100 mm or more to the side, up or ahead.
        Shake {
            /// Reversals within a second at which it turns on. Default: 4.
            #[serde(default)]
            on: Option<Reversals>,
            /// Reversals within a second at which it turns off. Default: 1.
            #[serde(default)]
            off: Option<Reversals>,
        },
        /// A circle that the hand draws in the air, or flat as on a table, within 2.5 s and with a radius of 35 mm or more.
        Circle {
            /// The point that draws: the palm or the tip of the index finger. Default: `"palm"`.
            #[serde(default)]
            point: Option<CirclePoint>,
            /// The direction as the wearer sees it, of a flat circle from above. Default: either.
            #[serde(default)]
            direction: Option<CircleDirection>,
            /// Turns without a stop at which it turns on. Default: 0.8.
            #[serde(default)]
            on: Option<CircleTurns>,
            /// Turns at which it turns off. A hand that stops has 0. Default: 0.4.
            #[serde(default)]
            off: Option<CircleTurns>,
        },
        /// Other triggers, one after the other. It is on while the last one is.
        Sequence {
            /// Names of two to four triggers that stand before it, in their order.
            #[serde(borrow)]
            steps: Vec<Spanned<'a>>,
            /// Longest time from the end of a step to the beginning of the next. Default: 1000.
            #[serde(default)]
            within_ms: Option<StepGap>,
        },
        /// A stick, trigger or button of the glove, or an angle of the head, a foot or a knee.
        Input {
            /// `stick-x`, `stick-y`, `stick-button`, `trigger`, `trigger-button`, `button-a`, `button-b`, `grab`, `pinch`,
            /// `menu` or `calibrate` of a glove that has them; `head-yaw`, `head-pitch`, `head-roll`, `left-foot-pitch`,
            /// `right-foot-pitch`, `left-knee-flexion` or `right-knee-flexion` of body landmarks, in degrees.
            #[serde(borrow)]
            name: Spanned<'a>,
            /// Value at which it turns on: a button is 0 or 1, a stick -1 to 1, an angle in degrees. Default: 0.5 or 15°.
            #[serde(default)]
            on: Option<InputValue>,
            /// Value at which it turns off. Default: 0.4 or 10°.
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
pub(super) struct Thresholds {
    /// The end of the names of their fields.
    unit: &'static str,
    pub(super) on: f64,
    pub(super) off: f64,
    zero: Option<f64>,
    full: Option<f64>,
    /// `true` if only one of `on` and `off` is written, and the default of the other is on the wrong side of it.
    is_reversed: bool,
}

impl MeasureSchema<'_> {
    /// Returns the measurement of the trigger with this name, and its thresholds.
    pub(super) fn check(
        &self,
        name: &str,
        builder: &LayoutBuilder,
    ) -> Result<(Measure, Thresholds), DocumentError> {
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
                    is_reversed: false,
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
                let values = [on_mm, off_mm, zero_mm, full_mm];
                let values = values.map(|it| it.map(FingertipGap::get));
                let source = finger.text;
                let finger = parse::<Finger>(builder, finger)?;
                if finger == Finger::Thumb {
                    let message = "the thumb pinches with another finger, name that finger";
                    return Err(builder.error(source, message));
                }
                let thresholds = Thresholds::with_defaults("_mm", PINCH_MM, values);
                (Measure::Pinch(finger), thresholds)
            }
            Self::HandShape {
                name: shape_name,
                on,
                off,
                zero,
                full,
            } => {
                let values = [on, off, zero, full].map(|it| it.map(Confidence::get));
                let thresholds = Thresholds::with_defaults("", CONFIDENCE, values);
                (Measure::HandShape(shape_name), thresholds)
            }
            Self::Swipe {
                direction,
                on_mm,
                off_mm,
            } => {
                let on = on_mm.map_or(SWIPE_MM.0, SwipeDistance::get);
                let off = off_mm.map_or(SWIPE_MM.1, SwipeDistance::get);
                (Measure::Swipe(direction), Thresholds::new("_mm", on, off))
            }
            Self::Shake { on, off } => {
                let on = on.map_or(SHAKE.0, Reversals::get);
                let off = off.map_or(SHAKE.1, Reversals::get);
                (Measure::Shake, Thresholds::new("", on, off))
            }
            Self::Circle {
                point,
                direction,
                on,
                off,
            } => {
                let on = on.map_or(CIRCLE.0, CircleTurns::get);
                let off = off.map_or(CIRCLE.1, CircleTurns::get);
                let measure = Measure::Circle(point.unwrap_or(CirclePoint::Palm), direction);
                (measure, Thresholds::new("", on, off))
            }
            Self::Sequence {
                ref steps,
                within_ms,
            } => {
                let steps = sequence(builder, name, steps, within_ms)?;
                let (on, off) = SEQUENCE;
                (Measure::Sequence(steps), Thresholds::new("", on, off))
            }
            Self::Input {
                name: input_name,
                on,
                off,
                zero,
                full,
            } => {
                let values = [on, off, zero, full].map(|it| it.map(InputValue::get));
                input_thresholds(builder, input_name, values)?
            }
        })
    }
}

impl Thresholds {
    /// Creates the thresholds of a trigger without a value in between.
    fn new(unit: &'static str, on: f64, off: f64) -> Self {
        Self {
            unit,
            on,
            off,
            zero: None,
            full: None,
            is_reversed: false,
        }
    }

    /// Creates thresholds from the values of a file: at which it turns on and off, and at which the value is 0 and 1.
    fn with_defaults(
        unit: &'static str,
        defaults: (f64, f64),
        [on, off, zero, full]: [Option<f64>; 4],
    ) -> Self {
        let is_written_alone = on.is_some() != off.is_some();
        let (on, off) = (on.unwrap_or(defaults.0), off.unwrap_or(defaults.1));
        Self {
            unit,
            on,
            off,
            zero,
            full,
            is_reversed: is_written_alone && (on < off) != (defaults.0 < defaults.1),
        }
    }

    /// Returns the quantities at value 0 and 1, if the trigger has a value. Rejects thresholds that contradict each other.
    pub(super) fn range(&self, name: &str, measure: Measure) -> Result<Option<(f64, f64)>, String> {
        let Thresholds { unit, on, off, .. } = *self;
        if on == off {
            return Err(format!(
                "the trigger `{name}` turns on and off at {on}, set different values for on{unit} and off{unit}"
            ));
        }
        // A hand that does nothing would be one of these.
        let needs_more = matches!(
            measure,
            Measure::HandShape(_) | Measure::Swipe(_) | Measure::Shake | Measure::Circle(..)
        );
        if needs_more && on < off {
            return Err(format!(
                "the trigger `{name}` turns on at {on} and off at {off}, set on{unit} to more than off{unit}"
            ));
        }
        // It would turn on with the fingers apart, or stay on when a stick is back at its center.
        if self.is_reversed {
            return Err(format!(
                "the trigger `{name}` turns on at {on} and off at {off}, one of which is a default in the wrong order; set both on{unit} and off{unit}"
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

/// Returns the measurement of an input of a glove or of an angle of the body, and its thresholds. `values` are those at which it turns
/// on and off and at which the value is 0 and 1.
fn input_thresholds(
    builder: &LayoutBuilder,
    name: Spanned,
    values: [Option<f64>; 4],
) -> Result<(Measure, Thresholds), DocumentError> {
    let (measure, defaults) = input(builder, name)?;
    let thresholds = Thresholds::with_defaults("", defaults, values);
    let is_beyond = |value: &f64| !(-1.0..=1.0).contains(value);
    if let (Measure::Input(input), Some(value)) =
        (measure, values.into_iter().flatten().find(is_beyond))
    {
        let message = format!("`{input}` is from -1 to 1, so {value} is never reached");
        return Err(builder.error(name.text, message));
    }
    Ok((measure, thresholds))
}

/// Returns the input of a glove or the angle of the body with this name, and the default values at which it turns on and off.
fn input(builder: &LayoutBuilder, name: Spanned) -> Result<(Measure, (f64, f64)), DocumentError> {
    if let Ok(input) = name.text.parse() {
        return Ok((Measure::Input(input), INPUT));
    }
    let names = || Input::NAMES.iter().chain(BodyAngle::NAMES).copied();
    let angle = name.text.parse();
    let angle = angle.map_err(|_: UnknownName| UnknownName::one_of("input", name.text, names()));
    let angle = angle.map_err(|error| builder.error(name.text, error))?;
    Ok((Measure::Body(angle), BODY_DEG))
}

/// Returns the steps of a sequence, which are triggers before it and no sequences themselves.
fn sequence(
    builder: &LayoutBuilder,
    own: &str,
    names: &[Spanned],
    within: Option<StepGap>,
) -> Result<Steps, DocumentError> {
    let mut targets = [None; MAX_STEPS];
    for (index, name) in names.iter().enumerate() {
        let error = |message: String| Err(builder.error(name.text, message));
        let Some(target) = targets.get_mut(index) else {
            return error(format!("a sequence has at most {MAX_STEPS} steps"));
        };
        let others = || builder.triggers.iter();
        let Some((_, step)) = others().find(|(other, _)| other == name.text) else {
            // A trigger that was not added has an error, unless it is the sequence itself.
            let is_trigger = matches!(builder.target(name.text), Ok((_, "trigger")));
            if is_trigger && name.text != own {
                return Err(builder.consequence());
            }
            let others = others().map(|(other, _)| other.as_str());
            let unknown = UnknownName::new("trigger before the sequence", name.text, others);
            return error(unknown.to_string());
        };
        if matches!(step.measure, Measure::Sequence(_)) {
            return error(format!(
                "a sequence has no sequence as a step, write the steps of `{}`",
                name.text
            ));
        }
        *target = Some(step.target);
    }
    match names {
        [_, _, ..] => Ok(Steps {
            targets,
            within: duration(within.map_or(WITHIN_MS, StepGap::get)),
        }),
        _ => Err(builder.error(own, "a sequence has two or more steps, name two triggers")),
    }
}
