//! The angles of the joints of one arm and hand.

use std::fmt;

use serde::de::{Error, MapAccess, Visitor};
use serde::{Deserialize, Deserializer, Serialize, Serializer};

use super::Dof;

/// The angles of an arm and hand, in radians, some of which may not be known.
///
/// Serialised as a map of the known angles: `{"elbow-flexion":0.5,"wrist-flexion":0.0}`.
// Aligned to vector registers, so that instructions take their operands from memory.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
#[repr(C, align(16))]
pub struct JointAngles {
    radians: [f64; Dof::COUNT],
    known: u32,
}

impl JointAngles {
    /// Returns the angle in radians, or 0 if it is not known.
    pub fn get(&self, dof: Dof) -> f64 {
        self.radians[dof.index()]
    }

    /// Returns all angles in radians, in the order of [`Dof::ALL`]; 0 for those that are not known.
    pub fn radians(&self) -> &[f64; Dof::COUNT] {
        &self.radians
    }

    /// Sets an angle, in radians, and marks it as known.
    pub fn set(&mut self, dof: Dof, radians: f64) {
        self.radians[dof.index()] = radians;
        self.known |= 1 << dof.index();
    }

    /// Makes an angle unknown.
    pub(crate) fn remove(&mut self, dof: Dof) {
        self.radians[dof.index()] = 0.0;
        self.known &= !(1 << dof.index());
    }

    /// Returns `true` if the angle is known.
    pub fn is_known(&self, dof: Dof) -> bool {
        self.known & (1 << dof.index()) != 0
    }

    /// Returns `true` if no angle is known.
    pub fn is_empty(&self) -> bool {
        self.known == 0
    }

    /// Returns `true` if the same angles are known in `other`.
    pub fn has_same_dofs(&self, other: &Self) -> bool {
        self.known == other.known
    }

    /// Returns `true` if no angle that is known in both differs by more than `radians`.
    pub(crate) fn is_within(&self, radians: f64, other: &Self) -> bool {
        let is_near = |a: f64, b: f64| (a - b).abs() <= radians;
        if self.has_same_dofs(other) {
            // Without a branch for each angle. Those that are not known are 0 in both.
            let pairs = self.radians.iter().zip(&other.radians);
            return pairs.fold(true, |is_within, (a, b)| is_within & is_near(*a, *b));
        }
        let mut known = self.known().filter(|(dof, _)| other.is_known(*dof));
        known.all(|(dof, angle)| is_near(angle, other.get(dof)))
    }

    /// Iterates over the known angles, in the order of [`Dof::ALL`].
    pub fn known(&self) -> impl Iterator<Item = (Dof, f64)> + '_ {
        Dof::ALL
            .iter()
            .filter(|dof| self.is_known(**dof))
            .map(|&dof| (dof, self.get(dof)))
    }

    /// Marks the same angles as known as in `other`. The caller sets all of them.
    pub(crate) fn set_known_as(&mut self, other: &Self) {
        self.known = other.known;
    }

    /// Returns the values of all angles for changes in place, in the order of [`Dof::ALL`]. Which angles are known does
    /// not change.
    pub(crate) fn radians_mut(&mut self) -> &mut [f64; Dof::COUNT] {
        &mut self.radians
    }
}

impl Serialize for JointAngles {
    fn serialize<S: Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        serializer.collect_map(self.known())
    }
}

impl<'de> Deserialize<'de> for JointAngles {
    fn deserialize<D: Deserializer<'de>>(deserializer: D) -> Result<Self, D::Error> {
        deserializer.deserialize_map(MapVisitor)
    }
}

struct MapVisitor;

impl<'de> Visitor<'de> for MapVisitor {
    type Value = JointAngles;

    fn expecting(&self, f: &mut fmt::Formatter) -> fmt::Result {
        f.write_str("a map from degrees of freedom to angles in radians")
    }

    fn visit_map<A: MapAccess<'de>>(self, mut map: A) -> Result<JointAngles, A::Error> {
        let mut angles = JointAngles::default();
        while let Some((dof, radians)) = map.next_entry::<Dof, f64>()? {
            if angles.is_known(dof) {
                return Err(A::Error::custom(format_args!("duplicate angle `{dof}`")));
            }
            angles.set(dof, radians);
        }
        Ok(angles)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn known_angles_survive_serialisation() {
        let mut angles = JointAngles::default();
        angles.set(Dof::ElbowFlexion, 0.5);
        angles.set(Dof::WristFlexion, 0.0);
        let json = serde_json::to_string(&angles).unwrap();
        assert_eq!(json, r#"{"elbow-flexion":0.5,"wrist-flexion":0.0}"#);
        assert_eq!(serde_json::from_str::<JointAngles>(&json).unwrap(), angles);
    }

    #[test]
    fn unknown_and_duplicate_angles_are_rejected() {
        let error = |json| {
            serde_json::from_str::<JointAngles>(json)
                .unwrap_err()
                .to_string()
        };
        assert!(error(r#"{"elbow-flexon":0.5}"#).contains("did you mean `elbow-flexion`?"));
        assert!(error(r#"{"elbow-flexion":0,"elbow-flexion":1}"#).contains("duplicate angle"));
    }
}
