//! Rotations of the bones of the arms, as animation programs keep them.

use std::collections::BTreeMap;

use glam::Quat;
use serde::{Deserialize, Serialize};

use super::{Finger, Side};
use crate::names::named_enum;

named_enum! {
    /// A bone of an arm. The number in recordings is the index in this list: new bones come last.
    pub enum ArmBone ("bone") {
        /// The forearm.
        LowerArm = "lower-arm",
        /// The hand.
        Hand = "hand",
        /// The metacarpal of the thumb.
        ThumbFirst = "thumb-1",
        /// The proximal phalanx of the thumb.
        ThumbSecond = "thumb-2",
        /// The distal phalanx of the thumb.
        ThumbThird = "thumb-3",
        /// The proximal phalanx of the index finger.
        IndexFirst = "index-1",
        /// The intermediate phalanx of the index finger.
        IndexSecond = "index-2",
        /// The distal phalanx of the index finger.
        IndexThird = "index-3",
        /// The proximal phalanx of the middle finger.
        MiddleFirst = "middle-1",
        /// The intermediate phalanx of the middle finger.
        MiddleSecond = "middle-2",
        /// The distal phalanx of the middle finger.
        MiddleThird = "middle-3",
        /// The proximal phalanx of the ring finger.
        RingFirst = "ring-1",
        /// The intermediate phalanx of the ring finger.
        RingSecond = "ring-2",
        /// The distal phalanx of the ring finger.
        RingThird = "ring-3",
        /// The proximal phalanx of the little finger.
        LittleFirst = "little-1",
        /// The intermediate phalanx of the little finger.
        LittleSecond = "little-2",
        /// The distal phalanx of the little finger.
        LittleThird = "little-3",
        /// The upper arm.
        UpperArm = "upper-arm",
    }
}

impl ArmBone {
    /// Number of moving bones of a finger.
    pub const PER_FINGER: usize = 3;

    /// Returns a bone of a finger: 0 is the nearest to the palm, 2 has the tip. `None` beyond that.
    pub fn of_finger(finger: Finger, index: usize) -> Option<Self> {
        let first = Self::ThumbFirst.index() + Self::PER_FINGER * finger.index();
        let is_bone = index < Self::PER_FINGER;
        is_bone.then(|| Self::ALL[first + index])
    }

    /// Returns the finger of the bone, or `None` if it moves the whole hand.
    pub const fn finger(self) -> Option<Finger> {
        match self {
            Self::LowerArm | Self::Hand | Self::UpperArm => None,
            _ => {
                let index = self.index() - Self::ThumbFirst.index();
                Some(Finger::ALL[index / Self::PER_FINGER])
            }
        }
    }
}

/// The rotations of the bones of one arm, some of which may not be known.
///
/// Each is the rotation from the T pose in the frame of the parent, with the axes of the world: X to the right of the body,
/// Y up, −Z forward. The upper arm has no parent: its rotation is in the world. As JSON a map of quaternions x, y, z, w:
/// `{"hand":[0.0,0.0,0.0,1.0]}`.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
#[serde(
    from = "BTreeMap<ArmBone, [f32; 4]>",
    into = "BTreeMap<ArmBone, [f32; 4]>"
)]
pub struct ArmRotations {
    rotations: [[f32; 4]; ArmBone::COUNT],
    known: u32,
}

impl ArmRotations {
    /// Sets the rotation of a bone.
    pub fn set(&mut self, bone: ArmBone, rotation: Quat) {
        self.rotations[bone.index()] = rotation.to_array();
        self.known |= 1 << bone.index();
    }

    /// Returns the rotation of a bone, if it is known.
    pub fn get(&self, bone: ArmBone) -> Option<Quat> {
        let rotation = Quat::from_array(self.rotations[bone.index()]);
        self.is_known(bone).then_some(rotation)
    }

    /// Returns `true` if the rotation of a bone is known.
    pub fn is_known(&self, bone: ArmBone) -> bool {
        self.known & (1 << bone.index()) != 0
    }

    /// Returns `true` if no rotation is known.
    pub fn is_empty(&self) -> bool {
        self.known == 0
    }

    /// Iterates over the known rotations, in the order of [`ArmBone::ALL`].
    pub fn known(&self) -> impl Iterator<Item = (ArmBone, Quat)> + '_ {
        let all = ArmBone::ALL.iter();
        all.filter_map(|&bone| Some((bone, self.get(bone)?)))
    }
}

impl From<BTreeMap<ArmBone, [f32; 4]>> for ArmRotations {
    fn from(map: BTreeMap<ArmBone, [f32; 4]>) -> Self {
        let mut rotations = Self::default();
        for (bone, rotation) in map {
            rotations.set(bone, Quat::from_array(rotation));
        }
        rotations
    }
}

impl From<ArmRotations> for BTreeMap<ArmBone, [f32; 4]> {
    fn from(rotations: ArmRotations) -> Self {
        let known = rotations.known();
        known
            .map(|(bone, rotation)| (bone, rotation.to_array()))
            .collect()
    }
}

/// The rotations of the bones of both arms.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct BoneRotations {
    /// The left arm.
    #[serde(default)]
    pub left: ArmRotations,
    /// The right arm.
    #[serde(default)]
    pub right: ArmRotations,
}

impl BoneRotations {
    /// Returns the arm of a side.
    pub fn arm(&self, side: Side) -> &ArmRotations {
        match side {
            Side::Left => &self.left,
            Side::Right => &self.right,
        }
    }

    /// Returns the arm of a side for changes.
    pub fn arm_mut(&mut self, side: Side) -> &mut ArmRotations {
        match side {
            Side::Left => &mut self.left,
            Side::Right => &mut self.right,
        }
    }
}
