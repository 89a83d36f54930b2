//! Triggers as written → checked.

use serde::Deserialize;

use super::Drives;
use crate::contact::TargetId;
use crate::device::trigger::{self, MAX_TRIGGERS, Measure};
use crate::document::DocumentError;
use crate::hand::{Dof, Finger, Side};
use crate::layout::builder::Checked;
use crate::layout::model::{MAX_TARGETS, metres};
use crate::layout::ranged::{Angle, Gap};
use crate::layout::schema::Does;
use crate::layout::text::Spanned;
use crate::names::UnknownName;

/// Where a pinch goes on and off that does not say it itself, in millimetres: the thresholds of
/// Ultraleap's hand tracking.
const PINCH_MM: (f64, f64) = (25.0, 30.0);

/// A trigger as it stands in the file.
#[derive(Debug, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Trigger<'a> {
    /// What it is called.
    #[serde(borrow)]
    pub name: Spanned<'a>,
    /// Of which hand; else of either.
    #[serde(borrow, default)]
    pub hand: Option<Spanned<'a>>,
    /// What it measures.
    #[serde(borrow)]
    pub when: When<'a>,
    /// What is pressed as long as it is on.
    #[serde(borrow, default)]
    pub does: Option<Does<'a>>,
    /// What its value drives.
    #[serde(borrow, default)]
    pub drives: Option<Drives<'a>>,
}

/// What a trigger measures, where it goes on and off, and where its value is 0 and 1.
#[derive(Debug, Deserialize)]
#[serde(deny_unknown_fields)]
pub enum When<'a> {
    /// An angle of a joint.
    Angle {
        /// Which: the name of a degree of freedom.
        #[serde(borrow)]
        of: Spanned<'a>,
        /// Where it goes on.
        on_deg: Angle,
        /// Where it goes off.
        off_deg: Angle,
        /// Where its value is 0.
        #[serde(default)]
        from_deg: Option<Angle>,
        /// Where its value is 1.
        #[serde(default)]
        full_deg: Option<Angle>,
    },
    /// How far the tip of a finger is from that of the thumb.
    Pinch {
        /// Which finger.
        #[serde(borrow)]
        of: Spanned<'a>,
        /// Where it goes on.
        #[serde(default)]
        on_mm: Option<Gap>,
        /// Where it goes off.
        #[serde(default)]
        off_mm: Option<Gap>,
        /// Where its value is 0.
        #[serde(default)]
        from_mm: Option<Gap>,
        /// Where its value is 1.
        #[serde(default)]
        full_mm: Option<Gap>,
    },
}

/// The numbers of a trigger in one unit of the file.
struct Limits {
    unit: &'static str,
    on: f64,
    off: f64,
    from: Option<f64>,
    full: Option<f64>,
}

impl<'a> Checked<'a> {
    /// Adds a trigger; its target comes after all that are there.
    pub(in crate::layout) fn add_trigger(
        &mut self,
        written: &Trigger<'a>,
    ) -> Result<(), DocumentError> {
        let name = written.name;
        let document = self.document;
        let error = |message: String| document.error_at(name.0, message);
        self.refuse_second(name.0, name)?;
        if self.triggers.len() == MAX_TRIGGERS {
            return Err(error(format!(
                "a layout has at most {MAX_TRIGGERS} triggers"
            )));
        }
        let place = self.scene.len() + self.triggers.len();
        if place >= MAX_TARGETS {
            return Err(error(format!(
                "a layout has at most {MAX_TARGETS} keys and other controls"
            )));
        }
        let (measure, limits) = self.measure(&written.when)?;
        let range = limits.range(name.0).map_err(error)?;
        let into_si = |value: f64| match measure {
            Measure::Angle(_) => value.to_radians() as f32,
            Measure::Pinch(_) => metres(value),
        };
        let side = written.hand.map(|hand| self.side(hand)).transpose()?;
        let action = written
            .does
            .map(|does| self.action(does, None))
            .transpose()?;
        let drive = self.drive(written.drives)?;
        self.names.insert(name.0, ("trigger", name.0));
        self.triggers.push((
            name.0.to_owned(),
            trigger::Trigger {
                target: TargetId(place as u32),
                side,
                measure,
                on: into_si(limits.on),
                off: into_si(limits.off),
                range: range.map(|(from, full)| (into_si(from), into_si(full))),
                action,
                output: drive,
            },
        ));
        Ok(())
    }

    fn measure(&self, when: &When<'a>) -> Result<(Measure, Limits), DocumentError> {
        let millimetres = |gap: Option<Gap>| gap.map(Gap::get);
        Ok(match *when {
            When::Angle {
                of,
                on_deg,
                off_deg,
                from_deg,
                full_deg,
            } => {
                let limits = Limits {
                    unit: "deg",
                    on: on_deg.get(),
                    off: off_deg.get(),
                    from: from_deg.map(Angle::get),
                    full: full_deg.map(Angle::get),
                };
                let dof: Result<Dof, UnknownName> = of.0.parse();
                let dof = dof.map_err(|error| self.document.error_at(of.0, error))?;
                (Measure::Angle(dof), limits)
            }
            When::Pinch {
                of,
                on_mm,
                off_mm,
                from_mm,
                full_mm,
            } => {
                let limits = Limits {
                    unit: "mm",
                    on: millimetres(on_mm).unwrap_or(PINCH_MM.0),
                    off: millimetres(off_mm).unwrap_or(PINCH_MM.1),
                    from: millimetres(from_mm),
                    full: millimetres(full_mm),
                };
                let finger: Result<Finger, UnknownName> = of.0.parse();
                let finger = finger.map_err(|error| self.document.error_at(of.0, error))?;
                if finger == Finger::Thumb {
                    let message = "the thumb pinches with another finger, name that one";
                    return Err(self.document.error_at(of.0, message));
                }
                (Measure::Pinch(finger), limits)
            }
        })
    }

    fn side(&self, hand: Spanned<'a>) -> Result<Side, DocumentError> {
        let side: Result<Side, UnknownName> = hand.0.parse();
        side.map_err(|error| self.document.error_at(hand.0, error))
    }
}

impl Limits {
    /// Where the value is 0 and where it is 1; refuses numbers that do not go together.
    fn range(&self, name: &str) -> Result<Option<(f64, f64)>, String> {
        let Limits { unit, on, off, .. } = *self;
        if on == off {
            return Err(format!(
                "the trigger `{name}` goes on and off at {on}, set on_{unit} and off_{unit} apart"
            ));
        }
        match (self.from, self.full) {
            (None, None) => Ok(None),
            (Some(from), Some(full)) if from != full => Ok(Some((from, full))),
            (Some(from), Some(_)) => Err(format!(
                "the value of the trigger `{name}` is 0 and 1 at {from}, set from_{unit} and full_{unit} apart"
            )),
            _ => Err(format!(
                "the trigger `{name}` has one of from_{unit} and full_{unit}, give it both or none"
            )),
        }
    }
}
