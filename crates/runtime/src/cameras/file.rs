//! Files of cameras: RON, and the TOML of Pose2Sim and Anipose.

use std::fmt::Write;

use ademan_core::document::{Document, DocumentError};
use glam::{DQuat, DVec2, DVec3};
use serde::{Deserialize, Serialize};

use super::camera::Camera;

/// Largest number of a file: no room is larger, and no image.
const MAX_NUMBER: f64 = 1e6;

/// The form of a file.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum CamerasFormat {
    /// RON, the form of all files of this program.
    Ron,
    /// TOML, which Pose2Sim and Anipose read.
    Toml,
}

/// The cameras of a room.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields, rename = "Cameras")]
pub struct CamerasFile {
    cameras: Vec<Entry>,
}

/// A camera in the convention of OpenCV.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields, rename = "Camera")]
struct Entry {
    name: String,
    size_px: (f64, f64),
    focal_px: (f64, f64),
    center_px: (f64, f64),
    #[serde(default)]
    distortion: (f64, f64, f64, f64),
    /// Axis times angle in radians, camera from world.
    rotation: (f64, f64, f64),
    translation_m: (f64, f64, f64),
}

/// The table of a camera in TOML. Other keys are ignored.
#[derive(Deserialize)]
struct Table {
    name: Option<String>,
    size: (f64, f64),
    matrix: [[f64; 3]; 3],
    distortions: Vec<f64>,
    rotation: (f64, f64, f64),
    translation: (f64, f64, f64),
    #[serde(default)]
    fisheye: bool,
}

/// A reason why a text is not a file of cameras.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
pub enum CamerasFileError {
    /// The text has another form.
    #[error(transparent)]
    Text(#[from] DocumentError),
    /// A camera has numbers that no camera has.
    #[error("the camera `{name}` {reason}")]
    Camera {
        /// The name of the camera.
        name: String,
        /// The reason.
        reason: &'static str,
    },
}

impl CamerasFile {
    /// Creates the file of some cameras.
    pub fn new(cameras: &[Camera]) -> Self {
        let entry = |camera: &Camera| Entry {
            name: camera.name.clone(),
            size_px: camera.size.into(),
            focal_px: camera.focal.into(),
            center_px: camera.center.into(),
            distortion: camera.distortion.into(),
            rotation: camera.rotation.to_scaled_axis().into(),
            translation_m: camera.translation.into(),
        };
        Self {
            cameras: cameras.iter().map(entry).collect(),
        }
    }

    /// Parses a document.
    pub fn parse(document: &Document, format: CamerasFormat) -> Result<Self, CamerasFileError> {
        let file: Self = match format {
            CamerasFormat::Ron => document.parse()?,
            CamerasFormat::Toml => Self::parse_toml(document)?,
        };
        for (index, entry) in file.cameras.iter().enumerate() {
            let error = |reason| CamerasFileError::Camera {
                name: entry.name.clone(),
                reason,
            };
            // A view is of the camera with its name.
            let before = &file.cameras[..index];
            if before.iter().any(|other| other.name == entry.name) {
                return Err(error("is given twice; give each camera its own name"));
            }
            let (k1, k2, p1, p2) = entry.distortion;
            let pairs = [entry.size_px, entry.focal_px, entry.center_px];
            let triples = [entry.rotation, entry.translation_m];
            let all = pairs.into_iter().flat_map(|(x, y)| [x, y]);
            let all = all.chain(triples.into_iter().flat_map(|(x, y, z)| [x, y, z]));
            let is_possible = |number: f64| number.is_finite() && number.abs() <= MAX_NUMBER;
            if !all.chain([k1, k2, p1, p2]).all(is_possible) {
                return Err(error(
                    "has a number that is not finite, or beyond a million",
                ));
            }
            let is_positive = |(x, y): (f64, f64)| x > 0.0 && y > 0.0;
            if !is_positive(entry.size_px) || !is_positive(entry.focal_px) {
                return Err(error("needs an image and focal lengths above 0"));
            }
        }
        Ok(file)
    }

