//! Bundle adjustment: cameras and points that explain all image positions best.

use glam::{DVec2, DVec3};
use nalgebra::{DMatrix, DVector};

use super::camera::{Camera, PARAMETERS};

/// Most steps.
const MAX_STEPS: usize = 100;

/// Relative gain of a step below which the adjustment ends.
const MIN_GAIN: f64 = 1e-10;

/// Weight of a deviation of the length of a wand by its whole length, in pixels: 0.1 % count as ten pixels.
const WAND_WEIGHT: f64 = 1e4;

/// Distance in pixels beyond which an image position counts less.
const ROBUST_PX: f64 = 4.0;

/// A mark in an image.
#[derive(Clone, Copy, Debug)]
pub struct Mark {
    /// Index of the camera.
    pub camera: usize,
    /// Index of the point in its group.
    pub point: usize,
    /// The position in the image, in pixels, as the lens shows it.
    pub pixel: DVec2,
}

/// Points that are placed together: one point, or the two ends of a wand.
#[derive(Clone, Debug)]
pub struct PointGroup {
    /// The places.
    pub points: Vec<DVec3>,
    /// The distance of the first two points, if it is known.
    pub length: Option<f64>,
    /// `true` if the places are known.
    pub is_fixed: bool,
    /// The pixels at which cameras see them.
    pub marks: Vec<Mark>,
}

/// The parameters that are adjusted.
#[derive(Clone, Copy, Debug)]
pub struct Adjusted {
    /// `true` if focal lengths, centers and distortions are adjusted.
    pub has_lenses: bool,
    /// `true` if the first camera stays where it is.
    pub is_first_fixed: bool,
}

/// Adjusts cameras and points to the least sum of the squared distances in the images, of which those beyond some pixels count
/// less, with the method of Levenberg and Marquardt. The points are eliminated from each step.
pub fn adjust(cameras: &mut Vec<Camera>, groups: &mut Vec<PointGroup>, adjusted: Adjusted) {
    let mut damping = 1e-4;
    let mut cost = total_cost(cameras, groups);
    for _ in 0..MAX_STEPS {
        let found = step(cameras, groups, adjusted, damping);
        let found = found.map(|found| (total_cost(&found.0, &found.1), found));
        if let Some((new_cost, new)) = found.filter(|(new_cost, _)| *new_cost < cost) {
            let gain = (cost - new_cost) / cost;
            ((*cameras, *groups), cost) = (new, new_cost);
            damping = (damping * 0.2).max(1e-12);
            if gain < MIN_GAIN {
                return;
            }
        } else {
            damping *= 10.0;
            if damping > 1e12 {
                return;
            }
        }
    }
}

/// Returns the distance of a mark from where the camera shows its point, in pixels; `None` behind the camera.
pub fn error(cameras: &[Camera], group: &PointGroup, mark: &Mark) -> Option<DVec2> {
    let projected = cameras[mark.camera].project(group.points[mark.point])?;
    Some(projected.pixel - mark.pixel)
}

fn total_cost(cameras: &[Camera], groups: &[PointGroup]) -> f64 {
    let mut cost = 0.0;
    for group in groups {
        for mark in &group.marks {
            // A point behind its camera is as wrong as can be.
            let length = error(cameras, group, mark).map_or(1e6, DVec2::length);
            cost += if length <= ROBUST_PX {
                length * length
            } else {
                ROBUST_PX * (2.0 * length - ROBUST_PX)
            };
        }
        if let Some(error) = length_error(group) {
            cost += error * error;
        }
    }
    cost
}

fn length_error(group: &PointGroup) -> Option<f64> {
    let length = group.length?;
    let found = group.points[0].distance(group.points[1]);
    Some(WAND_WEIGHT * (found - length) / length)
}

/// The normal equations of one group of points: its own, and those with the cameras that see it.
struct Equations {
    own: DMatrix<f64>,
    own_right: DVector<f64>,
    /// Rows of all cameras.
    with_cameras: DMatrix<f64>,
}

