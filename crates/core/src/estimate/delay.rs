//! The delay of one source behind another, from the movement that both saw.

use std::time::Duration;

use super::Estimate;
use crate::time::Timestamp;

/// The smallest number of samples that both records have in common: 2 s.
const MIN_SAMPLES: usize = 400;

/// The interval at which both movements are sampled: finer than a camera, coarser than a fast glove.
const GRID: Duration = Duration::from_millis(5);

/// The longest part of both records that is compared, from the first time that they have in common: twice the longest measurement. The
/// clock of a file may jump by years.
const MAX_SPAN: Duration = Duration::from_secs(120);

/// The largest delay that is found, in either direction.
const MAX_DELAY: Duration = Duration::from_millis(500);

/// The lowest correlation of two records of one movement. Noise of independent sources correlates with less than 0.2.
const MIN_CORRELATION: f64 = 0.5;

/// The smallest peak speed of a record with a movement, in rad/s: well above tremor.
const MIN_SPEED: f64 = 0.5;

/// The speed of a movement over time: the sum of the speeds of all joints.
#[derive(Clone, Debug, Default)]
pub struct Activity {
    last: Option<Estimate>,
    /// Time in the middle of two estimates, and the speed between them, in rad/s.
    speeds: Vec<(Timestamp, f64)>,
}

/// The delay of one source behind another.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Delay {
    /// The delay in seconds; negative if the other source is behind.
    pub seconds: f64,
    /// The correlation of both movements at this delay, up to 1.
    pub correlation: f64,
}

/// The reason why two movements show no delay.
#[derive(Clone, Copy, Debug, PartialEq, thiserror::Error)]
pub enum DelayError {
    /// The records have less than two seconds in common.
    #[error("both sources have less than 2 s in common")]
    TooShort,
    /// One of the sources saw nothing move.
    #[error("the {} source saw no movement", if *.is_first { "first" } else { "second" })]
    NoMovement {
        /// `true` if it is the first source.
        is_first: bool,
    },
    /// The movements are not the same.
    #[error("the movements that both sources saw do not agree (correlation {correlation:.2})")]
    NoAgreement {
        /// The highest correlation.
        correlation: f64,
    },
}

impl Activity {
    /// Adds an estimate. Angles count in radians, and measured positions as angles at a lever of 0.3 m.
    pub fn push(&mut self, time: Timestamp, estimate: &Estimate) {
        if let Some(last) = &self.last
            && let elapsed = time.since(last.time)
            && !elapsed.is_zero()
        {
            let speed = change(last, estimate) / elapsed.as_secs_f64();
            self.speeds.push((last.time + elapsed / 2, speed));
        }
        self.last = Some(Estimate { time, ..*estimate });
    }

    /// Returns the largest speed, in rad/s.
    fn peak(&self) -> f64 {
        self.speeds
            .iter()
            .map(|(_, speed)| *speed)
            .fold(0.0, f64::max)
    }

    /// Returns the times of the first and of the last speed.
    fn span(&self) -> Option<(Timestamp, Timestamp)> {
        Some((self.speeds.first()?.0, self.speeds.last()?.0))
    }

    /// Returns `count` speeds from `start` on, interpolated.
    fn sampled(&self, start: Timestamp, count: usize) -> Vec<f64> {
        let mut index = 0;
        let sample = |step| {
            let time = start + GRID * step;
            while index + 2 < self.speeds.len() && self.speeds[index + 1].0 < time {
                index += 1;
            }
            let [(t0, v0), (t1, v1)] = [self.speeds[index], self.speeds[index + 1]];
            let span = t1.since(t0).as_secs_f64().max(1e-6);
            let t = (time.since(t0).as_secs_f64() / span).min(1.0);
            v0 + (v1 - v0) * t
        };
        (0..count as u32).map(sample).collect()
    }
}

/// Returns the sum of the changes of all joints, in radians.
fn change(before: &Estimate, after: &Estimate) -> f64 {
    const LEVER: f64 = 0.3;
    let angles = after.angles.known();
    let angles = angles.filter(|(dof, _)| before.angles.is_known(*dof));
    let angles: f64 = angles
        .map(|(dof, radians)| (radians - before.angles.get(dof)).abs())
        .sum();
    let positions = after.measured.iter();
    let positions = positions.filter_map(|(joint, position)| {
        let before = before.measured.get(joint)?;
        Some(f64::from(position.distance(before)) / LEVER)
    });
    angles + positions.sum::<f64>()
}

