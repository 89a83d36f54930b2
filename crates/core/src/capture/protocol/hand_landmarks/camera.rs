//! The camera of a hand tracker: positions in metres from points of the image.

use glam::DVec3;

/// Number of landmarks of a hand.
pub const HAND_LANDMARKS: usize = 21;

/// Landmarks of a hand, in the order of MediaPipe: the wrist, then four points of each finger from the base to the tip.
pub(super) type Landmarks = [DVec3; HAND_LANDMARKS];

/// Index of the wrist and of the knuckle of the middle finger.
const WRIST: usize = 0;
const MIDDLE_KNUCKLE: usize = 9;

/// Smallest and largest distance of a hand from the camera, in metres. Beyond it, points and shape do not belong together.
const DISTANCES: std::ops::RangeInclusive<f64> = 0.05..=5.0;

/// Smallest mean square of the distance of the rays from their mean, as a tangent: a hand of 2 cm at 5 m.
const MIN_SPREAD: f64 = 1e-6;

/// The place of the camera, with respect to the person.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) enum Mount {
    /// In front of the person, as a webcam: it looks at the person.
    Front,
    /// At the head: it looks where the person looks.
    Head,
    /// Above the desk: it looks down, and forward is up in the image.
    Above,
}

impl Mount {
    /// Returns the place with this name in source URIs.
    pub fn from_name(name: &str) -> Option<Self> {
        match name {
            "front" => Some(Self::Front),
            "head" => Some(Self::Head),
            "above" => Some(Self::Above),
            _ => None,
        }
    }
}

/// A camera that follows hands.
#[derive(Clone, Copy, Debug)]
pub(super) struct Camera {
    /// Place of the camera.
    pub mount: Mount,
    /// `true` if the image was flipped left to right before the hand was found in it.
    pub is_mirrored: bool,
    /// Focal length divided by the width of the image.
    pub focal: f64,
    /// Distance from the wrist to the knuckle of the middle finger, in metres: the scale of a hand without world landmarks.
    pub palm: f64,
}

impl Camera {
    /// Returns the focal length, divided by the width of the image, for a horizontal angle of view.
    pub fn focal_of(angle_of_view_deg: f64) -> f64 {
        0.5 / (angle_of_view_deg.to_radians() / 2.0).tan()
    }

    /// Returns the landmarks in the world, in metres, for points of the image in multiples of its width from its center.
    ///
    /// `shape` has the world landmarks of a tracker, relative to the hand. With it, the hand has this shape at the position that
    /// its points show; without it, its size in the image gives the distance. `None` if there is no such position.
    pub fn place(&self, points: &Landmarks, shape: Option<&Landmarks>) -> Option<Landmarks> {
        let placed = match shape {
            Some(shape) => {
                let offset = self.offset(points, shape)?;
                shape.map(|landmark| landmark + offset)
            }
            None => self.scaled(points)?,
        };
        Some(placed.map(|landmark| self.world(landmark)))
    }

    /// Returns landmarks relative to the wrist, in the axes of the world.
    pub fn turn(&self, shape: &Landmarks) -> Landmarks {
        shape.map(|landmark| self.world(landmark - shape[WRIST]))
    }

    /// Returns the displacement of a shape for which its landmarks lie closest to the rays through their points: the least
    /// sum of (X + tₓ − a (Z + t_z))² + (Y + t_y − b (Z + t_z))² for rays (a, b, 1), which is linear in the displacement.
    fn offset(&self, points: &Landmarks, shape: &Landmarks) -> Option<DVec3> {
        let count = HAND_LANDMARKS as f64;
        let (mut rays, mut rest, mut squares, mut products) = (DVec3::ZERO, DVec3::ZERO, 0.0, 0.0);
        for (point, landmark) in points.iter().zip(shape) {
            let ray = DVec3::new(point.x / self.focal, point.y / self.focal, 0.0);
            let distance = ray * landmark.z - landmark.with_z(0.0);
            rays += ray;
            rest += distance;
            squares += ray.length_squared();
            products += ray.dot(distance);
        }
        let spread = squares - rays.length_squared() / count;
        if spread.is_nan() || spread < MIN_SPREAD * count {
            return None;
        }
        let depth = (rays.dot(rest) / count - products) / spread;
        let offset = ((rest + rays * depth) / count).with_z(depth);
        DISTANCES.contains(&offset.z).then_some(offset)
    }

