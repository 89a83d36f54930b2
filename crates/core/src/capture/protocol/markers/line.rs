//! The form of a line.

use glam::{DQuat, DVec3};
use serde::Deserialize;

use crate::capture::markers::{MAX_CAMERAS, Observation, Ray};

/// Most markers of a camera. The time of the matching grows with their cube.
const MAX_MARKERS: usize = 64;

/// Largest difference of the length of a quaternion from 1.
const QUATERNION_TOLERANCE: f64 = 1e-3;

/// The observations of all cameras at one instant.
#[derive(Debug, Deserialize)]
pub(super) struct Line<'a> {
    pub time_us: Option<u64>,
    #[serde(borrow, deserialize_with = "at_most::<_, _, MAX_CAMERAS>")]
    pub cameras: Vec<Camera<'a>>,
}

/// A camera and the markers that it sees.
#[derive(Debug, Deserialize)]
pub(super) struct Camera<'a> {
    position: [f64; 3],
    orientation: Option<[f64; 4]>,
    #[serde(default = "default_focal")]
    focal_px: [f64; 2],
    #[serde(default)]
    center_px: [f64; 2],
    #[serde(borrow, deserialize_with = "at_most::<_, _, MAX_MARKERS>")]
    markers: Vec<Marker<'a>>,
}

#[derive(Debug, Deserialize)]
struct Marker<'a> {
    #[serde(borrow)]
    label: Option<std::borrow::Cow<'a, str>>,
    // Not a flattened enum: that would store every field before it is read.
    point: Option<[f64; 3]>,
    direction: Option<[f64; 3]>,
    image: Option<[f64; 2]>,
}

fn default_focal() -> [f64; 2] {
    [1.0; 2]
}

/// Reads a list of at most `MAX` elements.
fn at_most<'de, D, T, const MAX: usize>(deserializer: D) -> Result<Vec<T>, D::Error>
where
    D: serde::Deserializer<'de>,
    T: Deserialize<'de>,
{
    let list = Vec::deserialize(deserializer)?;
    if list.len() <= MAX {
        Ok(list)
    } else {
        Err(serde::de::Error::invalid_length(
            list.len(),
            &"a shorter list",
        ))
    }
}

impl Line<'_> {
    /// Returns the labels that the cameras state.
    pub fn labels(&self) -> impl Iterator<Item = &str> {
        let markers = self.cameras.iter().flat_map(|camera| &camera.markers);
        markers.filter_map(|marker| marker.label.as_deref())
    }

    /// Returns `true` if there are markers, and none of them has a position.
    pub fn hides_all(&self) -> bool {
        let mut markers = self.cameras.iter().flat_map(|camera| &camera.markers);
        let is_hidden = |marker: &Marker| {
            marker.point.is_none() && marker.direction.is_none() && marker.image.is_none()
        };
        self.cameras.iter().any(|camera| !camera.markers.is_empty()) && markers.all(is_hidden)
    }
}

impl Camera<'_> {
    /// Returns the rays to the markers that the camera sees; `None` if one of them is not determined.
    pub fn observations(&self) -> Option<Vec<Observation<'_>>> {
        let origin = DVec3::from_array(self.position);
        let mut observations = Vec::with_capacity(self.markers.len());
        for marker in &self.markers {
            let direction = match (marker.point, marker.direction, marker.image) {
                (Some(point), None, None) => DVec3::from_array(point) - origin,
                (None, Some(direction), None) => DVec3::from_array(direction),
                (None, None, Some(image)) => self.direction(image)?,
                (None, None, None) => DVec3::ZERO,
                _ => return None,
            };
            // One hidden marker says nothing about the others.
            if direction == DVec3::ZERO {
                continue;
            }
            let ray = Ray { origin, direction };
            observations.push(Observation {
                label: marker.label.as_deref(),
                ray: ray.is_valid().then_some(ray)?,
            });
        }
        Some(observations)
    }

    /// Returns the direction in space of an image position.
    fn direction(&self, [u, v]: [f64; 2]) -> Option<DVec3> {
        let world_from_camera = DQuat::from_array(self.orientation?);
        if (world_from_camera.length() - 1.0).abs() > QUATERNION_TOLERANCE {
            return None;
        }
        let [focal_u, focal_v] = self.focal_px;
        let [center_u, center_v] = self.center_px;
        let in_camera = DVec3::new((u - center_u) / focal_u, (v - center_v) / focal_v, 1.0);
        Some(world_from_camera.normalize() * in_camera)
    }
}