/// Returns the delay of `second` behind `first`: the shift at which the speeds of both correlate best, at most 0.5 s. Of longer records,
/// the first two minutes that they have in common count.
///
/// The method is the normalized cross-correlation, with a parabola through the highest value and its neighbors.
pub fn estimate_delay(first: &Activity, second: &Activity) -> Result<Delay, DelayError> {
    let (Some(a), Some(b)) = (first.span(), second.span()) else {
        return Err(DelayError::TooShort);
    };
    let (start, end) = (a.0.max(b.0), a.1.min(b.1));
    let span = end.since(start).min(MAX_SPAN);
    let count = (span.as_secs_f64() / GRID.as_secs_f64()) as usize;
    if count < MIN_SAMPLES {
        return Err(DelayError::TooShort);
    }
    for (activity, is_first) in [(first, true), (second, false)] {
        if activity.peak() < MIN_SPEED {
            return Err(DelayError::NoMovement { is_first });
        }
    }
    let (first, second) = (first.sampled(start, count), second.sampled(start, count));
    let longest = (MAX_DELAY.as_secs_f64() / GRID.as_secs_f64()) as isize;
    let correlations: Vec<f64> = (-longest..=longest)
        .map(|shift| correlation(&first, &second, shift))
        .collect();
    let best = (1..correlations.len() - 1)
        .max_by(|&one, &other| correlations[one].total_cmp(&correlations[other]));
    let best = best.expect("there are more than two shifts");
    let [left, peak, right] = [best - 1, best, best + 1].map(|index| correlations[index]);
    if peak < MIN_CORRELATION {
        return Err(DelayError::NoAgreement { correlation: peak });
    }
    let curvature = left - 2.0 * peak + right;
    let vertex = if curvature < 0.0 {
        (left - right) / (2.0 * curvature)
    } else {
        0.0
    };
    let shift = best as f64 - longest as f64 + vertex.clamp(-0.5, 0.5);
    Ok(Delay {
        seconds: shift * GRID.as_secs_f64(),
        correlation: peak,
    })
}

/// Returns the correlation of `first[i]` with `second[i + shift]`.
fn correlation(first: &[f64], second: &[f64], shift: isize) -> f64 {
    let skip = |lag: isize| lag.max(0) as usize;
    let count = first.len() - shift.unsigned_abs();
    let first = &first[skip(-shift)..][..count];
    let second = &second[skip(shift)..][..count];
    let mean = |values: &[f64]| values.iter().sum::<f64>() / count as f64;
    let (mean_first, mean_second) = (mean(first), mean(second));
    let (mut product, mut squares) = (0.0, [0.0; 2]);
    for (a, b) in first.iter().zip(second) {
        let (a, b) = (a - mean_first, b - mean_second);
        product += a * b;
        squares[0] += a * a;
        squares[1] += b * b;
    }
    let norm = (squares[0] * squares[1]).sqrt();
    if norm > 0.0 { product / norm } else { 0.0 }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::hand::{Dof, Joint, JointAngles};
    use parry3d::math::Vec3;

    /// Angle of a joint that moves irregularly, in radians.
    fn angle(seconds: f64) -> f64 {
        0.5 * (3.1 * seconds).sin() + 0.3 * (7.3 * seconds + 1.0).sin()
    }

    fn activity(rate_hz: f64, delay: f64, estimate: impl Fn(f64) -> Estimate) -> Activity {
        let mut activity = Activity::default();
        for index in 0..(10.0 * rate_hz) as u32 {
            let moved_at = f64::from(index) / rate_hz;
            let time = Timestamp::from_seconds(moved_at + 1.0 + delay);
            activity.push(time, &estimate(moved_at));
        }
        activity
    }

    fn glove(moved_at: f64) -> Estimate {
        let mut angles = JointAngles::default();
        angles.set(Dof::IndexMcpFlexion, angle(moved_at));
        Estimate::new(Timestamp(0), angles)
    }

    fn camera(moved_at: f64) -> Estimate {
        let mut estimate = Estimate::new(Timestamp(0), JointAngles::default());
        let height = 0.2 * angle(moved_at) as f32;
        estimate.measured.set(Joint::Wrist, Vec3::Y * height);
        estimate
    }

    #[test]
    fn the_delay_of_a_camera_behind_a_glove_is_found_to_3_ms() {
        for delay in [0.0, 0.012, 0.06, 0.31, 0.45] {
            let (fast, slow) = (activity(175.0, 0.0, glove), activity(30.0, delay, camera));
            let found = estimate_delay(&fast, &slow).unwrap();
            assert!((found.seconds - delay).abs() < 0.003, "{delay}: {found:?}");
            assert!(found.correlation > 0.9, "{found:?}");
            let behind = estimate_delay(&slow, &fast).unwrap();
            assert!(
                (behind.seconds + delay).abs() < 0.003,
                "{delay}: {behind:?}"
            );
        }
    }

    #[test]
    fn a_clock_that_jumps_by_a_year_leaves_the_movement_before_it() {
        let delay = 0.06;
        let (mut fast, mut slow) = (activity(175.0, 0.0, glove), activity(30.0, delay, camera));
        let year = Duration::from_secs(365 * 86_400);
        for (record, estimate) in [(&mut fast, glove(10.0)), (&mut slow, camera(10.0))] {
            record.push(Timestamp::from_seconds(11.0 + delay) + year, &estimate);
        }
        let found = estimate_delay(&fast, &slow).unwrap();
        assert!((found.seconds - delay).abs() < 0.003, "{found:?}");
    }

    #[test]
    fn records_without_a_common_movement_show_no_delay() {
        let fast = activity(175.0, 0.0, glove);
        let still = activity(30.0, 0.0, |_| camera(0.0));
        let error = estimate_delay(&fast, &still).unwrap_err();
        assert_eq!(error, DelayError::NoMovement { is_first: false });
        let other = activity(30.0, 0.0, |moved_at| camera((moved_at * 7.9).powi(2)));
        let disagreement = estimate_delay(&fast, &other).unwrap_err();
        assert!(
            matches!(disagreement, DelayError::NoAgreement { .. }),
            "{disagreement}"
        );
        let late = activity(175.0, 9.0, glove);
        assert_eq!(estimate_delay(&fast, &late), Err(DelayError::TooShort));
        assert_eq!(
            estimate_delay(&Activity::default(), &fast),
            Err(DelayError::TooShort)
        );
    }
}
