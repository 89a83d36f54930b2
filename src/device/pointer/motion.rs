//! From where a hand points to how far that moved.

use parry3d::math::Vec3;

use super::mode::Aim;
use super::settings::PointerSettings;
use crate::estimate::OneEuroFilter;

/// Follows the place that a hand points at, in pixels to the right, up and towards the wearer.
#[derive(Clone, Debug)]
pub(super) struct Way {
    extent: Vec3,
    dead_zone: f32,
    filter: Option<OneEuroFilter>,
    /// `None` when the hand has not been seen, and in a mode without places.
    place: Option<Vec3>,
}

/// What became of the place.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Moved {
    /// How far it moved.
    pub(super) by: Vec3,
    /// Where it is when it is there for the first time.
    pub(super) starts_at: Option<Vec3>,
}

impl Way {
    pub(super) fn new(settings: &PointerSettings) -> Self {
        Self {
            extent: extent(settings),
            dead_zone: settings.dead_zone_px,
            filter: settings
                .smoothing
                .map(|smoothing| OneEuroFilter::new(smoothing, 3)),
            place: None,
        }
    }

    /// Where the hand points.
    pub(super) fn place(&self) -> Option<Vec3> {
        self.place
    }

    /// Forgets where the hand was.
    pub(super) fn forget(&mut self) {
        self.place = None;
        if let Some(filter) = &mut self.filter {
            filter.reset();
        }
    }

    pub(super) fn follow(&mut self, aim: Aim, seconds: f32) -> Moved {
        let shares = match aim {
            Aim::At(shares) => shares,
            Aim::Goes(speed) => {
                return Moved {
                    by: speed * seconds,
                    starts_at: None,
                };
            }
        };
        let new = self.smooth(shares * self.extent, seconds);
        let Some(before) = self.place else {
            self.place = Some(new);
            return Moved {
                by: Vec3::ZERO,
                starts_at: Some(new),
            };
        };
        let taut = (new - before).length() - self.dead_zone;
        let by = (new - before).normalize_or_zero() * taut.max(0.0);
        self.place = Some(before + by);
        Moved {
            by,
            starts_at: None,
        }
    }

    fn smooth(&mut self, place: Vec3, seconds: f32) -> Vec3 {
        let Some(filter) = &mut self.filter else {
            return place;
        };
        let mut values = place.to_array().map(f64::from);
        filter.filter(&mut values, f64::from(seconds));
        Vec3::from_array(values.map(|value| value as f32))
    }
}

/// How many pixels the whole range is; as many towards the wearer as up.
pub(super) fn extent(settings: &PointerSettings) -> Vec3 {
    let last = settings.screen_px - 1.0;
    last.extend(last.y)
}
