//! The motion of the position that a hand points at.

use parry3d::math::Vec3;

use super::mode::Aim;
use super::settings::PointerSettings;
use crate::estimate::OneEuroFilter;

/// Smooths the position that a hand points at, applies the dead zone and returns its motion.
///
/// Positions are in pixels: to the right, up, towards the wearer.
#[derive(Clone, Debug)]
pub(super) struct MotionTracker {
    extent: Vec3,
    dead_zone_px: f32,
    filter: Option<OneEuroFilter<3>>,
    /// `None` before the hand is seen, and in a mode without positions.
    position: Option<Vec3>,
}

/// The motion in one step.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Motion {
    pub(super) delta: Vec3,
    /// The position, in the first step that has one.
    pub(super) first_position: Option<Vec3>,
}

impl MotionTracker {
    pub(super) fn new(settings: &PointerSettings) -> Self {
        Self {
            extent: extent(settings),
            dead_zone_px: settings.dead_zone_px,
            filter: settings.smoothing.map(OneEuroFilter::new),
            position: None,
        }
    }

    pub(super) fn position(&self) -> Option<Vec3> {
        self.position
    }

    pub(super) fn reset(&mut self) {
        self.position = None;
        if let Some(filter) = &mut self.filter {
            filter.reset();
        }
    }

    pub(super) fn update(&mut self, aim: Aim, seconds: f32) -> Motion {
        let fractions = match aim {
            Aim::Position(fractions) => fractions,
            Aim::Posture(_) => {
                return Motion {
                    delta: Vec3::ZERO,
                    first_position: None,
                };
            }
            Aim::Velocity(velocity) => {
                return Motion {
                    delta: velocity * seconds,
                    first_position: None,
                };
            }
        };
        let smoothed = self.smooth(fractions * self.extent, seconds);
        let Some(before) = self.position else {
            self.position = Some(smoothed);
            return Motion {
                delta: Vec3::ZERO,
                first_position: Some(smoothed),
            };
        };
        let beyond_dead_zone = (smoothed - before).length() - self.dead_zone_px;
        let delta = (smoothed - before).normalize_or_zero() * beyond_dead_zone.max(0.0);
        self.position = Some(before + delta);
        Motion {
            delta,
            first_position: None,
        }
    }

    fn smooth(&mut self, position: Vec3, seconds: f32) -> Vec3 {
        let Some(filter) = &mut self.filter else {
            return position;
        };
        let mut values = position.to_array().map(f64::from);
        filter.filter(&mut values, f64::from(seconds));
        Vec3::from_array(values.map(|value| value as f32))
    }
}

/// Returns the size of the whole range in pixels; the depth is equal to the height.
pub(super) fn extent(settings: &PointerSettings) -> Vec3 {
    let last = settings.screen_px - 1.0;
    last.extend(last.y)
}
