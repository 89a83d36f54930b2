//! Calibration poses: their instructions, and the joint angles that a hand has in them.

use crate::estimate::ChannelMap;
use crate::hand::{Dof, Finger, JointAngles};
use crate::names::named_enum;

named_enum! {
    /// A pose that a person takes for a calibration.
    pub enum CalibrationPose ("calibration pose") {
        /// The hand lies relaxed. Its angles are not known; the pose shows the noise of the sensors and the zero of
        /// `ademan ctl zero`.
        Rest = "rest",
        /// Palm, fingers and thumb lie flat and together on a table.
        Flat = "flat",
        /// The fingers are closed, the thumb lies bent across them.
        Fist = "fist",
        /// The hand lies flat with fingers and thumb spread.
        Spread = "spread",
        /// The tips of thumb and index finger touch, the other fingers are straight.
        Pinch = "pinch",
        /// The arm is straight.
        ElbowStraight = "elbow-straight",
        /// The forearm is at a right angle to the upper arm.
        ElbowBent = "elbow-bent",
        /// The wrist is bent towards the back of the hand.
        WristUp = "wrist-up",
        /// The wrist is bent towards the palm.
        WristDown = "wrist-down",
        /// The hand is turned towards the thumb.
        WristIn = "wrist-in",
        /// The hand is turned towards the little finger.
        WristOut = "wrist-out",
        /// The palm faces up.
        PalmUp = "palm-up",
        /// The palm faces down.
        PalmDown = "palm-down",
        /// Only the thumb is bent.
        ThumbBent = "thumb-bent",
        /// Only the index finger is bent.
        IndexBent = "index-bent",
        /// Only the middle finger is bent.
        MiddleBent = "middle-bent",
        /// Only the ring finger is bent.
        RingBent = "ring-bent",
        /// Only the little finger is bent.
        LittleBent = "little-bent",
    }
}

/// The angle of a joint in a pose.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ExpectedAngle {
    /// The angle of a typical adult, in radians.
    pub radians: f64,
    /// The standard deviation between people, and between two attempts of one person, in radians.
    pub deviation: f64,
}

/// The largest deviation of an angle that a pose defines, in degrees.
const DEFINED: f64 = 8.5;

/// The deviation of a joint that a pose leaves free, in degrees.
const FREE: f64 = 40.0;

