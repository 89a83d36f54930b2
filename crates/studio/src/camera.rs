//! The camera of the 3D view, which orbits around a point.

use std::f32::consts::FRAC_PI_2;

use parry3d::math::{Vec2, Vec3};

use ademan_core::contact::ray::Ray;

/// Nearest point that is drawn, in metres from the eye.
const NEAR: f32 = 0.02;

/// Focal length in heights of the picture.
const FOCAL: f32 = 1.25;

/// Distance of the eye of a parallel projection from its center, in metres: everything is before it.
const PARALLEL_DISTANCE: f32 = 10.0;

/// Rotation per pixel of a drag, in radians.
const ORBIT_SPEED: f32 = 0.008;

/// Drag that one key stands for, in points: 14° of an orbit.
const KEY_DRAG: f32 = 30.0;

/// Factor of the distance of one key.
const KEY_ZOOM: f32 = 1.15;

/// Range of the distance from the eye to the target, in metres.
const DISTANCES: (f32, f32) = (0.08, 6.0);

/// Part of the picture that framed points fill.
const FRAME: f32 = 0.88;

/// Steps that approach the distance from which points fill the picture.
const FRAMING_STEPS: usize = 12;

/// A camera that looks at a target.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Camera {
    /// The point in the middle of the picture, in the world.
    pub target: Vec3,
    /// Direction of the eye about the vertical, in radians: 0 is behind the wearer, positive to the right.
    pub azimuth: f32,
    /// Elevation of the eye above the horizon, in radians.
    pub elevation: f32,
    /// Distance from the eye to the target, in metres.
    pub distance: f32,
}

/// A position of the camera with a name.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Viewpoint {
    /// Above and behind the wearer.
    Eye,
    /// Straight above.
    Above,
    /// Straight below.
    Below,
    /// At the right of the wearer.
    Side,
}

/// A movement of the camera by a key. Directions are those in which the eye moves: to the right and up, −1, 0 or 1.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum CameraStep {
    /// Turns around the target.
    Orbit(f32, f32),
    /// Moves the target.
    Pan(f32, f32),
    /// Approaches the target if positive.
    Zoom(f32),
}

impl Viewpoint {
    /// Returns azimuth and elevation, in radians.
    const fn direction(self) -> (f32, f32) {
        match self {
            Self::Eye => (0.0, 1.05),
            Self::Above => (0.0, FRAC_PI_2),
            Self::Below => (0.0, -FRAC_PI_2),
            Self::Side => (FRAC_PI_2, 0.15),
        }
    }
}

/// A point on the screen.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Projected {
    /// Position in points, from the upper left corner.
    pub position: Vec2,
    /// Distance along the view, in metres.
    pub depth: f32,
    /// Points per metre at this depth.
    pub scale: f32,
}

/// The mapping from the world to a picture of one size, computed once for all points.
#[derive(Clone, Copy, Debug)]
pub struct Projection {
    /// Position of the eye.
    pub eye: Vec3,
    /// Directions to the right, up and backwards.
    pub axes: [Vec3; 3],
    /// Focal length in points, or points per metre of a parallel projection.
    focal: f32,
    middle: Vec2,
    is_parallel: bool,
}

impl Projection {
    /// Returns the parallel projection along the last axis with a point in the middle of a picture of this size, at `scale` points per metre.
    pub fn parallel(axes: [Vec3; 3], center: Vec3, scale: f32, size: Vec2) -> Self {
        Self {
            eye: center + axes[2] * PARALLEL_DISTANCE,
            axes,
            focal: scale,
            middle: size / 2.0,
            is_parallel: true,
        }
    }

    /// Returns the direction from a point to the eye; not normalized.
    pub fn to_eye(&self, point: Vec3) -> Vec3 {
        if self.is_parallel {
            self.axes[2]
        } else {
            self.eye - point
        }
    }

