//! A fingertip that pushes forward.

use parry3d::math::Vec3;

use super::gesture::Levels;

/// How fast the place that a push begins at follows a fingertip that goes forward, in 1/s: a push of 15 mm is
/// one from 150 mm/s on, the speed from which TouchFree counts one.
const FOLLOWS: f32 = 10.0;

/// How far to a side a push may go for each metre forward: 15°. A fingertip that goes further aside is on
/// its way to another place.
const ASIDE: f32 = 0.27;

/// So far aside counts for nothing, in metres: hands tremble.
const TREMBLE: f32 = 0.002;

/// A fingertip that goes on further than so many depths reaches for something: that is no push.
const REACHES: f32 = 2.5;

/// A fingertip slower than this, in m/s, has come to rest.
const RESTS: f32 = 0.05;

/// Where a push begins: at once where the fingertip draws back or aside to, and slowly along when it goes
/// forward.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct Push {
    rest: Option<Vec3>,
    /// Whether it has gone aside or too far: it has to come to rest before a push can begin.
    is_on_its_way: bool,
}

impl Push {
    /// How far it is pushed, in metres; `is_held` keeps the place as long as a push of `depth` metres is on.
    pub(super) fn measure(
        &mut self,
        tip: Option<Vec3>,
        forward: Vec3,
        (depth, is_held): (f32, bool),
        seconds: f32,
    ) -> Option<f32> {
        let Some(tip) = tip else {
            *self = Self::default();
            return None;
        };
        let way = tip - self.rest.unwrap_or(tip);
        let ahead = way.dot(forward);
        let aside = (way - forward * ahead).length();
        let goes_aside = !is_held && aside > TREMBLE + ASIDE * ahead;
        if goes_aside || ahead > REACHES * depth {
            self.is_on_its_way = true;
        } else if ahead <= RESTS * seconds {
            self.is_on_its_way = false;
        }
        if self.is_on_its_way || ahead <= 0.0 {
            self.rest = Some(tip);
            return Some(0.0);
        }
        let share = match is_held {
            true => 0.0,
            false => 1.0 - 1.0 / (1.0 + FOLLOWS * seconds),
        };
        self.rest = Some(tip - way * (1.0 - share));
        Some(ahead)
    }
}

/// Of a push of this depth, in metres: it goes off half way back, a quarter is its first sign.
pub(super) fn levels(depth: f32) -> Levels {
    Levels {
        ready: 0.25 * depth,
        off: 0.5 * depth,
        on: depth,
    }
}
