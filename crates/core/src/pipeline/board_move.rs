//! Moves of the boards of the active layout.

use parry3d::math::{Pose, Rot3, Vec3};

use super::auto_recenter::RECENTER_FINGER;
use super::{CommandError, LayoutInstance};
use crate::contact::board_pose::BoardPose;
use crate::contact::surface::Surface;
use crate::contact::trusted_fingertip;
use crate::kinematics::HandPose;

/// A move of several boards.
#[derive(Clone, Copy, Debug)]
pub(super) enum BoardMove<'a> {
    /// A translation in metres along the axes of the world.
    Nudge(Vec3),
    /// A rotation of each board about its own X axis, in radians; positive raises the far side.
    Tilt(f32),
    /// A translation, only of the boards that this hand can touch.
    Recenter(Vec3, &'a HandPose),
}

impl BoardMove<'_> {
    /// Returns the new `anchor_from_surface`, or `None` if the surface does not move.
    fn moved(self, surface: &Surface) -> Option<Pose> {
        let pose = surface.anchor_from_surface();
        let translated = |by| Pose::from_parts(pose.translation + by, pose.rotation);
        match self {
            Self::Nudge(by) => Some(translated(by)),
            Self::Tilt(by) => {
                let rotation = pose.rotation * Rot3::from_rotation_x(by);
                Some(Pose::from_parts(pose.translation, rotation))
            }
            Self::Recenter(by, hand) => surface.world_from_surface(hand).map(|_| translated(by)),
        }
    }
}

impl LayoutInstance {
    /// Iterates over the poses of the boards.
    pub fn board_poses(&self) -> impl Iterator<Item = BoardPose> {
        let surfaces = self.scene.surfaces().iter();
        surfaces.map(|surface| BoardPose::from_pose(&surface.anchor_from_surface()))
    }

    /// Copies the board poses of `other`; does nothing if the numbers of boards differ.
    pub(super) fn copy_board_poses(&mut self, other: &Self) {
        if self.scene.surfaces().len() != other.scene.surfaces().len() {
            return;
        }
        for (index, surface) in other.scene.surfaces().iter().enumerate() {
            self.scene
                .set_surface_pose(index, surface.anchor_from_surface());
        }
    }

    /// Returns the translation of all boards of a hand, in metres, that brings the center of the nearest one below the
    /// index fingertip. The nearest board moves in its own plane, so the height of the fingertip above its keys does not
    /// change.
    pub fn recenter_offset(&self, pose: &HandPose) -> Result<Vec3, CommandError> {
        let fingertip =
            trusted_fingertip(pose, RECENTER_FINGER).ok_or(CommandError::NoFingertip(pose.side))?;
        let offsets = self.scene.surfaces().iter().filter_map(|surface| {
            let world_from_board = surface.world_from_surface(pose)?;
            let center = world_from_board.transform_point(surface.center());
            Some((fingertip - center, world_from_board.rotation * Vec3::Z))
        });
        let nearest = offsets.min_by(|a, b| a.0.length_squared().total_cmp(&b.0.length_squared()));
        let (offset, normal) = nearest.ok_or(CommandError::NoBoard(pose.side))?;
        Ok(offset - normal * offset.dot(normal))
    }

    /// Checks that there are boards, and that a layout file can represent their poses after a move.
    pub(super) fn check_move(&self, board_move: BoardMove) -> Result<(), CommandError> {
        if self.scene.surfaces().is_empty() {
            return Err(CommandError::NoBoards);
        }
        for (number, surface) in (1..).zip(self.scene.surfaces()) {
            let Some(pose) = board_move.moved(surface) else {
                continue;
            };
            let pose = BoardPose::from_pose(&pose);
            if !pose.is_distance_valid() {
                return Err(CommandError::TooFar(number));
            }
            if !pose.is_tilt_valid() {
                return Err(CommandError::TooSteep(number));
            }
        }
        Ok(())
    }

    /// Moves boards. All touches must have been released before.
    pub(super) fn apply_move(&mut self, board_move: BoardMove) {
        for index in 0..self.scene.surfaces().len() {
            if let Some(pose) = board_move.moved(&self.scene.surfaces()[index]) {
                self.scene.set_surface_pose(index, pose);
            }
        }
        self.auto_recenter.rebase();
    }
}
