//! From sensor channels to joint angles that can be believed.

use std::time::Duration;

use super::channels::ChannelMap;
use super::limits::JointLimits;
use super::rows::{Row, Wire, prepare};
use super::smoothing::{Smoother, Smoothing};
use super::{JointAngles, Rejection};
use crate::capture::{Channels, Reading, Sample};
use crate::hand::{Dof, FingerSet};
use crate::time::Timestamp;

/// The most rows a channel map can have: two for each degree of freedom is more than any glove needs.
pub const MAX_ROWS: usize = 2 * Dof::COUNT;

/// Readings in a row, each near the one before, after which a place that the hand cannot have
/// reached is believed all the same.
const CONSISTENT_READINGS: u8 = 3;

/// A turn that is always possible, in radians: a busy machine hands readings over in bunches, so that the
/// time between two of them can come out far too short.
const MIN_REACH: f64 = 0.3;

/// What the estimator lets pass.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct EstimatorSettings {
    /// The filter.
    pub smoothing: Smoothing,
    /// Ranges of the joints; `None` lets every finite angle pass.
    pub limits: Option<JointLimits>,
    /// The fastest that a joint turns, in rad/s; `None` lets every step pass.
    pub max_speed: Option<f64>,
    /// A gap between two readings after which the filters start anew.
    pub max_gap: Duration,
    /// How long a channel may stay at one end of its range before its fingers are not believed
    /// any more: a broken wire or a short circuit; `None` believes it for ever.
    pub rail_timeout: Option<Duration>,
}

impl Default for EstimatorSettings {
    /// Human limits; 40 rad/s, twice the fastest finger flexion; filters start anew after 0.5 s; a
    /// channel is given up after 1 s.
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
    /// Only the arithmetic: every finite angle passes, at any speed.
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

/// Turns the counts of a glove into joint angles.
#[derive(Clone, Debug)]
pub struct Estimator {
    full_scale: u16,
    channels_needed: usize,
    rows: Vec<Row>,
    channel_health: Vec<Wire>,
    settings: EstimatorSettings,
    smoother: Smoother,
    last: Option<Measured>,
    candidate: Option<(Measured, u8)>,
}

/// The angles of all rows as measured, before the filter.
#[derive(Clone, Copy, Debug)]
struct Measured {
    time: Timestamp,
    rows: [f64; MAX_ROWS],
}

impl Estimator {
    /// An estimator that has seen nothing yet.
    ///
    /// # Panics
    /// When the map has more than [`MAX_ROWS`] rows.
    pub fn new(map: ChannelMap, settings: EstimatorSettings) -> Self {
        assert!(map.rows().len() <= MAX_ROWS, "at most {MAX_ROWS} rows");
        let (rows, wires) = prepare(&map, settings.limits.as_ref());
        Self {
            smoother: Smoother::new(settings.smoothing, rows.len()),
            channels_needed: map.required_channels(),
            full_scale: map.full_scale(),
            rows,
            channel_health: wires,
            settings,
            last: None,
            candidate: None,
        }
    }

    /// The angles that a reading tells, or why it tells none; then nothing is remembered of it.
    pub fn update(&mut self, reading: &Reading) -> Result<JointAngles, Rejection> {
        let Sample::Channels(channels) = &reading.sample;
        if !self.fits(channels) {
            return Err(Rejection::WrongShape);
        }
        let time = reading.time;
        let last_time = self.last.as_ref().map(|last| last.time);
        if last_time.is_some_and(|last| time <= last) {
            return Err(Rejection::Stale);
        }
        let untrusted = self.watch_wires(time, channels);
        let measured = self.measure(time, channels)?;
        let jumped = self.check_speed(&measured)?;
        let gap = last_time.map_or(Duration::ZERO, |last| time.since(last));
        if jumped || gap > self.settings.max_gap {
            self.smoother.reset();
        }
        let measured = self.last.insert(measured);
        let rows = self.rows.len();
        let mut smooth = measured.rows;
        let seconds = gap.as_secs_f64();
        self.smoother
            .smooth(&mut smooth[..rows], &self.rows, channels, seconds);
        let mut angles = JointAngles::new(time);
        angles.untrusted = untrusted;
        angles.jumped = jumped;
        for (row, smooth) in self.rows.iter().zip(smooth) {
            angles.set(row.dof, row.range.clamp(smooth));
        }
        Ok(angles)
    }

    fn fits(&self, channels: &Channels) -> bool {
        channels.full_scale == self.full_scale && channels.counts.len() >= self.channels_needed
    }

    /// Gives the fingers that hang on a dead wire.
    fn watch_wires(&mut self, time: Timestamp, channels: &Channels) -> FingerSet {
        let mut untrusted = FingerSet::NONE;
        let Some(limit) = self.settings.rail_timeout else {
            return untrusted;
        };
        for wire in &mut self.channel_health {
            wire.watch(time, channels, limit);
            if wire.is_dead {
                untrusted = untrusted.union(wire.fingers);
            }
        }
        untrusted
    }

    fn measure(&self, time: Timestamp, channels: &Channels) -> Result<Measured, Rejection> {
        let mut rows = [0.0; MAX_ROWS];
        for (row, angle) in self.rows.iter().zip(&mut rows) {
            let measured = row.calibration.apply(row.count(channels));
            *angle = match row.range.admit(measured) {
                _ if !measured.is_finite() => return Err(Rejection::NotFinite),
                Some(admitted) => admitted,
                None if self.channel_health[row.health].is_dead => row.range.clamp(measured),
                None => return Err(Rejection::OutsideLimits),
            };
        }
        Ok(Measured { time, rows })
    }

    /// Whether the hand was re-acquired in a new place; an error while that is not sure.
    fn check_speed(&mut self, measured: &Measured) -> Result<bool, Rejection> {
        let (Some(max_speed), Some(last)) = (self.settings.max_speed, &self.last) else {
            return Ok(false);
        };
        let rows = self.rows.len();
        // Readings that were not believed give the hand no time to get anywhere.
        let before = self
            .candidate
            .as_ref()
            .map_or(last.time, |(before, _)| before.time);
        let reach = max_speed * measured.time.since(before).as_secs_f64();
        let is_near = |from: &Measured| from.is_within(reach.max(MIN_REACH), measured, rows);
        if is_near(last) {
            self.candidate = None;
            return Ok(false);
        }
        let agreeing = match &self.candidate {
            Some((before, count)) if is_near(before) => count + 1,
            _ => 1,
        };
        if agreeing < CONSISTENT_READINGS {
            self.candidate = Some((*measured, agreeing));
            return Err(Rejection::TooFast);
        }
        self.candidate = None;
        Ok(true)
    }
}

impl Measured {
    /// Whether no row is more than `reach` (radians) away in `other`.
    fn is_within(&self, reach: f64, other: &Self, rows: usize) -> bool {
        let mut pairs = self.rows[..rows].iter().zip(&other.rows[..rows]);
        pairs.all(|(from, to)| (to - from).abs() <= reach)
    }
}
