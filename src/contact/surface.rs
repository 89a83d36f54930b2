//! Where the controls are in space.

use parry3d::bounding_volume::Aabb;
use parry3d::math::{Pose, Vec2, Vec3};
use parry3d::partitioning::{Bvh, BvhBuildStrategy};

use super::TargetId;
use crate::hand::{Joint, Side};
use crate::kinematics::HandPose;

/// The outline of a target's front, in metres, about its middle.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Shape {
    /// A rectangle with these half extents along the target's X and Y.
    Box(Vec2),
    /// A circle of this radius.
    Disc(f32),
}

/// Something that a fingertip can push in.
///
/// Its own frame has its origin in the middle of its front at rest, +X along its row, +Y away from
/// the wearer, and +Z out of the front; it is pushed along −Z.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Target {
    /// The outline of the front.
    pub shape: Shape,
    /// Where the target is on its surface.
    pub surface_from_target: Pose,
    /// How far it can be pushed in, in metres; more than 0.
    pub travel: f32,
    /// The share of the travel at which it counts as pressed, more than `release_share`, at most 1.
    pub press_at: f32,
    /// The share of the travel at which it counts as let go again, 0 or more.
    pub release_at: f32,
    /// Metres by which the outline is wider for a fingertip that is on it: [`TREMBLE`] for what is
    /// only pushed, [`STRAY`] or more for a handle that is held on to while it moves.
    pub margin: f32,
}

/// The least that a fingertip on a target may be beside its outline, in metres, so that a tremble at
/// the edge does not cancel. An unsupported arm sways 0.5–2 mm below 2 Hz, a fingertip trembles
/// 0.02–0.1 mm (Arch Neurol 1982;39:358).
pub const TREMOR_MARGIN: f32 = 0.002;

/// How far a fingertip may be beside the outline of a handle that it drags, in metres: whoever drags
/// looks at what comes of it and not at the finger. Poke interaction of shipped headsets gives up as far
/// beside a panel.
pub const DRAG_MARGIN: f32 = 0.03;

/// Metres by which the box around a front is thicker than the front on every side.
///
/// It covers the rounding of turned fronts, some 1e-7 m at arm's length. And it gives the boxes a
/// volume: parry chooses where to split a tree by volume, and a tree over boxes without any comes
/// out so lopsided (48 levels for 10 000 fronts instead of 15) that a search through it allocates.
const SKIN: f32 = 1e-5;

/// What a surface is fixed to.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Anchor {
    /// The world's origin.
    World,
    /// A joint's position of the hand that touches; the surface goes along with it and keeps the
    /// world's axes.
    Joint(Joint),
}

/// A group of targets that moves as one.
#[derive(Clone, Debug)]
pub struct Surface {
    side: Option<Side>,
    anchor: Anchor,
    anchor_from_surface: Pose,
    /// The mean of the middles of its fronts, in its own frame.
    middle: Vec3,
    first: u32,
    targets: Vec<Target>,
    fronts: Bvh,
}

impl Surface {
    /// Where the surface is for this pose of the hand; `None` when its anchor is not known, or when it
    /// is there for the other hand.
    pub fn world_from_surface(&self, pose: &HandPose) -> Option<Pose> {
        if self.side.is_some_and(|side| side != pose.side) {
            return None;
        }
        let origin = match self.anchor {
            Anchor::World => Vec3::ZERO,
            Anchor::Joint(joint) => pose.position(joint)?,
        };
        Some(Pose::from_parts(
            origin + self.anchor_from_surface.translation,
            self.anchor_from_surface.rotation,
        ))
    }

    /// The hand that it is there for, where it is not there for either.
    pub fn side(&self) -> Option<Side> {
        self.side
    }

    /// Where the surface is in the world's axes around its anchor.
    pub fn anchor_from_surface(&self) -> Pose {
        self.anchor_from_surface
    }

    /// The mean of the middles of its fronts, in its own frame (metres).
    pub fn center(&self) -> Vec3 {
        self.middle
    }

    /// The targets, each with its id.
    pub fn targets(&self) -> impl Iterator<Item = (TargetId, &Target)> {
        let first = self.first;
        (first..).map(TargetId).zip(&self.targets)
    }

    /// The bounding volume hierarchy over the fronts, in the surface's frame; leaf `i` is the
    /// surface's target number `i`.
    pub fn front_bvh(&self) -> &Bvh {
        &self.fronts
    }

