//! Stage 2: [`Reading`](crate::capture::Reading) → [`Estimate`].

pub mod arm_attributes;
mod bend;
mod bone_angles;
mod calibration;
mod channel_map;
pub mod delay;
mod estimator;
mod fusion;
mod hand_angles;
mod hand_estimator;
mod hysteresis;
mod last_seen;
mod learned_range;
mod limits;
mod linearity;
mod one_euro;
mod plausibility;
mod position_filter;
mod repeated_positions;
mod samples;
mod settings;
mod smoothing;
pub mod t_pose;
mod tip_speed;
mod zero;

pub use bend::{BendRanges, FingerBends};
pub use bone_angles::{angles_from_bones, bones_from_angles};
pub use calibration::{AffineMap, CountRange, FitError};
pub(crate) use channel_map::channels_of;
pub use channel_map::{ChannelMap, ChannelRow, InputRow, MAX_CURVATURE, MAX_HYSTERESIS, MAX_ROWS};
pub use estimator::Estimator;
pub use fusion::FusedEstimator;
pub(crate) use fusion::max_sweep;
pub use hand_angles::{forearm_sides, hand_angles};
pub use hand_estimator::HandEstimator;
pub(crate) use last_seen::LastSeen;
pub use learned_range::LearnedRange;
pub use limits::JointLimits;
pub use linearity::{Linearity, divider_voltage};
pub use one_euro::{OneEuroFilter, OneEuroSettings};
pub use plausibility::Implausible;
pub use position_filter::{LANDMARK_SMOOTHING, MARKER_SMOOTHING};
pub use settings::EstimatorSettings;
pub use smoothing::Smoothing;
pub use zero::{ZeroError, Zeroed};

pub use crate::hand::JointAngles;

use parry3d::math::{Pose, Vec3};

use crate::hand::{Displacement, FingerSet, InputValues, Joint};
use crate::names::named_enum;
use crate::time::Timestamp;

/// The state of an arm and hand estimated from one reading.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Estimate {
    /// The time stamp of the reading.
    pub time: Timestamp,
    /// The filtered joint angles, within the joint limits.
    pub angles: JointAngles,
    /// Fingers with a sensor fault. They press nothing.
    pub untrusted: FingerSet,
    /// `true` if the hand was re-acquired at another position. The movement in between was not seen.
    pub jumped: bool,
    /// `true` if the fingers or a part of the arm were not seen for so long before this reading that their movement is not known, or if
    /// the hand is elsewhere after its source repeated all positions. The pipeline adds missing readings of a hand that one source
    /// measures.
    pub is_after_gap: bool,
    /// `true` if the fingers were not seen for so long, so that it is not known how they have bent. Implies `is_after_gap`.
    pub misses_bends: bool,
    /// `false` if the position of the hand in the world is not known, as when the source of its arm was lost. Nothing can be
    /// touched or pointed at.
    pub is_placed: bool,
    /// The pose of the arm's root in the world (metres), or `None` if the sensor does not measure it.
    pub root: Option<Pose>,
    /// The displacement of the arm or the hand from the pose that its angles give it.
    pub displacement: Option<Displacement>,
    /// The joint positions that the sensor measures directly. They override the positions of forward kinematics.
    pub measured: MeasuredJoints,
    /// The sticks, triggers and buttons of a glove.
    pub inputs: InputValues,
}

impl Estimate {
    /// Creates an estimate that consists of joint angles only.
    pub fn new(time: Timestamp, angles: JointAngles) -> Self {
        Self {
            time,
            angles,
            untrusted: FingerSet::NONE,
            jumped: false,
            is_after_gap: false,
            misses_bends: false,
            is_placed: true,
            root: None,
            displacement: None,
            measured: MeasuredJoints::default(),
            inputs: InputValues::default(),
        }
    }

