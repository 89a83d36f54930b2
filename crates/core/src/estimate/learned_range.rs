//! Learning of a sensor's range: a warm or slipped sensor goes beyond the range of its calibration.
//!
//! A joint does not bend further than it did in the calibration. If a channel stays beyond the calibrated range for a while and
//! comes back, its range has become wider: the ends of the wider range are then the angles that the ends of the calibrated range
//! were. One such excursion widens the range by a small step only, so that neither a spike nor a loose contact moves it far.

use std::time::Duration;

use super::{AffineMap, CountRange, Linearity};
use crate::hand::Dof;
use crate::time::Timestamp;

/// The largest widening of one end, as a fraction of the calibrated range. A sensor that goes further is broken.
const MAX_WIDENING: f64 = 0.15;

/// The widening that one excursion gives, as a fraction of the calibrated range: 1° of a finger joint.
const STEP: f64 = 0.01;

/// The distance beyond an end that is not an excursion, as a fraction of the calibrated range: noise, and the difference between
/// two stretches of one hand.
const TOLERANCE: f64 = 0.015;

/// The time for which a channel must stay beyond an end. No movement of typing lasts as long.
const MIN_HOLD: Duration = Duration::from_millis(500);

/// Minimum number of readings of an excursion: a slow source must not pass with one spike.
const MIN_READINGS: u32 = 10;

/// The longest excursion. Hands do not stretch for longer; a sensor that does is stuck.
const MAX_HOLD: Duration = Duration::from_secs(10);

/// A channel whose range was widened.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct LearnedRange {
    /// The index of the channel.
    pub channel: usize,
    /// The first joint that it measures.
    pub dof: Dof,
    /// The widening at the low end, as a fraction of the calibrated range.
    pub below: f64,
    /// The widening at the high end.
    pub above: f64,
}

impl LearnedRange {
    /// Returns the larger of both widenings.
    pub fn largest(&self) -> f64 {
        self.below.max(self.above)
    }

    /// Returns the map from linear counts of the wider range to the calibrated range, whose ends are `low` and `high`.
    pub(super) fn correction(&self, (low, high): CountRange) -> AffineMap {
        let gain = 1.0 / (1.0 + self.below + self.above);
        let new_low = low - self.below * (high - low);
        AffineMap {
            gain,
            offset: low - gain * new_low,
        }
    }
}

/// The detection of excursions of one channel.
#[derive(Clone, Debug)]
pub(super) struct RangeLearner {
    learned: LearnedRange,
    linearity: Linearity,
    /// The ends of the calibrated range, in linear counts.
    ends: CountRange,
    excursion: Option<Excursion>,
    /// Ends, low and high, that were exceeded and wait to be widened.
    is_due: [bool; 2],
    /// `true` if the channel had a fault. It may be another sensor now, as after an exchange of plugs.
    had_fault: bool,
}

/// Readings beyond one end.
#[derive(Clone, Copy, Debug)]
struct Excursion {
    end: RangeEnd,
    since: Timestamp,
    latest: Timestamp,
    readings: u32,
}

#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum RangeEnd {
    Low,
    High,
}

impl RangeLearner {
    /// Creates the learner of a channel whose calibrated range is `counts`.
    pub(super) fn new(
        channel: usize,
        dof: Dof,
        linearity: Linearity,
        (low, high): CountRange,
    ) -> Self {
        Self {
            learned: LearnedRange {
                channel,
                dof,
                below: 0.0,
                above: 0.0,
            },
            linearity,
            ends: (linearity.apply(low), linearity.apply(high)),
            excursion: None,
            is_due: [false; 2],
            had_fault: false,
        }
    }

    /// Returns what was learned.
    pub(super) fn learned(&self) -> &LearnedRange {
        &self.learned
    }

    /// Returns the map from linear counts to the calibrated range.
    pub(super) fn correction(&self) -> AffineMap {
        self.learned.correction(self.ends)
    }

    /// Returns `true` if an excursion waits to widen the range.
    pub(super) fn is_due(&self) -> bool {
        self.is_due.contains(&true)
    }

    /// Adds the count of an accepted reading.
    pub(super) fn observe(&mut self, time: Timestamp, count: f64) {
        if self.had_fault {
            return;
        }
        let (low, high) = self.ends;
        let fraction = (self.linearity.apply(count) - low) / (high - low);
        let (below, above) = (-fraction, fraction - 1.0);
        if below.max(above) > MAX_WIDENING + TOLERANCE {
            self.excursion = None;
            return;
        }
        let end = if below > self.learned.below + TOLERANCE {
            Some(RangeEnd::Low)
        } else if above > self.learned.above + TOLERANCE {
            Some(RangeEnd::High)
        } else {
            None
        };
        match (&mut self.excursion, end) {
            (Some(excursion), Some(end)) if excursion.end == end => {
                excursion.latest = time;
                excursion.readings = excursion.readings.saturating_add(1);
            }
            (_, Some(end)) => self.excursion = Some(Excursion::new(end, time)),
            (_, None) => {
                // The channel came back, which a stuck sensor does not.
                if let Some(excursion) = self.excursion.take_if(|excursion| excursion.is_stretch())
                {
                    self.is_due[excursion.end as usize] = true;
                }
                self.excursion = None;
            }
        }
    }

