//! The estimator: converts readings to plausible, smooth joint angles.

use std::time::Duration;

use parry3d::math::Vec3;

use super::hysteresis::HysteresisCompensation;
use super::plausibility::{Implausible, Plausibility};
use super::position_filter::PositionFilter;
use super::repeated_positions::RepeatedPositions;
use super::samples::{ChannelConverter, SampleConverter};
use super::smoothing::Smoother;
use super::tip_speed::{TipSpeed, Tips};
use super::zero::{Zero, ZeroError, Zeroed};
use super::{BendRanges, ChannelMap, Estimate, EstimatorSettings, LearnedRange, Rejection};
use crate::capture::{Reading, Sample, SampleKind};
use crate::hand::{BodyPoint, Displacement, Dof, Joint, JointAngles};
use crate::time::Timestamp;

/// The number of consecutive readings, each plausible after the previous one, after which an implausible jump is
/// accepted.
const CONSISTENT_READINGS: u8 = 3;

/// A rotation that is always plausible, in radians: a busy machine delivers readings in bursts, so the
/// measured time between two readings can be far too short.
const MIN_PLAUSIBLE_ROTATION: f64 = 0.3;

/// The highest speed of a measured joint that moves with the whole hand, in m/s: faster than a fast reach, so that a
/// tracker that takes one hand for the other is noticed.
const MAX_HAND_SPEED: f64 = 4.0;

/// A distance that is always plausible, in metres, for the same reason.
const MIN_PLAUSIBLE_DISTANCE: f64 = 0.09;

/// The estimator of one hand. It accepts samples of every kind; those with sensor channels need a
/// [channel map](Self::with_channels).
#[derive(Clone, Debug)]
pub struct Estimator {
    settings: EstimatorSettings,
    converter: SampleConverter,
    smoother: Smoother,
    hysteresis: HysteresisCompensation,
    position_filter: Option<PositionFilter>,
    /// The estimate of the latest reading, updated in place because it is too large to move for every reading.
    estimate: Estimate,
    /// The last accepted angles, before the filter.
    last: Option<RawAngles>,
    /// An implausible jump, and the number of consecutive readings that agree with it.
    candidate: Option<(RawAngles, u8)>,
    tip_speed: TipSpeed,
    repeated_positions: RepeatedPositions,
    plausibility: Plausibility,
    zero: Zero,
    /// `true` if the meaning of the counts has changed since the latest reading, so that the next estimate jumps.
    has_jumped: bool,
    /// `true` if the sensor measures joint angles.
    measures_angles: bool,
    bend_ranges: BendRanges,
}

/// The angles of one reading before the filter.
#[derive(Clone, Copy, Debug)]
struct RawAngles {
    time: Timestamp,
    angles: JointAngles,
    anchor: Option<Anchor>,
    /// The measured fingertips, relative to the anchor.
    tips: Tips,
}

/// A measured joint that moves with the whole hand: the wrist, else the first joint, else the displaced one.
type Anchor = (Joint, Vec3);

fn anchor(estimate: &Estimate) -> Option<Anchor> {
    let wrist = estimate.measured.get(Joint::Wrist);
    let wrist = wrist.map(|position| (Joint::Wrist, position));
    let displaced = |displacement: Displacement| (displacement.joint, displacement.translation());
    wrist
        .or_else(|| estimate.measured.iter().next())
        .or_else(|| estimate.displacement.map(displaced))
}

impl Estimator {
    /// Creates an estimator for samples that need no channel map.
    pub fn new(settings: EstimatorSettings) -> Self {
        Self {
            settings,
            converter: SampleConverter::new(),
            smoother: Smoother::new(settings.smoothing),
            hysteresis: HysteresisCompensation::default(),
            position_filter: settings.position_smoothing.map(PositionFilter::new),
            estimate: Estimate::new(Timestamp::default(), JointAngles::default()),
            last: None,
            candidate: None,
            tip_speed: TipSpeed::default(),
            repeated_positions: RepeatedPositions::default(),
            plausibility: Plausibility::default(),
            zero: Zero::new(settings.rest_pose),
            has_jumped: false,
            measures_angles: false,
            bend_ranges: BendRanges::human(),
        }
    }