    /// Returns the position of a point, or `None` behind the eye.
    pub fn project(&self, point: Vec3) -> Option<Projected> {
        let [right, up, back] = self.axes;
        let offset = point - self.eye;
        let depth = -offset.dot(back);
        if depth < NEAR {
            return None;
        }
        let scale = if self.is_parallel {
            self.focal
        } else {
            self.focal / depth
        };
        let position = self.middle + Vec2::new(offset.dot(right), -offset.dot(up)) * scale;
        Some(Projected {
            position,
            depth,
            scale,
        })
    }

    /// Returns the ray from the eye through a point of the picture.
    pub fn ray(&self, position: Vec2) -> Ray {
        let [right, up, back] = self.axes;
        let offset = (position - self.middle) / self.focal;
        let aside = right * offset.x - up * offset.y;
        if self.is_parallel {
            Ray {
                origin: self.eye + aside,
                direction: -back,
            }
        } else {
            Ray {
                origin: self.eye,
                direction: (aside - back).normalize(),
            }
        }
    }
}

impl Default for Camera {
    fn default() -> Self {
        let (azimuth, elevation) = Viewpoint::Eye.direction();
        Self {
            target: Vec3::new(0.0, 0.0, -0.5),
            azimuth,
            elevation,
            distance: 0.7,
        }
    }
}

impl Camera {
    /// Moves to a named position relative to this azimuth, without a change of target and distance.
    fn look_from(&mut self, viewpoint: Viewpoint, bearing: f32) {
        let (azimuth, elevation) = viewpoint.direction();
        self.azimuth = bearing + azimuth;
        self.elevation = elevation;
    }

    /// Shows all of these points in a picture with this ratio of width to height, as large as they fit. The viewpoint is relative
    /// to the bearing of the boards.
    pub fn frame(&mut self, points: &[Vec3], bearing: f32, viewpoint: Viewpoint, aspect: f32) {
        let bounds = points.iter().map(|&point| (point, point));
        let Some((low, high)) = bounds.reduce(|a, b| (a.0.min(b.0), a.1.max(b.1))) else {
            return;
        };
        self.look_from(viewpoint, bearing);
        self.target = (low + high) / 2.0;
        let size = Vec2::new(aspect, 1.0);
        self.distance = DISTANCES.1;
        for _ in 0..FRAMING_STEPS {
            let Some((lowest, highest)) = self.bounds(points, size) else {
                return;
            };
            let middle = (lowest + highest) / 2.0 - size / 2.0;
            self.pan(-middle, size.y);
            let factor = ((highest - lowest) / (size * FRAME)).max_element();
            self.zoom(factor);
        }
    }

    /// Returns the bounds of points on a picture of this size, or `None` if one is behind the eye.
    fn bounds(&self, points: &[Vec3], size: Vec2) -> Option<(Vec2, Vec2)> {
        let projection = self.projection(size);
        let mut bounds = (Vec2::MAX, Vec2::MIN);
        for &point in points {
            let position = projection.project(point)?.position;
            bounds = (bounds.0.min(position), bounds.1.max(position));
        }
        Some(bounds)
    }

    /// Turns around the target by a drag in points.
    pub fn orbit(&mut self, drag: Vec2) {
        [self.azimuth, self.elevation] = orbited([self.azimuth, self.elevation], drag);
    }

    /// Moves the target by a drag in points of a picture of this height.
    pub fn pan(&mut self, drag: Vec2, height: f32) {
        let [right, up, _] = self.axes();
        let metres = self.distance / (FOCAL * height.max(1.0));
        self.target += (up * drag.y - right * drag.x) * metres;
    }

    /// Multiplies the distance.
    pub fn zoom(&mut self, factor: f32) {
        self.distance = (self.distance * factor).clamp(DISTANCES.0, DISTANCES.1);
    }

    /// Moves by a key, on a picture of this height.
    pub fn step(&mut self, step: CameraStep, height: f32) {
        match step {
            CameraStep::Orbit(right, up) => self.orbit(key_drag(right, up)),
            CameraStep::Pan(right, up) => self.pan(key_drag(right, up), height),
            CameraStep::Zoom(nearer) => self.zoom(KEY_ZOOM.powf(-nearer)),
        }
    }

