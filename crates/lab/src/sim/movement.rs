//! Movements of a simulated hand from one posture to the next.

use glam::Quat;
use parry3d::math::Vec3;

use super::effector::Effector;
use super::typing_hand::TypingHand;
use crate::hand::{BodyAngle, Input};

/// A planned movement. It starts in the posture that the hand then has.
#[derive(Clone, Debug)]
pub(super) struct Movement {
    /// Channels that are moved directly: their indices in the posture, and their values at the end.
    pub(super) channel_targets: Vec<(usize, f64)>,
    /// Path of the fingertip that points; `None` if the fingertip follows from the channels.
    pub(super) path: Option<TipPath>,
    /// An input that is set at the start.
    pub(super) input: Option<InputChange>,
    /// The finger or the hand that moves along the path.
    pub(super) effector: Effector,
    /// `true` if the thumb stays at the index finger.
    pub(super) is_pinched: bool,
    /// `true` if the fingertip presses a target during a part of the movement.
    pub(super) is_down: bool,
    /// `true` if the fingertip presses a target at the end.
    pub(super) ends_down: bool,
    /// Duration in packets; more than 0.
    pub(super) packets: u32,
}

/// A change of an input beside the joints of the arm.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) enum InputChange {
    /// An input of the glove, and its value.
    Glove(Input, f64),
    /// An angle of the body, in radians.
    Body(BodyAngle, f64),
}

/// The path of a fingertip (world, metres).
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) enum TipPath {
    /// A straight line to a point.
    To(Vec3),
    /// An arc around `center`, right-handed about the unit vector `axis`.
    Around {
        center: Vec3,
        axis: Vec3,
        radians: f32,
    },
}

impl TipPath {
    /// Returns the point at `t`, 0..=1, of the path that starts at `start`.
    fn at(&self, start: Vec3, t: f32) -> Vec3 {
        match *self {
            Self::To(end) => start.lerp(end, t),
            Self::Around {
                center,
                axis,
                radians,
            } => center + Quat::from_axis_angle(axis, radians * t) * (start - center),
        }
    }

    /// Returns the end of the path that starts at `start`.
    pub(super) fn end(&self, start: Vec3) -> Vec3 {
        self.at(start, 1.0)
    }
}

/// A movement that has begun.
#[derive(Clone, Debug)]
pub(super) struct ActiveMovement {
    movement: Movement,
    /// Channels that the movement sets directly, which inverse kinematics must not change.
    locked: Vec<usize>,
    start_values: Vec<f64>,
    start_tip: Vec3,
}

impl ActiveMovement {
    /// Begins a movement in the posture `values`. The channels that it sets keep their values as their new rest.
    pub(super) fn begin(movement: Movement, hand: &mut TypingHand, values: &[f64]) -> Self {
        for &(index, value) in &movement.channel_targets {
            hand.set_rest(index, value);
        }
        let locked = movement.channel_targets.iter().map(|&(index, _)| index);
        Self {
            locked: locked.collect(),
            start_values: values.to_vec(),
            start_tip: hand.tip_of(movement.effector.finger, values),
            movement,
        }
    }

    /// Returns `true` if the fingertip presses a target during a part of the movement.
    pub(super) fn is_down(&self) -> bool {
        self.movement.is_down
    }

    /// Returns `true` if the fingertip presses a target at the end.
    pub(super) fn ends_down(&self) -> bool {
        self.movement.ends_down
    }

    /// Returns the input that is set.
    pub(super) fn input(&self) -> Option<InputChange> {
        self.movement.input
    }

    /// Returns the duration in packets.
    pub(super) fn packets(&self) -> u32 {
        self.movement.packets
    }

    /// Sets `values`, the previous posture, to the posture at `time_fraction` (0..=1) of the movement. Returns the
    /// distance from the fingertip to its path in metres.
    pub(super) fn step(&self, time_fraction: f32, hand: &TypingHand, values: &mut [f64]) -> f64 {
        let t = minimum_jerk(time_fraction);
        for &(index, end) in &self.movement.channel_targets {
            let start = self.start_values[index];
            values[index] = start + (end - start) * f64::from(t);
        }
        let Some(path) = &self.movement.path else {
            if self.movement.is_pinched {
                hand.bring_thumb_to_index(values);
            }
            return 0.0;
        };
        let tip = path.at(self.start_tip, t);
        if self.movement.is_pinched {
            hand.reach_pinched(tip, values, &self.locked)
        } else {
            hand.reach_with(self.movement.effector, tip, values, &self.locked)
        }
    }
}

/// Returns the minimum-jerk profile x = 10 t³ − 15 t⁴ + 6 t⁵ (Flash & Hogan 1985).
pub(crate) fn minimum_jerk(t: f32) -> f32 {
    t.powi(3) * (10.0 + t * (-15.0 + 6.0 * t))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_movement_is_at_its_start_middle_and_end_on_time() {
        assert_eq!([0.0, 0.5, 1.0].map(minimum_jerk), [0.0, 0.5, 1.0]);
    }

    #[test]
    fn a_quarter_turn_is_counter_clockwise_seen_from_the_front() {
        let path = TipPath::Around {
            center: Vec3::new(1.0, 1.0, 0.0),
            axis: Vec3::Z,
            radians: std::f32::consts::FRAC_PI_2,
        };
        let end = path.end(Vec3::new(3.0, 1.0, 0.0));
        assert!(end.distance(Vec3::new(1.0, 3.0, 0.0)) < 1e-6, "{end}");
    }
}
