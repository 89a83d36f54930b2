//! A ray from the eye through a point of a picture, and the front that it selects.

use parry3d::math::{Pose, Vec3};

use super::TargetId;
use super::surface::Surface;
use super::sweep::distance_from_outline;

/// The smallest cosine of the angle between a ray and the direction into a front. A flatter ray would meet the plane far away.
const MIN_FACING: f32 = 0.02;

/// A ray in the world.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Ray {
    /// The eye, in metres.
    pub origin: Vec3,
    /// The direction, of length 1.
    pub direction: Vec3,
}

/// A point of a ray on the plane of a front, on the front or beside it.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct FrontHit {
    /// The target of the front.
    pub target: TargetId,
    /// The point in the world, in metres.
    pub point: Vec3,
    /// The direction out of the front, of length 1.
    pub normal: Vec3,
    /// The travel of the target, in metres.
    pub travel: f32,
    /// The distance of the point from the outline, in metres; 0 on the front.
    pub beside: f32,
    /// The distance of the point from the eye, in metres.
    pub distance: f32,
}

impl Ray {
    /// Returns the front of a board that the ray means: the nearest one that it meets, or else the one that it passes with the
    /// smallest distance of at most `reach` metres. Fronts that are turned away are not seen, and targets that fingers press by
    /// bending have no front to press.
    pub fn front_of(
        &self,
        surface: &Surface,
        world_from_surface: &Pose,
        reach: f32,
    ) -> Option<FrontHit> {
        if surface.is_bent() {
            return None;
        }
        let mut meant: Option<FrontHit> = None;
        for (id, target) in surface.targets() {
            let pose = *world_from_surface * target.surface_from_target;
            let normal = pose.rotation * Vec3::Z;
            let Some(point) = self.on_plane(pose.translation, normal) else {
                continue;
            };
            let on_front = pose.inverse_transform_point(point).truncate();
            let hit = FrontHit {
                target: id,
                point,
                normal,
                travel: target.travel,
                beside: distance_from_outline(target.shape, on_front),
                distance: point.distance(self.origin),
            };
            if hit.beside <= reach && meant.is_none_or(|other| hit.precedes(&other)) {
                meant = Some(hit);
            }
        }
        meant
    }

    /// Returns the point at which the ray enters a plane from its front; `None` if it does not, or at a very small angle.
    pub fn on_plane(&self, point: Vec3, normal: Vec3) -> Option<Vec3> {
        let facing = self.direction.dot(normal);
        let distance = (point - self.origin).dot(normal) / facing;
        (facing < -MIN_FACING && distance > 0.0).then(|| self.origin + self.direction * distance)
    }
}

impl FrontHit {
    /// Returns `true` if the ray means this front rather than `other`: it passes this one with a smaller distance, or this one
    /// hides the other.
    pub fn precedes(&self, other: &Self) -> bool {
        (self.beside, self.distance) < (other.beside, other.distance)
    }
}

#[cfg(test)]
mod tests {
    use parry3d::math::{Rotation, Vec2};

    use super::*;
    use crate::contact::surface::{Anchor, Scene, Shape, Target};
    use crate::contact::target::test_target;

    const REACH: f32 = 0.006;

    fn target(surface_from_target: Pose) -> Target {
        test_target(Shape::Box(Vec2::new(0.008, 0.006)), surface_from_target)
    }

    fn scene(targets: Vec<Target>) -> Scene {
        let mut scene = Scene::new();
        scene.add_surface(Anchor::World, Pose::IDENTITY, targets);
        scene
    }

    fn ray(origin: Vec3, at: Vec3) -> Ray {
        Ray {
            origin,
            direction: (at - origin).normalize(),
        }
    }

    #[test]
    fn a_ray_means_the_front_that_it_meets_first() {
        let at = |x: f32, z: f32| target(Pose::from_translation(Vec3::new(x, 0.0, z)));
        let scene = scene(vec![at(0.0, 0.0), at(0.0, 0.02), at(0.03, 0.0)]);
        let front = |toward: Vec3| {
            let ray = ray(Vec3::new(0.0, -0.1, 0.3), toward);
            let hit = ray.front_of(&scene.surfaces()[0], &Pose::IDENTITY, REACH)?;
            Some((hit.target.0, hit.beside))
        };
        assert_eq!(front(Vec3::new(0.001, 0.001, 0.02)), Some((1, 0.0)));
        assert_eq!(front(Vec3::new(0.03, 0.0, 0.0)), Some((2, 0.0)));
        let (index, beside) = front(Vec3::new(0.041, 0.0, 0.0)).unwrap();
        assert!(index == 2 && (beside - 0.003).abs() < 1e-4, "{beside}");
        assert_eq!(front(Vec3::new(0.1, 0.0, 0.0)), None);
    }

    #[test]
    fn the_point_is_on_a_front_of_a_tilted_board_that_is_bent() {
        let side = Pose::from_parts(Vec3::new(0.02, 0.01, 0.01), Rotation::from_rotation_y(-0.6));
        let scene = scene(vec![target(Pose::IDENTITY), target(side)]);
        let board = Pose::from_parts(Vec3::new(0.1, 0.9, -0.4), Rotation::from_rotation_x(-0.8));
        let meant = board * side * Vec3::new(0.005, -0.003, 0.0);
        let eye = Vec3::new(0.0, 1.4, 0.0);
        let hit = ray(eye, meant).front_of(&scene.surfaces()[0], &board, REACH);
        let hit = hit.unwrap();
        assert_eq!((hit.target.0, hit.travel), (1, 0.004));
        assert!(hit.point.distance(meant) < 1e-5, "{}", hit.point);
        let normal = board.rotation * side.rotation * Vec3::Z;
        assert!(hit.normal.distance(normal) < 1e-5, "{}", hit.normal);
        assert!((hit.distance - eye.distance(meant)).abs() < 1e-5);
    }

    #[test]
    fn a_front_is_not_met_from_behind_nor_behind_the_eye() {
        let scene = scene(vec![target(Pose::IDENTITY)]);
        let front = |origin: Vec3, direction: Vec3| {
            let ray = Ray { origin, direction };
            ray.front_of(&scene.surfaces()[0], &Pose::IDENTITY, REACH)
        };
        assert!(front(Vec3::Z, Vec3::NEG_Z).is_some());
        assert_eq!(front(Vec3::NEG_Z, Vec3::Z), None, "from behind");
        assert_eq!(front(Vec3::NEG_Z, Vec3::NEG_Z), None, "behind the eye");
        assert_eq!(front(Vec3::Z, Vec3::X), None, "along the board");
    }
}
