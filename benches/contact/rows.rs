//! Three ways to find the keys that fingertips enter: the contact tracker of the library, and two with parry alone.
//!
//! The tracker also follows presses, releases and positions on the keys; the rows of parry only find entries.

use std::hint::black_box;

use ademan::contact::surface::{Scene, Shape, Surface};
use ademan::contact::{ContactTracker, Phase, TargetId, Touches};
use ademan::hand::Finger;
use ademan::kinematics::HandPose;
use parry3d::bounding_volume::Aabb;
use parry3d::math::{Pose, Vec3};
use parry3d::partitioning::{Bvh, BvhBuildStrategy};
use parry3d::query::{Ray, RayCast, ShapeCastOptions, cast_shapes};
use parry3d::shape::{Ball, Cuboid};

/// The entry of a fingertip into a key: number of the pose, finger, key.
pub type Hit = (usize, Finger, TargetId);

/// A way to find entries. `reset` precedes a pass over poses, which are passed one by one to `step`.
pub trait Row {
    /// Forgets the last pose.
    fn reset(&mut self);

    /// Finds the entries between the last pose and this one.
    fn step(&mut self, pose: &HandPose, hit: &mut dyn FnMut(Finger, TargetId));

    /// Returns all entries of a pass.
    fn hits(&mut self, poses: &[HandPose]) -> Vec<Hit> {
        self.reset();
        let mut hits = Vec::new();
        for (number, pose) in poses.iter().enumerate() {
            self.step(pose, &mut |finger, target| {
                hits.push((number, finger, target));
            });
        }
        hits.sort_unstable_by_key(|&(number, finger, _)| (number, finger.index()));
        hits
    }
}

/// The contact tracker.
pub struct Tracker<'a> {
    scene: &'a Scene,
    tracker: ContactTracker,
    touches: Touches,
}

impl<'a> Tracker<'a> {
    pub fn new(scene: &'a Scene) -> Self {
        Self {
            scene,
            tracker: ContactTracker::new(scene),
            touches: Touches::new(),
        }
    }
}

impl Row for Tracker<'_> {
    fn reset(&mut self) {
        self.touches.clear();
        self.tracker = ContactTracker::new(self.scene);
    }

    fn step(&mut self, pose: &HandPose, hit: &mut dyn FnMut(Finger, TargetId)) {
        self.touches.clear();
        self.tracker
            .update(self.scene, black_box(pose), &mut self.touches);
        for touch in black_box(&self.touches) {
            if touch.phase == Phase::Touched {
                hit(touch.finger, touch.target);
            }
        }
    }
}

/// The fronts of a surface for parry: thin plates in the surface's frame.
struct Plates {
    surface: usize,
    bvh: Bvh,
    poses: Vec<Pose>,
    plates: Vec<Cuboid>,
    previous: [Option<Vec3>; Finger::COUNT],
}

/// Half the thickness of a plate, in metres.
const HALF_THICKNESS: f32 = 1e-5;

impl Plates {
    /// `scale` is the number of units in a metre.
    fn new(index: usize, surface: &Surface, scale: f32) -> Self {
        let (mut poses, mut plates) = (Vec::new(), Vec::new());
        for (_, target) in surface.targets() {
            let Shape::Box(half) = target.shape else {
                panic!("a board of boxes")
            };
            let mut pose = target.surface_from_target;
            // The upper side of the plate is the front.
            pose.translation -= pose.rotation * (Vec3::Z * HALF_THICKNESS);
            pose.translation *= scale;
            poses.push(pose);
            plates.push(Cuboid::new(half.extend(HALF_THICKNESS) * scale));
        }
        let boxes: Vec<Aabb> = plates
            .iter()
            .zip(&poses)
            .map(|(plate, pose)| plate.aabb(pose))
            .collect();
        Self {
            surface: index,
            bvh: Bvh::from_leaves(BvhBuildStrategy::Binned, &boxes),
            poses,
            plates,
            previous: [None; Finger::COUNT],
        }
    }
}

fn plates(scene: &Scene, scale: f32) -> Vec<Plates> {
    let surfaces = scene.surfaces().iter().enumerate();
    surfaces
        .map(|(index, surface)| Plates::new(index, surface, scale))
        .collect()
}

