//! Types that every stage shares: sides and parts of a hand, fingers, joints, degrees of freedom, joint angles, joint
//! positions, rotations of bones, displacements, the inputs of a glove, and angles and points of the body.

mod body_angles;
mod body_point;
mod bone_rotations;
mod displacement;
mod inputs;
mod joint_angles;
mod joint_positions;
pub(crate) mod open_hand;

pub use body_angles::BodyAngle;
pub use body_point::{BodyPoint, BodyPoints};
pub use bone_rotations::{ArmBone, ArmRotations, BoneRotations};
pub use displacement::Displacement;
pub use inputs::{Input, InputValues};
pub use joint_angles::JointAngles;
pub use joint_positions::JointPositions;

use crate::names::named_enum;

named_enum! {
    /// A side of the body: the left or right hand.
    pub enum Side ("side") {
        /// The left hand.
        Left = "left",
        /// The right hand.
        Right = "right",
    }
}

impl Side {
    /// Returns the other side.
    pub const fn opposite(self) -> Self {
        match self {
            Self::Left => Self::Right,
            Self::Right => Self::Left,
        }
    }
}

named_enum! {
    /// A part of an arm and hand that one of several sources measures.
    pub enum HandPart ("part of a hand") {
        /// The arm up to the wrist, which places the hand in the world.
        Arm = "arm",
        /// The fingers.
        Fingers = "fingers",
    }
}

named_enum! {
    /// A finger. On a tie between two fingers, the first in this order takes precedence.
    pub enum Finger ("finger") {
        /// The thumb, finger 0.
        Thumb = "thumb",
        /// The index finger, 1.
        Index = "index",
        /// The middle finger, 2.
        Middle = "middle",
        /// The ring finger, 3.
        Ring = "ring",
        /// The little finger, 4.
        Little = "little",
    }
}

/// The number of fingers of both hands.
pub const FINGERS_OF_BOTH_HANDS: usize = Side::COUNT * Finger::COUNT;

/// A set of fingers.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct FingerSet(u8);

impl FingerSet {
    /// The empty set.
    pub const NONE: Self = Self(0);
    /// All five fingers.
    pub const ALL: Self = Self(0b1_1111);

    /// Returns the set with `finger` added.
    #[must_use]
    pub fn with(self, finger: Finger) -> Self {
        Self(self.0 | 1 << finger.index())
    }

    /// Returns the set with `finger` removed.
    #[must_use]
    pub fn without(self, finger: Finger) -> Self {
        Self(self.0 & !(1 << finger.index()))
    }

    /// Returns the fingers that are in either set.
    #[must_use]
    pub fn union(self, other: Self) -> Self {
        Self(self.0 | other.0)
    }

    /// Returns the fingers that are in this set and not in `other`.
    #[must_use]
    pub fn difference(self, other: Self) -> Self {
        Self(self.0 & !other.0)
    }

    /// Returns `true` if `finger` is in the set.
    pub fn contains(self, finger: Finger) -> bool {
        self.0 & (1 << finger.index()) != 0
    }

    /// Returns `true` if the set has no finger.
    pub fn is_empty(self) -> bool {
        self.0 == 0
    }
}

named_enum! {
    /// A joint or fingertip whose pose forward kinematics computes.
    ///
    /// The 25 joints of the hand have the names of the WebXR hand input specification. A phalanx is named
    /// after the joint at its near end: `index-finger-phalanx-proximal` is the MCP joint.
    pub enum Joint ("joint") {
        /// The shoulder.
        Shoulder = "shoulder",
        /// The elbow.
        Elbow = "elbow",
        /// The wrist.
        Wrist = "wrist",
        /// The base of the thumb metacarpal: the CMC joint.
        ThumbMetacarpal = "thumb-metacarpal",
        /// The thumb MCP joint.
        ThumbPhalanxProximal = "thumb-phalanx-proximal",
        /// The thumb IP joint.
        ThumbPhalanxDistal = "thumb-phalanx-distal",
        /// The tip of the thumb.
        ThumbTip = "thumb-tip",
        /// The base of the index metacarpal.
        IndexMetacarpal = "index-finger-metacarpal",
        /// The index MCP joint (knuckle).
        IndexPhalanxProximal = "index-finger-phalanx-proximal",
        /// The index PIP joint.
        IndexPhalanxIntermediate = "index-finger-phalanx-intermediate",
        /// The index DIP joint.
        IndexPhalanxDistal = "index-finger-phalanx-distal",
        /// The tip of the index finger.
        IndexTip = "index-finger-tip",
        /// The base of the middle metacarpal.
        MiddleMetacarpal = "middle-finger-metacarpal",
        /// The middle MCP joint (knuckle).
        MiddlePhalanxProximal = "middle-finger-phalanx-proximal",
        /// The middle PIP joint.
        MiddlePhalanxIntermediate = "middle-finger-phalanx-intermediate",
        /// The middle DIP joint.
        MiddlePhalanxDistal = "middle-finger-phalanx-distal",
        /// The tip of the middle finger.
        MiddleTip = "middle-finger-tip",
        /// The base of the ring metacarpal.
        RingMetacarpal = "ring-finger-metacarpal",
        /// The ring MCP joint (knuckle).
        RingPhalanxProximal = "ring-finger-phalanx-proximal",
        /// The ring PIP joint.
        RingPhalanxIntermediate = "ring-finger-phalanx-intermediate",
        /// The ring DIP joint.
        RingPhalanxDistal = "ring-finger-phalanx-distal",
        /// The tip of the ring finger.
        RingTip = "ring-finger-tip",
        /// The base of the little metacarpal.
        LittleMetacarpal = "pinky-finger-metacarpal",
        /// The little MCP joint (knuckle).
        LittlePhalanxProximal = "pinky-finger-phalanx-proximal",
        /// The little PIP joint.
        LittlePhalanxIntermediate = "pinky-finger-phalanx-intermediate",
        /// The little DIP joint.
        LittlePhalanxDistal = "pinky-finger-phalanx-distal",
        /// The tip of the little finger.
        LittleTip = "pinky-finger-tip",
    }
}

