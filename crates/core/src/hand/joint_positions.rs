//! The positions of the joints of one arm and hand, as a sensor measures them.

use std::fmt;

use glam::DVec3;
use serde::de::{Error, MapAccess, Visitor};
use serde::{Deserialize, Deserializer, Serialize, Serializer};

use super::Joint;

/// The positions of the joints of an arm and hand in the world, in metres, some of which may not be known.
///
/// Serialised as a map of the known positions: `{"elbow":[0.0,-0.3,0.0],"wrist":[0.0,-0.3,-0.25]}`.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct JointPositions {
    positions: [DVec3; Joint::COUNT],
    known: u32,
}

impl Default for JointPositions {
    fn default() -> Self {
        Self {
            positions: [DVec3::ZERO; Joint::COUNT],
            known: 0,
        }
    }
}

impl JointPositions {
    /// Sets the position of a joint, in metres.
    pub fn set(&mut self, joint: Joint, position: DVec3) {
        self.positions[joint.index()] = position;
        self.known |= 1 << joint.index();
    }

    /// Returns the position of a joint (metres), or `None` if it is not known.
    pub fn get(&self, joint: Joint) -> Option<DVec3> {
        (self.known & (1 << joint.index()) != 0).then(|| self.positions[joint.index()])
    }

    /// Returns whether no position is known.
    pub fn is_empty(&self) -> bool {
        self.known == 0
    }

    /// Iterates over the known joints and their positions (metres), in the order of [`Joint::ALL`].
    pub fn known(&self) -> impl Iterator<Item = (Joint, DVec3)> + '_ {
        Joint::ALL
            .iter()
            .filter_map(|&joint| Some((joint, self.get(joint)?)))
    }
}

impl Serialize for JointPositions {
    fn serialize<S: Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        serializer.collect_map(
            self.known()
                .map(|(joint, position)| (joint, position.to_array())),
        )
    }
}

impl<'de> Deserialize<'de> for JointPositions {
    fn deserialize<D: Deserializer<'de>>(deserializer: D) -> Result<Self, D::Error> {
        deserializer.deserialize_map(MapVisitor)
    }
}

struct MapVisitor;

impl<'de> Visitor<'de> for MapVisitor {
    type Value = JointPositions;

    fn expecting(&self, f: &mut fmt::Formatter) -> fmt::Result {
        f.write_str("a map from joints to positions in metres")
    }

    fn visit_map<A: MapAccess<'de>>(self, mut map: A) -> Result<JointPositions, A::Error> {
        let mut positions = JointPositions::default();
        while let Some((joint, position)) = map.next_entry::<Joint, [f64; 3]>()? {
            if positions.get(joint).is_some() {
                return Err(A::Error::custom(format_args!("duplicate joint `{joint}`")));
            }
            positions.set(joint, DVec3::from_array(position));
        }
        Ok(positions)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn known_positions_survive_serialisation() {
        let mut positions = JointPositions::default();
        positions.set(Joint::Wrist, DVec3::new(0.25, -1.0, 0.0));
        positions.set(Joint::IndexTip, DVec3::ZERO);
        let json = serde_json::to_string(&positions).unwrap();
        assert_eq!(
            json,
            r#"{"wrist":[0.25,-1.0,0.0],"index-finger-tip":[0.0,0.0,0.0]}"#
        );
        let read: JointPositions = serde_json::from_str(&json).unwrap();
        assert_eq!(read, positions);
        assert!(serde_json::from_str::<JointPositions>(r#"{"wirst":[0,0,0]}"#).is_err());
    }
}
