//! The pose of a board relative to its anchor, in the parameters of a layout file.

use std::f32::consts::FRAC_PI_2;
use std::time::Duration;

use parry3d::math::{Pose, Rot3, Vec3};

/// The largest distance of a board from its anchor to the right, up or forward, in metres.
pub const MAX_DISTANCE: f32 = 2.0;

/// The pose of a board relative to its anchor; metres and radians.
///
/// The position locates the board's origin, along axes that the bearing turns about the vertical. Any combination of
/// bearing and tilt can be represented; a sideways roll cannot.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct BoardPose {
    /// The direction of the board about the vertical: 0 is straight forward, a quarter turn is to the right.
    pub bearing: f32,
    /// The displacement to the right of the bearing.
    pub right: f32,
    /// The displacement upwards.
    pub height: f32,
    /// The displacement along the bearing.
    pub forward: f32,
    /// The elevation of the far side: 0 is flat, a quarter turn is upright and faces the wearer.
    pub tilt: f32,
}

impl BoardPose {
    /// Returns `anchor_from_board`. The board frame has rows along +X, +Y away from the wearer and +Z out of the front;
    /// the anchor frame has the world's axes (+X right, +Y up, −Z forward).
    pub fn to_pose(&self) -> Pose {
        let turn = Rot3::from_rotation_y(-self.bearing);
        let slope = Rot3::from_rotation_x(self.tilt - FRAC_PI_2);
        let origin = turn * Vec3::new(self.right, self.height, -self.forward);
        Pose::from_parts(origin, turn * slope)
    }

    /// Converts `anchor_from_board`. A sideways roll is dropped.
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

    /// Returns `true` if a layout file accepts the position: at most [`MAX_DISTANCE`] along each axis.
    pub fn is_distance_valid(&self) -> bool {
        // `all` and `<=`, so that NaN is invalid.
        [self.right, self.height, self.forward]
            .iter()
            .all(|distance| distance.abs() <= MAX_DISTANCE)
    }

    /// Returns `true` if a layout file accepts the tilt: −90° to 90°.
    pub fn is_tilt_valid(&self) -> bool {
        /// Covers the rounding of a quarter turn.
        const ROUNDING: f32 = 1e-5;
        self.tilt.abs() <= FRAC_PI_2 + ROUNDING
    }
}

/// Settings of auto-recentering: a board slowly follows a hand that rests above it.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct AutoRecenter {
    /// The speed of the board, in metres per second.
    pub speed: f32,
    /// The time for which the hand must rest before the board moves.
    pub delay: Duration,
    /// The largest displacement from the board's own position, in metres.
    pub max_offset: f32,
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn converting_to_a_pose_and_back_gives_the_same_values() {
        let mut random = fastrand::Rng::with_seed(3);
        let mut between = |low: f32, high: f32| low + (high - low) * random.f32();
        for _ in 0..1_000 {
            let expected = BoardPose {
                bearing: between(-3.1, 3.1),
                right: between(-2.0, 2.0),
                height: between(-2.0, 2.0),
                forward: between(-2.0, 2.0),
                tilt: between(-FRAC_PI_2, FRAC_PI_2),
            };
            let found = BoardPose::from_pose(&expected.to_pose());
            for (part, wanted) in [
                (found.bearing, expected.bearing),
                (found.right, expected.right),
                (found.height, expected.height),
                (found.forward, expected.forward),
                (found.tilt, expected.tilt),
            ] {
                assert!((part - wanted).abs() < 2e-6, "{part} for {wanted}");
            }
        }
    }

    #[test]
    fn nan_is_invalid() {
        let pose = BoardPose {
            height: f32::NAN,
            tilt: f32::NAN,
            ..BoardPose::default()
        };
        assert!(!pose.is_distance_valid() && !pose.is_tilt_valid());
    }
}
