//! First estimates of cameras by linear equations: one camera from known points, and two cameras from each other.

use glam::{DMat3, DQuat, DVec2, DVec3};
use nalgebra::{DMatrix, Matrix3, Vector3};

use super::camera::Camera;
use crate::capture::markers::{Ray, closest_points, median};

/// Distance of two directions with Z = 1 below which they are one: a pixel of most lenses.
const MIN_APART: f64 = 1e-3;

/// Fewest known points of a camera.
const MIN_POINTS: usize = 6;

/// Fewest points that two cameras see together.
const MIN_PAIRS: usize = 8;

/// Smallest thickness of known points, as a fraction of their size.
const MIN_THICKNESS: f64 = 0.02;

/// Smallest error of the map from a plane that takes one image into the other, as a fraction of the size of the image.
const MIN_PARALLAX: f64 = 0.03;

/// A reason why a camera has no estimate.
#[derive(Clone, Copy, Debug, PartialEq, Eq, thiserror::Error)]
pub enum LinearError {
    /// Too few points.
    #[error("{found} points are seen and {needed} are needed")]
    TooFew {
        /// The points that are seen.
        found: usize,
        /// The points that are needed.
        needed: usize,
    },
    /// The points lie in a plane or on a line.
    #[error("the points lie in a plane or on a line; spread them over the whole volume")]
    Flat,
    /// Both cameras are at one place, or one is there twice.
    #[error(
        "both cameras see the points from the same position; leave one of them out if they are one camera, or move one aside by a tenth of the distance to the points"
    )]
    SamePlace,
    /// The points fit no camera.
    #[error("the points fit no camera; check the labels and the known places")]
    Inconsistent,
}

/// Returns a camera that sees known points at these pixels, without distortion: the direct linear transform.
pub fn camera_from_points(
    start: &Camera,
    points: &[DVec3],
    pixels: &[DVec2],
) -> Result<Camera, LinearError> {
    let found = points.len();
    if found < MIN_POINTS {
        let needed = MIN_POINTS;
        return Err(LinearError::TooFew { found, needed });
    }
    if thickness(points) < MIN_THICKNESS {
        return Err(LinearError::Flat);
    }
    let middle = points.iter().sum::<DVec3>() / found as f64;
    let size = points
        .iter()
        .map(|point| point.distance(middle))
        .sum::<f64>()
        / found as f64;
    let pixel_middle = pixels.iter().sum::<DVec2>() / found as f64;
    let pixel_size = pixels
        .iter()
        .map(|pixel| pixel.distance(pixel_middle))
        .sum::<f64>()
        / found as f64;
    if pixel_size <= 0.0 {
        return Err(LinearError::Inconsistent);
    }
    let pairs = points.iter().zip(pixels).map(|(point, pixel)| {
        let place = ((*point - middle) / size).extend(1.0).to_array();
        (place, (*pixel - pixel_middle) / pixel_size)
    });
    let solution = null_vector(&projection_equations(pairs));
    // Pixels and places as they are, from those around their middles.
    let row = |index: usize| {
        let values = &solution[4 * index..4 * index + 4];
        let along = DVec3::from_slice(values) / size;
        (along, values[3] - along.dot(middle))
    };
    let (last, last_offset) = row(2);
    let image = |index: usize, image_middle: f64| {
        let (along, offset) = row(index);
        (
            pixel_size * along + image_middle * last,
            pixel_size * offset + image_middle * last_offset,
        )
    };
    let (first, first_offset) = image(0, pixel_middle.x);
    let (second, second_offset) = image(1, pixel_middle.y);
    let matrix = DMat3::from_cols(first, second, last).transpose();
    let offset = DVec3::new(first_offset, second_offset, last_offset);
    // The equations leave the sign open: a camera has a rotation, not a reflection.
    let sign = matrix.determinant().signum();
    let (matrix, offset) = (matrix * sign, offset * sign);
    let (intrinsic, rotation) = decompose(&matrix).ok_or(LinearError::Inconsistent)?;
    let scale = intrinsic.z_axis.z;
    let camera = Camera {
        focal: DVec2::new(intrinsic.x_axis.x, intrinsic.y_axis.y) / scale,
        center: DVec2::new(intrinsic.z_axis.x, intrinsic.z_axis.y) / scale,
        rotation: DQuat::from_mat3(&rotation).normalize(),
        translation: intrinsic.inverse() * offset,
        ..start.clone()
    };
    let in_front = points
        .iter()
        .filter(|point| camera.in_camera(**point).z > 0.0)
        .count();
    if in_front == found && camera.focal.is_finite() {
        Ok(camera)
    } else {
        Err(LinearError::Inconsistent)
    }
}

/// Splits a matrix into one with zeros below its diagonal, which is positive, and a rotation; `None` if its determinant is
/// not positive.
fn decompose(matrix: &DMat3) -> Option<(DMat3, DMat3)> {
    let inverse = matrix.inverse();
    let decomposed = Matrix3::from_column_slice(&inverse.to_cols_array()).qr();
    let turned = DMat3::from_cols_slice(decomposed.q().as_slice()).transpose();
    let upper = DMat3::from_cols_slice(decomposed.r().as_slice()).inverse();
    let signs = DVec3::new(
        upper.x_axis.x.signum(),
        upper.y_axis.y.signum(),
        upper.z_axis.z.signum(),
    );
    let flip = DMat3::from_diagonal(signs);
    let (upper, turned) = (upper * flip, flip * turned);
    (upper.is_finite() && turned.determinant() > 0.0).then_some((upper, turned))
}

