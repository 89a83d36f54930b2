//! A camera: its place, its lens and its image.

use glam::{DMat3, DQuat, DVec2, DVec3};

/// Number of parameters of a camera: six of its place, four of its image and four of its lens.
pub const PARAMETERS: usize = 14;

/// Steps in which the distortion of a lens is inverted.
const UNDISTORT_STEPS: usize = 20;

/// A camera in the convention of OpenCV: X right, Y down, Z along the view.
#[derive(Clone, Debug, PartialEq)]
pub struct Camera {
    /// The name.
    pub name: String,
    /// Width and height of the image in pixels.
    pub size: DVec2,
    /// Focal lengths in pixels.
    pub focal: DVec2,
    /// The center of the image in pixels.
    pub center: DVec2,
    /// The distortion of the lens: k1, k2, p1, p2.
    pub distortion: [f64; 4],
    /// Camera from world.
    pub rotation: DQuat,
    /// Place of the origin of the world in the axes of the camera.
    pub translation: DVec3,
}

/// The position of a point in an image, and its changes with the parameters of the camera and with the place of the point.
#[derive(Clone, Copy, Debug)]
pub struct Projection {
    /// The position in the image, in pixels.
    pub pixel: DVec2,
    /// The derivatives by the turn in the axes of the camera, the translation, the focal lengths, the center and the distortion.
    pub by_camera: [DVec2; PARAMETERS],
    /// The derivatives by the three coordinates of the point.
    pub by_point: [DVec2; 3],
}

impl Camera {
    /// Creates a camera at the origin of the world with a lens without distortion, whose focal length is about the larger side of
    /// its image.
    pub fn new(name: String, size: DVec2) -> Self {
        Self {
            name,
            size,
            focal: DVec2::splat(1.1 * size.max_element()),
            center: size / 2.0,
            distortion: [0.0; 4],
            rotation: DQuat::IDENTITY,
            translation: DVec3::ZERO,
        }
    }

    /// Returns the place of the camera in the world.
    pub fn position(&self) -> DVec3 {
        -(self.rotation.inverse() * self.translation)
    }

    /// Returns the place of a point in the axes of the camera.
    pub fn in_camera(&self, point: DVec3) -> DVec3 {
        self.rotation * point + self.translation
    }

    /// Returns the position of a point in the image; `None` if it is not in front of the camera.
    pub fn project(&self, point: DVec3) -> Option<Projection> {
        let at = self.in_camera(point);
        // Also false for a number that is not one.
        let is_in_front = at.z > 1e-9;
        if !is_in_front {
            return None;
        }
        let (ideal, [k1, k2, p1, p2]) = (at.truncate() / at.z, self.distortion);
        let DVec2 { x, y } = ideal;
        let r2 = ideal.length_squared();
        let radial = 1.0 + k1 * r2 + k2 * r2 * r2;
        let slope = k1 + 2.0 * k2 * r2;
        let cross = 2.0 * (x * y * slope + p1 * x + p2 * y);
        let by_x = DVec2::new(
            radial + 2.0 * (x * x * slope + p1 * y + 3.0 * p2 * x),
            cross,
        );
        let by_y = DVec2::new(
            cross,
            radial + 2.0 * (y * y * slope + 3.0 * p1 * y + p2 * x),
        );
        let distorted = self.distort(ideal);
        let by_place = [
            self.focal * by_x / at.z,
            self.focal * by_y / at.z,
            -self.focal * (by_x * x + by_y * y) / at.z,
        ];
        let along = |way: DVec3| by_place[0] * way.x + by_place[1] * way.y + by_place[2] * way.z;
        let turned = at - self.translation;
        let rotation = DMat3::from_quat(self.rotation);
        let mut by_camera = [DVec2::ZERO; PARAMETERS];
        for (axis, unit) in DVec3::AXES.into_iter().enumerate() {
            by_camera[axis] = along(unit.cross(turned));
            by_camera[3 + axis] = by_place[axis];
        }
        by_camera[6] = DVec2::X * distorted.x;
        by_camera[7] = DVec2::Y * distorted.y;
        by_camera[8] = DVec2::X;
        by_camera[9] = DVec2::Y;
        by_camera[10] = self.focal * ideal * r2;
        by_camera[11] = self.focal * ideal * r2 * r2;
        by_camera[12] = self.focal * DVec2::new(2.0 * x * y, r2 + 2.0 * y * y);
        by_camera[13] = self.focal * DVec2::new(r2 + 2.0 * x * x, 2.0 * x * y);
        Some(Projection {
            pixel: self.focal * distorted + self.center,
            by_camera,
            by_point: [rotation.x_axis, rotation.y_axis, rotation.z_axis].map(along),
        })
    }

