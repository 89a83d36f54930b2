//! The calibration of cameras from a wand, from known points, or from what they see alone.

use std::collections::{BTreeMap, BTreeSet};
use std::f64::consts::PI;

use glam::{DQuat, DVec2, DVec3};

use super::bundle::{Adjusted, Mark, PointGroup, adjust, error};
use super::camera::Camera;
use super::linear::{LinearError, camera_from_pair, camera_from_points, crossing};
use crate::capture::markers::{Ray, median, triangulate};

/// Fewest frames in which two cameras see the wand together.
const MIN_WAND_FRAMES: usize = 8;

/// The labels of the ends of a wand.
const ENDS: [&str; 2] = ["a", "b"];

/// Fewest marks of a camera whose lens is adjusted.
const MIN_LENS_MARKS: usize = 40;

/// The view of all cameras at one instant: the pixel of each label, by camera.
pub type Frame = Vec<BTreeMap<String, DVec2>>;

/// Calibrated cameras.
#[derive(Clone, Debug)]
pub struct Calibration {
    /// The cameras.
    pub cameras: Vec<Camera>,
    /// The error of each camera.
    pub errors: Vec<ImageError>,
}

/// Distances of the marks of a camera from where it shows their points.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct ImageError {
    /// The number of marks.
    pub marks: usize,
    /// The median in pixels.
    pub median_px: f64,
    /// The root of the mean square in pixels.
    pub rms_px: f64,
}

/// A reason why cameras are not calibrated.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum CalibrationError {
    /// Two cameras that nothing else connects see the wand together in too few frames.
    #[error(
        "`{first}` and `{second}` see both ends of the wand together in {found} frames and {MIN_WAND_FRAMES} are needed: \
         {} are missing",
        MIN_WAND_FRAMES - found
    )]
    TooFewFrames {
        /// The name of the first camera.
        first: String,
        /// The name of the second camera.
        second: String,
        /// The frames.
        found: usize,
    },
    /// A camera has no first estimate.
    #[error("`{name}`: {reason}")]
    Camera {
        /// The name of the camera, or of two.
        name: String,
        /// The reason.
        reason: LinearError,
    },
    /// There are not two cameras.
    #[error("a calibration needs two cameras or more")]
    OneCamera,
    /// No point is seen by two cameras.
    #[error("no point is seen by two cameras")]
    NothingShared,
}

/// Calibrates cameras that see the ends `a` and `b` of a wand of a length in metres. The world is the frame of the first camera: X to
/// its right, Y up and −Z along its view. The lenses begin with the lenses of `start`, and are kept if `keeps_lenses`.
pub fn from_wand(
    start: &[Camera],
    frames: &[Frame],
    length: f64,
    keeps_lenses: bool,
) -> Result<Calibration, CalibrationError> {
    if start.len() < 2 {
        return Err(CalibrationError::OneCamera);
    }
    let cameras = placed_by_wand(start, frames, length)?;
    let groups = frames
        .iter()
        .flat_map(|frame| wand_groups(&cameras, frame, length))
        .collect();
    adjusted(cameras, groups, true, keeps_lenses)
}

/// Calibrates each camera by points at known places in metres.
pub fn from_points(
    start: &[Camera],
    frames: &[Frame],
    known: &BTreeMap<String, DVec3>,
    keeps_lenses: bool,
) -> Result<Calibration, CalibrationError> {
    let mut cameras = Vec::new();
    let mut group = PointGroup {
        points: known.values().copied().collect(),
        length: None,
        is_fixed: true,
        marks: Vec::new(),
    };
    for (index, camera) in start.iter().enumerate() {
        let (mut points, mut pixels) = (Vec::new(), Vec::new());
        for (point, (label, place)) in known.iter().enumerate() {
            for pixel in frames.iter().filter_map(|frame| frame[index].get(label)) {
                points.push(*place);
                pixels.push(*pixel);
                group.marks.push(Mark {
                    camera: index,
                    point,
                    pixel: *pixel,
                });
            }
        }
        let estimate = camera_from_points(camera, &points, &pixels);
        let mut estimate = estimate.map_err(|reason| CalibrationError::Camera {
            name: camera.name.clone(),
            reason,
        })?;
        if keeps_lenses {
            (estimate.focal, estimate.center) = (camera.focal, camera.center);
        }
        cameras.push(estimate);
    }
    adjusted(cameras, vec![group], false, keeps_lenses)
}