impl Finger {
    /// Returns the finger in words, such as `thumb` or `index finger`.
    pub const fn in_words(self) -> &'static str {
        match self {
            Self::Thumb => "thumb",
            Self::Index => "index finger",
            Self::Middle => "middle finger",
            Self::Ring => "ring finger",
            Self::Little => "little finger",
        }
    }

    /// The joints that bend each finger, in the order of [`Finger::ALL`] and from the base outwards.
    pub const FLEXIONS: [[Dof; 3]; Self::COUNT] = [
        [
            Dof::ThumbCmcFlexion,
            Dof::ThumbMcpFlexion,
            Dof::ThumbIpFlexion,
        ],
        [
            Dof::IndexMcpFlexion,
            Dof::IndexPipFlexion,
            Dof::IndexDipFlexion,
        ],
        [
            Dof::MiddleMcpFlexion,
            Dof::MiddlePipFlexion,
            Dof::MiddleDipFlexion,
        ],
        [
            Dof::RingMcpFlexion,
            Dof::RingPipFlexion,
            Dof::RingDipFlexion,
        ],
        [
            Dof::LittleMcpFlexion,
            Dof::LittlePipFlexion,
            Dof::LittleDipFlexion,
        ],
    ];

    /// Returns the joints from the base to the tip: four of the thumb, five of another finger.
    pub fn joints(self) -> &'static [Joint] {
        let tip = Joint::tip(self).index();
        let joints = if self == Self::Thumb { 4 } else { 5 };
        &Joint::ALL[tip + 1 - joints..=tip]
    }
}

impl Joint {
    /// Returns the tip of `finger`.
    pub const fn tip(finger: Finger) -> Self {
        match finger {
            Finger::Thumb => Self::ThumbTip,
            Finger::Index => Self::IndexTip,
            Finger::Middle => Self::MiddleTip,
            Finger::Ring => Self::RingTip,
            Finger::Little => Self::LittleTip,
        }
    }
}

