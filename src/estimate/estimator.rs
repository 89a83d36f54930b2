//! The estimator: converts readings to plausible, smooth joint angles.

use std::time::Duration;

use super::channel_map::ChannelMap;
use super::channels::ChannelConverter;
use super::limits::JointLimits;
use super::smoothing::{Smoother, Smoothing};
use super::{Estimate, JointAngles, Rejection, angles};
use crate::capture::{Channels, Reading, Sample};
use crate::hand::FingerSet;
use crate::time::Timestamp;

/// The number of consecutive readings, each plausible after the previous one, after which an implausible jump is
/// accepted.
const CONSISTENT_READINGS: u8 = 3;

/// A rotation that is always plausible, in radians: a busy machine delivers readings in bursts, so the
/// measured time between two readings can be far too short.
const MIN_PLAUSIBLE_ROTATION: f64 = 0.3;

/// Settings of an [`Estimator`].
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct EstimatorSettings {
    /// The smoothing filter.
    pub smoothing: Smoothing,
    /// The ranges of motion; `None` accepts every finite angle.
    pub limits: Option<JointLimits>,
    /// The highest speed of a joint, in rad/s; `None` accepts every change.
    pub max_speed: Option<f64>,
    /// The longest gap between two readings that does not reset the filters.
    pub max_gap: Duration,
    /// The time for which a channel may stay at one end of its range before its fingers are untrusted, as with a broken
    /// wire or a short circuit; `None` disables the check.
    pub rail_timeout: Option<Duration>,
}

impl Default for EstimatorSettings {
    /// Human ranges of motion; 40 rad/s, twice the fastest finger flexion; reset after 0.5 s;
    /// rail time-out 1 s.
    fn default() -> Self {
        Self {
            smoothing: Smoothing::default(),
            limits: Some(JointLimits::human()),
            max_speed: Some(40.0),
            max_gap: Duration::from_millis(500),
            rail_timeout: Some(Duration::from_secs(1)),
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
        }
    }
}

/// The estimator of one hand. It accepts samples of every kind; those with sensor channels need a
/// [channel map](Self::with_channels).
#[derive(Clone, Debug)]
pub struct Estimator {
    channels: Option<ChannelConverter>,
    settings: EstimatorSettings,
    smoother: Smoother,
    /// The last accepted angles, before the filter.
    last: Option<RawAngles>,
    /// An implausible jump, and the number of consecutive readings that agree with it.
    candidate: Option<(RawAngles, u8)>,
}

/// The angles of one reading before the filter.
#[derive(Clone, Copy, Debug)]
struct RawAngles {
    time: Timestamp,
    angles: JointAngles,
}

impl Estimator {
    /// Creates an estimator for samples of joint angles.
    pub fn new(settings: EstimatorSettings) -> Self {
        Self {
            channels: None,
            smoother: Smoother::new(settings.smoothing),
            settings,
            last: None,
            candidate: None,
        }
    }

    /// Adds the channel map of a glove, for samples of sensor channels.
    #[must_use]
    pub fn with_channels(mut self, map: &ChannelMap) -> Self {
        let limits = self.settings.limits.as_ref();
        self.channels = Some(ChannelConverter::new(map, limits));
        self
    }

    /// Converts a reading. A rejected reading does not change the filters.
    pub fn update(&mut self, reading: &Reading) -> Result<Estimate, Rejection> {
        let time = reading.time;
        let (angles, untrusted) = match &reading.sample {
            Sample::Channels(channels) => self.convert_channels(time, channels)?,
            Sample::Angles { angles } => {
                self.check_order(time)?;
                let limits = self.settings.limits.as_ref();
                (angles::convert(angles, limits)?, FingerSet::NONE)
            }
        };
        let raw = RawAngles { time, angles };
        let jumped = self.check_speed(&raw)?;
        let gap = match &self.last {
            Some(last) => time.since(last.time),
            None => Duration::ZERO,
        };
        if jumped || gap > self.settings.max_gap || !self.has_same_dofs(&angles) {
            self.smoother.reset();
        }
        self.last = Some(raw);
        let mut estimate = Estimate::new(time, angles);
        estimate.untrusted = untrusted;
        estimate.jumped = jumped;
        self.smoother
            .filter(&mut estimate.angles, gap.as_secs_f64());
        if let Some(limits) = &self.settings.limits {
            limits.clamp_all(&mut estimate.angles);
        }
        Ok(estimate)
    }

    fn convert_channels(
        &mut self,
        time: Timestamp,
        channels: &Channels,
    ) -> Result<(JointAngles, FingerSet), Rejection> {
        let converter = self.channels.as_ref();
        if !converter.is_some_and(|converter| converter.accepts(channels)) {
            return Err(Rejection::WrongShape);
        }
        self.check_order(time)?;
        let converter = self.channels.as_mut().ok_or(Rejection::WrongShape)?;
        let untrusted = match self.settings.rail_timeout {
            Some(timeout) => converter.update_health(time, channels, timeout),
            None => FingerSet::NONE,
        };
        Ok((converter.convert(channels)?, untrusted))
    }

    fn check_order(&self, time: Timestamp) -> Result<(), Rejection> {
        match &self.last {
            Some(last) if time <= last.time => Err(Rejection::OutOfOrder),
            _ => Ok(()),
        }
    }

    fn has_same_dofs(&self, angles: &JointAngles) -> bool {
        let last = self.last.as_ref();
        last.is_none_or(|last| last.angles.has_same_dofs(angles))
    }

    /// Returns whether the hand was re-acquired at another position; an error until consecutive readings agree on it.
    fn check_speed(&mut self, raw: &RawAngles) -> Result<bool, Rejection> {
        let (Some(max_speed), Some(last)) = (self.settings.max_speed, &self.last) else {
            return Ok(false);
        };
        // The time of rejected readings does not extend the plausible rotation.
        let previous = self
            .candidate
            .as_ref()
            .map_or(last.time, |(candidate, _)| candidate.time);
        let rotation = max_speed * raw.time.since(previous).as_secs_f64();
        let rotation = rotation.max(MIN_PLAUSIBLE_ROTATION);
        if raw.is_within(rotation, last) {
            self.candidate = None;
            return Ok(false);
        }
        let agreeing = match &self.candidate {
            Some((candidate, count)) if raw.is_within(rotation, candidate) => count + 1,
            _ => 1,
        };
        if agreeing < CONSISTENT_READINGS {
            self.candidate = Some((*raw, agreeing));
            return Err(Rejection::TooFast);
        }
        self.candidate = None;
        Ok(true)
    }
}

impl RawAngles {
    /// Returns whether no angle differs from `other` by more than `rotation` (radians). Angles that are known in only
    /// one of both do not count.
    fn is_within(&self, rotation: f64, other: &Self) -> bool {
        let mut known = self.angles.known();
        known.all(|(dof, radians)| {
            !other.angles.is_known(dof) || (radians - other.angles.get(dof)).abs() <= rotation
        })
    }
}