/// Improves calibrated cameras by labelled points that they see. The first camera stays, and so does its distance from the second, which
/// gives the scale: both at one place are refused.
pub fn refine(
    start: &[Camera],
    frames: &[Frame],
    keeps_lenses: bool,
) -> Result<Calibration, CalibrationError> {
    let [first, second, ..] = start else {
        return Err(CalibrationError::OneCamera);
    };
    let distance = first.position().distance(second.position());
    let mut groups = Vec::new();
    for frame in frames {
        let labels: BTreeSet<&String> = frame.iter().flat_map(BTreeMap::keys).collect();
        let point = labels
            .into_iter()
            .filter_map(|label| point_group(start, frame, label));
        groups.extend(point);
    }
    let mut calibration = adjusted(start.to_vec(), groups, true, keeps_lenses)?;
    let [first_place, second_place] = [0, 1].map(|index| calibration.cameras[index].position());
    let scale = distance / first_place.distance(second_place);
    let has_scale = scale.is_finite() && scale > 0.0;
    if !has_scale {
        return Err(CalibrationError::Camera {
            name: format!("{}` and `{}", first.name, second.name),
            reason: LinearError::SamePlace,
        });
    }
    for camera in &mut calibration.cameras {
        let position = first_place + scale * (camera.position() - first_place);
        camera.translation = -(camera.rotation * position);
    }
    Ok(calibration)
}

/// Adjusts the places of cameras and points, then the lenses too, if there are enough marks, and measures the errors.
fn adjusted(
    mut cameras: Vec<Camera>,
    mut groups: Vec<PointGroup>,
    is_first_fixed: bool,
    keeps_lenses: bool,
) -> Result<Calibration, CalibrationError> {
    if groups.iter().all(|group| group.marks.is_empty()) {
        return Err(CalibrationError::NothingShared);
    }
    let places = Adjusted {
        has_lenses: false,
        is_first_fixed,
    };
    adjust(&mut cameras, &mut groups, places);
    let marks = |camera: usize| {
        let all = groups.iter().flat_map(|group| &group.marks);
        all.filter(|mark| mark.camera == camera).count()
    };
    if !keeps_lenses && (0..cameras.len()).all(|camera| marks(camera) >= MIN_LENS_MARKS) {
        let lenses = Adjusted {
            has_lenses: true,
            ..places
        };
        adjust(&mut cameras, &mut groups, lenses);
    }
    let errors = (0..cameras.len()).map(|camera| image_error(&cameras, &groups, camera));
    Ok(Calibration {
        errors: errors.collect(),
        cameras,
    })
}

fn image_error(cameras: &[Camera], groups: &[PointGroup], camera: usize) -> ImageError {
    let mut distances = Vec::new();
    for group in groups {
        let own = group.marks.iter().filter(|mark| mark.camera == camera);
        distances.extend(own.filter_map(|mark| Some(error(cameras, group, mark)?.length())));
    }
    let squares: f64 = distances.iter().map(|distance| distance * distance).sum();
    ImageError {
        marks: distances.len(),
        rms_px: (squares / distances.len().max(1) as f64).sqrt(),
        median_px: median(&mut distances).unwrap_or_default(),
    }
}

/// Returns the pixels of both ends in the frames in which two cameras see both.
fn shared(frames: &[Frame], cameras: [usize; 2]) -> Vec<[[DVec2; 2]; 2]> {
    let seen = |frame: &Frame| {
        let in_camera =
            |camera: usize| Some([*frame[camera].get(ENDS[0])?, *frame[camera].get(ENDS[1])?]);
        Some([in_camera(cameras[0])?, in_camera(cameras[1])?])
    };
    frames.iter().filter_map(seen).collect()
}