named_enum! {
    /// A degree of freedom: one angle of one joint, in radians. All angles are 0 in the model's zero pose.
    ///
    /// Flexion is positive towards the palm, abduction and deviation are positive towards the
    /// little-finger side, supination is positive when the palm turns up.
    pub enum Dof ("degree of freedom") {
        /// Upper arm about the model's first shoulder axis.
        ShoulderZ = "shoulder-z",
        /// Upper arm about the model's second shoulder axis.
        ShoulderY = "shoulder-y",
        /// Upper arm about its long axis.
        ShoulderX = "shoulder-x",
        /// Elbow flexion.
        ElbowFlexion = "elbow-flexion",
        /// Forearm supination (negative: pronation); 0 with the palm down in the mounted model.
        ForearmSupination = "forearm-supination",
        /// Roll of the second forearm bone, which has no children.
        ForearmSecondBone = "forearm-second-bone",
        /// Wrist deviation: ulnar positive, radial negative.
        WristDeviation = "wrist-deviation",
        /// Wrist flexion (negative: extension).
        WristFlexion = "wrist-flexion",
        /// Thumb CMC abduction: sideways, positive towards the little-finger side.
        ThumbCmcAbduction = "thumb-cmc-abduction",
        /// Thumb CMC flexion.
        ThumbCmcFlexion = "thumb-cmc-flexion",
        /// Thumb MCP flexion.
        ThumbMcpFlexion = "thumb-mcp-flexion",
        /// Thumb IP flexion.
        ThumbIpFlexion = "thumb-ip-flexion",
        /// Index MCP abduction.
        IndexMcpAbduction = "index-mcp-abduction",
        /// Index MCP flexion.
        IndexMcpFlexion = "index-mcp-flexion",
        /// Index PIP flexion.
        IndexPipFlexion = "index-pip-flexion",
        /// Index DIP flexion.
        IndexDipFlexion = "index-dip-flexion",
        /// Middle MCP abduction.
        MiddleMcpAbduction = "middle-mcp-abduction",
        /// Middle MCP flexion.
        MiddleMcpFlexion = "middle-mcp-flexion",
        /// Middle PIP flexion.
        MiddlePipFlexion = "middle-pip-flexion",
        /// Middle DIP flexion.
        MiddleDipFlexion = "middle-dip-flexion",
        /// Ring MCP abduction.
        RingMcpAbduction = "ring-mcp-abduction",
        /// Ring MCP flexion.
        RingMcpFlexion = "ring-mcp-flexion",
        /// Ring PIP flexion.
        RingPipFlexion = "ring-pip-flexion",
        /// Ring DIP flexion.
        RingDipFlexion = "ring-dip-flexion",
        /// Little MCP abduction.
        LittleMcpAbduction = "little-mcp-abduction",
        /// Little MCP flexion.
        LittleMcpFlexion = "little-mcp-flexion",
        /// Little PIP flexion.
        LittlePipFlexion = "little-pip-flexion",
        /// Little DIP flexion.
        LittleDipFlexion = "little-dip-flexion",
    }
}

impl Dof {
    /// Returns the finger that this angle moves, or `None` if it moves the whole hand.
    pub const fn finger(self) -> Option<Finger> {
        match self.index() {
            0..8 => None,
            8..12 => Some(Finger::Thumb),
            12..16 => Some(Finger::Index),
            16..20 => Some(Finger::Middle),
            20..24 => Some(Finger::Ring),
            _ => Some(Finger::Little),
        }
    }
}

/// A set of degrees of freedom.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct DofSet(u32);

const _: () = assert!(Dof::COUNT <= 32);

impl DofSet {
    /// The empty set.
    pub const NONE: Self = Self(0);

    /// Returns the set with `dof` added.
    #[must_use]
    pub fn with(self, dof: Dof) -> Self {
        Self(self.0 | 1 << dof.index())
    }

    /// Returns the degrees of freedom that are in either set.
    #[must_use]
    pub fn union(self, other: Self) -> Self {
        Self(self.0 | other.0)
    }

    /// Returns the degrees of freedom that are in this set and not in `other`.
    #[must_use]
    pub fn difference(self, other: Self) -> Self {
        Self(self.0 & !other.0)
    }

    /// Returns `true` if `dof` is in the set.
    pub fn contains(self, dof: Dof) -> bool {
        self.0 & (1 << dof.index()) != 0
    }

    /// Returns `true` if the set is empty.
    pub fn is_empty(self) -> bool {
        self.0 == 0
    }

    /// Iterates over the set, in the order of [`Dof::ALL`].
    pub fn iter(self) -> impl Iterator<Item = Dof> {
        let all = Dof::ALL.iter().copied();
        all.filter(move |dof| self.contains(*dof))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_finger_has_four_degrees_of_freedom_and_the_arm_has_eight() {
        for &finger in Finger::ALL {
            let count = Dof::ALL.iter().filter(|dof| dof.finger() == Some(finger));
            assert_eq!(count.count(), 4, "{finger}");
        }
        assert_eq!(
            Dof::ALL.iter().filter(|dof| dof.finger().is_none()).count(),
            8
        );
        assert_eq!(Dof::WristFlexion.finger(), None);
        assert_eq!(Dof::ThumbCmcAbduction.finger(), Some(Finger::Thumb));
    }

    #[test]
    fn the_joints_of_the_fingers_follow_the_wrist() {
        let joints = Finger::ALL.iter().flat_map(|finger| finger.joints());
        let expected = &Joint::ALL[Joint::Wrist.index() + 1..];
        assert_eq!(joints.copied().collect::<Vec<_>>(), expected);
    }

    #[test]
    fn the_hand_has_the_25_joints_of_webxr() {
        let hand_joints = Joint::ALL
            .iter()
            .filter(|joint| joint.index() >= Joint::Wrist.index());
        assert_eq!(hand_joints.count(), 25);
    }
}
