//! Moving boards while they are in force.

use parry3d::math::{Pose, Rot3, Vec3};

use super::LayoutInstance;
use crate::contact::board_pose::BoardPose;
use crate::contact::surface::Surface;
use crate::contact::tracker::trusted_fingertip;
use crate::hand::{Finger, Side};
use crate::kinematics::HandPose;

/// The finger under which boards are brought.
pub(super) const GUIDE: Finger = Finger::Index;

/// Why boards stay where they are.
#[derive(Clone, Copy, Debug, PartialEq, Eq, thiserror::Error)]
pub enum CommandError {
    /// Readings stay away, or have not come yet.
    #[error("no hand is seen: hold it where the boards are to go, and ask again")]
    NoHand,
    /// The hand is seen, and its index fingertip is not known.
    #[error(
        "the index fingertip of the {0} hand cannot be made out, so there is no place to go to"
    )]
    NoFingertip(Side),
    /// The boards are there for the other hand, or their anchor is not known.
    #[error("no board is there for the {0} hand, which was seen last")]
    NoBoard(Side),
    /// A file could not say the place.
    #[error(
        "board {0} would be more than 2000 mm to one side of its anchor, so no board was moved"
    )]
    TooFar(usize),
    /// A file could not say the tilt.
    #[error("board {0} would lean over: a tilt is -90 to 90 degrees, so no board was moved")]
    TooSteep(usize),
}

/// A way in which boards are moved.
#[derive(Clone, Copy, Debug)]
pub(super) enum Move<'a> {
    /// By so many metres along the axes of the world.
    Nudge(Vec3),
    /// Each about its own rows through its (0, 0), by so many radians: the far side rises.
    Tilt(f32),
    /// The same as a nudge, for the boards that are there for this hand.
    Bring(Vec3, &'a HandPose),
}

impl Move<'_> {
    /// Where a surface goes; `None` where it stays.
    fn of(self, surface: &Surface) -> Option<Pose> {
        let pose = surface.anchor_from_surface();
        let shifted = |by| Pose::from_parts(pose.translation + by, pose.rotation);
        match self {
            Self::Nudge(by) => Some(shifted(by)),
            Self::Tilt(by) => {
                let turned = pose.rotation * Rot3::from_rotation_x(by);
                Some(Pose::from_parts(pose.translation, turned))
            }
            Self::Bring(by, hand) => surface.world_from_surface(hand).map(|_| shifted(by)),
        }
    }
}

impl LayoutInstance {
    /// Where each board is.
    pub fn places(&self) -> impl Iterator<Item = BoardPose> {
        let surfaces = self.scene.surfaces().iter();
        surfaces.map(|surface| BoardPose::from_pose(&surface.anchor_from_surface()))
    }

    /// Puts the boards where those of `other` are, one by one; nothing where they are not as many.
    pub(super) fn put_as(&mut self, other: &Self) {
        if self.scene.surfaces().len() != other.scene.surfaces().len() {
            return;
        }
        for (place, surface) in other.scene.surfaces().iter().enumerate() {
            self.scene
                .set_surface_pose(place, surface.anchor_from_surface());
        }
    }

    /// How far the boards that are there for this hand have to go, all alike, so that the middle of the
    /// nearest one comes to lie below the index fingertip. That one goes in its own plane, so that the
    /// fingertip stays as far in front of its keys as it is.
    pub(super) fn way_to(&self, pose: &HandPose) -> Result<Vec3, CommandError> {
        let tip = trusted_fingertip(pose, GUIDE).ok_or(CommandError::NoFingertip(pose.side))?;
        let there = self.scene.surfaces().iter().filter_map(|surface| {
            let world_from_board = surface.world_from_surface(pose)?;
            let middle = world_from_board.transform_point(surface.center());
            Some((tip - middle, world_from_board.rotation * Vec3::Z))
        });
        let nearest = there.min_by(|a, b| a.0.length_squared().total_cmp(&b.0.length_squared()));
        let (way, normal) = nearest.ok_or(CommandError::NoBoard(pose.side))?;
        Ok(way - normal * way.dot(normal))
    }

    /// Refuses what a layout file could not say.
    pub(super) fn refuse(&self, way: Move) -> Result<(), CommandError> {
        for (number, surface) in (1..).zip(self.scene.surfaces()) {
            let Some(pose) = way.of(surface) else {
                continue;
            };
            let place = BoardPose::from_pose(&pose);
            if !place.is_distance_valid() {
                return Err(CommandError::TooFar(number));
            }
            if !place.is_tilt_valid() {
                return Err(CommandError::TooSteep(number));
            }
        }
        Ok(())
    }

    /// Moves boards. Nothing may be touched: every touch has to be let go of before.
    pub(super) fn shift(&mut self, way: Move) {
        for place in 0..self.scene.surfaces().len() {
            if let Some(pose) = way.of(&self.scene.surfaces()[place]) {
                self.scene.set_surface_pose(place, pose);
            }
        }
        self.drifting.settle();
    }
}