/// Places the cameras one after the other, each beside the one with which it sees the wand most often.
fn placed_by_wand(
    start: &[Camera],
    frames: &[Frame],
    length: f64,
) -> Result<Vec<Camera>, CalibrationError> {
    let mut cameras = start.to_vec();
    let mut placed = vec![0];
    // Y up, and −Z along the view.
    cameras[0].rotation = DQuat::from_rotation_x(PI);
    cameras[0].translation = DVec3::ZERO;
    while placed.len() < cameras.len() {
        let open = (0..cameras.len()).filter(|camera| !placed.contains(camera));
        let pairs = open.flat_map(|open| placed.iter().map(move |&known| (known, open)));
        let counted = pairs
            .map(|(known, candidate)| (shared(frames, [known, candidate]).len(), known, candidate));
        let best = counted.max_by_key(|&(count, known, candidate)| {
            (count, std::cmp::Reverse((known, candidate)))
        });
        let (found, known, next) = best.expect("a camera is open");
        let names = [&start[known].name, &start[next].name];
        if found < MIN_WAND_FRAMES {
            let [first, second] = names.map(Clone::clone);
            return Err(CalibrationError::TooFewFrames {
                first,
                second,
                found,
            });
        }
        let pixels = shared(frames, [known, next]);
        let ideal = |[first, second]: &[[DVec2; 2]; 2], end: usize| {
            (
                start[known].ideal(first[end]),
                start[next].ideal(second[end]),
            )
        };
        let directions: Vec<(DVec2, DVec2)> = pixels
            .iter()
            .flat_map(|seen| [ideal(seen, 0), ideal(seen, 1)])
            .collect();
        let beside = camera_from_pair(&start[next], &directions);
        let beside = beside.map_err(|reason| CalibrationError::Camera {
            name: format!("{}` and `{}", names[0], names[1]),
            reason,
        })?;
        let mut scales: Vec<f64> = directions
            .chunks(2)
            .filter_map(|wand| {
                let end = |(first, second): (DVec2, DVec2)| crossing(&beside, first, second);
                Some(length / end(wand[0])?.distance(end(wand[1])?))
            })
            .collect();
        let scale = median(&mut scales).unwrap_or(1.0);
        let before = &cameras[known];
        let rotation = beside.rotation * before.rotation;
        let translation = beside.rotation * before.translation + scale * beside.translation;
        (cameras[next].rotation, cameras[next].translation) = (rotation, translation);
        placed.push(next);
    }
    Ok(cameras)
}

/// Returns the ends of the wand in a frame that two cameras or more see.
fn wand_groups(cameras: &[Camera], frame: &Frame, length: f64) -> Vec<PointGroup> {
    match ENDS.map(|end| point_group(cameras, frame, end)) {
        [Some(first), Some(second)] => {
            let marks = second.marks.iter().map(|mark| Mark { point: 1, ..*mark });
            vec![PointGroup {
                points: vec![first.points[0], second.points[0]],
                length: Some(length),
                is_fixed: false,
                marks: first.marks.iter().copied().chain(marks).collect(),
            }]
        }
        others => others.into_iter().flatten().collect(),
    }
}

/// Returns the point of a label that two cameras or more see in front of them.
fn point_group(cameras: &[Camera], frame: &Frame, label: &str) -> Option<PointGroup> {
    let (mut rays, mut marks) = (Vec::new(), Vec::new());
    for (index, camera) in cameras.iter().enumerate() {
        if let Some(&pixel) = frame[index].get(label) {
            rays.push(Ray {
                origin: camera.position(),
                direction: camera.direction(pixel),
            });
            marks.push(Mark {
                camera: index,
                point: 0,
                pixel,
            });
        }
    }
    let found = triangulate(&rays).ok()?;
    Some(PointGroup {
        points: vec![found.point],
        length: None,
        is_fixed: false,
        marks,
    })
}
