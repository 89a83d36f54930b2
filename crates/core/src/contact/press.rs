//! The evidence of a press, which a decoder or a score needs in addition to the pressed target.

use arrayvec::ArrayVec;
use parry3d::math::Vec3;

use super::surface::{Scene, Surface, Target};
use super::sweep::distance_from_outline;
use super::{TargetId, Touch};
use crate::hand::{Finger, Side};
use crate::time::Timestamp;

/// Maximum number of neighbors that a press lists.
pub const MAX_NEIGHBORS: usize = 3;

/// The largest distance of a neighbor from the point of a press, in metres: a little more than the pitch of a keyboard.
pub const NEIGHBOR_DISTANCE: f32 = 0.02;

/// A press of a target with its evidence.
#[derive(Clone, Debug, PartialEq)]
pub struct Press {
    /// The time at which the fingertip passed the press depth, interpolated between two poses.
    pub time: Timestamp,
    /// The hand.
    pub side: Side,
    /// The finger.
    pub finger: Finger,
    /// The target that counts as pressed.
    pub target: TargetId,
    /// The position of the pad at that time in the frame of the board, in metres.
    pub point: Vec3,
    /// The depth at that time, in metres behind the front.
    pub depth: f32,
    /// The speed of the pad into the target between the two poses, in metres per second, 0 or more; 0 if the poses have the same
    /// time.
    pub speed: f32,
    /// The other targets of the board nearby, the nearest first.
    pub neighbors: ArrayVec<Neighbor, MAX_NEIGHBORS>,
}

/// A target near a press.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Neighbor {
    /// The target.
    pub target: TargetId,
    /// The distance of the pad from its outline, in metres in the plane of its front; 0 within the outline.
    pub distance: f32,
}

/// The presses of one step. In a step a finger ends at most one contact and begins at most one.
pub type Presses = ArrayVec<Press, { 2 * Finger::COUNT }>;

impl Press {
    /// Creates the press of a fingertip whose center moved from `centers[0]` to `centers[1]`, in the frame of the surface of the
    /// target, within `seconds`.
    pub(super) fn new(
        touch: &Touch,
        (surface, target): (&Surface, &Target),
        centers: [Vec3; 2],
        seconds: f64,
    ) -> Self {
        let depth = touch.depth * target.travel;
        let point = target.surface_from_target * touch.position.extend(-depth);
        let normal = target.surface_from_target.rotation * Vec3::Z;
        let inward = f64::from(normal.dot(centers[0] - centers[1]));
        Self {
            time: touch.time,
            side: touch.side,
            finger: touch.finger,
            target: touch.target,
            point,
            depth,
            speed: if seconds > 0.0 {
                (inward / seconds).max(0.0) as f32
            } else {
                0.0
            },
            neighbors: neighbors(surface, touch.target, point),
        }
    }
}

/// Returns the targets near a point, without the pressed one.
fn neighbors(
    surface: &Surface,
    pressed: TargetId,
    point: Vec3,
) -> ArrayVec<Neighbor, MAX_NEIGHBORS> {
    let mut nearest: ArrayVec<Neighbor, MAX_NEIGHBORS> = ArrayVec::new();
    let fronts = surface.fronts();
    fronts.for_each_near(point, NEIGHBOR_DISTANCE, |index| {
        let id = surface.target_id(index);
        let is_known = id == pressed || nearest.iter().any(|other| other.target == id);
        let Some(target) = surface.target(id).filter(|_| !is_known) else {
            return;
        };
        let at = target.surface_from_target.inverse_transform_point(point);
        let distance = distance_from_outline(target.shape, at.truncate());
        if distance > NEIGHBOR_DISTANCE {
            return;
        }
        // On a tie the target with the lower id precedes, so that the order of the search does not matter.
        let precedes = |other: &Neighbor| (other.distance, other.target.0) < (distance, id.0);
        let rank = nearest.iter().take_while(|other| precedes(other)).count();
        if rank < MAX_NEIGHBORS {
            nearest.truncate(MAX_NEIGHBORS - 1);
            nearest.insert(
                rank.min(nearest.len()),
                Neighbor {
                    target: id,
                    distance,
                },
            );
        }
    });
    nearest
}

/// Finds a target, and the index of its surface.
pub(super) fn locate(scene: &Scene, id: TargetId) -> Option<(usize, &Surface, &Target)> {
    let mut surfaces = scene.surfaces().iter().enumerate();
    surfaces.find_map(|(index, surface)| Some((index, surface, surface.target(id)?)))
}

