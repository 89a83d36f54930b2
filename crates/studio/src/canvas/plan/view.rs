//! The directions from which all boards are seen.

use parry3d::math::{Vec2, Vec3};

/// A direction from which all boards are seen, without perspective.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum PlanView {
    /// From above: away from the wearer is up on the picture.
    #[default]
    Above,
    /// From the front, as the wearer sees them.
    Front,
    /// From the right of the wearer: away from the wearer is to the right on the picture.
    Side,
}

impl PlanView {
    /// All views; a view is at its index.
    pub const ALL: [Self; 3] = [Self::Above, Self::Front, Self::Side];

    /// Returns the directions of the world to the right and up on the picture, and towards the eye.
    pub const fn axes(self) -> [Vec3; 3] {
        match self {
            Self::Above => [Vec3::X, Vec3::NEG_Z, Vec3::Y],
            Self::Front => [Vec3::X, Vec3::Y, Vec3::Z],
            Self::Side => [Vec3::NEG_Z, Vec3::Y, Vec3::X],
        }
    }

    /// Returns the position of a point of the world, which is in metres, on the picture, in millimetres.
    pub fn flatten(self, point: Vec3) -> Vec2 {
        let [right, up, _] = self.axes();
        Vec2::new(point.dot(right), point.dot(up)) * 1e3
    }

    /// Returns the nearness of a point to the eye, in metres.
    pub fn nearness(self, point: Vec3) -> f32 {
        point.dot(self.axes()[2])
    }

    /// Returns the point of the world at a position on the picture, in the plane through the origin.
    pub fn point(self, position: Vec2) -> Vec3 {
        let [right, up, _] = self.axes();
        (right * position.x + up * position.y) / 1e3
    }

    /// Returns a motion on the picture as a motion in space: to the right, away from the wearer and up, in millimetres.
    pub fn motion(self, [x, y]: [f64; 2]) -> [f64; 3] {
        match self {
            Self::Above => [x, y, 0.0],
            Self::Front => [x, 0.0, y],
            Self::Side => [0.0, x, y],
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_motion_on_the_picture_is_the_same_motion_in_space() {
        for view in PlanView::ALL {
            let [right, up, back] = view.axes();
            assert_eq!(right.cross(up), back, "{view:?}");
            let [x, away, height] = view.motion([3.0, 5.0]);
            let moved = Vec3::new(x as f32, height as f32, -away as f32) / 1e3;
            let on_picture = view.flatten(moved);
            assert!((on_picture - Vec2::new(3.0, 5.0)).length() < 1e-4);
            assert!(view.point(on_picture).distance(moved) < 1e-6);
        }
    }
}