    fn distort(&self, ideal: DVec2) -> DVec2 {
        let [k1, k2, p1, p2] = self.distortion;
        let DVec2 { x, y } = ideal;
        let r2 = ideal.length_squared();
        let tangential = DVec2::new(
            2.0 * p1 * x * y + p2 * (r2 + 2.0 * x * x),
            p1 * (r2 + 2.0 * y * y) + 2.0 * p2 * x * y,
        );
        ideal * (1.0 + k1 * r2 + k2 * r2 * r2) + tangential
    }

    /// Returns the direction of a pixel in the axes of the camera, with Z = 1.
    pub fn ideal(&self, pixel: DVec2) -> DVec2 {
        let distorted = (pixel - self.center) / self.focal;
        let mut ideal = distorted;
        for _ in 0..UNDISTORT_STEPS {
            ideal += distorted - self.distort(ideal);
        }
        ideal
    }

    /// Returns the direction of a pixel in the world.
    pub fn direction(&self, pixel: DVec2) -> DVec3 {
        self.rotation.inverse() * self.ideal(pixel).extend(1.0)
    }

    /// Returns the camera with its parameters changed.
    pub fn changed(&self, step: &[f64; PARAMETERS]) -> Self {
        let turn = DQuat::from_scaled_axis(DVec3::from_slice(&step[..3]));
        let mut distortion = self.distortion;
        for (value, change) in distortion.iter_mut().zip(&step[10..]) {
            *value += change;
        }
        Self {
            name: self.name.clone(),
            size: self.size,
            focal: self.focal + DVec2::from_slice(&step[6..8]),
            center: self.center + DVec2::from_slice(&step[8..10]),
            distortion,
            rotation: (turn * self.rotation).normalize(),
            translation: self.translation + DVec3::from_slice(&step[3..6]),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn changes_of_the_projection_are_those_of_small_steps() {
        let camera = Camera {
            distortion: [-0.2, 0.05, 0.002, -0.003],
            rotation: DQuat::from_scaled_axis(DVec3::new(0.3, -0.2, 0.1)),
            translation: DVec3::new(0.1, -0.2, 2.0),
            ..Camera::new("a".into(), DVec2::new(1280.0, 720.0))
        };
        let point = DVec3::new(0.5, 0.3, 0.2);
        let projected = camera.project(point).unwrap();
        let h = 1e-6;
        for index in 0..PARAMETERS {
            let mut step = [0.0; PARAMETERS];
            step[index] = h;
            let moved = camera.changed(&step).project(point).unwrap().pixel;
            let error = (moved - projected.pixel) / h - projected.by_camera[index];
            assert!(error.length() < 1e-2, "{index}: {error}");
        }
        for (axis, unit) in DVec3::AXES.into_iter().enumerate() {
            let moved = camera.project(point + unit * h).unwrap().pixel;
            let error = (moved - projected.pixel) / h - projected.by_point[axis];
            assert!(error.length() < 1e-2, "{axis}: {error}");
        }
        let direction = camera.direction(projected.pixel).normalize();
        let expected = (point - camera.position()).normalize();
        assert!(direction.distance(expected) < 1e-9, "{direction}");
        assert!(camera.project(camera.position() - expected).is_none());
    }
}