    /// Sets the channel map of a glove, for samples of sensor channels.
    #[must_use]
    pub fn with_channels(mut self, map: &ChannelMap) -> Self {
        self.converter.set_channel_map(map, &self.settings);
        self.bend_ranges = BendRanges::of_glove(map);
        self.hysteresis = HysteresisCompensation::new(map);
        self
    }

    /// Returns the angles at which the fingers are straight and closed.
    pub fn bend_ranges(&self) -> &BendRanges {
        &self.bend_ranges
    }

    /// Returns the position of a point of the body in the latest accepted reading, in metres in the frame of the hand; `None` if it
    /// was not measured.
    pub fn body_point(&self, point: BodyPoint) -> Option<Vec3> {
        match point {
            BodyPoint::Shoulder => self.estimate.measured.get(Joint::Shoulder),
            BodyPoint::Head | BodyPoint::Hip => self.converter.body_points().get(point),
        }
    }

    /// Returns `true` if the source sends, but does not show the arm.
    pub(super) fn has_lost_arm(&self) -> bool {
        self.converter.has_lost_arm()
    }

    /// Returns `true` if the source has repeated all positions of the hand exactly for more than 5 s, so that it is not known where the
    /// hand is.
    pub(super) fn is_stuck(&self) -> bool {
        self.repeated_positions.is_stuck()
    }

    /// Converts a reading. A rejected reading does not change the filters. Does not allocate.
    pub fn update(&mut self, reading: &Reading) -> Result<&Estimate, Rejection> {
        let gap = self.gap(reading.time)?;
        let judged = self.judge(reading);
        let outcome = judged.as_ref().map(|_| ()).map_err(|reason| *reason);
        self.plausibility.update(reading.time, outcome);
        let (anchor, mut tips) = judged?;
        self.plausibility.distrust(&mut self.estimate);
        tips.remove(self.estimate.untrusted);
        let was_unseen = self.estimate.jumped || gap > self.settings.max_gap;
        self.estimate.jumped |= std::mem::take(&mut self.has_jumped);
        let is_seen = self.estimate.is_placed && !self.has_lost_arm();
        let was_repeated = self.repeated_positions.push(&self.estimate, is_seen);
        self.estimate.is_after_gap |= was_repeated;
        self.estimate.misses_bends |= was_repeated;
        let is_interrupted = was_unseen || self.estimate.jumped || was_repeated;
        if is_interrupted || !self.has_same_dofs() {
            self.smoother.reset();
        }
        match &mut self.last {
            // In place: an assignment of the whole copies the angles twice.
            Some(last) => last.set(&self.estimate, anchor, tips),
            none => *none = Some(RawAngles::new(&self.estimate, anchor, tips)),
        }
        let angles = &mut self.estimate.angles;
        self.smoother.filter(angles, gap.as_secs_f64());
        if self.estimate.jumped {
            self.hysteresis.reset();
        }
        self.hysteresis.apply(angles);
        if let Some(limits) = &self.settings.limits {
            limits.clamp_all(angles);
        }
        if let Some(filter) = &mut self.position_filter {
            if is_interrupted {
                filter.reset();
            }
            filter.filter(&mut self.estimate.measured, gap.as_secs_f64());
        }
        if is_interrupted {
            self.zero.reset();
        }
        self.measures_angles = matches!(
            reading.sample.kind(),
            SampleKind::Channels | SampleKind::Angles
        );
        let estimate = &self.estimate;
        self.zero
            .update(estimate.time, &estimate.angles, estimate.untrusted);
        self.observe_ranges(reading, was_unseen);
        Ok(&self.estimate)
    }

    /// Converts a reading to an estimate, without the angles that are unreliable, and rejects it if it is not plausible after the
    /// previous one. Returns the measured position of the hand and the measured fingertips.
    fn judge(&mut self, reading: &Reading) -> Result<(Option<Anchor>, Tips), Rejection> {
        self.estimate.reset(reading.time);
        self.converter.convert(
            reading,
            &self.settings,
            self.zero.offsets(),
            &mut self.plausibility,
            &mut self.estimate,
        )?;
        self.remove_unreliable();
        let anchor = anchor(&self.estimate);
        let tips = Tips::measured(&self.estimate, anchor.map(|(_, position)| position));
        self.estimate.jumped |= self.check_speed(anchor, &tips)?;
        Ok((anchor, tips))
    }

