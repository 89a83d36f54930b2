//! The position of a marker from the rays of two or more cameras.

use glam::{DMat3, DVec3};

use super::ray::{Ray, RayError, closest_points};

/// The position of a marker.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Triangulation {
    /// The point with the least sum of squared distances from the rays.
    pub point: DVec3,
    /// Twice the largest distance of the point from a ray. With two rays this is the distance between them.
    pub gap: f64,
}

/// The reason why rays give no position.
#[derive(Clone, Copy, Debug, PartialEq, Eq, thiserror::Error)]
pub enum TriangulationError {
    /// Fewer than two cameras see the marker.
    #[error("a position needs two cameras that see the marker")]
    TooFewRays,
    /// A ray has no direction, or all rays are parallel.
    #[error(transparent)]
    Rays(#[from] RayError),
    /// The point lies behind the camera of the ray with this index.
    #[error("the point lies behind camera {0}")]
    Behind(usize),
}

/// Returns the point that is nearest to all `rays`: for two rays the midpoint of their closest points, for more the
/// solution P of Σ (1 − uᵢuᵢᵀ)(P − Cᵢ) = 0 with unit directions uᵢ, which is the same point for two.
///
/// Refuses parallel rays and points behind a camera.
pub fn triangulate(rays: &[Ray]) -> Result<Triangulation, TriangulationError> {
    let point = match rays {
        [] | [_] => return Err(TriangulationError::TooFewRays),
        [first, second] => closest_points(first, second)?.midpoint(),
        _ => nearest_point(rays)?,
    };
    let mut largest = 0.0_f64;
    for (index, ray) in rays.iter().enumerate() {
        let k = ray.nearest(point);
        if k <= 0.0 {
            return Err(TriangulationError::Behind(index));
        }
        largest = largest.max(ray.at(k).distance_squared(point));
    }
    Ok(Triangulation {
        point,
        gap: 2.0 * largest.sqrt(),
    })
}

/// Solves the normal equations, relative to the first camera for the sake of precision.
fn nearest_point(rays: &[Ray]) -> Result<DVec3, RayError> {
    if !rays.iter().all(Ray::is_valid) {
        return Err(RayError::Degenerate);
    }
    if rays[1..].iter().all(|ray| ray.is_parallel(&rays[0])) {
        return Err(RayError::Parallel);
    }
    let reference = rays[0].origin;
    let (mut matrix, mut sum) = (DMat3::ZERO, DVec3::ZERO);
    for ray in rays {
        let along = ray.direction;
        let scaled = along / along.length_squared();
        let across = DMat3::IDENTITY
            - DMat3::from_cols(scaled * along.x, scaled * along.y, scaled * along.z);
        matrix += across;
        sum += across * (ray.origin - reference);
    }
    Ok(reference + matrix.inverse() * sum)
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Rays from cameras on a circle of 3 m, through `points[index]`.
    fn rays(points: &[DVec3]) -> Vec<Ray> {
        let through = |(index, &point): (usize, &DVec3)| {
            let (sine, cosine) = (index as f64 * 1.1).sin_cos();
            Ray::through(DVec3::new(3.0 * cosine, 1.5, 3.0 * sine), point)
        };
        points.iter().enumerate().map(through).collect()
    }

    #[test]
    fn four_exact_rays_meet_in_the_point() {
        let point = DVec3::new(0.2, 1.1, -0.3);
        let found = triangulate(&rays(&[point; 4])).unwrap();
        assert!(found.point.distance(point) < 1e-12 && found.gap < 1e-12);
    }

    #[test]
    fn least_squares_of_two_rays_is_the_midpoint() {
        let rays = rays(&[DVec3::new(0.2, 1.1, -0.3), DVec3::new(0.21, 1.08, -0.3)]);
        let two = triangulate(&rays).unwrap();
        assert!(nearest_point(&rays).unwrap().distance(two.point) < 1e-12);
        assert!((two.gap - closest_points(&rays[0], &rays[1]).unwrap().gap()).abs() < 1e-12);
    }

    #[test]
    fn the_gap_shows_a_ray_of_another_marker() {
        let mut points = [DVec3::new(0.2, 1.1, -0.3); 4];
        points[2] += DVec3::Y * 0.05;
        let found = triangulate(&rays(&points)).unwrap();
        assert!(found.gap > 0.02, "{}", found.gap);
    }

    #[test]
    fn parallel_rays_and_points_behind_a_camera_are_refused() {
        let same = Ray::through(DVec3::ZERO, DVec3::Z);
        let beside = |x: f64| Ray::through(DVec3::X * x, DVec3::X * x + DVec3::Z);
        let parallel = [same, beside(1.0), beside(2.0)];
        assert_eq!(triangulate(&parallel), Err(RayError::Parallel.into()));
        assert_eq!(triangulate(&[same]), Err(TriangulationError::TooFewRays));
        let mut rays = rays(&[DVec3::new(0.2, 1.1, -0.3); 3]);
        rays[1].direction = -rays[1].direction;
        assert_eq!(triangulate(&rays), Err(TriangulationError::Behind(1)));
        rays[1].direction = DVec3::new(f64::NAN, 0.0, 0.0);
        assert_eq!(triangulate(&rays), Err(RayError::Degenerate.into()));
    }
}
