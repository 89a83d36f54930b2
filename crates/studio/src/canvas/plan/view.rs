//! The directions from which all boards are seen.

use parry3d::math::{Vec2, Vec3};

use crate::camera::{orbited, view_axes};

/// A direction from which all boards are seen, without perspective.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub enum PlanView {
    /// From above: away from the wearer is up on the picture.
    #[default]
    Above,
    /// From the front, as the wearer sees them.
    Front,
    /// From the right of the wearer: away from the wearer is to the right on the picture.
    Side,
    /// From a direction that is turned freely.
    Free {
        /// Direction of the eye about the vertical, in radians: 0 is behind the wearer, positive to the right.
        azimuth: f32,
        /// Elevation of the eye above the horizon, in radians.
        elevation: f32,
    },
}

impl PlanView {
    /// The free view before it is turned.
    pub const FREE: Self = Self::Free {
        azimuth: 0.6,
        elevation: 0.6,
    };

    /// All views; a view is at its index.
    pub const ALL: [Self; 4] = [Self::Above, Self::Front, Self::Side, Self::FREE];

    /// Returns its index in [`ALL`](Self::ALL), whatever the direction of a free view is.
    pub const fn index(self) -> usize {
        match self {
            Self::Above => 0,
            Self::Front => 1,
            Self::Side => 2,
            Self::Free { .. } => 3,
        }
    }

    /// Returns `true` if it is turned freely: no axis of the world need be one of the picture.
    pub const fn is_free(self) -> bool {
        matches!(self, Self::Free { .. })
    }

    /// Returns the free view after a drag in points; the others do not turn.
    #[must_use]
    pub fn turned(self, drag: Vec2) -> Self {
        let Self::Free { azimuth, elevation } = self else {
            return self;
        };
        let [azimuth, elevation] = orbited([azimuth, elevation], drag);
        Self::Free { azimuth, elevation }
    }

    /// Returns the directions of the world to the right and up on the picture, and towards the eye.
    pub fn axes(self) -> [Vec3; 3] {
        match self {
            Self::Above => [Vec3::X, Vec3::NEG_Z, Vec3::Y],
            Self::Front => [Vec3::X, Vec3::Y, Vec3::Z],
            Self::Side => [Vec3::NEG_Z, Vec3::Y, Vec3::X],
            Self::Free { azimuth, elevation } => view_axes(azimuth, elevation),
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
        let [right, up, _] = self.axes();
        let along = |axis: Vec3| f64::from(right.dot(axis)) * x + f64::from(up.dot(axis)) * y;
        [Vec3::X, Vec3::NEG_Z, Vec3::Y].map(along)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::camera::Camera;

    #[test]
    fn a_motion_on_the_picture_is_the_same_motion_in_space() {
        let turned = PlanView::FREE.turned(Vec2::new(-250.0, 90.0));
        for view in PlanView::ALL.into_iter().chain([turned]) {
            let [right, up, back] = view.axes();
            assert!(right.cross(up).distance(back) < 1e-6, "{view:?}");
            let [x, away, height] = view.motion([3.0, 5.0]);
            let moved = Vec3::new(x as f32, height as f32, -away as f32) / 1e3;
            let on_picture = view.flatten(moved);
            assert!((on_picture - Vec2::new(3.0, 5.0)).length() < 1e-4);
            assert!(view.point(on_picture).distance(moved) < 1e-6);
            assert!(
                view.nearness(moved).abs() < 1e-6,
                "in the plane of the picture"
            );
        }
        assert_eq!(PlanView::Side.motion([0.1, 0.7]), [0.0, 0.1, 0.7], "exact");
    }

    #[test]
    fn a_drag_turns_the_free_view_as_it_turns_the_camera() {
        for (index, view) in PlanView::ALL.into_iter().enumerate() {
            assert_eq!(view.index(), index);
            assert_eq!(view.turned(Vec2::new(40.0, 0.0)) != view, view.is_free());
        }
        let mut camera = Camera {
            azimuth: 0.6,
            elevation: 0.6,
            ..Camera::default()
        };
        let drag = Vec2::new(35.0, -20.0);
        camera.orbit(drag);
        assert_eq!(PlanView::FREE.turned(drag).axes(), camera.axes());
        let above = PlanView::FREE.turned(Vec2::Y * 1e4);
        assert!(above.axes()[2].distance(Vec3::Y) < 1e-6, "not upside down");
    }
}
