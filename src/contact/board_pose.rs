//! Where a board is around its anchor, in the terms in which people say it.

use std::f32::consts::FRAC_PI_2;
use std::time::Duration;

use parry3d::math::{Pose, Rot3, Vec3};

/// The furthest that a board is from its anchor to the right, up or forward, in metres.
pub const MAX_DISTANCE: f32 = 2.0;

/// The place of a board's point (0, 0) and which way the board faces; metres and radians.
///
/// Every turn about the vertical with every slope of the far side has one; a board that leans sideways
/// has none.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct BoardPose {
    /// Which way the board lies: 0 is straight forward, a quarter turn is to the right.
    pub bearing: f32,
    /// To the right of the bearing.
    pub right: f32,
    /// Up.
    pub height: f32,
    /// Along the bearing.
    pub forward: f32,
    /// How much the far side is lifted: 0 lies flat, a quarter turn stands upright and faces the wearer.
    pub tilt: f32,
}

impl BoardPose {
    /// The board's frame (rows along +X, away from the wearer along +Y, front along +Z) in the world's
    /// axes around the anchor (+X right, +Y up, −Z forward).
    pub fn to_pose(&self) -> Pose {
        let turn = Rot3::from_rotation_y(-self.bearing);
        let slope = Rot3::from_rotation_x(self.tilt - FRAC_PI_2);
        let origin = turn * Vec3::new(self.right, self.height, -self.forward);
        Pose::from_parts(origin, turn * slope)
    }

    /// The place of such a frame; the nearest one where the frame leans sideways.
    pub fn from_pose(anchor_from_board: &Pose) -> Self {
        let along = anchor_from_board.rotation * Vec3::X;
        let bearing = along.z.atan2(along.x);
        let unturned = Rot3::from_rotation_y(bearing);
        let origin = unturned * anchor_from_board.translation;
        let away = unturned * (anchor_from_board.rotation * Vec3::Y);
        Self {
            bearing,
            right: origin.x,
            height: origin.y,
            forward: -origin.z,
            tilt: away.y.atan2(-away.z),
        }
    }

    /// Whether a layout file can say it, as far as distances go: at most [`FARTHEST`] each way.
    pub fn is_distance_valid(&self) -> bool {
        // `all` and `<=`, so that NaN is far.
        [self.right, self.height, self.forward]
            .iter()
            .all(|distance| distance.abs() <= MAX_DISTANCE)
    }

    /// Whether a layout file can say it, as far as the tilt goes: at most upright, either way.
    pub fn is_gentle(&self) -> bool {
        /// Covers the rounding of a quarter turn.
        const ROUNDING: f32 = 1e-5;
        self.tilt.abs() <= FRAC_PI_2 + ROUNDING
    }
}

/// How a board creeps under a hand that rests over it.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct AutoRecenter {
    /// How fast, in metres per second.
    pub speed: f32,
    /// How long the hand has to rest before.
    pub delay: Duration,
    /// How far from its place at most, in metres.
    pub max_offset: f32,
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_place_is_found_again_from_its_frame() {
        let mut number = fastrand::Rng::with_seed(3);
        let mut between = |low: f32, high: f32| low + (high - low) * number.f32();
        for _ in 0..1_000 {
            let place = BoardPose {
                bearing: between(-3.1, 3.1),
                right: between(-2.0, 2.0),
                height: between(-2.0, 2.0),
                forward: between(-2.0, 2.0),
                tilt: between(-FRAC_PI_2, FRAC_PI_2),
            };
            let found = BoardPose::from_pose(&place.to_pose());
            for (found, expected) in [
                (found.bearing, place.bearing),
                (found.right, place.right),
                (found.height, place.height),
                (found.forward, place.forward),
                (found.tilt, place.tilt),
            ] {
                assert!((found - expected).abs() < 2e-6, "{found} for {expected}");
            }
        }
    }

    #[test]
    fn what_is_no_number_is_nowhere() {
        let place = BoardPose {
            height: f32::NAN,
            tilt: f32::NAN,
            ..BoardPose::default()
        };
        assert!(!place.is_distance_valid() && !place.is_gentle());
    }
}