    /// Returns the position of the eye.
    pub fn eye(&self) -> Vec3 {
        self.target + self.axes()[2] * self.distance
    }

    /// Returns the mapping to a picture of this size.
    pub fn projection(&self, size: Vec2) -> Projection {
        Projection {
            eye: self.eye(),
            axes: self.axes(),
            focal: FOCAL * size.y,
            middle: size / 2.0,
            is_parallel: false,
        }
    }

    /// Returns the position of a point on a picture of this size, or `None` behind the eye.
    pub fn project(&self, point: Vec3, size: Vec2) -> Option<Projected> {
        self.projection(size).project(point)
    }

    /// Returns the directions to the right, up and backwards.
    pub fn axes(&self) -> [Vec3; 3] {
        view_axes(self.azimuth, self.elevation)
    }
}

/// Returns the directions to the right, up and backwards of an eye at this azimuth and elevation, in radians.
pub fn view_axes(azimuth: f32, elevation: f32) -> [Vec3; 3] {
    let (sin, cos) = azimuth.sin_cos();
    let (rise, run) = elevation.sin_cos();
    let back = Vec3::new(sin * run, rise, cos * run);
    let right = Vec3::new(cos, 0.0, -sin);
    [right, back.cross(right), back]
}

/// Returns azimuth and elevation of an eye, in radians, after a drag in points.
pub fn orbited([azimuth, elevation]: [f32; 2], drag: Vec2) -> [f32; 2] {
    let raised = elevation + drag.y * ORBIT_SPEED;
    [
        azimuth - drag.x * ORBIT_SPEED,
        raised.clamp(-FRAC_PI_2, FRAC_PI_2),
    ]
}

/// Returns the drag that one key stands for, in points. Directions are those in which the eye moves: to the right and up.
pub fn key_drag(right: f32, up: f32) -> Vec2 {
    Vec2::new(-right, up) * KEY_DRAG
}

#[cfg(test)]
mod tests {
    use super::*;

    const SIZE: Vec2 = Vec2::new(800.0, 600.0);

    #[test]
    fn the_target_is_in_the_middle_of_every_view() {
        for viewpoint in [Viewpoint::Eye, Viewpoint::Above, Viewpoint::Side] {
            let mut camera = Camera::default();
            camera.look_from(viewpoint, 0.3);
            let middle = camera.project(camera.target, SIZE).unwrap();
            assert!((middle.position - SIZE / 2.0).length() < 1e-2);
            assert!((middle.depth - camera.distance).abs() < 1e-5);
        }
    }

    #[test]
    fn the_ray_through_a_point_of_the_picture_meets_what_is_shown_there() {
        let mut camera = Camera::default();
        camera.orbit(Vec2::new(70.0, -30.0));
        let point = camera.target + Vec3::new(0.12, -0.05, 0.08);
        let shown = camera.project(point, SIZE).unwrap().position;
        let ray = camera.projection(SIZE).ray(shown);
        let along = (point - ray.origin).dot(ray.direction);
        assert!((ray.origin + ray.direction * along).distance(point) < 1e-5);
        assert!(along > 0.0 && (ray.direction.length() - 1.0).abs() < 1e-5);
    }

    #[test]
    fn a_parallel_projection_has_one_scale_and_one_direction() {
        let axes = [Vec3::X, Vec3::NEG_Z, Vec3::Y];
        let center = Vec3::new(0.1, 0.0, -0.3);
        let projection = Projection::parallel(axes, center, 2000.0, SIZE);
        for height in [-0.4, 0.0, 0.7] {
            let point = center + Vec3::new(0.05, height, -0.02);
            let seen = projection.project(point).unwrap();
            let expected = SIZE / 2.0 + Vec2::new(100.0, -40.0);
            assert!((seen.position - expected).length() < 1e-2, "{seen:?}");
            assert_eq!((seen.scale, projection.to_eye(point)), (2000.0, Vec3::Y));
            let ray = projection.ray(seen.position);
            assert_eq!(ray.direction, Vec3::NEG_Y);
            assert!((ray.origin - point).cross(Vec3::Y).length() < 1e-5);
        }
    }

