//! The positions of the fingertips in the frame of one surface.

use glam::Vec3A;
use parry3d::math::Vec3;

use super::surface::Surface;
use crate::hand::{Finger, FingerSet};
use crate::kinematics::HandPose;

/// The centers of the fingertips that may press, in one frame, in metres.
///
/// The vectors have the width of a register: three separate numbers that were just stored cannot be loaded at once.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct Fingertips {
    known: FingerSet,
    centers: [Vec3A; Finger::COUNT],
}

impl Fingertips {
    /// Returns the trusted fingertips of a pose, in the world.
    pub fn trusted(pose: &HandPose) -> Self {
        let mut tips = Self::default();
        for &finger in Finger::ALL {
            if let Some(center) = trusted_fingertip(pose, finger) {
                tips.centers[finger.index()] = center.into();
                tips.known = tips.known.with(finger);
            }
        }
        tips
    }

    fn from_centers(centers: &[Vec3; Finger::COUNT]) -> Self {
        let mut tips = Self::default();
        for (&finger, center) in Finger::ALL.iter().zip(centers) {
            tips.centers[finger.index()] = (*center).into();
            if center.is_finite() {
                tips.known = tips.known.with(finger);
            }
        }
        tips
    }

    /// Converts positions in the world to the frame of a surface. Positions that are not finite there are unknown.
    fn on_surface(&self, surface: &Surface, pose: &HandPose) -> Self {
        let mut tips = Self::default();
        let Some(world_from_surface) = surface.world_from_surface(pose) else {
            return tips;
        };
        let surface_from_world = world_from_surface.inverse();
        let origin = Vec3A::from(surface_from_world.translation);
        for &finger in Finger::ALL {
            let index = finger.index();
            let center = surface_from_world.rotation * self.centers[index] + origin;
            tips.centers[index] = center;
            if self.known.contains(finger) && center.is_finite() {
                tips.known = tips.known.with(finger);
            }
        }
        tips
    }

    fn get(&self, finger: Finger) -> Option<Vec3> {
        let center = self.centers[finger.index()];
        self.known.contains(finger).then(|| center.into())
    }
}

/// The fingertips in the previous and the current pose, in the frame of one surface.
#[derive(Clone, Copy, Debug, Default)]
pub(crate) struct FingertipPositions {
    previous: Fingertips,
    current: Fingertips,
}

impl FingertipPositions {
    /// Creates the positions of the previous and the current pose. Those that are not finite are unknown.
    pub fn from_centers(centers: [[Vec3; Finger::COUNT]; 2]) -> Self {
        let [previous, current] = centers.map(|centers| Fingertips::from_centers(&centers));
        Self { previous, current }
    }

    /// Appends a pose with these fingertips in the world. After a jump the previous positions are unknown.
    pub(super) fn push(&mut self, tips: &Fingertips, surface: &Surface, pose: &HandPose) {
        self.previous = match pose.jumped {
            true => Fingertips::default(),
            false => self.current,
        };
        self.current = tips.on_surface(surface, pose);
    }

    /// Returns the previous and the current center of a fingertip, if both are known.
    #[inline]
    pub fn centers(&self, finger: Finger) -> Option<[Vec3; 2]> {
        Some([self.previous.get(finger)?, self.current.get(finger)?])
    }
}

/// Returns the center of a fingertip that may press (world, metres), or `None` if it is not known,
/// not finite or untrusted.
pub fn trusted_fingertip(pose: &HandPose, finger: Finger) -> Option<Vec3> {
    if pose.untrusted.contains(finger) || !pose.tip_radius.is_finite() {
        return None;
    }
    pose.fingertip(finger).filter(|center| center.is_finite())
}