    /// Returns a hand of the usual size, whose depth has the scale of its width, as MediaPipe gives it.
    fn scaled(&self, points: &Landmarks) -> Option<Landmarks> {
        let palm = points[WRIST].distance(points[MIDDLE_KNUCKLE]);
        let metres = self.palm / palm;
        let distance = self.focal * metres;
        if palm.is_nan() || !DISTANCES.contains(&distance) {
            return None;
        }
        let deepen = |point: &DVec3| {
            let depth = distance + (point.z - points[WRIST].z) * metres;
            DVec3::new(point.x / self.focal, point.y / self.focal, 1.0) * depth
        };
        Some(std::array::from_fn(|index| deepen(&points[index])))
    }

    /// Converts a position in the axes of the camera: X to the right of the image, Y down, Z away from the camera.
    fn world(&self, position: DVec3) -> DVec3 {
        let DVec3 { x, y, z } = position;
        let x = if self.is_mirrored { -x } else { x };
        match self.mount {
            Mount::Front => DVec3::new(-x, -y, z),
            Mount::Head => DVec3::new(x, -y, -z),
            Mount::Above => DVec3::new(x, -z, y),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn camera(mount: Mount) -> Camera {
        Camera {
            mount,
            is_mirrored: false,
            focal: Camera::focal_of(60.0),
            palm: 0.085,
        }
    }

    /// A hand about its middle, as in world landmarks.
    fn shape() -> Landmarks {
        std::array::from_fn(|index| {
            let (finger, bone) = (index.div_ceil(4), (index + 3) % 4);
            DVec3::new(
                0.02 * finger as f64 - 0.04,
                0.05 - 0.03 * bone as f64,
                0.004 * (bone * bone) as f64,
            )
        })
    }

    fn seen(camera: &Camera, landmarks: &Landmarks) -> Landmarks {
        landmarks.map(|landmark| landmark / landmark.z * camera.focal)
    }

    #[test]
    fn a_hand_is_put_where_its_points_show_it() {
        let camera = camera(Mount::Head);
        let offset = DVec3::new(0.1, -0.05, 0.45);
        let there = shape().map(|landmark| landmark + offset);
        let placed = camera.place(&seen(&camera, &there), Some(&shape()));
        let placed = placed.expect("a hand in front of the camera");
        for (landmark, expected) in placed.iter().zip(&there) {
            let world = DVec3::new(expected.x, -expected.y, -expected.z);
            assert!(landmark.distance(world) < 1e-9, "{landmark} {world}");
        }
    }

    #[test]
    fn a_hand_without_a_shape_has_the_distance_of_a_palm_of_the_given_length() {
        let flat = shape().map(|landmark| landmark.with_z(0.4));
        let camera = Camera {
            palm: flat[WRIST].distance(flat[MIDDLE_KNUCKLE]),
            ..camera(Mount::Above)
        };
        let points = seen(&camera, &flat).map(|point| point.with_z(0.0));
        let placed = camera.place(&points, None).expect("a hand");
        for (landmark, expected) in placed.iter().zip(&flat) {
            let world = DVec3::new(expected.x, -expected.z, expected.y);
            assert!(landmark.distance(world) < 1e-9, "{landmark} {world}");
        }
    }

    #[test]
    fn points_that_coincide_or_are_not_finite_have_no_place() {
        let camera = camera(Mount::Front);
        for points in [
            [DVec3::ZERO; HAND_LANDMARKS],
            [DVec3::NAN; HAND_LANDMARKS],
            [DVec3::splat(1e300); HAND_LANDMARKS],
        ] {
            assert_eq!(camera.place(&points, None), None);
            assert_eq!(camera.place(&points, Some(&shape())), None);
        }
    }

    #[test]
    fn a_mirrored_image_is_mirrored_back() {
        for mount in [Mount::Front, Mount::Head, Mount::Above] {
            let plain = camera(mount);
            let mirrored = Camera {
                is_mirrored: true,
                ..plain
            };
            let flipped = shape().map(|landmark| landmark.with_x(-landmark.x));
            assert_eq!(mirrored.turn(&flipped), plain.turn(&shape()));
        }
    }
}
