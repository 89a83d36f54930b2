//! Rays of cameras, and the points where two of them come closest.

use glam::DVec3;

/// Largest |d₁ × d₂|² / (|d₁|² |d₂|²) of parallel rays: the squared sine of the angle between them.
pub(super) const PARALLEL_SIN_SQUARED: f64 = 1e-12;

/// The half-line from a camera through a point that it sees: `origin + k · direction` with `k > 0`.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Ray {
    /// The optical center of the camera.
    pub origin: DVec3,
    /// The direction of sight, of any length except 0.
    pub direction: DVec3,
}

impl Ray {
    /// Creates the ray from a camera at `origin` through `point`, for example a point of its image plane.
    pub fn through(origin: DVec3, point: DVec3) -> Self {
        Self {
            origin,
            direction: point - origin,
        }
    }

    /// Returns the point `origin + k · direction`; behind the camera for a negative `k`.
    pub fn at(&self, k: f64) -> DVec3 {
        self.origin + k * self.direction
    }

    /// Returns the parameter `k` of the point of the line that is nearest to `point`; negative behind the camera.
    pub fn nearest(&self, point: DVec3) -> f64 {
        (point - self.origin).dot(self.direction) / self.direction.length_squared()
    }

    /// Returns `true` if the line passes `point` within `distance`. Takes a fraction of the time that the distance itself
    /// takes, for the many points that the line does not pass.
    pub fn passes(&self, point: DVec3, distance: f64) -> bool {
        let across = (point - self.origin).cross(self.direction).length_squared();
        across <= distance * distance * self.direction.length_squared() * (1.0 + 1e-9)
    }

    /// Returns `true` if the ray has a direction and all its numbers are finite.
    pub fn is_valid(&self) -> bool {
        let length_squared = self.direction.length_squared();
        self.origin.is_finite() && length_squared.is_finite() && length_squared > 0.0
    }

    /// Returns `true` if both rays have the same direction or opposite ones. Both must be valid.
    pub fn is_parallel(&self, other: &Self) -> bool {
        let lengths = self.direction.length_squared() * other.direction.length_squared();
        let normal = self.direction.cross(other.direction);
        normal.length_squared() <= PARALLEL_SIN_SQUARED * lengths
    }
}

/// The reason why two rays have no closest points.
#[derive(Clone, Copy, Debug, PartialEq, Eq, thiserror::Error)]
pub enum RayError {
    /// A ray has no direction, or a number that is not finite.
    #[error("a ray has no direction")]
    Degenerate,
    /// The rays are parallel, opposite or the same, so that no point is the closest.
    #[error("the rays are parallel")]
    Parallel,
}

/// The points where two rays come closest. Their difference is perpendicular to both rays.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ClosestPoints {
    /// The parameter of the point on each ray, in multiples of its direction.
    pub parameters: [f64; 2],
    /// The point on each ray.
    pub points: [DVec3; 2],
}

impl ClosestPoints {
    /// Returns the position of the marker: the point half-way between the rays.
    pub fn midpoint(&self) -> DVec3 {
        (self.points[0] + self.points[1]) / 2.0
    }

    /// Returns the distance between the rays, 0 or more.
    pub fn gap(&self) -> f64 {
        self.points[0].distance(self.points[1])
    }

    /// Returns `true` if both cameras have the point in front of them.
    pub fn is_in_front(&self) -> bool {
        self.parameters.iter().all(|&k| k > 0.0)
    }
}

/// Returns the distance of the lines of two valid rays, |w · N| / |N| with N = d₁ × d₂ and w = C₂ − C₁, as
/// [`ClosestPoints::gap`] does, in a fraction of its time. `None` if it is more than `max_gap`, if the rays are parallel, or
/// if their closest points are not in front of both cameras.
pub fn gap_in_front(first: &Ray, second: &Ray, max_gap: f64) -> Option<f64> {
    let normal = first.direction.cross(second.direction);
    let baseline = second.origin - first.origin;
    let squared = normal.length_squared();
    let across = baseline.dot(normal);
    if across * across > max_gap * max_gap * squared || first.is_parallel(second) {
        return None;
    }
    let is_in_front = |other: DVec3| baseline.cross(other).dot(normal) > 0.0;
    let is_seen = is_in_front(second.direction) && is_in_front(first.direction);
    is_seen.then(|| across.abs() / squared.sqrt())
}

/// Returns the points where two rays come closest: with N = d₁ × d₂ and w = C₂ − C₁, the parameters are
/// k₁ = ((w × d₂) · N) / |N|² and k₂ = ((w × d₁) · N) / |N|².
///
/// The lines are used, so that points may lie behind a camera: see [`ClosestPoints::is_in_front`].
pub fn closest_points(first: &Ray, second: &Ray) -> Result<ClosestPoints, RayError> {
    if !first.is_valid() || !second.is_valid() {
        return Err(RayError::Degenerate);
    }
    if first.is_parallel(second) {
        return Err(RayError::Parallel);
    }
    let normal = first.direction.cross(second.direction);
    let baseline = second.origin - first.origin;
    let parameter = |other: DVec3| baseline.cross(other).dot(normal) / normal.length_squared();
    let parameters = [parameter(second.direction), parameter(first.direction)];
    Ok(ClosestPoints {
        parameters,
        points: [first.at(parameters[0]), second.at(parameters[1])],
    })
}
