//! Triggers: postures, shapes and motions of a hand, and buttons of a glove, with an action or a value.

use std::time::Duration;

use serde::Deserialize;

use super::value_output::{ValueOutputSchema, value_output};
use crate::device::trigger::{HandShape, MAX_TRIGGERS, Measure, SwipeDirection, Trigger};
use crate::document::{DocumentError, Spanned, schema};
use crate::hand::{BodyAngle, Dof, Finger, Input, Side};
use crate::layout::builder::LayoutBuilder;
use crate::layout::quantity::{
    Confidence, CoolDown, FingertipGap, InputValue, JointAngle, Reversals, SwipeDistance,
    TriggerHold, duration, metres,
};
use crate::layout::schema::Action;
use crate::layout::shape::ShapeSchema;
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
        /// Time after it turned off in which it does not turn on; swipes of a hand share it. Default: 0, of a hand shape 300, of a motion 600.
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
            .range(name, measure)
            .map_err(|message| builder.error(name, message))?;
        let to_si = |value: f64| match measure {
            Measure::Angle(_) | Measure::Body(_) => value.to_radians() as f32,
            Measure::Pinch(_) | Measure::Swipe(_) => metres(value),
            Measure::Input(_) | Measure::HandShape(_) | Measure::Shake => value as f32,
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
            hold: self.hold(measure),
            cool_down: self.cool_down(measure),
            range: range.map(|(zero, full)| (to_si(zero), to_si(full))),
            action,
            output,
        };
        if let Some(shape) = &self.shape {
            let shape = shape.build(builder.document())?;
            builder.add_shape(target, shape);
        }
        builder.add_trigger(name, trigger);
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
            Measure::Swipe(_) | Measure::Shake => MOTION_COOL_DOWN_MS,
            _ => 0.0,
        };
        duration(self.cool_down_ms.map_or(default, CoolDown::get))
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
            Self::HandShape {
                name,
                on,
                off,
                zero,
                full,
            } => {
                let thresholds = Thresholds {
                    unit: "",
                    on: on.map_or(CONFIDENCE.0, Confidence::get),
                    off: off.map_or(CONFIDENCE.1, Confidence::get),
                    zero: zero.map(Confidence::get),
                    full: full.map(Confidence::get),
                };
                (Measure::HandShape(name), thresholds)
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
            Self::Input {
                name,
                on,
                off,
                zero,
                full,
            } => {
                let values = [on, off, zero, full].map(|it| it.map(InputValue::get));
                input_thresholds(builder, name, values)?
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
        }
    }

    /// Returns the quantities at value 0 and 1, if the trigger has a value. Rejects thresholds that contradict each other.
    fn range(&self, name: &str, measure: Measure) -> Result<Option<(f64, f64)>, String> {
        let Thresholds { unit, on, off, .. } = *self;
        if on == off {
            return Err(format!(
                "the trigger `{name}` turns on and off at {on}, set different values for on{unit} and off{unit}"
            ));
        }
        // A hand that does nothing would be one of these.
        let needs_more = matches!(
            measure,
            Measure::HandShape(_) | Measure::Swipe(_) | Measure::Shake
        );
        if needs_more && on < off {
            return Err(format!(
                "the trigger `{name}` turns on at {on} and off at {off}, set on{unit} to more than off{unit}"
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
    let [on, off, zero, full] = values;
    let thresholds = Thresholds {
        unit: "",
        on: on.unwrap_or(defaults.0),
        off: off.unwrap_or(defaults.1),
        zero,
        full,
    };
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
    let angle = angle.map_err(|_: UnknownName| UnknownName::new("input", name.text, names()));
    let angle = angle.map_err(|error| builder.error(name.text, error))?;
    Ok((Measure::Body(angle), BODY_DEG))
}

fn parse<T: std::str::FromStr<Err = UnknownName>>(
    builder: &LayoutBuilder,
    name: Spanned,
) -> Result<T, DocumentError> {
    let parsed = name.text.parse();
    parsed.map_err(|error| builder.error(name.text, error))
}
