//! Hit tests: the targets that a fingertip touches at one time or enters during one step.

use parry3d::math::Vec3;

use super::surface::{Surface, Target};
use super::sweep::{Sweep, distance_from_outline, is_inside, pad_position};

/// The largest difference in `t` at which two crossings count as simultaneous: `f32` does not resolve coplanar
/// fronts any finer.
const COPLANAR_TOLERANCE: f32 = 1e-5;

/// The largest depth behind a front, in metres, at which a fingertip counts as inside the target. A finger is at most
/// about 70 mm long (palmar length of the middle finger, doi 10.5115/acb.23.310). A fingertip further behind cannot
/// have pushed through, and on a board that bends around the hand it may be in front of other targets.
const MAX_PENETRATION: f32 = 0.1;

/// Returns the depth of a pad (metres, target's frame) behind the front: more than 0, at most the travel.
/// Returns `None` in front of the plane, on it and outside the outline.
///
/// A pad beyond the travel has the depth of the full travel: pushing through does not release.
pub fn penetration_depth(target: &Target, pad: Vec3) -> Option<f32> {
    let is_behind = pad.z < 0.0 && is_inside(target.shape, pad.truncate(), 0.0);
    is_behind.then(|| (-pad.z).min(target.travel))
}

/// The entry of a fingertip through the front of a target.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Crossing {
    /// The index of the target on its surface.
    pub index: u32,
    /// The position along the sweep, 0..=1.
    pub t: f32,
    /// The sweep over the target, which was computed to find the entry.
    pub(super) sweep: Sweep,
    /// The distance from the outline and the squared distance from the center of the front, in metres and square metres.
    distances: [f32; 2],
}

impl Crossing {
    /// Creates the crossing of a target at `t`.
    fn new(index: u32, target: &Target, t: f32, sweep: Sweep) -> Self {
        let point = sweep.point_at(t).truncate();
        Self {
            index,
            t,
            sweep,
            distances: [
                distance_from_outline(target.shape, point),
                point.length_squared(),
            ],
        }
    }

    /// Returns `true` if this crossing takes precedence over `other`: the earlier one; on a tie, the one nearer to its
    /// outline, then to its center.
    pub fn precedes(&self, other: &Self) -> bool {
        if (self.t - other.t).abs() > COPLANAR_TOLERANCE {
            return self.t < other.t;
        }
        self.distances < other.distances
    }
}

/// Returns the first front of `surface` that a fingertip enters at or after `since` (0..=1); the centers at the start
/// and end of the step and the radius are in the surface's frame (metres). Does not allocate.
#[inline]
pub fn first_crossing(
    surface: &Surface,
    centers: [Vec3; 2],
    radius: f32,
    since: f32,
) -> Option<Crossing> {
    let mut first: Option<Crossing> = None;
    surface.fronts().for_each_entered(centers, radius, |index| {
        let Some(target) = surface.target(surface.target_id(index)) else {
            return;
        };
        let sweep = Sweep::from_centers(target, centers, radius);
        let entry = sweep.t_at_entry(target.shape, target.share);
        let Some(t) = entry.filter(|&t| t >= since) else {
            return;
        };
        let crossing = Crossing::new(index, target, t, sweep);
        if first.is_none_or(|other| crossing.precedes(&other)) {
            first = Some(crossing);
        }
    });
    first
}

/// Returns `true` if a fingertip is behind the front of any target of `surface`, inside its outline and at
/// most 0.1 m deep; center and radius are in the surface's frame (metres).
pub fn is_inside_any_target(surface: &Surface, center: Vec3, radius: f32) -> bool {
    let mut is_inside = false;
    let fronts = surface.fronts();
    fronts.for_each_before(center, radius, MAX_PENETRATION, |index| {
        is_inside |= surface
            .target(surface.target_id(index))
            .is_some_and(|target| {
                let pad = pad_position(target, center, radius);
                pad.z > -MAX_PENETRATION && penetration_depth(target, pad).is_some()
            });
    });
    is_inside
}

/// Returns `true` if a fingertip may be within `distance` metres of a front of `surface`; center and radius
/// are in the surface's frame (metres). Conservative: tests the bounding boxes of the fronts.
pub fn is_near_any_target(surface: &Surface, center: Vec3, radius: f32, distance: f32) -> bool {
    let mut is_near = false;
    for_each_front_near(surface, center, radius + distance, |_| is_near = true);
    is_near
}