impl CalibrationPose {
    /// The poses of a complete calibration, in the order in which a hand takes them with the fewest movements.
    pub const GUIDED: &'static [Self] = &[
        Self::Rest,
        Self::Flat,
        Self::Spread,
        Self::Fist,
        Self::Pinch,
        Self::WristUp,
        Self::WristDown,
        Self::WristIn,
        Self::WristOut,
        Self::PalmUp,
        Self::PalmDown,
        Self::ElbowStraight,
        Self::ElbowBent,
    ];

    /// The poses that tell the fingers apart. They find swapped sensors of fingers that bend together in all other poses.
    pub const SINGLE_FINGERS: &'static [Self] = &[
        Self::ThumbBent,
        Self::IndexBent,
        Self::MiddleBent,
        Self::RingBent,
        Self::LittleBent,
    ];

    /// Returns the instruction for the person.
    pub const fn instruction(self) -> &'static str {
        match self {
            Self::Rest => "lay the hand on the table and relax it",
            Self::Flat => "press palm and fingers flat on the table, fingers and thumb together",
            Self::Fist => "make a tight fist, with the thumb bent across the fingers",
            Self::Spread => {
                "lay the hand flat on the table, and spread fingers and thumb as far as they go"
            }
            Self::Pinch => {
                "touch the tip of the thumb with the index finger, the other fingers straight"
            }
            Self::ElbowStraight => "stretch the arm straight, fingers straight",
            Self::ElbowBent => "bend the elbow to a right angle, fingers straight",
            Self::WristUp => "bend the wrist up as far as it goes, fingers straight",
            Self::WristDown => "bend the wrist down as far as it goes, fingers straight",
            Self::WristIn => "hand flat on the table: turn it towards the thumb as far as it goes",
            Self::WristOut => {
                "hand flat on the table: turn it towards the little finger as far as it goes"
            }
            Self::PalmUp => {
                "forearm on the table: turn the palm up as far as it goes, fingers straight"
            }
            Self::PalmDown => "lay the hand flat on the table again, palm down",
            Self::ThumbBent => "bend only the thumb, the fingers straight",
            Self::IndexBent => "bend only the index finger, the others straight",
            Self::MiddleBent => "bend only the middle finger, the others straight",
            Self::RingBent => "bend only the ring finger, the others straight",
            Self::LittleBent => "bend only the little finger, the others straight",
        }
    }

    /// Returns the angles of a typical adult in this pose, for a picture. Joints that the pose leaves free are at 0.
    pub fn angles(self) -> JointAngles {
        let mut angles = JointAngles::default();
        for &dof in Dof::ALL {
            angles.set(dof, self.expected(dof).radians);
        }
        angles
    }

    /// Returns the angle of a joint in this pose.
    pub fn expected(self, dof: Dof) -> ExpectedAngle {
        let (degrees, deviation) = self.degrees(dof);
        ExpectedAngle {
            radians: degrees.to_radians(),
            deviation: deviation.to_radians(),
        }
    }

    /// Returns `true` if the pose defines the angle of a joint well enough to calibrate it.
    pub fn defines(self, dof: Dof) -> bool {
        self.degrees(dof).1 <= DEFINED
    }

    /// Returns `true` if the pose leaves a joint free, so that its angle may be any.
    pub fn leaves_free(self, dof: Dof) -> bool {
        self.degrees(dof).1 >= FREE
    }

    /// Returns `true` if a glove with these channels is calibrated by this pose: it moves a joint that the glove measures, or is
    /// the zero of all.
    pub fn is_needed_for(self, map: &ChannelMap) -> bool {
        let moves = |dof: Dof| self.defines(dof) && self.expected(dof).radians != 0.0;
        let is_reference = matches!(self, Self::Rest | Self::Flat);
        let measures = |dof: Dof| map.rows().iter().any(|row| row.dof == dof);
        is_reference
            || Dof::ALL.iter().any(|&dof| moves(dof) && measures(dof))
            || (self == Self::PalmDown && measures(Dof::ForearmSupination))
            || (self == Self::ElbowStraight && measures(Dof::ElbowFlexion))
            || self.bent_finger().is_some_and(|finger| {
                let mut rows = map.rows().iter();
                rows.any(|row| row.dof.finger() == Some(finger))
            })
    }

    /// Returns the only finger that is bent.
    pub const fn bent_finger(self) -> Option<Finger> {
        match self {
            Self::ThumbBent => Some(Finger::Thumb),
            Self::IndexBent => Some(Finger::Index),
            Self::MiddleBent => Some(Finger::Middle),
            Self::RingBent => Some(Finger::Ring),
            Self::LittleBent => Some(Finger::Little),
            _ => None,
        }
    }

    /// Returns the angle of a joint and its deviation, in degrees.
    ///
    /// Ranges are the clinical ones of [`JointLimits::human`](crate::estimate::JointLimits::human). Deviations
    /// follow Boone & Azen 1979 for wrist and forearm, 4° to 6.5°; the fingers have the same. A table holds a joint to 3°.
    fn degrees(self, dof: Dof) -> (f64, f64) {
        match dof.finger() {
            None => self.arm_degrees(dof),
            Some(Finger::Thumb) => self.thumb_degrees(dof),
            Some(finger) => self.finger_degrees(finger, dof),
        }
    }

    fn arm_degrees(self, dof: Dof) -> (f64, f64) {
        match (dof, self) {
            (Dof::ElbowFlexion, Self::ElbowStraight) => (0.0, 3.0),
            (Dof::ElbowFlexion, Self::ElbowBent) => (90.0, 4.0),
            (Dof::ForearmSupination, Self::PalmUp) => (155.0, 6.5),
            (Dof::ForearmSupination, Self::PalmDown | Self::Flat | Self::Spread) => (0.0, 5.0),
            (Dof::WristFlexion, Self::WristUp) => (-70.0, 6.5),
            (Dof::WristFlexion, Self::WristDown) => (75.0, 6.5),
            (Dof::WristDeviation, Self::WristIn) => (-20.0, 4.0),
            (Dof::WristDeviation, Self::WristOut) => (35.0, 4.0),
            (Dof::WristFlexion | Dof::WristDeviation, Self::Flat) => (0.0, 3.0),
            (Dof::WristFlexion | Dof::WristDeviation, Self::Spread) => (0.0, 4.0),
            _ => (0.0, FREE),
        }
    }

    fn thumb_degrees(self, dof: Dof) -> (f64, f64) {
        match (self, dof) {
            (Self::Flat, _) => (0.0, 5.0),
            (Self::Spread, Dof::ThumbCmcAbduction) => (-50.0, 6.0),
            (Self::Fist | Self::ThumbBent, Dof::ThumbCmcFlexion) => (35.0, 6.0),
            (Self::Fist | Self::ThumbBent, Dof::ThumbMcpFlexion) => (50.0, 6.0),
            (Self::Fist | Self::ThumbBent, Dof::ThumbIpFlexion) => (70.0, 6.0),
            (Self::Pinch, Dof::ThumbCmcAbduction) => (-20.0, 8.0),
            (Self::Pinch, _) => (25.0, 8.0),
            _ => (0.0, FREE),
        }
    }

    fn finger_degrees(self, finger: Finger, dof: Dof) -> (f64, f64) {
        let is_bent = self == Self::Fist || self.bent_finger() == Some(finger);
        let deviation = match self {
            Self::Flat | Self::Spread | Self::WristIn | Self::WristOut | Self::PalmDown => 3.0,
            Self::Fist => 6.0,
            Self::WristUp | Self::WristDown | Self::PalmUp => 6.0,
            Self::ElbowStraight | Self::ElbowBent => 6.0,
            Self::Pinch if finger == Finger::Index => 8.0,
            _ => 12.0,
        };
        let joint = Joint::of(dof);
        let degrees = match (self, joint) {
            (Self::Spread, Joint::Abduction) => spread_degrees(finger),
            (Self::Fist, Joint::Abduction) => return (0.0, FREE),
            (Self::Rest, Joint::Mcp | Joint::Pip) => 30.0,
            (Self::Rest, Joint::Dip) => 15.0,
            (Self::Pinch, Joint::Mcp | Joint::Pip) if finger == Finger::Index => 45.0,
            (Self::Pinch, Joint::Dip) if finger == Finger::Index => 30.0,
            (_, Joint::Mcp) if is_bent => 90.0,
            (_, Joint::Pip) if is_bent => 100.0,
            (_, Joint::Dip) if is_bent => 70.0,
            _ => 0.0,
        };
        (degrees, deviation)
    }
}

