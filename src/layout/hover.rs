//! Where fingertips are over the boards, for displays.

use parry3d::math::{Vec2, Vec3};

use super::model::Layout;
use crate::hand::Finger;
use crate::kinematics::HandPose;

/// A fingertip over a board.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Hover {
    /// The board's place in [`Layout::boards`].
    pub board: usize,
    /// Whose fingertip.
    pub finger: Finger,
    /// Where it is along and across the board's rows, in metres, as [`Front::at`](super::Front::at).
    pub row_position: Vec2,
    /// How far the fingertip's pad is in front of the keys, in metres; negative when it pushes in.
    pub height: f32,
}

impl Layout {
    /// Where each fingertip is over each board.
    pub fn hovers(&self, pose: &HandPose) -> Vec<Hover> {
        let mut found = Vec::new();
        for (board, surface) in self.scene.surfaces().iter().enumerate() {
            let Some(world_from_surface) = surface.world_from_surface(pose) else {
                continue;
            };
            let board_over = &self.boards[board];
            for &finger in Finger::ALL {
                let Some(tip) = pose.fingertip(finger) else {
                    continue;
                };
                let at: Vec3 = board_over.unbend(world_from_surface.inverse_transform_point(tip));
                found.push(Hover {
                    board,
                    finger,
                    row_position: at.truncate(),
                    height: at.z - pose.tip_radius,
                });
            }
        }
        found
    }
}