    fn remove_unreliable(&mut self) {
        let seconds = self.estimate.time.since(self.plausibility.time());
        let reach = self.settings.max_speed.map_or(f64::INFINITY, |max_speed| {
            plausible_rotation(max_speed, seconds.as_secs_f64())
        });
        self.plausibility
            .remove_unreliable(reach, &mut self.estimate.angles);
    }

    /// Returns the parts of the hand that are not trusted because their readings are implausible.
    pub fn implausible(&self) -> Implausible {
        self.plausibility.implausible()
    }

    /// Returns the sensor channel that measures an angle, if a glove does.
    pub fn channel_of(&self, dof: Dof) -> Option<usize> {
        self.converter.channels()?.channel_of(dof)
    }

    /// Adds an accepted reading to the learning of ranges. If the hand was not seen before the reading, its movement is unknown, and
    /// all excursions are forgotten. A jump after a change of ranges does not count as such.
    fn observe_ranges(&mut self, reading: &Reading, was_unseen: bool) {
        let (Sample::Channels(channels), Some(converter)) =
            (&reading.sample, self.converter.channels_mut())
        else {
            return;
        };
        if was_unseen {
            converter.forget_excursions();
        }
        let unreliable = self.plausibility.implausible().angles;
        converter.observe_ranges(reading.time, channels, unreliable);
    }

    /// Returns `true` if a sensor has been beyond its range, so that [`widen_ranges`](Self::widen_ranges) changes something.
    pub fn is_widening_due(&self) -> bool {
        let converter = self.converter.channels();
        converter.is_some_and(ChannelConverter::is_widening_due)
    }

    /// Widens the ranges of sensors that have been beyond them, each by 1 % of the calibrated one. The next estimate jumps. Does
    /// not allocate.
    pub fn widen_ranges(&mut self) {
        self.change_ranges(ChannelConverter::widen_ranges);
    }

    /// Returns to the calibrated ranges. The next estimate jumps.
    pub fn undo_learning(&mut self) {
        self.change_ranges(ChannelConverter::undo_learning);
    }

    /// Discards the excursions that were observed and have not widened a range yet.
    pub fn forget_excursions(&mut self) {
        if let Some(converter) = self.converter.channels_mut() {
            converter.forget_excursions();
        }
    }

    /// Iterates over the ranges that were widened.
    pub fn learned_ranges(&self) -> impl Iterator<Item = LearnedRange> {
        let converter = self.converter.channels().into_iter();
        converter.flat_map(ChannelConverter::learned_ranges)
    }

    fn change_ranges(&mut self, change: impl FnOnce(&mut ChannelConverter)) {
        if let Some(converter) = self.converter.channels_mut() {
            change(converter);
            self.candidate = None;
            self.has_jumped = true;
        }
    }

    /// Turns the present angles into the [rest pose](EstimatorSettings::rest_pose), by offsets that last until
    /// [`undo_zero`](Self::undo_zero). The next estimate jumps. Refused unless the hand is still.
    pub fn zero(&mut self) -> Result<(), ZeroError> {
        if !self.measures_angles {
            return Err(ZeroError::NoAngles);
        }
        let changes = self.zero.zero()?;
        self.shift(&changes);
        Ok(())
    }

    /// Adopts the offsets of [`zero`](Self::zero) from the estimator that this one replaces. The next estimate jumps.
    pub(super) fn adopt_zero(&mut self, previous: &Self) {
        self.zero.adopt_offsets(&previous.zero);
        self.has_jumped = true;
    }

    /// Removes the offsets of [`zero`](Self::zero). The next estimate jumps.
    pub fn undo_zero(&mut self) -> Result<(), ZeroError> {
        let changes = self.zero.undo()?;
        self.shift(&changes);
        Ok(())
    }

    /// Returns the effect of [`zero`](Self::zero), if there is one.
    pub fn zeroed(&self) -> Option<Zeroed> {
        self.zero.zeroed()
    }

    /// Applies a change of the offsets to the last angles, so that the next ones are not taken for a movement.
    fn shift(&mut self, changes: &JointAngles) {
        if let Some(last) = &mut self.last {
            for (dof, change) in changes.known() {
                if last.angles.is_known(dof) {
                    last.angles.set(dof, last.angles.get(dof) + change);
                }
            }
        }
        self.candidate = None;
        self.has_jumped = true;
    }

