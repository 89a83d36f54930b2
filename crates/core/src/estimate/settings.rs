//! Settings of the estimator.

use std::time::Duration;

use super::{JointAngles, JointLimits, OneEuroSettings, Smoothing};

/// Settings of an [`Estimator`](super::Estimator).
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct EstimatorSettings {
    /// The smoothing filter of the joint angles.
    pub smoothing: Smoothing,
    /// The smoothing filter of measured joint positions, `beta` in Hz per m/s; `None` for none.
    pub position_smoothing: Option<OneEuroSettings>,
    /// The ranges of motion; `None` accepts every finite angle.
    pub limits: Option<JointLimits>,
    /// The highest speed of a joint, in rad/s; `None` accepts every change.
    pub max_speed: Option<f64>,
    /// The longest gap between two readings that does not reset the filters.
    pub max_gap: Duration,
    /// The time for which a channel may stay at one end of its range before its fingers are untrusted, as with a broken
    /// wire or a short circuit; `None` disables the check.
    pub rail_timeout: Option<Duration>,
    /// The angles of the hand at rest, in radians, to which [zeroing](super::Estimator::zero) returns. Angles that are not
    /// known are not zeroed.
    pub rest_pose: JointAngles,
    /// `true` to widen the calibrated ranges of finger sensors that go beyond them; see
    /// [`with_ranges`](super::ChannelMap::with_ranges).
    pub learn_ranges: bool,
}

impl Default for EstimatorSettings {
    /// Human ranges of motion; 40 rad/s, twice the fastest finger flexion; reset after 0.5 s;
    /// rail time-out 1 s.
    fn default() -> Self {
        Self {
            smoothing: Smoothing::default(),
            position_smoothing: None,
            limits: Some(JointLimits::human()),
            max_speed: Some(40.0),
            max_gap: Duration::from_millis(500),
            rail_timeout: Some(Duration::from_secs(1)),
            rest_pose: JointAngles::default(),
            learn_ranges: false,
        }
    }
}

impl EstimatorSettings {
    /// Returns settings without plausibility checks: every finite angle is accepted, at any speed.
    pub fn unchecked(smoothing: Smoothing) -> Self {
        Self {
            smoothing,
            limits: None,
            max_speed: None,
            max_gap: Duration::MAX,
            rail_timeout: None,
            ..Self::default()
        }
    }
}