/// Calls `search` with the plates of each surface and the center of each fingertip in the previous and this pose, in the
/// surface's frame, and reports the earliest entry of each finger.
fn step_plates(
    scene: &Scene,
    plates: &mut [Plates],
    scale: f32,
    pose: &HandPose,
    search: impl Fn(&Plates, [Vec3; 2]) -> Option<(u32, f32)>,
    hit: &mut dyn FnMut(Finger, TargetId),
) {
    let mut first = [None::<(TargetId, f32)>; Finger::COUNT];
    for board_plates in plates {
        let surface = &scene.surfaces()[board_plates.surface];
        let Some(world_from_surface) = surface.world_from_surface(pose) else {
            continue;
        };
        let surface_from_world = world_from_surface.inverse();
        for (index, &finger) in Finger::ALL.iter().enumerate() {
            let Some(tip) = pose.fingertip(finger) else {
                continue;
            };
            let current = surface_from_world.transform_point(tip) * scale;
            let Some(previous) = board_plates.previous[index].replace(current) else {
                continue;
            };
            if let Some((leaf, t)) = search(board_plates, [previous, current])
                && first[index].is_none_or(|(_, other)| t < other)
            {
                first[index] = Some((surface.target_id(leaf), t));
            }
        }
    }
    for (found, &finger) in first.iter().zip(Finger::ALL) {
        if let Some((target, _)) = found {
            hit(finger, *target);
        }
    }
}

/// Rays of the pads through parry's tree, each plate tested with parry's ray cast.
pub struct ParryRay<'a> {
    scene: &'a Scene,
    plates: Vec<Plates>,
}

impl<'a> ParryRay<'a> {
    pub fn new(scene: &'a Scene) -> Self {
        let plates = plates(scene, 1.0);
        Self { scene, plates }
    }
}

impl Row for ParryRay<'_> {
    fn reset(&mut self) {
        for plates in &mut self.plates {
            plates.previous = [None; Finger::COUNT];
        }
    }

    fn step(&mut self, pose: &HandPose, hit: &mut dyn FnMut(Finger, TargetId)) {
        let pose = black_box(pose);
        let to_pad = Vec3::Z * pose.tip_radius;
        let search = |plates: &Plates, [previous, current]: [Vec3; 2]| {
            let ray = Ray::new(previous - to_pad, current - previous);
            let found = plates.bvh.cast_ray(&ray, 1.0, |leaf, furthest| {
                let index = leaf as usize;
                plates.plates[index].cast_ray(&plates.poses[index], &ray, furthest, true)
            });
            // A pad that leaves the board, or that starts within a plate, does not enter a key.
            found.filter(|&(_, t)| t > 0.0 && ray.dir.z < 0.0)
        };
        step_plates(self.scene, &mut self.plates, 1.0, pose, search, hit);
    }
}

/// The radius of the ball that stands for a pad in `cast_shapes`, in metres. A ball of the size of a fingertip would meet the
/// edges of keys that the pad does not enter.
const PAD_RADIUS: f32 = 1e-6;

/// Pads cast as small balls against the plates whose bounding boxes they sweep, in millimetres: the tolerances of
/// `cast_shapes` are absolute, and in metres it misses entries.
pub struct ParryShapeCast<'a> {
    scene: &'a Scene,
    plates: Vec<Plates>,
    scale: f32,
}

impl<'a> ParryShapeCast<'a> {
    /// `scale` is the number of units in a metre.
    pub fn new(scene: &'a Scene, scale: f32) -> Self {
        let plates = plates(scene, scale);
        Self {
            scene,
            plates,
            scale,
        }
    }
}

impl Row for ParryShapeCast<'_> {
    fn reset(&mut self) {
        for plates in &mut self.plates {
            plates.previous = [None; Finger::COUNT];
        }
    }

    fn step(&mut self, pose: &HandPose, hit: &mut dyn FnMut(Finger, TargetId)) {
        let pose = black_box(pose);
        let to_pad = Vec3::Z * pose.tip_radius * self.scale;
        let pad = Ball::new(PAD_RADIUS * self.scale);
        let options = ShapeCastOptions {
            max_time_of_impact: 1.0,
            stop_at_penetration: false,
            ..ShapeCastOptions::default()
        };
        let search = |plates: &Plates, [previous, current]: [Vec3; 2]| {
            let motion = current - previous;
            let [from, to] = [previous - to_pad, current - to_pad];
            let extent = Vec3::splat(pad.radius);
            let swept = Aabb::new(from.min(to) - extent, from.max(to) + extent);
            let mut first: Option<(u32, f32)> = None;
            for leaf in plates.bvh.intersect_aabb(&swept) {
                let index = leaf as usize;
                let found = cast_shapes(
                    &plates.poses[index],
                    Vec3::ZERO,
                    &plates.plates[index],
                    &Pose::from_translation(from),
                    motion,
                    &pad,
                    options,
                );
                let Ok(Some(found)) = found else { continue };
                let t = found.time_of_impact;
                // The side of the ball that touches an edge is not the pad.
                let is_front = found.normal1.z > 0.9999;
                if t > 0.0 && is_front && first.is_none_or(|(_, other)| t < other) {
                    first = Some((leaf, t));
                }
            }
            first
        };
        step_plates(self.scene, &mut self.plates, self.scale, pose, search, hit);
    }
}

/// Passes all poses to a row.
pub fn pass(row: &mut impl Row, poses: &[HandPose]) {
    row.reset();
    for pose in poses {
        row.step(pose, &mut |finger, target| {
            black_box((finger, target));
        });
    }
}
