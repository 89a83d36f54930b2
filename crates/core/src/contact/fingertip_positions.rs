//! The positions of the fingertips in the frame of one surface.

use std::time::Duration;

use glam::Vec3A;
use parry3d::math::Vec3;

use super::surface::Surface;
use super::tip_noise::TipNoise;
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

    /// Sets the center of a fingertip. One that is not finite is unknown.
    fn set(&mut self, finger: Finger, center: Vec3A) {
        self.centers[finger.index()] = center;
        self.known = if center.is_finite() {
            self.known.with(finger)
        } else {
            self.known.without(finger)
        };
    }

    /// Sets all fingertips from `tips`, which are in the world, converted to the frame of a surface. Positions that are not finite
    /// there are unknown. Returns `true` if the pose of the surface is known.
    fn set_from_world(&mut self, tips: &Self, surface: &Surface, pose: &HandPose) -> bool {
        self.known = FingerSet::NONE;
        let Some(world_from_surface) = surface.world_from_surface(pose) else {
            return false;
        };
        let surface_from_world = world_from_surface.inverse();
        let origin = Vec3A::from(surface_from_world.translation);
        for &finger in Finger::ALL {
            let index = finger.index();
            let center = surface_from_world.rotation * tips.centers[index] + origin;
            self.centers[index] = center;
            if tips.known.contains(finger) && center.is_finite() {
                self.known = self.known.with(finger);
            }
        }
        origin.is_finite()
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
    /// The fingers that keep the position of the previous pose, because this pose has none.
    held: FingerSet,
    /// The noise of the fingertips, without positions that [`set`](Self::set) has set.
    pub(super) noise: TipNoise,
}

/// The longest time between two poses for which a fingertip that is missing in the second one keeps its position: two readings of
/// a camera with 30 pictures per second.
const MAX_HOLD: Duration = Duration::from_millis(70);

impl FingertipPositions {
    /// Sets the previous and the current center of a fingertip. One that is not finite is unknown.
    pub fn set(&mut self, finger: Finger, [previous, current]: [Vec3; 2]) {
        self.previous.set(finger, previous.into());
        self.current.set(finger, current.into());
    }

    /// Appends a pose with these fingertips in the world, `gap` after the previous one. After a jump the previous positions are
    /// unknown.
    ///
    /// A fingertip that is missing in one pose keeps its position on the surface, so that a tracker that loses a fingertip in one
    /// picture neither ends a touch nor misses a tap. In the next pose the fingertip is unknown.
    pub(super) fn push(
        &mut self,
        tips: &Fingertips,
        surface: &Surface,
        pose: &HandPose,
        gap: Duration,
    ) {
        // Field by field: a copy of the whole loads bytes at once that were just stored one by one.
        self.previous.centers = self.current.centers;
        self.previous.known = if pose.jumped {
            FingerSet::NONE
        } else {
            self.current.known
        };
        let is_placed = self.current.set_from_world(tips, surface, pose);
        let mut held = FingerSet::NONE;
        // If the whole hand is not seen, the estimator decides for how long it is held.
        let is_hand_seen = pose.untrusted != FingerSet::ALL;
        let is_any_missing = self.previous.known != self.current.known;
        if is_any_missing && is_placed && is_hand_seen && gap <= MAX_HOLD {
            held = self.hold_missing();
        }
        self.held = held;
        if pose.jumped {
            self.noise.forget_positions();
        }
        let current = &self.current;
        self.noise.push(current.known, &current.centers, gap);
    }

    /// Keeps the positions of fingertips that are missing for the first time, and returns these fingers.
    fn hold_missing(&mut self) -> FingerSet {
        let missing = self.previous.known.difference(self.current.known);
        let held = missing.difference(self.held);
        for finger in Finger::ALL.iter().filter(|&&finger| held.contains(finger)) {
            let index = finger.index();
            self.current.centers[index] = self.previous.centers[index];
        }
        self.current.known = self.current.known.union(held);
        held
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