/// A joint of a finger.
#[derive(Clone, Copy, PartialEq, Eq)]
enum Joint {
    Abduction,
    Mcp,
    Pip,
    Dip,
}

impl Joint {
    /// Returns the joint of a degree of freedom of a finger: abduction first, then from the knuckle outwards.
    fn of(dof: Dof) -> Self {
        match dof.index() % 4 {
            0 => Self::Abduction,
            1 => Self::Mcp,
            2 => Self::Pip,
            _ => Self::Dip,
        }
    }
}

/// Returns the abduction of a spread finger in degrees: positive towards the little finger.
fn spread_degrees(finger: Finger) -> f64 {
    match finger {
        Finger::Index => -17.0,
        Finger::Ring => 10.0,
        Finger::Little => 20.0,
        Finger::Thumb | Finger::Middle => 0.0,
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::document::Document;
    use crate::estimate::JointLimits;
    use crate::layout::Glove;

    #[test]
    fn every_pose_is_within_the_range_of_motion() {
        let limits = JointLimits::human();
        for &pose in CalibrationPose::ALL {
            for &dof in Dof::ALL {
                let radians = pose.expected(dof).radians;
                assert_eq!(limits.clamp(dof, radians), radians, "{pose} {dof}");
            }
        }
    }

    #[test]
    fn two_poses_define_every_joint_of_the_shipped_gloves() {
        for name in ["unam-hc11", "unam-hc11-left", "lucidgloves"] {
            for row in Glove::parse(&Document::shipped(name).unwrap())
                .unwrap()
                .map
                .rows()
            {
                let poses = CalibrationPose::GUIDED.iter();
                let defining = poses.filter(|pose| pose.defines(row.dof));
                let mut angles: Vec<f64> = defining
                    .map(|pose| pose.expected(row.dof).radians)
                    .collect();
                angles.sort_by(f64::total_cmp);
                angles.dedup();
                let is_placeholder = row.dof == Dof::ForearmSecondBone;
                let is_middle = row.dof == Dof::MiddleMcpAbduction;
                assert!(
                    angles.len() >= 2 || is_placeholder || is_middle,
                    "{name} {}",
                    row.dof
                );
            }
        }
    }

    #[test]
    fn a_glove_without_arm_sensors_needs_no_arm_poses() {
        let map = Glove::parse(&Document::shipped("lucidgloves").unwrap())
            .unwrap()
            .map;
        let needed = CalibrationPose::GUIDED.iter().copied();
        let needed: Vec<_> = needed.filter(|pose| pose.is_needed_for(&map)).collect();
        use CalibrationPose::{Fist, Flat, Pinch, Rest, Spread};
        assert_eq!(needed, [Rest, Flat, Spread, Fist, Pinch]);
    }
}
