//! The 3D view of a session: hands over boards, from a state and a camera to a [`Picture`].

mod boards;
mod colors;
mod fingertips;
mod hand;
mod labels;
mod limbs;
mod plan;
mod raster;
mod reach;
mod resting;
mod shapes;
mod skin;
mod spaces;

use parry3d::math::{Pose, Vec2, Vec3};

use self::boards::add_board;
pub(crate) use self::boards::corners as front_corners;
pub use self::colors::SceneColors;
#[cfg(test)]
pub(crate) use self::colors::THEMES;
use self::fingertips::{add_rings, add_trail};
use self::hand::{add_bones, add_hand};
pub use self::plan::{PlanScene, draw_plan};
use self::raster::Mesh;
use self::reach::add_reach;
pub use self::resting::beside;
use self::shapes::{add_limbs, add_shapes};
pub(crate) use self::spaces::volume_corners;
use self::spaces::{add_pointer, add_spaces};
use super::camera::{Camera, Projected, Projection};
use super::model::StudioModel;
use super::picture::Picture;
use ademan_core::hand::Joint;
use ademan_core::kinematics::HandPose;

/// Opacity of skin through which bones are seen.
const SKIN_OVER_BONES: f32 = 0.45;

/// Opacity of skin through which keys are seen.
const SKIN_OVER_KEYS: f32 = 0.6;

/// Optional parts of the picture.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct SceneOptions {
    /// Bones and joints, through the skin.
    pub bones: bool,
    /// Skin that hides the keys below it.
    pub opaque: bool,
    /// Trails of the fingertips.
    pub trails: bool,
    /// The space that the fingertips can reach with the elbow where it is.
    pub reach: bool,
}

impl Default for SceneOptions {
    fn default() -> Self {
        Self {
            bones: false,
            opaque: false,
            trails: true,
            reach: false,
        }
    }
}

/// A projection and the picture that is drawn with it.
struct Canvas<'a> {
    projection: Projection,
    size: Vec2,
    colors: &'a SceneColors,
    /// The hands.
    skin: Mesh,
    picture: Picture,
}

impl<'a> Canvas<'a> {
    fn new(projection: Projection, size: Vec2, colors: &'a SceneColors) -> Self {
        Self {
            projection,
            size,
            colors,
            skin: Mesh::default(),
            picture: Picture::default(),
        }
    }

    fn project(&self, point: Vec3) -> Option<Projected> {
        self.projection.project(point)
    }

    /// Returns the picture, with skin of this opacity.
    fn finish(mut self, opacity: f32) -> Picture {
        self.picture.skin = self.skin.draw(self.size, opacity);
        self.picture
    }

    /// Returns `true` if a disc of this radius is on the picture, at least in part.
    fn is_seen(&self, center: Vec2, radius: f32) -> bool {
        center.cmpge(Vec2::splat(-radius)).all() && center.cmple(self.size + radius).all()
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
    let mut canvas = Canvas::new(camera.projection(size), size, colors);
    for pose in model.poses.iter().flatten().filter(|_| options.reach) {
        add_reach(&mut canvas, pose);
    }
    for index in 0..model.view.layout.boards.len() {
        add_board(&mut canvas, model, index);
    }
    add_spaces(&mut canvas, model);
    for pose in model.poses.iter().flatten() {
        add_rings(&mut canvas, model, pose);
        if !add_limbs(&mut canvas, model, pose) {
            add_hand(&mut canvas, pose, options);
        } else if options.bones {
            add_bones(&mut canvas, pose);
        }
    }
    if let Some(hand) = &model.resting {
        add_hand(&mut canvas, hand, options);
    }
    add_shapes(&mut canvas, model);
    if options.trails {
        for trail in model.trails.iter().flatten() {
            add_trail(&mut canvas, trail);
        }
    }
    add_pointer(&mut canvas, model);
    let hides_keys = !model.view.layout.boards.is_empty();
    canvas.finish(match options {
        SceneOptions { bones: true, .. } => SKIN_OVER_BONES,
        SceneOptions { opaque: false, .. } if hides_keys => SKIN_OVER_KEYS,
        _ => 1.0,
    })
}

/// Draws a hand without boards on a picture of this size, in points.
pub fn draw_hand(pose: &HandPose, camera: &Camera, size: Vec2, colors: &SceneColors) -> Picture {
    let mut canvas = Canvas::new(camera.projection(size), size, colors);
    add_hand(&mut canvas, pose, SceneOptions::default());
    canvas.finish(1.0)
}

/// Returns the corners of all keys and controls, and of targets in space, whose place is known.
fn points_to_touch(model: &StudioModel) -> Vec<Vec3> {
    let surfaces = model.view.layout.scene.surfaces().iter().enumerate();
    let mut points = Vec::new();
    for (index, surface) in surfaces {
        if let Some(world_from_board) = model.world_from_board(index) {
            points.extend(surface.targets().flat_map(|(_, target)| {
                boards::corners(target).map(|corner| world_from_board * corner)
            }));
        }
    }
    points.extend(spaces::points(model));
    points
}

/// Returns the points that the first picture shows: the corners of all keys and controls, targets in space, and the hands.
pub fn points_of_interest(model: &StudioModel) -> Vec<Vec3> {
    let mut points = points_to_touch(model);
    // An arm alone is shown with its elbow.
    let is_near = |joint: Joint| {
        if points.is_empty() {
            joint != Joint::Shoulder
        } else {
            !matches!(joint, Joint::Shoulder | Joint::Elbow)
        }
    };
    let hands = model.poses.iter().chain([&model.resting]).flatten();
    let known = hands.flat_map(HandPose::known);
    let near: Vec<Vec3> = known
        .filter(|(joint, _)| is_near(*joint))
        .map(|(_, pose)| pose.translation)
        .collect();
    points.extend(near);
    points
}

/// Returns the direction from which the boards are upright, in radians about the vertical: 0 is behind the wearer, positive to
/// the right.
pub fn bearing(model: &StudioModel) -> f32 {
    // Away from the wearer along a board that lies, and through one that stands.
    let away = |pose: Pose| pose.rotation * Vec3::new(0.0, 0.8, -0.6);
    let boards = 0..model.view.layout.boards.len();
    let boards = boards.filter_map(|index| model.world_from_board(index));
    let away = boards.map(away).sum::<Vec3>() + Vec3::NEG_Z * 1e-3;
    (-away.x).atan2(-away.z)
}

#[cfg(test)]
pub(crate) mod tests;
