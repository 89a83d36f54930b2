//! Gestures of one hand and their detection.

use std::time::Duration;

use super::trusted_hand::TrustedHand;
use crate::hand::{Dof, Finger, Input};
use crate::time::Timestamp;

/// Difference of the off threshold of a flexion from its on threshold, in radians: 10°.
const FLEXION_OFF: f32 = 0.174_533;
/// Difference of the near threshold of a flexion from its on threshold, in radians: 20°.
const FLEXION_NEAR: f32 = 0.349_066;

/// The values at which an input of the glove switches on and off.
const INPUT_ON: f32 = 0.5;
const INPUT_OFF: f32 = 0.4;

/// Time for which a near gesture holds the pointer: a hand whose fingers rest close together does not hold
/// it for longer.
const NEAR_TIME: Duration = Duration::from_millis(300);

/// A gesture that can be held.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Gesture {
    /// The fingertips of the thumb and of this finger meet; not the thumb itself.
    Pinch(Finger),
    /// A joint is bent by this angle, in radians; negative for the other direction. Off 10° before.
    Flexion(Dof, f32),
    /// A trigger or button of the glove is held.
    Input(Input),
}

/// The distances between two fingertip centers in a pinch, in metres: `on < off < near`.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct PinchGaps {
    /// A pinch switches on at this distance or less.
    pub on: f32,
    /// A pinch switches off at more than this distance.
    pub off: f32,
    /// A pinch is near at less than this distance.
    pub near: f32,
}

impl Default for PinchGaps {
    /// 25, 30 and 45 mm. The first two are the values of the Ultraleap tracking plug-in. With the third, a
    /// hand that closes at 200 mm/s is near 100 ms before it is on.
    fn default() -> Self {
        Self {
            on: 0.025,
            off: 0.030,
            near: 0.045,
        }
    }
}

/// Thresholds of a measurement that increases with a gesture: `near <= off < on`.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Thresholds {
    pub(super) near: f32,
    pub(super) off: f32,
    pub(super) on: f32,
}

impl Gesture {
    /// Returns a measurement that increases with the gesture; `None` if it is unknown.
    pub(super) fn measurement(self, hand: &TrustedHand) -> Option<f32> {
        match self {
            Self::Pinch(finger) => {
                let gap = hand.tip(Finger::Thumb)?.distance(hand.tip(finger)?);
                Some(-gap)
            }
            Self::Flexion(dof, angle) => Some(hand.angle(dof)? * angle.signum()),
            Self::Input(input) => hand.input(input),
        }
    }

    pub(super) fn thresholds(self, gaps: PinchGaps) -> Thresholds {
        match self {
            Self::Pinch(_) => Thresholds {
                near: -gaps.near,
                off: -gaps.off,
                on: -gaps.on,
            },
            Self::Flexion(_, angle) => Thresholds {
                near: angle.abs() - FLEXION_NEAR,
                off: angle.abs() - FLEXION_OFF,
                on: angle.abs(),
            },
            // A button moves nothing but itself, so that it needs no approach in which the cursor rests.
            Self::Input(_) => Thresholds {
                near: INPUT_OFF,
                off: INPUT_OFF,
                on: INPUT_ON,
            },
        }
    }
}

/// Detects the beginning and the end of a gesture.
///
/// A gesture has to be seen off before it can begin. One that is on when the hand appears, after a loss, or
/// while another gesture blocks it, does not count.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct GestureDetector(State);

#[derive(Clone, Copy, Debug, Default, PartialEq)]
enum State {
    /// Not seen off yet.
    #[default]
    Blocked,
    Off,
    /// Near since this time: about to begin, or just ended.
    Near(Timestamp),
    /// Near for longer than [`NEAR_TIME`].
    Resting,
    On,
}

/// The change of a gesture in one step.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Change {
    None,
    Began,
    Ended,
    /// The gesture was on, and its measurement is unknown now.
    Lost,
}

