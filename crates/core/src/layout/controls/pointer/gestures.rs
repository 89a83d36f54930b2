//! Gestures of a pointer: clicks, dwell clicks, scrolling.

use std::time::Duration;

use serde::Deserialize;

use crate::device::KeyAction;
use crate::device::pointer::{
    ClickMethod, DwellSettings, Gesture, MAX_CLICKS, PinchGaps, ScrollSettings,
};
use crate::document::{DocumentError, schema};
use crate::hand::{Dof, Finger, Input};
use crate::layout::builder::LayoutBuilder;
use crate::layout::quantity::{
    DwellTime, FingertipGap, JointAngle, PixelDistance, PixelsPerDetent, PushDistance, metres,
};
use crate::layout::schema::Action;

/// The smallest angle of a flexion gesture, in degrees: it turns off before the joint is straight.
const MIN_FLEXION_DEG: f64 = 5.0;

schema! {
    /// A gesture that is held.
    #[derive(Clone, Copy, Debug, PartialEq, Deserialize)]
    #[serde(rename = "Gesture")]
    pub(super) enum GestureSchema {
        /// The thumb touches this fingertip.
        Pinch(Finger),
        /// A joint is bent beyond an angle, or below a negative angle, until it is 10° back.
        Flexion(Dof, JointAngle),
        /// A trigger or button of the glove is held.
        Input(Input),
    }
}

schema! {
    /// A gesture that clicks.
    #[derive(Clone, Copy, Debug, PartialEq, Deserialize)]
    #[serde(rename = "ClickGesture")]
    enum ClickGestureSchema {
        /// The thumb touches this fingertip.
        Pinch(Finger),
        /// A joint is bent beyond an angle, or below a negative angle, until it is 10° back.
        Flexion(Dof, JointAngle),
        /// A trigger or button of the glove is held.
        Input(Input),
        /// The index fingertip moves forward by this distance, at ten times the distance per second or faster (15 mm: 150 mm/s), until
        /// it is half-way back.
        Push(PushDistance),
    }
}

schema! {
    /// Distances between thumb and fingertip in a pinch.
    #[derive(Clone, Copy, Debug, PartialEq, Deserialize)]
    #[serde(rename = "PinchGaps", deny_unknown_fields)]
    pub(super) struct PinchGapsSchema {
        /// The pinch turns on.
        on: FingertipGap,
        /// The pinch turns off.
        off: FingertipGap,
        /// The cursor freezes.
        near: FingertipGap,
    }
}

schema! {
    /// A gesture and its action.
    #[derive(Debug, Deserialize)]
    #[serde(rename = "Click", deny_unknown_fields)]
    pub(super) struct ClickSchema<'a> {
        /// The gesture.
        gesture: ClickGestureSchema,
        /// Action while the gesture is held.
        #[serde(borrow)]
        action: Action<'a>,
    }
}

schema! {
    /// An action that is tapped where the cursor rests.
    #[derive(Debug, Deserialize)]
    #[serde(rename = "Dwell", deny_unknown_fields)]
    pub(super) struct DwellClickSchema<'a> {
        /// Time that the cursor rests.
        time_ms: DwellTime,
        /// Radius of the circle that it rests in.
        radius_px: PixelDistance,
        /// The action.
        #[serde(borrow)]
        action: Action<'a>,
    }
}

schema! {
    /// Scrolling by motion of the hand.
    #[derive(Clone, Copy, Debug, PartialEq, Deserialize)]
    #[serde(rename = "Scroll", deny_unknown_fields)]
    pub(super) struct ScrollSchema {
        /// Motion scrolls while this gesture is held.
        pub gesture: GestureSchema,
        /// Motion per detent of the wheel. A negative number reverses the direction.
        px_per_detent: PixelsPerDetent,
    }
}

impl GestureSchema {
    /// Returns the checked gesture.
    pub fn check(self) -> Result<Gesture, String> {
        match self {
            Self::Pinch(Finger::Thumb) => {
                Err("the thumb pinches with another finger, name that finger".into())
            }
            Self::Pinch(finger) => Ok(Gesture::Pinch(finger)),
            Self::Flexion(dof, angle) if angle.get().abs() < MIN_FLEXION_DEG => Err(format!(
                "the angle of `Flexion` of `{dof}` must be at least {MIN_FLEXION_DEG}° or at most -{MIN_FLEXION_DEG}°, so that it can turn off"
            )),
            Self::Flexion(dof, angle) => Ok(Gesture::Flexion(dof, angle.get().to_radians() as f32)),
            Self::Input(input @ (Input::StickX | Input::StickY)) => Err(format!(
                "`{input}` moves to both sides; a gesture is a button, or the `trigger`"
            )),
            Self::Input(input) => Ok(Gesture::Input(input)),
        }
    }
}

