//! How a simulated hand gets from one posture to the next.

use glam::Quat;
use parry3d::math::Vec3;

use super::typing_hand::TypingHand;

/// One movement, from wherever the hand is when it begins.
#[derive(Clone, Debug)]
pub(super) struct Movement {
    /// Channels, by their places in the hand's posture, and the values that they come to.
    pub(super) channel_targets: Vec<(usize, f64)>,
    /// The way of the index fingertip; it goes along with the hand where there is none.
    pub(super) path: Option<TipPath>,
    /// Whether the thumb stays at the index finger.
    pub(super) is_pinched: bool,
    /// How many frames it takes; more than 0.
    pub(super) frames: u32,
}

/// The way of a fingertip (world, metres).
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) enum TipPath {
    /// Straight to a place.
    To(Vec3),
    /// Around `centre`, right-handed about the unit `axis`.
    Around {
        centre: Vec3,
        axis: Vec3,
        radians: f32,
    },
}

impl TipPath {
    fn at(&self, from: Vec3, share: f32) -> Vec3 {
        match *self {
            Self::To(to) => from.lerp(to, share),
            Self::Around {
                centre,
                axis,
                radians,
            } => centre + Quat::from_axis_angle(axis, radians * share) * (from - centre),
        }
    }

    /// Where it ends when it begins at `from`.
    pub(super) fn end(&self, from: Vec3) -> Vec3 {
        self.at(from, 1.0)
    }
}

/// A movement that has begun.
#[derive(Clone, Debug)]
pub(super) struct Motion {
    movement: Movement,
    /// The places that the movement turns itself: the way of the fingertip has to do without them.
    held: Vec<usize>,
    values: Vec<f64>,
    tip: Vec3,
}

impl Motion {
    /// Begins a movement in the posture `values`. What it turns stays so: it is where the hand comes
    /// back to from now on.
    pub(super) fn begin(movement: Movement, hand: &mut TypingHand, values: &[f64]) -> Self {
        for &(place, value) in &movement.channel_targets {
            hand.set_rest(place, value);
        }
        Self {
            held: movement
                .channel_targets
                .iter()
                .map(|&(place, _)| place)
                .collect(),
            values: values.to_vec(),
            tip: hand.tip(values),
            movement,
        }
    }

    /// How many frames it takes.
    pub(super) fn frames(&self) -> u32 {
        self.movement.frames
    }

    /// Brings `values`, the posture of the frame before, to the one after this share of the time.
    /// Returns how far from its way the fingertip stays, in metres.
    pub(super) fn step(&self, time_share: f32, hand: &TypingHand, values: &mut [f64]) -> f64 {
        let share = minimum_jerk(time_share);
        for &(place, to) in &self.movement.channel_targets {
            let from = self.values[place];
            values[place] = from + (to - from) * f64::from(share);
        }
        let Some(path) = &self.movement.path else {
            if self.movement.is_pinched {
                hand.follow(values);
            }
            return 0.0;
        };
        let tip = path.at(self.tip, share);
        match self.movement.is_pinched {
            true => hand.reach_pinched(tip, values, &self.held),
            false => hand.reach(tip, values, &self.held),
        }
    }
}

/// x = 10 s³ − 15 s⁴ + 6 s⁵ (Flash & Hogan 1985).
fn minimum_jerk(share: f32) -> f32 {
    share.powi(3) * (10.0 + share * (-15.0 + 6.0 * share))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_movement_starts_and_ends_where_it_should_and_is_half_way_in_the_middle() {
        assert_eq!([0.0, 0.5, 1.0].map(minimum_jerk), [0.0, 0.5, 1.0]);
    }

    #[test]
    fn a_quarter_turn_seen_from_the_front_goes_counter_clockwise() {
        let path = TipPath::Around {
            centre: Vec3::new(1.0, 1.0, 0.0),
            axis: Vec3::Z,
            radians: std::f32::consts::FRAC_PI_2,
        };
        let end = path.end(Vec3::new(3.0, 1.0, 0.0));
        assert!(end.distance(Vec3::new(1.0, 3.0, 0.0)) < 1e-6, "{end}");
    }
}