    /// Returns the time since the last accepted reading, or zero at the first.
    fn gap(&self, time: Timestamp) -> Result<Duration, Rejection> {
        match &self.last {
            Some(last) if time <= last.time => Err(Rejection::OutOfOrder),
            Some(last) => Ok(time.since(last.time)),
            None => Ok(Duration::ZERO),
        }
    }

    fn has_same_dofs(&self) -> bool {
        let last = self.last.as_ref();
        last.is_none_or(|last| last.angles.has_same_dofs(&self.estimate.angles))
    }

    /// Returns `true` if the hand was re-acquired at another position; an error until consecutive readings agree on it.
    fn check_speed(&mut self, anchor: Option<Anchor>, tips: &Tips) -> Result<bool, Rejection> {
        let (Some(max_speed), Some(last)) = (self.settings.max_speed, &self.last) else {
            return Ok(false);
        };
        if self.estimate.jumped {
            self.tip_speed.reset();
        }
        // The time of rejected readings does not extend the plausible rotation.
        let previous = self
            .candidate
            .as_ref()
            .map_or(last.time, |(candidate, _)| candidate.time);
        let estimate = &self.estimate;
        let seconds = estimate.time.since(previous).as_secs_f64();
        let reach = Reach {
            rotation: plausible_rotation(max_speed, seconds),
            distance: (MAX_HAND_SPEED * seconds).max(MIN_PLAUSIBLE_DISTANCE),
        };
        if last.is_within(&reach, &estimate.angles, anchor, tips) {
            self.candidate = None;
            if !tips.is_empty() {
                let beyond = self
                    .tip_speed
                    .update(tips, reach.rotation, CONSISTENT_READINGS);
                self.estimate.untrusted = self.estimate.untrusted.union(beyond);
            }
            return Ok(false);
        }
        if tips.is_empty() {
            self.plausibility
                .note_jumps(reach.rotation, &estimate.angles, &last.angles);
        }
        let agreeing = match &self.candidate {
            Some((candidate, count))
                if candidate.is_within(&reach, &estimate.angles, anchor, tips) =>
            {
                count + 1
            }
            _ => 1,
        };
        if agreeing < CONSISTENT_READINGS {
            self.candidate = Some((RawAngles::new(estimate, anchor, *tips), agreeing));
            return Err(Rejection::TooFast);
        }
        self.candidate = None;
        self.tip_speed.reset();
        Ok(true)
    }
}

/// Returns the largest plausible rotation of a joint in `seconds`, in radians.
fn plausible_rotation(max_speed: f64, seconds: f64) -> f64 {
    (max_speed * seconds).max(MIN_PLAUSIBLE_ROTATION)
}

/// The largest plausible change from one reading to another.
struct Reach {
    /// The change of each angle, in radians.
    rotation: f64,
    /// The change of a measured position, in metres.
    distance: f64,
}

impl RawAngles {
    fn new(estimate: &Estimate, anchor: Option<Anchor>, tips: Tips) -> Self {
        Self {
            time: estimate.time,
            angles: estimate.angles,
            anchor,
            tips,
        }
    }

    fn set(&mut self, estimate: &Estimate, anchor: Option<Anchor>, tips: Tips) {
        self.time = estimate.time;
        self.angles = estimate.angles;
        self.anchor = anchor;
        self.tips = tips;
    }

    /// Returns `true` if neither the measured position of a later reading nor an angle is out of reach. Positions and angles
    /// that only one of both readings has do not count.
    ///
    /// Of measured fingertips at least one must be within reach. Their angles do not count: the angles of a straight finger
    /// change much when its measured length changes little.
    fn is_within(
        &self,
        reach: &Reach,
        angles: &JointAngles,
        anchor: Option<Anchor>,
        tips: &Tips,
    ) -> bool {
        let distance = match (anchor, self.anchor) {
            (Some((joint, now)), Some((same, before))) if joint == same => now.distance(before),
            _ => 0.0,
        };
        let is_turned = if self.tips.is_empty() || tips.is_empty() {
            !angles.is_within(reach.rotation, &self.angles)
        } else {
            self.tips.are_all_out_of_reach(tips, reach.rotation)
        };
        f64::from(distance) <= reach.distance && !is_turned
    }
}
