//! How far the hand is from a pose of rest is how fast the pointer goes.

use parry3d::math::{Vec2, Vec3};

use super::anchored_frame::AnchoredFrame;
use super::joint::AngleMapping;
use super::trusted_hand::Sight;
use crate::hand::Finger;

/// Displacement as speed.
///
/// speed = top · ((d − dead) / (1 − dead))^curve in the direction of the displacement, whose length d is
/// a share of the full one, at most 1; 0 within the dead zone.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct RateControl {
    /// What is displaced.
    pub displacement: Displacement,
    /// The share of the full displacement within which the pointer stands still: 0..1.
    pub dead_zone: f32,
    /// The speed at the full displacement, in pixels a second.
    pub max_speed_px_s: f32,
    /// More than 1 makes small displacements slower; more than 0.
    pub curve: f32,
}

/// What is displaced from its rest.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Displacement {
    /// The index fingertip: from where, and how far is full, in metres, more than 0.
    Fingertip(AnchoredFrame, f32),
    /// Two angles, to the right and up: from the middle of their ranges to the ends. Curves of their own
    /// count as well.
    Angles(AngleMapping, AngleMapping),
}

impl RateControl {
    /// Pixels a second to the right and up.
    pub(super) fn speed(&self, sight: &Sight) -> Option<Vec3> {
        let displaced = match &self.displacement {
            Displacement::Fingertip(frame, full) => {
                let tip = frame.to_local(sight.pose(), sight.tip(Finger::Index)?)?;
                tip.truncate() / full
            }
            Displacement::Angles(x, y) => Vec2::new(x.deflection(sight)?, y.deflection(sight)?),
        };
        let displaced = displaced.clamp_length_max(1.0);
        let beyond = (displaced.length() - self.dead_zone) / (1.0 - self.dead_zone);
        if beyond <= 0.0 {
            return Some(Vec3::ZERO);
        }
        let speed = self.max_speed_px_s * beyond.powf(self.curve);
        Some((displaced.normalize_or_zero() * speed).extend(0.0))
    }

    /// What the displacement is seen from.
    pub(super) fn frame(&self) -> Option<&AnchoredFrame> {
        match &self.displacement {
            Displacement::Fingertip(frame, _) => Some(frame),
            Displacement::Angles(..) => None,
        }
    }
}
