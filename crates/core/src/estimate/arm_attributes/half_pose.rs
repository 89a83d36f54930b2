//! The upper-body landmarks of a pose of 33 points.

use glam::DVec3;

use crate::hand::Side;

/// The number of rows of a half pose: rows 11 to 24 of a pose of 33 points.
pub const HALF_POSE_ROWS: usize = 14;

/// The landmarks of both arms and the hips, in the image frame: x to the right, y down, z away from the camera.
///
/// All three axes have the same unit. Lengths derived from them have it too.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct HalfPose {
    /// The arms, in the order of [`Side::ALL`].
    pub arms: [ArmLandmarks; Side::COUNT],
    /// The hips, in the order of [`Side::ALL`].
    pub hips: [DVec3; Side::COUNT],
}

/// The landmarks of one arm.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ArmLandmarks {
    /// The shoulder.
    pub shoulder: DVec3,
    /// The elbow.
    pub elbow: DVec3,
    /// The wrist.
    pub wrist: DVec3,
    /// The little finger.
    pub little: DVec3,
    /// The index finger.
    pub index: DVec3,
    /// The thumb.
    pub thumb: DVec3,
}

/// The landmarks of the trunk.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Trunk {
    /// The shoulders, in the order of [`Side::ALL`].
    pub shoulders: [DVec3; Side::COUNT],
    /// The hips, in the order of [`Side::ALL`].
    pub hips: [DVec3; Side::COUNT],
}

/// The size of the image in which normalized landmarks were found, in pixels.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ImageSize {
    /// The width, by which x and z are divided in normalized coordinates.
    pub width: f64,
    /// The height, by which y is divided.
    pub height: f64,
}

impl ImageSize {
    /// Converts a normalized position to pixels.
    pub fn to_pixels(self, normalized: DVec3) -> DVec3 {
        normalized * DVec3::new(self.width, self.height, self.width)
    }
}

impl HalfPose {
    /// Creates a half pose from its rows, left before right: shoulders, elbows, wrists, little fingers, index fingers,
    /// thumbs, hips.
    pub fn from_rows(rows: &[DVec3; HALF_POSE_ROWS]) -> Self {
        let arm = |side: Side| {
            let row = |pair: usize| rows[Side::COUNT * pair + side.index()];
            ArmLandmarks {
                shoulder: row(0),
                elbow: row(1),
                wrist: row(2),
                little: row(3),
                index: row(4),
                thumb: row(5),
            }
        };
        Self {
            arms: [arm(Side::Left), arm(Side::Right)],
            hips: [rows[12], rows[13]],
        }
    }

    /// Returns the rows, in the order of [`from_rows`](Self::from_rows).
    pub fn rows(&self) -> [DVec3; HALF_POSE_ROWS] {
        std::array::from_fn(|row| {
            let (pair, side) = (row / Side::COUNT, row % Side::COUNT);
            let arm = &self.arms[side];
            match pair {
                0 => arm.shoulder,
                1 => arm.elbow,
                2 => arm.wrist,
                3 => arm.little,
                4 => arm.index,
                5 => arm.thumb,
                _ => self.hips[side],
            }
        })
    }

    /// Returns the arm of one side.
    pub fn arm(&self, side: Side) -> &ArmLandmarks {
        &self.arms[side.index()]
    }

    /// Returns the landmarks of the trunk.
    pub fn trunk(&self) -> Trunk {
        Trunk {
            shoulders: self.arms.map(|arm| arm.shoulder),
            hips: self.hips,
        }
    }
}

impl ArmLandmarks {
    /// Returns `true` if all coordinates are finite.
    pub fn is_finite(&self) -> bool {
        let points = [
            self.shoulder,
            self.elbow,
            self.wrist,
            self.little,
            self.index,
            self.thumb,
        ];
        points.iter().all(|point| point.is_finite())
    }
}

impl Trunk {
    /// Returns `true` if all coordinates are finite.
    pub fn is_finite(&self) -> bool {
        self.shoulders
            .iter()
            .chain(&self.hips)
            .all(|point| point.is_finite())
    }

    /// Returns the largest distance of a landmark from the left shoulder.
    pub(super) fn extent(&self) -> f64 {
        let [origin, _] = self.shoulders;
        let points = self.shoulders.iter().chain(&self.hips);
        points.fold(0.0, |extent, point| extent.max(point.distance(origin)))
    }
}
