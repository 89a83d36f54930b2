//! A fingertip that pushes forward.

use parry3d::math::Vec3;

use super::gesture::Levels;

/// How fast the place that a push begins at follows a fingertip that goes forward, in 1/s: a push of 15 mm is
/// one from 150 mm/s on, the speed from which TouchFree counts one.
const FOLLOWS: f32 = 10.0;

/// Where a push begins: at once where the fingertip draws back to, and slowly along when it goes forward.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct Push {
    /// How far forward the place is, in metres.
    rest: Option<f32>,
}

impl Push {
    /// How far it is pushed, in metres; `is_held` keeps the place as long as the push is on.
    pub(super) fn measure(
        &mut self,
        tip: Option<Vec3>,
        forward: Vec3,
        is_held: bool,
        seconds: f32,
    ) -> Option<f32> {
        let Some(ahead) = tip.map(|tip| tip.dot(forward)) else {
            self.rest = None;
            return None;
        };
        let rest = self.rest.unwrap_or(ahead).min(ahead);
        let share = match is_held {
            true => 0.0,
            false => 1.0 - 1.0 / (1.0 + FOLLOWS * seconds),
        };
        self.rest = Some(rest + share * (ahead - rest));
        Some(ahead - rest)
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
