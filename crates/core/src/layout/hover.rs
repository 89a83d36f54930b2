//! Positions of fingertips over boards, for displays.

use parry3d::math::Vec2;

use super::model::Layout;
use crate::contact::surface::Scene;
use crate::hand::Finger;
use crate::kinematics::HandPose;

/// A fingertip over a board.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Hover {
    /// Index of the board in [`Layout::boards`].
    pub board: usize,
    /// The finger.
    pub finger: Finger,
    /// Position in row coordinates, in metres; see [`Face::row_position`](super::Face::row_position).
    pub row_position: Vec2,
    /// Distance from the pad of the fingertip to the board, in metres. Negative while it presses.
    pub height: f32,
}

impl Layout {
    /// Returns the position of each tracked fingertip over each board. `scene` is the scene of the layout, with the
    /// present poses of the boards.
    pub fn hovers(&self, scene: &Scene, pose: &HandPose) -> Vec<Hover> {
        let mut hovers = Vec::new();
        let boards = self.boards.iter().zip(scene.surfaces()).enumerate();
        for (index, (board, surface)) in boards {
            // The place of a hand has no meaning for fingers that press by bending.
            if surface.is_bent() {
                continue;
            }
            let Some(world_from_surface) = surface.world_from_surface(pose) else {
                continue;
            };
            let shape = board.shape;
            for &finger in Finger::ALL {
                let Some(tip) = pose.fingertip(finger) else {
                    continue;
                };
                let position = shape.unbend(world_from_surface.inverse_transform_point(tip));
                hovers.push(Hover {
                    board: index,
                    finger,
                    row_position: position.truncate(),
                    height: position.z - pose.tip_radius,
                });
            }
        }
        hovers
    }
}
