//! The 3D view of a session: hands over boards, from a state and a camera to a [`Picture`].

mod boards;
mod colors;
mod hand;

use parry3d::math::{Vec2, Vec3};

use self::boards::add_board;
pub use self::colors::SceneColors;
use self::hand::{add_hand, add_rings};
use super::camera::{Camera, Projected};
use super::model::StudioModel;
use super::picture::Picture;

/// Optional parts of the picture.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct SceneOptions {
    /// Bones and joints, through the skin.
    pub bones: bool,
}

/// The camera and the picture that it draws.
struct Canvas<'a> {
    camera: &'a Camera,
    size: Vec2,
    colors: &'a SceneColors,
    picture: Picture,
}

impl Canvas<'_> {
    fn project(&self, point: Vec3) -> Option<Projected> {
        self.camera.project(point, self.size)
    }
}

/// Draws the boards and the hands on a picture of this size, in points.
pub fn draw(
    model: &StudioModel,
    camera: &Camera,
    size: Vec2,
    colors: &SceneColors,
    options: SceneOptions,
) -> Picture {
    let mut canvas = Canvas {
        camera,
        size,
        colors,
        picture: Picture::default(),
    };
    for index in 0..model.view.layout.boards.len() {
        add_board(&mut canvas, model, index);
    }
    for pose in model.poses.iter().flatten() {
        add_rings(&mut canvas, model, pose);
        add_hand(&mut canvas, pose, options);
    }
    canvas.picture
}

/// Returns the points that the first picture shows: the centers of all keys and controls, or else the hands.
pub fn points_of_interest(model: &StudioModel) -> Vec<Vec3> {
    let surfaces = model.view.layout.scene.surfaces().iter().enumerate();
    let mut points = Vec::new();
    for (index, surface) in surfaces {
        if let Some(world_from_board) = model.world_from_board(index) {
            let targets = surface.targets();
            points.extend(
                targets
                    .map(|(_, target)| world_from_board * target.surface_from_target.translation),
            );
        }
    }
    if points.is_empty() {
        let poses = model.poses.iter().flatten();
        points.extend(poses.flat_map(|pose| pose.known().map(|(_, joint)| joint.translation)));
    }
    points
}