    fn parse_toml(document: &Document) -> Result<Self, CamerasFileError> {
        let Document { file, text, .. } = document;
        let parsed = toml::from_str(text);
        let tables: toml::Table = parsed.map_err(|error: toml::de::Error| {
            DocumentError::at(file, text, error.span().unwrap_or(0..0), error.message())
        })?;
        let mut cameras = Vec::new();
        for (key, value) in tables {
            // A table of notes, such as `metadata`.
            if value.get("matrix").is_none() {
                continue;
            }
            let table: Table = value.try_into().map_err(|error: toml::de::Error| {
                // The text has a second line with the key.
                let reason = error.to_string().trim_end().replace('\n', " ");
                DocumentError::for_file(file, format!("the table `{key}`: {reason}"))
            })?;
            let name = table.name.unwrap_or(key);
            let refused = |reason| CamerasFileError::Camera {
                name: name.clone(),
                reason,
            };
            if table.fisheye {
                return Err(refused("is a fisheye camera, which is not supported"));
            }
            let [k1, k2, p1, p2, ref rest @ ..] = table.distortions[..] else {
                return Err(refused("needs the four distortions k1, k2, p1 and p2"));
            };
            if rest.iter().any(|number| *number != 0.0) {
                return Err(refused("has more distortions than k1, k2, p1 and p2"));
            }
            let [[focal_x, skew, center_x], [_, focal_y, center_y], _] = table.matrix;
            if skew != 0.0 {
                return Err(refused("has a skew in its matrix, which is not supported"));
            }
            cameras.push(Entry {
                name,
                size_px: table.size,
                focal_px: (focal_x, focal_y),
                center_px: (center_x, center_y),
                distortion: (k1, k2, p1, p2),
                rotation: table.rotation,
                translation_m: table.translation,
            });
        }
        Ok(Self { cameras })
    }

    /// Returns the text of the file.
    pub fn to_text(&self, format: CamerasFormat) -> String {
        match format {
            CamerasFormat::Ron => {
                let pretty = ron::ser::PrettyConfig::new().depth_limit(3);
                let text = ron::ser::to_string_pretty(self, pretty);
                text.expect("numbers and names are RON") + "\n"
            }
            CamerasFormat::Toml => self.to_toml(),
        }
    }

    fn to_toml(&self) -> String {
        let mut text = String::new();
        for (index, entry) in self.cameras.iter().enumerate() {
            let name = serde_json::to_string(&entry.name).expect("a name is text");
            let ((fx, fy), (cx, cy)) = (entry.focal_px, entry.center_px);
            let (k1, k2, p1, p2) = entry.distortion;
            let ((rx, ry, rz), (tx, ty, tz)) = (entry.rotation, entry.translation_m);
            let (width, height) = entry.size_px;
            writeln!(
                text,
                "[cam_{:02}]\nname = {name}\nsize = [{width:?}, {height:?}]\nmatrix = [[{fx:?}, 0.0, {cx:?}], [0.0, {fy:?}, {cy:?}], \
                 [0.0, 0.0, 1.0]]\ndistortions = [{k1:?}, {k2:?}, {p1:?}, {p2:?}]\nrotation = [{rx:?}, {ry:?}, {rz:?}]\n\
                 translation = [{tx:?}, {ty:?}, {tz:?}]\nfisheye = false\n",
                index + 1
            )
            .expect("memory accepts every text");
        }
        text
    }

    /// Returns the cameras.
    pub fn cameras(&self) -> Vec<Camera> {
        let camera = |entry: &Entry| Camera {
            name: entry.name.clone(),
            size: DVec2::from(entry.size_px),
            focal: DVec2::from(entry.focal_px),
            center: DVec2::from(entry.center_px),
            distortion: entry.distortion.into(),
            rotation: DQuat::from_scaled_axis(DVec3::from(entry.rotation)),
            translation: DVec3::from(entry.translation_m),
        };
        self.cameras.iter().map(camera).collect()
    }
}