    /// Becomes a copy of `other`. Cheaper than an assignment, which also copies the positions that were not measured.
    pub(crate) fn copy_from(&mut self, other: &Self) {
        let Self {
            time,
            angles,
            untrusted,
            jumped,
            is_after_gap,
            misses_bends,
            is_placed,
            root,
            displacement,
            measured,
            inputs,
        } = other;
        self.time = *time;
        self.angles = *angles;
        self.untrusted = *untrusted;
        self.jumped = *jumped;
        self.is_after_gap = *is_after_gap;
        self.misses_bends = *misses_bends;
        self.is_placed = *is_placed;
        self.root = *root;
        self.displacement = *displacement;
        self.inputs = *inputs;
        if measured.is_empty() {
            self.measured.known = 0
        } else {
            self.measured = *measured
        }
    }

    /// Prepares for the next reading: nothing is known but its time. Cheaper than a new estimate, most of which is the
    /// positions of joints that few sensors measure.
    fn reset(&mut self, time: Timestamp) {
        self.time = time;
        self.angles = JointAngles::default();
        self.untrusted = FingerSet::NONE;
        self.jumped = false;
        self.is_after_gap = false;
        self.misses_bends = false;
        self.is_placed = true;
        self.root = None;
        self.displacement = None;
        self.measured.known = 0;
        self.inputs = InputValues::default();
    }

    /// Returns `true` if the position of the hand and at least one of its fingers are measured.
    pub(crate) fn shows_hand(&self) -> bool {
        self.is_placed && self.untrusted != FingerSet::ALL
    }

    /// Forgets the hand: its position is unknown, and the next time it is seen counts as a jump.
    pub fn lose_hand(&mut self) {
        self.reset(self.time);
        self.untrusted = FingerSet::ALL;
        self.jumped = true;
        self.is_placed = false;
    }
}

/// The joint positions that a sensor measures directly, in the world (metres).
#[derive(Clone, Copy, Debug, Default)]
pub struct MeasuredJoints {
    positions: [Vec3; Joint::COUNT],
    known: u32,
}

impl MeasuredJoints {
    /// Sets the position of a joint, in metres.
    pub fn set(&mut self, joint: Joint, position: Vec3) {
        self.positions[joint.index()] = position;
        self.known |= 1 << joint.index();
    }

    /// Returns `true` if no joint was measured.
    pub fn is_empty(&self) -> bool {
        self.known == 0
    }

    /// Returns the position of a joint (metres), or `None` if it was not measured.
    pub fn get(&self, joint: Joint) -> Option<Vec3> {
        (self.known & (1 << joint.index()) != 0).then(|| self.positions[joint.index()])
    }

    /// Iterates over the measured joints and their positions (metres), in the order of [`Joint::ALL`].
    pub fn iter(&self) -> impl Iterator<Item = (Joint, Vec3)> + '_ {
        let mut rest = self.known;
        std::iter::from_fn(move || {
            let index = rest.trailing_zeros() as usize;
            let joint = *Joint::ALL.get(index)?;
            rest &= rest - 1;
            Some((joint, self.positions[index]))
        })
    }
}

/// Positions of joints that were not measured do not count.
impl PartialEq for MeasuredJoints {
    fn eq(&self, other: &Self) -> bool {
        self.iter().eq(other.iter())
    }
}

named_enum! {
    /// The reason why a reading was rejected.
    pub enum Rejection ("reason") {
        /// The reading has too few channels, no angles or no joints, or no glove is configured for its channels.
        WrongShape = "wrong-shape",
        /// Its time stamp is not later than the time stamp of the previous reading.
        OutOfOrder = "out-of-order",
        /// An angle is not a finite number.
        NotFinite = "not-finite",
        /// An angle is further outside the range of its joint than a calibration error explains.
        OutsideLimits = "outside-limits",
        /// A joint turned faster than a person can. Accepted once consecutive readings agree.
        TooFast = "too-fast",
        /// Landmarks are not trusted and the arm was not seen before.
        LowConfidence = "low-confidence",
        /// Landmarks or joints coincide or lie on a line, so that they show no direction.
        Collapsed = "collapsed",
    }
}

impl std::error::Error for Rejection {}