/// Returns the cameras and points after one step; `None` if it has no solution.
fn step(
    cameras: &[Camera],
    groups: &[PointGroup],
    adjusted: Adjusted,
    damping: f64,
) -> Option<(Vec<Camera>, Vec<PointGroup>)> {
    let size = PARAMETERS * cameras.len();
    let mut matrix = DMatrix::<f64>::zeros(size, size);
    let mut right = DVector::<f64>::zeros(size);
    let mut all = Vec::new();
    for group in groups {
        all.push(equations(cameras, group, &mut matrix, &mut right));
    }
    for index in 0..size {
        let (camera, parameter) = (index / PARAMETERS, index % PARAMETERS);
        let is_place = parameter < 6;
        let is_fixed = (is_place && camera == 0 && adjusted.is_first_fixed)
            || (!is_place && !adjusted.has_lenses);
        let weight = matrix[(index, index)];
        // A parameter that no mark shows stays.
        matrix[(index, index)] = if is_fixed {
            1e300
        } else {
            weight * (1.0 + damping) + 1e-12
        };
    }
    let mut solved = Vec::new();
    for (group, equations) in groups.iter().zip(all) {
        if group.is_fixed {
            solved.push(None);
            continue;
        }
        let mut own = equations.own;
        for index in 0..own.nrows() {
            own[(index, index)] = own[(index, index)] * (1.0 + damping) + 1e-12;
        }
        let own = own.cholesky()?;
        let by_camera = own.solve(&equations.with_cameras.transpose());
        let alone = own.solve(&equations.own_right);
        matrix -= &equations.with_cameras * &by_camera;
        right -= &equations.with_cameras * &alone;
        solved.push(Some((by_camera, alone)));
    }
    let change = matrix.cholesky()?.solve(&right);
    let new_cameras = cameras.iter().enumerate().map(|(index, camera)| {
        camera.changed(&std::array::from_fn(|row| change[PARAMETERS * index + row]))
    });
    let new_groups = groups.iter().zip(solved).map(|(group, solved)| {
        let mut group = group.clone();
        if let Some((by_camera, alone)) = solved {
            let moved = alone - by_camera * &change;
            for (index, point) in group.points.iter_mut().enumerate() {
                *point += DVec3::from_slice(&moved.as_slice()[3 * index..3 * index + 3]);
            }
        }
        group
    });
    Some((new_cameras.collect(), new_groups.collect()))
}

/// Adds the equations of the marks of a group to the equations of the cameras, and returns the equations of its points.
fn equations(
    cameras: &[Camera],
    group: &PointGroup,
    matrix: &mut DMatrix<f64>,
    right: &mut DVector<f64>,
) -> Equations {
    let size = 3 * group.points.len();
    let mut equations = Equations {
        own: DMatrix::zeros(size, size),
        own_right: DVector::zeros(size),
        with_cameras: DMatrix::zeros(matrix.nrows(), size),
    };
    for mark in &group.marks {
        let Some(projected) = cameras[mark.camera].project(group.points[mark.point]) else {
            continue;
        };
        let error = mark.pixel - projected.pixel;
        let weight = (ROBUST_PX / error.length().max(ROBUST_PX)).min(1.0);
        let (start, first) = (PARAMETERS * mark.camera, 3 * mark.point);
        for (row, by_row) in projected.by_camera.iter().enumerate() {
            right[start + row] += weight * by_row.dot(error);
            for (column, by_column) in projected.by_camera.iter().enumerate() {
                matrix[(start + row, start + column)] += weight * by_row.dot(*by_column);
            }
            for (column, by_column) in projected.by_point.iter().enumerate() {
                let product = weight * by_row.dot(*by_column);
                equations.with_cameras[(start + row, first + column)] += product;
            }
        }
        for (row, by_row) in projected.by_point.iter().enumerate() {
            equations.own_right[first + row] += weight * by_row.dot(error);
            for (column, by_column) in projected.by_point.iter().enumerate() {
                equations.own[(first + row, first + column)] += weight * by_row.dot(*by_column);
            }
        }
    }
    if let (Some(error), Some(length)) = (length_error(group), group.length) {
        let along = (group.points[1] - group.points[0]).normalize_or(DVec3::X);
        let by = along * (WAND_WEIGHT / length);
        let slopes = [-by.x, -by.y, -by.z, by.x, by.y, by.z];
        for (row, by_row) in slopes.iter().enumerate() {
            equations.own_right[row] -= by_row * error;
            for (column, by_column) in slopes.iter().enumerate() {
                equations.own[(row, column)] += by_row * by_column;
            }
        }
    }
    equations
}
