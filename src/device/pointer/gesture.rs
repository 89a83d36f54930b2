//! Gestures of one hand: from the first sign of one to its end.

use std::time::Duration;

use super::trusted_hand::Sight;
use crate::hand::{Dof, Finger};
use crate::time::Timestamp;

/// How much less bent than where it goes on a joint is when it goes off, and at the first sign, in
/// radians: 10° and 20°.
const BEND_OFF: f32 = 0.174_533;
const BEND_READY: f32 = 0.349_066;

/// For how long a first sign holds the pointer still: a hand whose fingers rest close together does not
/// keep it.
const READY_TIME: Duration = Duration::from_millis(300);

/// Something that a hand does and holds.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Gesture {
    /// The tips of the thumb and this finger meet; not the thumb itself.
    Pinch(Finger),
    /// A joint is bent this far, in radians; below 0 it is bent the other way. It goes off 10° before.
    Flexion(Dof, f32),
}

/// How far apart the middles of two fingertips are in a pinch, in metres: `on < off < ready`.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct PinchGaps {
    /// A pinch goes on where they are no further apart.
    pub on: f32,
    /// It goes off where they are further apart.
    pub off: f32,
    /// Its first sign is where they are nearer.
    pub near: f32,
}

impl Default for PinchGaps {
    /// 25, 30 and 45 mm: the first two as in Ultraleap's tracking plug-in, the third so far that a closing
    /// hand (some 200 mm/s) is seen 100 ms ahead.
    fn default() -> Self {
        Self {
            on: 0.025,
            off: 0.030,
            near: 0.045,
        }
    }
}

/// Where a measure that grows with a gesture changes what it means: `ready < off < on`.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Levels {
    pub(super) ready: f32,
    pub(super) off: f32,
    pub(super) on: f32,
}

impl Gesture {
    /// How much of it there is; `None` when that is not known.
    pub(super) fn measure(self, sight: &Sight) -> Option<f32> {
        match self {
            Self::Pinch(finger) => {
                let gap = sight.tip(Finger::Thumb)?.distance(sight.tip(finger)?);
                Some(-gap)
            }
            Self::Flexion(dof, at) => Some(sight.angle(dof)? * at.signum()),
        }
    }

    pub(super) fn levels(self, gaps: PinchGaps) -> Levels {
        match self {
            Self::Pinch(_) => Levels {
                ready: -gaps.near,
                off: -gaps.off,
                on: -gaps.on,
            },
            Self::Flexion(_, at) => Levels {
                ready: at.abs() - BEND_READY,
                off: at.abs() - BEND_OFF,
                on: at.abs(),
            },
        }
    }
}

/// A gesture followed from frame to frame.
///
/// It has to be seen off before it goes on: one that is on when the hand appears, after it was lost, or
/// while another one was in its way counts for nothing.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct Watch(Stage);

#[derive(Clone, Copy, Debug, Default, PartialEq)]
enum Stage {
    /// Not seen off.
    #[default]
    Unseen,
    Off,
    /// A first sign, or what is left of it, since then.
    Ready(Timestamp),
    /// The same for so long that it is none.
    Resting,
    On,
}

/// What became of a gesture in a frame.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Change {
    None,
    Begins,
    Ends,
    /// It was on and cannot be seen any more.
    IsLost,
}

impl Watch {
    pub(super) fn is_on(&self) -> bool {
        self.0 == Stage::On
    }

    /// Whether it may be about to begin, or has just ended.
    pub(super) fn is_ready(&self) -> bool {
        matches!(self.0, Stage::Ready(_))
    }

    /// Counts for nothing until it is seen off again; whether it was on.
    pub(super) fn forget(&mut self) -> bool {
        std::mem::take(&mut self.0) == Stage::On
    }

    pub(super) fn follow(
        &mut self,
        measure: Option<f32>,
        levels: Levels,
        may_begin: bool,
        time: Timestamp,
    ) -> Change {
        let Some(measure) = measure.filter(|measure| measure.is_finite()) else {
            return match self.forget() {
                true => Change::IsLost,
                false => Change::None,
            };
        };
        let (is_near, is_on) = (measure > levels.ready, measure >= levels.on);
        let (stage, change) = match self.0 {
            Stage::On if measure < levels.off => (near_since(is_near, time), Change::Ends),
            Stage::On => (Stage::On, Change::None),
            Stage::Unseen if measure >= levels.off => (Stage::Unseen, Change::None),
            Stage::Unseen if is_near => (Stage::Resting, Change::None),
            Stage::Unseen => (Stage::Off, Change::None),
            _ if is_on && may_begin => (Stage::On, Change::Begins),
            _ if is_on => (Stage::Unseen, Change::None),
            Stage::Off | Stage::Ready(_) | Stage::Resting if !is_near => (Stage::Off, Change::None),
            Stage::Off => (Stage::Ready(time), Change::None),
            Stage::Ready(since) if time.since(since) > READY_TIME => (Stage::Resting, Change::None),
            stage => (stage, Change::None),
        };
        self.0 = stage;
        change
    }
}

fn near_since(is_near: bool, time: Timestamp) -> Stage {
    match is_near {
        true => Stage::Ready(time),
        false => Stage::Off,
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const LEVELS: Levels = Levels {
        ready: 1.0,
        off: 2.0,
        on: 3.0,
    };

    /// What becomes of it, a character for each measure 100 ms apart: `^` begins, `v` ends, `!` lost; else
    /// `r` ready, `+` on, `.` neither.
    fn follow(measures: &[f32], may_begin: bool) -> String {
        let mut watch = Watch::default();
        let mut time = Timestamp(0);
        let mut step = |&measure: &f32| {
            time = time + Duration::from_millis(100);
            let measure = (measure >= 0.0).then_some(measure);
            match watch.follow(measure, LEVELS, may_begin, time) {
                Change::Begins => '^',
                Change::Ends => 'v',
                Change::IsLost => '!',
                Change::None if watch.is_on() => '+',
                Change::None if watch.is_ready() => 'r',
                Change::None => '.',
            }
        };
        measures.iter().map(&mut step).collect()
    }

    #[test]
    fn a_gesture_is_latched_between_two_levels_and_ready_on_both_sides() {
        let measures = [0.0, 1.5, 2.5, 3.0, 2.5, 2.1, 1.9, 1.5, 0.5];
        assert_eq!(follow(&measures, true), ".rr^++vr.");
    }

    #[test]
    fn one_that_is_on_at_first_or_after_it_was_lost_has_to_be_seen_off() {
        assert_eq!(follow(&[3.0, 3.0, 1.5, 3.0], true), "...^");
        assert_eq!(follow(&[0.0, 3.0, -1.0, 3.0, 0.0, 3.0], true), ".^!..^");
    }

    #[test]
    fn one_that_another_is_in_the_way_of_has_to_be_seen_off() {
        assert_eq!(follow(&[0.0, 3.0, 3.0], false), "...");
    }

    #[test]
    fn fingers_that_rest_close_together_are_no_first_sign_for_long() {
        assert_eq!(
            follow(&[0.0, 1.5, 1.5, 1.5, 1.5, 1.5, 3.0], true),
            ".rrrr.^"
        );
    }
}