/// Calls `visit` with the index of each front whose bounding box is within `distance` metres of a position along each axis;
/// the position is in the surface's frame (metres). May visit a front several times. Does not allocate.
pub fn for_each_front_near(
    surface: &Surface,
    position: Vec3,
    distance: f32,
    visit: impl FnMut(u32),
) {
    surface.fronts().for_each_near(position, distance, visit);
}

#[cfg(test)]
mod tests {
    use std::f32::consts::FRAC_PI_2;

    use parry3d::math::{Pose, Rotation, Vec2};

    use super::*;
    use crate::contact::surface::{Anchor, Scene, Shape, Share};
    use crate::contact::sweep::tests::assert_close;
    use crate::contact::target::test_target;

    const KEY: Shape = Shape::Box(Vec2::new(0.008, 0.006));

    #[test]
    fn a_rotated_target_is_pressed_along_its_own_normal() {
        // The front faces the wearer (+Y of the surface is away), 0.1 m to the right.
        let pose = Pose::from_parts(
            Vec3::new(0.1, 0.0, 0.0),
            Rotation::from_rotation_x(FRAC_PI_2),
        );
        let rotated = test_target(KEY, pose);
        let centers = [Vec3::new(0.1, -0.02, 0.0), Vec3::new(0.1, 0.0, 0.0)];
        let sweep = Sweep::from_centers(&rotated, centers, 0.005);
        assert_close(sweep.t_at_entry(KEY, Share::NONE), Some(0.75), "along +Y");
        let depth = |center| penetration_depth(&rotated, pad_position(&rotated, center, 0.005));
        let inside = Vec3::new(0.107, -0.004, 0.0);
        assert_close(depth(inside), Some(0.001), "inside the width");
        let above = Vec3::new(0.1, -0.004, 0.007);
        assert_eq!(depth(above), None);
    }

    #[test]
    fn the_first_front_wins_and_the_nearest_center_on_a_tie() {
        let at =
            |x: f32, z: f32| test_target(KEY, Pose::from_translation(Vec3::new(x, 0.0, z) * 1e-3));
        let cross = |targets: Vec<Target>, x: f32| {
            let mut scene = Scene::new();
            scene.add_surface(Anchor::World, Pose::IDENTITY, targets);
            let centers = [
                Vec3::new(x, 0.0, 15.0) * 1e-3,
                Vec3::new(x, 0.0, -5.0) * 1e-3,
            ];
            first_crossing(&scene.surfaces()[0], centers, 0.005, 0.0).map(|found| found.index)
        };
        assert_eq!(cross(vec![at(0.0, 0.0), at(0.0, 2.0)], 0.0), Some(1));
        assert_eq!(cross(vec![at(0.0, 0.0), at(4.0, 0.0)], 3.0), Some(1));
        assert_eq!(cross(vec![at(0.0, 0.0), at(4.0, 0.0)], 1.0), Some(0));
        assert_eq!(cross(vec![at(0.0, 0.0), at(16.0, 0.0)], 8.0), None);
    }