impl PinchGapsSchema {
    /// Returns the checked gaps in metres.
    pub fn check(self) -> Result<PinchGaps, String> {
        let Self { on, off, near } = self;
        if !(on < off && off < near) {
            return Err(
                "in `pinch_mm`, `on` must be less than `off`, and `off` less than `near`".into(),
            );
        }
        let [on, off, near] = [on, off, near].map(|gap| metres(gap.get()));
        Ok(PinchGaps { on, off, near })
    }
}

impl ScrollSchema {
    /// Returns the checked settings.
    pub fn check(self) -> Result<ScrollSettings, String> {
        let px_per_detent = self.px_per_detent.get() as f32;
        if px_per_detent.abs() < 1.0 {
            return Err("`px_per_detent` must be at least 1 or at most -1".into());
        }
        Ok(ScrollSettings {
            gesture: self.gesture.check()?,
            px_per_detent,
        })
    }
}

impl<'a> DwellClickSchema<'a> {
    /// Returns the checked settings and the action.
    pub fn build(
        &self,
        builder: &mut LayoutBuilder<'a>,
    ) -> Result<(DwellSettings, KeyAction), DocumentError> {
        let settings = DwellSettings {
            duration: Duration::from_secs_f64(self.time_ms.get() * 1e-3),
            radius_px: self.radius_px.get() as f32,
        };
        Ok((settings, builder.action(self.action, None)?))
    }
}

/// Returns the checked clicks. `source` is the position of errors.
pub(super) fn clicks<'a>(
    builder: &mut LayoutBuilder<'a>,
    source: &str,
    clicks: &[ClickSchema<'a>],
) -> Result<Vec<(ClickMethod, KeyAction)>, DocumentError> {
    if clicks.len() > MAX_CLICKS {
        let message = format!("a pointer has at most {MAX_CLICKS} clicks");
        return Err(builder.error(source, message));
    }
    let mut checked = Vec::new();
    for click in clicks {
        let method = click.gesture.check();
        let method = method.map_err(|message| builder.error(source, message))?;
        checked.push((method, builder.action(click.action, None)?));
    }
    Ok(checked)
}

/// Returns the message for two gestures that would be on together: of the same finger, or of the same joint and direction.
pub(super) fn duplicate(
    clicks: &[ClickSchema],
    others: impl Iterator<Item = GestureSchema>,
) -> Option<String> {
    let clicks = clicks.iter().map(|click| click.gesture);
    let gestures: Vec<ClickGestureSchema> = clicks.chain(others.map(Into::into)).collect();
    let (_, gesture) = gestures.iter().enumerate().find(|(index, gesture)| {
        gestures[..*index]
            .iter()
            .any(|other| other.coincides(gesture))
    })?;
    let what = match gesture {
        ClickGestureSchema::Pinch(finger) => {
            format!("two gestures are a pinch of the {finger} finger")
        }
        ClickGestureSchema::Flexion(dof, _) => {
            format!("two gestures bend `{dof}` in the same direction")
        }
        ClickGestureSchema::Input(input) => format!("two gestures are the input `{input}`"),
        ClickGestureSchema::Push(_) => "two clicks are a `Push`".into(),
    };
    Some(format!("{what}: both would be on together"))
}

impl ClickGestureSchema {
    fn check(self) -> Result<ClickMethod, String> {
        Ok(match self {
            Self::Pinch(finger) => ClickMethod::Gesture(GestureSchema::Pinch(finger).check()?),
            Self::Flexion(dof, angle) => {
                ClickMethod::Gesture(GestureSchema::Flexion(dof, angle).check()?)
            }
            Self::Input(input) => ClickMethod::Gesture(GestureSchema::Input(input).check()?),
            Self::Push(distance) => ClickMethod::Push(metres(distance.get())),
        })
    }

    fn coincides(&self, other: &Self) -> bool {
        match (self, other) {
            (Self::Pinch(one), Self::Pinch(other)) => one == other,
            (Self::Flexion(dof, angle), Self::Flexion(other_dof, other_angle)) => {
                dof == other_dof && angle.get().signum() == other_angle.get().signum()
            }
            (Self::Input(one), Self::Input(other)) => one == other,
            (Self::Push(_), Self::Push(_)) => true,
            _ => false,
        }
    }
}

impl From<GestureSchema> for ClickGestureSchema {
    fn from(gesture: GestureSchema) -> Self {
        match gesture {
            GestureSchema::Pinch(finger) => Self::Pinch(finger),
            GestureSchema::Flexion(dof, angle) => Self::Flexion(dof, angle),
            GestureSchema::Input(input) => Self::Input(input),
        }
    }
}