/// Returns the smallest extent of points as a fraction of the largest one.
fn thickness(points: &[DVec3]) -> f64 {
    let middle = points.iter().sum::<DVec3>() / points.len() as f64;
    let mut spread = Matrix3::<f64>::zeros();
    for point in points {
        let way = Vector3::from((*point - middle).to_array());
        spread += way * way.transpose();
    }
    let extents = spread.symmetric_eigenvalues();
    (extents.min().max(0.0) / extents.max().max(f64::MIN_POSITIVE)).sqrt()
}

/// Returns the equations of the projection, row by row, that takes places in homogeneous coordinates to points of an image.
fn projection_equations<const N: usize>(
    pairs: impl ExactSizeIterator<Item = ([f64; N], DVec2)>,
) -> DMatrix<f64> {
    let mut rows = DMatrix::<f64>::zeros(2 * pairs.len(), 3 * N);
    for (index, (place, at)) in pairs.enumerate() {
        for (column, value) in place.into_iter().enumerate() {
            rows[(2 * index, column)] = value;
            rows[(2 * index, 2 * N + column)] = -at.x * value;
            rows[(2 * index + 1, N + column)] = value;
            rows[(2 * index + 1, 2 * N + column)] = -at.y * value;
        }
    }
    rows
}

/// Returns the unit vector for which the equations fail least.
fn null_vector(rows: &DMatrix<f64>) -> Vec<f64> {
    let squares = rows.transpose() * rows;
    let found = squares.symmetric_eigen();
    let least = found.eigenvalues.imin();
    found.eigenvectors.column(least).iter().copied().collect()
}

/// Returns `true` if one map between planes takes the points of the first camera into the points of the second one, as it does if
/// the points lie in a plane or on a line.
fn is_flat(directions: &[(DVec2, DVec2)]) -> bool {
    let pairs = directions.iter();
    let pairs = pairs.map(|(first, second)| (first.extend(1.0).to_array(), *second));
    let map = DMat3::from_cols_slice(&null_vector(&projection_equations(pairs))).transpose();
    let middle =
        directions.iter().map(|(_, second)| *second).sum::<DVec2>() / directions.len() as f64;
    let mut errors: Vec<f64> = Vec::new();
    let mut sizes: Vec<f64> = Vec::new();
    for (first, second) in directions {
        let mapped = map * first.extend(1.0);
        errors.push((mapped.truncate() / mapped.z).distance(*second));
        sizes.push(second.distance(middle));
    }
    match (median(&mut errors), median(&mut sizes)) {
        (Some(error), Some(size)) => error.is_nan() || error <= MIN_PARALLAX * size,
        _ => true,
    }
}

/// Returns the second of two cameras, of which the first one is at the origin, from directions with Z = 1 in which both see the same
/// points. The distance of the cameras is 1.
pub fn camera_from_pair(
    second: &Camera,
    directions: &[(DVec2, DVec2)],
) -> Result<Camera, LinearError> {
    let found = directions.len();
    if found < MIN_PAIRS {
        let needed = MIN_PAIRS;
        return Err(LinearError::TooFew { found, needed });
    }
    if is_flat(directions) {
        let apart = |(one, other): &(DVec2, DVec2)| one.distance(*other);
        let apart = directions.iter().map(apart).fold(0.0, f64::max);
        return Err(if apart < MIN_APART {
            LinearError::SamePlace
        } else {
            LinearError::Flat
        });
    }
    let mut rows = DMatrix::<f64>::zeros(found, 9);
    for (index, (first_ray, second_ray)) in directions.iter().enumerate() {
        let (first_ray, second_ray) = (
            first_ray.extend(1.0).to_array(),
            second_ray.extend(1.0).to_array(),
        );
        for (row, value) in second_ray.into_iter().enumerate() {
            for (column, other) in first_ray.into_iter().enumerate() {
                rows[(index, 3 * row + column)] = value * other;
            }
        }
    }
    let solution = null_vector(&rows);
    let essential = Matrix3::from_row_slice(&solution);
    let parts = essential.svd(true, true);
    let (Some(u), Some(v_t)) = (parts.u, parts.v_t) else {
        return Err(LinearError::Inconsistent);
    };
    let glam = |matrix: Matrix3<f64>| DMat3::from_cols_slice(matrix.as_slice());
    let (u, v_t) = (glam(u), glam(v_t));
    let quarter = DMat3::from_cols(DVec3::Y, DVec3::NEG_X, DVec3::Z);
    let mut best = (0, None);
    for turn in [quarter, quarter.transpose()] {
        let rotation = u * turn * v_t;
        let rotation = rotation * rotation.determinant().signum();
        for translation in [u.z_axis, -u.z_axis] {
            let camera = Camera {
                rotation: DQuat::from_mat3(&rotation).normalize(),
                translation,
                ..second.clone()
            };
            let is_in_front = |(one, other): &&(DVec2, DVec2)| {
                let point = crossing(&camera, *one, *other);
                point.is_some_and(|point| point.z > 0.0 && camera.in_camera(point).z > 0.0)
            };
            let in_front = directions.iter().filter(is_in_front).count();
            if in_front > best.0 {
                best = (in_front, Some(camera));
            }
        }
    }
    match best {
        (in_front, Some(camera)) if 4 * in_front >= 3 * found => Ok(camera),
        _ => Err(LinearError::Inconsistent),
    }
}

/// Returns the point where the directions of a camera at the origin and of another one come closest.
pub fn crossing(other: &Camera, first: DVec2, second: DVec2) -> Option<DVec3> {
    let rays = [
        Ray {
            origin: DVec3::ZERO,
            direction: first.extend(1.0),
        },
        Ray {
            origin: other.position(),
            direction: other.rotation.inverse() * second.extend(1.0),
        },
    ];
    let closest = closest_points(&rays[0], &rays[1]).ok()?;
    Some(closest.midpoint())
}