    /// The searches on a surface, by testing every target.
    struct LinearSearch<'a>(&'a Surface);

    impl LinearSearch<'_> {
        fn first_crossing(&self, centers: [Vec3; 2], radius: f32) -> Option<Crossing> {
            let mut first: Option<Crossing> = None;
            for (id, target) in self.0.targets() {
                let sweep = Sweep::from_centers(target, centers, radius);
                let Some(t) = sweep.t_at_entry(target.shape, target.share) else {
                    continue;
                };
                let crossing = Crossing::new(id.0, target, t, sweep);
                if first.is_none_or(|other| crossing.precedes(&other)) {
                    first = Some(crossing);
                }
            }
            first
        }

        fn is_inside_any_target(&self, center: Vec3, radius: f32) -> bool {
            self.0.targets().any(|(_, target)| {
                let pad = pad_position(target, center, radius);
                pad.z > -MAX_PENETRATION && penetration_depth(target, pad).is_some()
            })
        }

        /// Returns the distance of the nearest front, in metres.
        fn distance(&self, center: Vec3) -> f32 {
            let distances = self.0.targets().map(|(_, target)| {
                let center = target.surface_from_target.inverse_transform_point(center);
                let beside = match target.shape {
                    Shape::Box(half) => (center.truncate().abs() - half).max(Vec2::ZERO).length(),
                    Shape::Disc(radius) => (center.truncate().length() - radius).max(0.0),
                };
                beside.hypot(center.z)
            });
            distances.fold(f32::INFINITY, f32::min)
        }
    }

    /// Compares all searches with a linear one at random positions within `limit` metres along each axis.
    fn assert_agrees_with_a_linear_search(targets: Vec<Target>, limit: Vec3) {
        const RADIUS: f32 = 0.006;
        let mut scene = Scene::new();
        scene.add_surface(Anchor::World, Pose::IDENTITY, targets);
        let surface = &scene.surfaces()[0];
        let linear = LinearSearch(surface);
        let mut random = fastrand::Rng::with_seed(8);
        let mut position =
            || limit * (2.0 * Vec3::from_array(std::array::from_fn(|_| random.f32())) - 1.0);
        let (mut crossings, mut inside, mut near) = (0, 0, 0);
        for _ in 0..2_000 {
            let [from, to] = [position(), position()];
            // Steep, as in a tap, and in any direction.
            for centers in [
                [from, to],
                [from, from + (to - from) * Vec3::new(0.01, 0.01, 1.0)],
            ] {
                let first = linear.first_crossing(centers, RADIUS);
                assert_eq!(
                    first_crossing(surface, centers, RADIUS, 0.0),
                    first,
                    "{centers:?}"
                );
                crossings += u32::from(first.is_some());
            }
            let expected = linear.is_inside_any_target(from, RADIUS);
            assert_eq!(
                is_inside_any_target(surface, from, RADIUS),
                expected,
                "{from}"
            );
            inside += u32::from(expected);
            let distance = linear.distance(from);
            let is_near = is_near_any_target(surface, from, RADIUS, 0.01);
            // A bounding box reaches beyond its front, by less than half its diagonal.
            assert!(is_near || distance > RADIUS + 0.01, "{from}: {distance} m");
            assert!(!is_near || distance < 0.06, "{from}: {distance} m");
            near += u32::from(is_near);
        }
        assert!(
            crossings > 200 && inside > 100 && near > 100,
            "{crossings} {inside} {near}"
        );
    }

    #[test]
    fn targets_in_any_direction_are_found_as_by_a_linear_search() {
        let mut random = fastrand::Rng::with_seed(7);
        let mut vector = |limit: f32| {
            let mut component = || limit * (2.0 * random.f32() - 1.0);
            Vec3::new(component(), component(), component())
        };
        let shapes = [KEY, Shape::Disc(0.01)].into_iter().cycle();
        let targets = shapes.take(400).map(|shape| {
            let pose = Pose::from_parts(vector(0.1), Rotation::from_scaled_axis(vector(3.0)));
            test_target(shape, pose)
        });
        assert_agrees_with_a_linear_search(targets.collect(), Vec3::splat(0.12));
    }

    #[test]
    fn targets_parallel_to_the_surface_are_found_as_by_a_linear_search() {
        let mut random = fastrand::Rng::with_seed(6);
        let mut between = |low: f32, high: f32| low + (high - low) * random.f32();
        // Turns of the first and of all other targets, and the distance between the lowest and the highest.
        for (turn, spread, thickness) in [(0.0, 0.0, 0.0), (0.5, 0.0, 0.0), (-2.0, 3.0, 0.02)] {
            let target = |index: usize| {
                let cell = Vec3::new((index % 20) as f32 - 9.5, (index / 20) as f32 - 9.5, 0.0);
                let offset = Vec3::new(between(-2.0, 2.0), between(-2.0, 2.0), 0.0) * 1e-3;
                let height = Vec3::Z * between(-0.5, 0.5) * thickness;
                let rotation = Rotation::from_rotation_z(turn + between(-spread, spread));
                let center = Rotation::from_rotation_z(turn) * (cell * 0.019 + offset);
                let shape = match index % 5 {
                    0 => Shape::Disc(between(0.003, 0.012)),
                    _ => Shape::Box(Vec2::new(between(0.002, 0.02), between(0.002, 0.01))),
                };
                test_target(shape, Pose::from_parts(center + height, rotation))
            };
            let targets = (0..400).map(target).collect();
            assert_agrees_with_a_linear_search(targets, Vec3::new(0.25, 0.25, 0.03));
        }
    }
}