    #[test]
    fn right_and_up_in_the_world_are_right_and_up_on_the_screen() {
        let camera = Camera::default();
        let at = |offset| {
            camera
                .project(camera.target + offset, SIZE)
                .unwrap()
                .position
        };
        assert!(at(Vec3::X * 0.1).x > SIZE.x / 2.0);
        assert!(at(Vec3::Y * 0.1).y < SIZE.y / 2.0);
        assert!(at(Vec3::NEG_Z * 0.1).y < SIZE.y / 2.0);
    }

    #[test]
    fn a_panned_target_follows_the_mouse() {
        let mut camera = Camera::default();
        let point = camera.target;
        camera.pan(Vec2::new(30.0, -20.0), SIZE.y);
        let moved = camera.project(point, SIZE).unwrap().position - SIZE / 2.0;
        assert!((moved - Vec2::new(30.0, -20.0)).length() < 1.0, "{moved}");
    }

    #[test]
    fn keys_move_the_eye_to_the_right_and_up_and_nearer() {
        let moved = |step| {
            let mut camera = Camera::default();
            let ([right, up, back], eye) = (camera.axes(), camera.eye());
            camera.step(step, SIZE.y);
            let way = camera.eye() - eye;
            [way.dot(right), way.dot(up), way.dot(back)]
        };
        assert!(moved(CameraStep::Orbit(1.0, 0.0))[0] > 0.05);
        assert!(moved(CameraStep::Orbit(0.0, 1.0))[1] > 0.05);
        assert!(moved(CameraStep::Pan(1.0, 0.0))[0] > 0.02);
        assert!(moved(CameraStep::Pan(0.0, 1.0))[1] > 0.02);
        assert!(moved(CameraStep::Zoom(1.0))[2] < -0.05);
        let mut camera = Camera::default();
        camera.step(CameraStep::Orbit(1.0, 0.0), SIZE.y);
        camera.step(CameraStep::Orbit(-1.0, 0.0), SIZE.y);
        assert!((camera.eye() - Camera::default().eye()).length() < 1e-6);
    }

    #[test]
    fn framed_points_fill_the_picture_and_stay_inside() {
        let points = [
            Vec3::new(0.1, -0.1, -0.5),
            Vec3::new(0.4, 0.1, -0.3),
            Vec3::new(0.2, 0.0, -0.6),
        ];
        for aspect in [0.5, 1.0, 2.5] {
            let mut camera = Camera::default();
            camera.frame(&points, 0.6, Viewpoint::Eye, aspect);
            let size = Vec2::new(aspect, 1.0);
            let (low, high) = camera.bounds(&points, size).unwrap();
            assert!(
                low.min_element() >= 0.0 && high.cmple(size).all(),
                "{low} {high}"
            );
            let filled = ((high - low) / size).max_element();
            assert!((0.8..0.95).contains(&filled), "{filled}");
        }
    }

    #[test]
    fn viewpoints_turn_with_the_boards() {
        let mut camera = Camera::default();
        let points = [Vec3::ZERO, Vec3::X];
        camera.frame(&points, 0.5, Viewpoint::Eye, 1.5);
        assert_eq!(camera.azimuth, 0.5);
        camera.frame(&points, 0.5, Viewpoint::Side, 1.5);
        assert_eq!(camera.azimuth, 0.5 + FRAC_PI_2);
    }

    #[test]
    fn nothing_behind_the_eye_is_drawn() {
        let camera = Camera::default();
        let behind = camera.eye() + (camera.eye() - camera.target);
        assert_eq!(camera.project(behind, SIZE), None);
    }
}