impl GestureDetector {
    pub(super) fn is_on(&self) -> bool {
        self.0 == State::On
    }

    /// Returns `true` if the gesture may be about to begin, or has just ended.
    pub(super) fn is_near(&self) -> bool {
        matches!(self.0, State::Near(_))
    }

    /// Blocks the gesture until it has been off. Returns `true` if it was on.
    pub(super) fn block(&mut self) -> bool {
        std::mem::take(&mut self.0) == State::On
    }

    pub(super) fn update(
        &mut self,
        measurement: Option<f32>,
        thresholds: Thresholds,
        may_begin: bool,
        time: Timestamp,
    ) -> Change {
        let Some(measurement) = measurement.filter(|it| it.is_finite()) else {
            return if self.block() {
                Change::Lost
            } else {
                Change::None
            };
        };
        let is_near = measurement > thresholds.near;
        let is_on = measurement >= thresholds.on;
        let (state, change) = match self.0 {
            State::On if measurement < thresholds.off => {
                if is_near {
                    (State::Near(time), Change::Ended)
                } else {
                    (State::Off, Change::Ended)
                }
            }
            State::On => (State::On, Change::None),
            State::Blocked if measurement >= thresholds.off => (State::Blocked, Change::None),
            State::Blocked if is_near => (State::Resting, Change::None),
            State::Blocked => (State::Off, Change::None),
            _ if is_on && may_begin => (State::On, Change::Began),
            _ if is_on => (State::Blocked, Change::None),
            State::Off | State::Near(_) | State::Resting if !is_near => (State::Off, Change::None),
            State::Off => (State::Near(time), Change::None),
            State::Near(since) if time.since(since) > NEAR_TIME => (State::Resting, Change::None),
            state => (state, Change::None),
        };
        self.0 = state;
        change
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const THRESHOLDS: Thresholds = Thresholds {
        near: 1.0,
        off: 2.0,
        on: 3.0,
    };

    /// Updates a detector with one measurement per 100 ms, negative for unknown. Returns one character for
    /// each: `^` began, `v` ended, `!` lost, `n` near, `+` on, `.` none of these.
    fn detect(measurements: &[f32], may_begin: bool) -> String {
        let mut detector = GestureDetector::default();
        let mut time = Timestamp(0);
        let mut step = |&measurement: &f32| {
            time = time + Duration::from_millis(100);
            let measurement = (measurement >= 0.0).then_some(measurement);
            match detector.update(measurement, THRESHOLDS, may_begin, time) {
                Change::Began => '^',
                Change::Ended => 'v',
                Change::Lost => '!',
                Change::None if detector.is_on() => '+',
                Change::None if detector.is_near() => 'n',
                Change::None => '.',
            }
        };
        measurements.iter().map(&mut step).collect()
    }

    #[test]
    fn a_gesture_has_hysteresis_and_is_near_before_and_after() {
        let measurements = [0.0, 1.5, 2.5, 3.0, 2.5, 2.1, 1.9, 1.5, 0.5];
        assert_eq!(detect(&measurements, true), ".nn^++vn.");
    }

    #[test]
    fn a_gesture_that_is_on_at_first_or_after_a_loss_has_to_be_seen_off() {
        assert_eq!(detect(&[3.0, 3.0, 1.5, 3.0], true), "...^");
        assert_eq!(detect(&[0.0, 3.0, -1.0, 3.0, 0.0, 3.0], true), ".^!..^");
    }

    #[test]
    fn a_gesture_that_may_not_begin_has_to_be_seen_off() {
        assert_eq!(detect(&[0.0, 3.0, 3.0], false), "...");
    }

    #[test]
    fn fingers_that_rest_close_together_are_near_for_300_ms() {
        assert_eq!(
            detect(&[0.0, 1.5, 1.5, 1.5, 1.5, 1.5, 3.0], true),
            ".nnnn.^"
        );
    }
}
