//! Persons, from `layouts/persons/*.ron`: the size of the hands, and how a simulated person moves them.

mod lengths;
mod motion;
mod schema;
#[cfg(test)]
mod tests;

pub use motion::{Motion, Scatter, Tremor};
pub use schema::{HandsSchema as HandUse, person_field_tables};

use self::schema::{PersonSchema, ScatterSchema, TremorSchema};
use crate::document::{Document, DocumentError, Format, Pairs, Spanned, Structure, first_error};
use crate::estimate::JointLimits;
use crate::hand::{Dof, Finger, FingerSet, Side};
use crate::kinematics::{ArmModel, ArmModelError, BoneLengths};
use crate::names::UnknownName;

/// A person. The default is the simulated person of a setup that names none.
#[derive(Clone, Debug, PartialEq)]
pub struct Person {
    /// Name for displays; empty if the file has none.
    pub name: String,
    /// The hand that types, or the first of two.
    pub side: Option<Side>,
    /// The lengths of the bones; `None` if the file has no length.
    pub bones: Option<BoneLengths>,
    /// The ranges of the joints.
    pub limits: JointLimits,
    /// The hands in use.
    pub hands: HandUse,
    /// The fingers that press; empty if the layout decides.
    pub fingers: FingerSet,
    /// The fingers that rest half bent.
    pub resting: FingerSet,
    /// The errors and the speed of movements.
    pub motion: Motion,
}

/// The format of person files.
const FORMAT: Format = Format {
    name: "Person",
    remedy: "; `ademan person new NAME` writes a person to start from",
    reread: |text| first_error::<PersonSchema>(text),
    structures: || {
        vec![
            Structure::of::<PersonSchema>("Person"),
            Structure::of::<ScatterSchema>("scatter"),
            Structure::of::<TremorSchema>("tremor"),
        ]
    },
};

impl Default for Person {
    fn default() -> Self {
        Self {
            name: String::new(),
            side: None,
            bones: None,
            limits: JointLimits::human(),
            hands: HandUse::Both,
            fingers: FingerSet::NONE,
            resting: FingerSet::NONE,
            motion: Motion::default(),
        }
    }
}

impl Person {
    /// Parses a document. Values that contradict each other are refused.
    pub fn parse(document: &Document) -> Result<Self, DocumentError> {
        let schema: PersonSchema = document.parse_as(&FORMAT)?;
        let fingers = fingers(document, &schema.fingers)?;
        let resting = fingers_beside(document, &schema.resting, fingers)?;
        Ok(Self {
            bones: lengths::bones(document, &schema)?,
            limits: limits(document, &schema.joint_limits_deg)?,
            motion: motion::motion(document, &schema, fingers)?,
            name: schema.name.map_or(String::new(), |name| name.text.into()),
            side: schema.side,
            hands: schema.hands,
            fingers,
            resting,
        })
    }

    /// Returns the arm of the lengths of this person; `None` if the file has no length.
    pub fn arm(&self, side: Side) -> Option<Result<ArmModel, ArmModelError>> {
        let bones = self.bones.as_ref()?;
        Some(ArmModel::anthropometric(side, bones))
    }
}

/// Returns the fingers of a list, each once.
fn fingers(document: &Document, names: &[Spanned]) -> Result<FingerSet, DocumentError> {
    let mut fingers = FingerSet::NONE;
    for name in names {
        let finger = finger(document, *name)?;
        if fingers.contains(finger) {
            let message = format!("duplicate finger `{finger}`; list it once");
            return Err(document.error_at(name.text, message));
        }
        fingers = fingers.with(finger);
    }
    Ok(fingers)
}

/// Returns the fingers of the list `resting`, which press nothing.
fn fingers_beside(
    document: &Document,
    names: &[Spanned],
    pressing: FingerSet,
) -> Result<FingerSet, DocumentError> {
    for name in names {
        let finger = finger(document, *name)?;
        if pressing.contains(finger) {
            let message =
                format!("`{finger}` rests and presses; remove it from `resting` or from `fingers`");
            return Err(document.error_at(name.text, message));
        }
        if pressing.is_empty() && finger == Finger::Index {
            let message = "`index` rests, and no other finger presses; list the fingers that press in `fingers`";
            return Err(document.error_at(name.text, message));
        }
    }
    fingers(document, names)
}

fn finger(document: &Document, name: Spanned) -> Result<Finger, DocumentError> {
    let finger = name.text.parse();
    finger.map_err(|error: UnknownName| document.error_at(name.text, error))
}

/// Returns the usual ranges of joints, narrowed by the ranges of the file.
fn limits(
    document: &Document,
    ranges: &Pairs<(
        crate::layout::quantity::JointAngle,
        crate::layout::quantity::JointAngle,
    )>,
) -> Result<JointLimits, DocumentError> {
    let human = JointLimits::human();
    let mut limits = human;
    let mut seen: Vec<Dof> = Vec::new();
    for (name, (low, high)) in &ranges.0 {
        let (low, high) = (low.get(), high.get());
        let dof = name.text.parse();
        let dof: Dof = dof.map_err(|error: UnknownName| document.error_at(name.text, error))?;
        if seen.contains(&dof) {
            let message = format!("duplicate joint `{dof}`; write one range for it");
            return Err(document.error_at(name.text, message));
        }
        seen.push(dof);
        if low >= high {
            let message =
                format!("the range of `{dof}` is ({low}, {high}); write the smaller angle first");
            return Err(document.error_at(name.text, message));
        }
        let (lowest, highest) = human.range(dof);
        let (lowest, highest) = (lowest.to_degrees(), highest.to_degrees());
        // Radians do not hold all degrees exactly.
        if low < lowest - 1e-9 || high > highest + 1e-9 {
            let message = format!(
                "the range of `{dof}` is ({low}, {high}), beyond ({lowest:.0}, {highest:.0}), within which a joint angle is accepted; narrow it"
            );
            return Err(document.error_at(name.text, message));
        }
        limits.set_range(dof, low.to_radians(), high.to_radians());
    }
    Ok(limits)
}