#[cfg(test)]
mod tests {
    use parry3d::math::{Pose, Rotation, Vec2};

    use super::*;
    use crate::contact::surface::{Anchor, Shape};
    use crate::contact::target::test_target;
    use crate::contact::{ContactTracker, Phase, Touches};
    use crate::hand::Joint;
    use crate::kinematics::HandPose;

    /// Keys of 16 mm at a pitch of 19 mm in three columns and two rows, on a board that stands upright.
    fn board() -> Scene {
        let key = |index: u32| {
            let place = Vec3::new((index % 3) as f32, (index / 3) as f32, 0.0) * 0.019;
            test_target(
                Shape::Box(Vec2::splat(0.008)),
                Pose::from_translation(place),
            )
        };
        let upright = Pose::from_parts(Vec3::new(0.1, 1.0, -0.4), Rotation::from_rotation_x(0.3));
        let mut scene = Scene::new();
        scene.add_surface(Anchor::World, upright, (0..6).map(key).collect());
        scene
    }

    /// A hand whose index fingertip has its pad at a point of the board.
    fn pose(scene: &Scene, time: u64, pad: Vec3) -> HandPose {
        let world_from_board = scene.surfaces()[0].anchor_from_surface();
        let radius = 0.008;
        let center = world_from_board * (pad + Vec3::Z * radius);
        let mut pose = HandPose::new(Timestamp(time), Side::Right, radius);
        pose.set(Joint::tip(Finger::Index), Pose::from_translation(center));
        pose
    }

    fn press(from: Vec3, to: Vec3, microseconds: u64) -> Press {
        let scene = board();
        let mut tracker = ContactTracker::new(&scene);
        let mut touches = Touches::new();
        for (time, pad) in [(0, from), (microseconds, to)] {
            touches.clear();
            tracker.update(&scene, &pose(&scene, time, pad), &mut touches);
        }
        assert!(touches.iter().any(|touch| touch.phase == Phase::Pressed));
        let mut presses = Presses::new();
        tracker.add_presses(&scene, &touches, &mut presses);
        assert_eq!(presses.len(), 1);
        presses.swap_remove(0)
    }

    #[test]
    fn a_press_has_its_time_point_depth_and_speed() {
        // From 6 mm above to 2 mm behind key 1 in 10 ms, 5 mm to the right and 1 mm up in the same time.
        let (from, to) = (
            Vec3::new(0.017, 0.0, 0.006),
            Vec3::new(0.022, 0.001, -0.002),
        );
        let press = press(from, to, 10_000);
        assert_eq!(press.target, TargetId(1));
        assert_eq!((press.finger, press.side), (Finger::Index, Side::Right));
        assert_eq!(press.time, Timestamp(10_000));
        assert!((press.point - to).length() < 1e-6, "{:?}", press.point);
        assert!((press.depth - 0.002).abs() < 1e-6);
        assert!((press.speed - 0.8).abs() < 1e-3, "{}", press.speed);
    }

    #[test]
    fn the_time_and_the_point_are_interpolated_between_two_poses() {
        // The press depth of 2 mm is passed after three quarters of the way.
        let press = press(
            Vec3::new(0.019, 0.0, 0.004),
            Vec3::new(0.023, 0.0, -0.004),
            8_000,
        );
        assert_eq!(press.time, Timestamp(6_000));
        assert!((press.point - Vec3::new(0.022, 0.0, -0.002)).length() < 1e-6);
        assert!((press.speed - 1.0).abs() < 1e-3, "{}", press.speed);
    }

    #[test]
    fn the_nearest_targets_are_listed_by_their_distance() {
        // 2 mm from the right edge of key 1 and 1 mm from its upper edge: the gaps between keys are 3 mm wide.
        let pad = Vec3::new(0.025, 0.007, 0.0);
        let press = press(pad + Vec3::Z * 0.003, pad - Vec3::Z * 0.003, 8_000);
        let found: Vec<u32> = press.neighbors.iter().map(|near| near.target.0).collect();
        assert_eq!(found, [4, 2, 5]);
        let expected = [0.004, 0.005, (0.005_f32.powi(2) + 0.004_f32.powi(2)).sqrt()];
        for (near, distance) in press.neighbors.iter().zip(expected) {
            assert!((near.distance - distance).abs() < 1e-5, "{near:?}");
        }
    }
}