    /// Discards the present excursion: the reading does not show the joint.
    pub(super) fn interrupt(&mut self) {
        self.excursion = None;
    }

    /// Discards what was observed and not learned yet.
    pub(super) fn forget(&mut self) {
        self.excursion = None;
        self.is_due = [false; 2];
    }

    /// Ends the learning of the channel, because its sensor has a fault.
    pub(super) fn note_fault(&mut self) {
        self.forget();
        self.had_fault = true;
    }

    /// Widens the ends that are due by one step.
    pub(super) fn widen(&mut self) {
        let widenings = [&mut self.learned.below, &mut self.learned.above];
        for (widening, is_due) in widenings.into_iter().zip(&mut self.is_due) {
            if std::mem::take(is_due) {
                *widening = (*widening + STEP).min(MAX_WIDENING);
            }
        }
    }

    /// Returns to the calibrated range.
    pub(super) fn undo(&mut self) {
        self.forget();
        self.learned.below = 0.0;
        self.learned.above = 0.0;
    }
}

impl Excursion {
    fn new(end: RangeEnd, time: Timestamp) -> Self {
        Self {
            end,
            since: time,
            latest: time,
            readings: 1,
        }
    }

    /// Returns `true` if a hand that stretches or makes a fist explains the excursion.
    fn is_stretch(&self) -> bool {
        let held = self.latest.since(self.since);
        (MIN_HOLD..=MAX_HOLD).contains(&held) && self.readings >= MIN_READINGS
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// The time between two readings.
    const PERIOD: u64 = 20_000;

    fn learner() -> RangeLearner {
        let linearity = Linearity::new(0.0, 255);
        RangeLearner::new(3, Dof::IndexPipFlexion, linearity, (50.0, 150.0))
    }

    /// Feeds pairs of a count and a number of readings, widens after each pair, and returns the widenings in percent.
    fn learn(learner: &mut RangeLearner, counts: &[(f64, u64)]) -> (i32, i32) {
        let mut time = Timestamp(0);
        for &(count, readings) in counts {
            for _ in 0..readings {
                time.0 += PERIOD;
                learner.observe(time, count);
            }
            learner.widen();
        }
        let percent = |fraction: f64| (100.0 * fraction).round() as i32;
        (
            percent(learner.learned.below),
            percent(learner.learned.above),
        )
    }

    #[test]
    fn a_channel_that_stays_beyond_its_range_and_comes_back_widens_it_by_a_step() {
        for (counts, expected) in [
            (&[(100.0, 50), (158.0, 50), (100.0, 1)][..], (0, 1)),
            (&[(100.0, 50), (40.0, 50), (100.0, 1)], (1, 0)),
            (&[(40.0, 50), (158.0, 50), (100.0, 1)], (0, 1)),
        ] {
            assert_eq!(learn(&mut learner(), counts), expected, "{counts:?}");
        }
    }

    #[test]
    fn spikes_stuck_sensors_and_excursions_that_no_drift_explains_teach_nothing() {
        for counts in [
            // A spike, and a stroke of typing.
            &[(100.0, 50), (158.0, 1), (100.0, 50)][..],
            &[(100.0, 50), (158.0, 20), (100.0, 50)],
            // Within the tolerance.
            &[(100.0, 50), (151.0, 50), (100.0, 50)],
            // Stuck for good, and for a minute.
            &[(100.0, 50), (158.0, 5_000)],
            &[(100.0, 50), (158.0, 3_000), (100.0, 50)],
            // Further than a drift goes.
            &[(100.0, 50), (190.0, 50), (100.0, 50)],
            &[
                (100.0, 50),
                (158.0, 40),
                (190.0, 1),
                (158.0, 10),
                (100.0, 50),
            ],
        ] {
            assert_eq!(learn(&mut learner(), counts), (0, 0), "{counts:?}");
        }
        let mut slow = learner();
        for (second, count) in [100.0, 158.0, 158.0, 100.0].into_iter().enumerate() {
            slow.observe(Timestamp(400_000 * (second as u64 + 1)), count);
        }
        assert!(!slow.is_due(), "two readings are not a stretch");
    }

    #[test]
    fn a_range_widens_to_the_present_one_but_not_beyond_the_limit() {
        let stretch = [(100.0, 50), (158.0, 50)];
        let mut own = learner();
        assert_eq!(
            learn(&mut own, &stretch.repeat(40)),
            (0, 7),
            "8 % less 1.5 %"
        );
        let end = own.correction().apply(157.0);
        assert!((end - 150.0).abs() < 1e-9, "{end}");
        assert!((own.correction().apply(50.0) - 50.0).abs() < 1e-9);
        let mut far = learner();
        let wide_stretch = [(100.0, 50), (166.4, 50)];
        assert_eq!(learn(&mut far, &wide_stretch.repeat(40)), (0, 15));
        far.undo();
        assert_eq!(far.correction(), AffineMap::IDENTITY);
    }

    #[test]
    fn a_channel_with_a_fault_teaches_nothing_for_the_rest_of_the_run() {
        let mut learner = learner();
        learner.note_fault();
        let stretch = [(100.0, 50), (158.0, 50)];
        assert_eq!(learn(&mut learner, &stretch.repeat(5)), (0, 0));
    }
}