    /// The id of the surface's target number `place`.
    pub fn target_id(&self, place: u32) -> TargetId {
        TargetId(self.first + place)
    }

    /// The target with this id, if it is on this surface.
    pub fn target(&self, id: TargetId) -> Option<&Target> {
        self.targets.get(id.0.checked_sub(self.first)? as usize)
    }
}

/// All targets that fingertips can meet.
#[derive(Clone, Debug, Default)]
pub struct Scene {
    surfaces: Vec<Surface>,
    count: u32,
}

impl Scene {
    /// A scene without targets.
    pub fn new() -> Self {
        Self::default()
    }

    /// Adds a surface for either hand; its targets get the next ids, in order. Returns the id of the
    /// first.
    pub fn add_surface(
        &mut self,
        anchor: Anchor,
        anchor_from_surface: Pose,
        targets: Vec<Target>,
    ) -> TargetId {
        self.add_surface_for(None, anchor, anchor_from_surface, targets)
    }

    /// As [`add`](Self::add), for one hand only where `side` names one.
    pub fn add_surface_for(
        &mut self,
        side: Option<Side>,
        anchor: Anchor,
        anchor_from_surface: Pose,
        targets: Vec<Target>,
    ) -> TargetId {
        let first = self.count;
        let boxes: Vec<Aabb> = targets.iter().map(front_box).collect();
        self.count += targets.len() as u32;
        let middles = targets
            .iter()
            .map(|target| target.surface_from_target.translation);
        self.surfaces.push(Surface {
            side,
            anchor,
            anchor_from_surface,
            middle: middles.sum::<Vec3>() / (targets.len().max(1) as f32),
            first,
            fronts: Bvh::from_leaves(BvhBuildStrategy::Binned, &boxes),
            targets,
        });
        TargetId(first)
    }

    /// The surfaces, in the order in which they were added.
    pub fn surfaces(&self) -> &[Surface] {
        &self.surfaces
    }

    /// Puts the surface number `place` somewhere else around its anchor; one that there is not stays away.
    ///
    /// Whoever follows fingertips over it takes the way of the surface for one of theirs, unless they are
    /// [reset](super::ContactTracker::reset).
    pub fn set_surface_pose(&mut self, place: usize, anchor_from_surface: Pose) {
        if let Some(surface) = self.surfaces.get_mut(place) {
            surface.anchor_from_surface = anchor_from_surface;
        }
    }

    /// How many targets there are.
    pub fn len(&self) -> usize {
        self.count as usize
    }

    /// Whether there is nothing to touch.
    pub fn is_empty(&self) -> bool {
        self.count == 0
    }

    /// The target with this id and its surface.
    pub fn target(&self, id: TargetId) -> Option<(&Surface, &Target)> {
        self.surfaces
            .iter()
            .find_map(|surface| Some((surface, surface.target(id)?)))
    }
}

/// The box around a target's front at rest and its skin, in the surface's frame.
fn front_box(target: &Target) -> Aabb {
    let half = match target.shape {
        Shape::Box(half) => half.extend(0.0),
        Shape::Disc(radius) => Vec3::new(radius, radius, 0.0),
    };
    let axes = parry3d::math::Mat3::from_quat(target.surface_from_target.rotation);
    let reach = axes.x_axis.abs() * half.x + axes.y_axis.abs() * half.y + SKIN;
    let middle = target.surface_from_target.translation;
    Aabb::new(middle - reach, middle + reach)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_tree_over_a_large_board_stays_shallow() {
        for (columns, rows) in [(100, 100), (142, 71), (1000, 10), (10_000, 1)] {
            let key = |number: u32| {
                let middle = Vec3::new((number % columns) as f32, (number / columns) as f32, 0.0);
                Target {
                    shape: Shape::Box(Vec2::splat(0.008)),
                    surface_from_target: Pose::from_translation(middle * 0.019),
                    travel: 0.004,
                    press_at: 0.5,
                    release_at: 0.25,
                    margin: TREMOR_MARGIN,
                }
            };
            let mut scene = Scene::new();
            let keys = (0..columns * rows).map(key).collect();
            scene.add_surface(Anchor::World, Pose::IDENTITY, keys);
            let depth = scene.surfaces()[0].front_bvh().subtree_depth(0);
            assert!(depth <= 24, "{columns} × {rows}: {depth} levels");
        }
    }
}
