//! The positions of the joints of one arm and hand, as a sensor measures them.

use std::borrow::Cow;
use std::fmt;

use glam::DVec3;
use serde::de::{Error, MapAccess, Visitor};
use serde::ser::SerializeMap;
use serde::{Deserialize, Deserializer, Serialize, Serializer};

use super::Joint;

/// The positions of the joints of an arm and hand in the world, in metres, some of which may not be known.
///
/// Serialised as a map of the known positions: `{"elbow":[0.0,-0.3,0.0],"wrist":[0.0,-0.3,-0.25]}`, with the direction across
/// the wrist as `wrist-axis` and the list of joints that are `predicted`, if there are any.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct JointPositions {
    positions: [DVec3; Joint::COUNT],
    known: u32,
    /// Joints whose position is predicted.
    predicted: u32,
    wrist_axis: Option<DVec3>,
}

impl JointPositions {
    /// Sets the position of a joint, in metres, as a measured one.
    pub fn set(&mut self, joint: Joint, position: DVec3) {
        self.positions[joint.index()] = position;
        self.known |= 1 << joint.index();
        self.predicted &= !(1 << joint.index());
    }

    /// Marks a joint as not measured at this moment: its position continues the motion before it was hidden.
    pub fn set_predicted(&mut self, joint: Joint) {
        self.predicted |= 1 << joint.index();
    }

    /// Returns `true` if the position of a joint is predicted.
    pub fn is_predicted(&self, joint: Joint) -> bool {
        self.predicted & (1 << joint.index()) != 0
    }

    /// Returns the predicted joints as bits, in the order of [`Joint::ALL`].
    pub fn predicted_bits(&self) -> u32 {
        self.predicted
    }

    /// Marks the joints of these bits as predicted.
    pub fn set_predicted_bits(&mut self, bits: u32) {
        self.predicted = bits & ((1 << Joint::COUNT) - 1);
    }

    /// Sets the direction across the wrist, from the side of the little finger to the side of the thumb, of any length. It turns
    /// with the forearm.
    pub fn set_wrist_axis(&mut self, axis: DVec3) {
        self.wrist_axis = Some(axis);
    }

    /// Returns the direction across the wrist, or `None` if it is not known.
    pub fn wrist_axis(&self) -> Option<DVec3> {
        self.wrist_axis
    }

    /// Returns the position of a joint (metres), or `None` if it is not known.
    pub fn get(&self, joint: Joint) -> Option<DVec3> {
        (self.known & (1 << joint.index()) != 0).then(|| self.positions[joint.index()])
    }

    /// Returns `true` if no position is known.
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

/// Key of the direction across the wrist.
const WRIST_AXIS: &str = "wrist-axis";

/// Key of the list of predicted joints.
const PREDICTED: &str = "predicted";

impl Serialize for JointPositions {
    fn serialize<S: Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        let mut map = serializer.serialize_map(None)?;
        for (joint, position) in self.known() {
            map.serialize_entry(&joint, &position.to_array())?;
        }
        if let Some(axis) = self.wrist_axis {
            map.serialize_entry(WRIST_AXIS, &axis.to_array())?;
        }
        if self.predicted != 0 {
            let predicted = Joint::ALL.iter().filter(|joint| self.is_predicted(**joint));
            map.serialize_entry(PREDICTED, &predicted.collect::<Vec<_>>())?;
        }
        map.end()
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
        while let Some(key) = map.next_key::<Cow<'de, str>>()? {
            match &*key {
                WRIST_AXIS => positions.set_wrist_axis(DVec3::from_array(map.next_value()?)),
                PREDICTED => {
                    for joint in map.next_value::<Vec<Joint>>()? {
                        positions.set_predicted(joint);
                    }
                }
                name => {
                    let joint: Joint = name.parse().map_err(A::Error::custom)?;
                    if positions.get(joint).is_some() {
                        return Err(A::Error::custom(format_args!("duplicate joint `{joint}`")));
                    }
                    positions.set(joint, DVec3::from_array(map.next_value()?));
                }
            }
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
        positions.set_wrist_axis(DVec3::new(0.0, 0.0, -1.0));
        positions.set_predicted(Joint::IndexTip);
        let predicted_json = serde_json::to_string(&positions).unwrap();
        assert!(
            predicted_json
                .ends_with(r#""wrist-axis":[0.0,0.0,-1.0],"predicted":["index-finger-tip"]}"#),
            "{predicted_json}"
        );
        assert_eq!(
            serde_json::from_str::<JointPositions>(&predicted_json).unwrap(),
            positions
        );
        assert!(serde_json::from_str::<JointPositions>(r#"{"wirst":[0,0,0]}"#).is_err());
    }
}
