//! The settings that Studio remembers between two starts.

use std::collections::BTreeMap;

use serde::{Deserialize, Serialize};

use super::camera::Camera;
use super::recent::RecentFiles;
use super::texts::Language;
use ademan_runtime::sound::DEFAULT_VOLUME;

/// Range of the scale of everything in the window.
const SCALES: (f32, f32) = (0.5, 3.0);

/// Lowest opacity of the overlay: below, it cannot be found.
pub const MIN_OPACITY: f32 = 0.1;

/// Range of the speed of the simulated hand, as a factor.
pub const HAND_SPEEDS: (f32, f32) = (0.25, 3.0);

/// Range of the noise of its sensors: with more, hardly any reading of a glove is accepted.
pub const HAND_NOISES: (f32, f32) = (0.0, 5.0);

/// The settings. Fields that a file lacks have their defaults, so that files of other versions are read.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(default)]
pub struct Settings {
    /// Light or dark colors.
    pub theme: Theme,
    /// Colors of high contrast.
    pub has_high_contrast: bool,
    /// Scale of everything in the window, 0.5..=3.
    pub scale: f32,
    /// The language, unless it follows the locale.
    pub language: Option<Language>,
    /// Position and size of the window.
    pub window: Option<WindowPlace>,
    /// Panels that are not shown, by key of their name.
    pub hidden_panels: Vec<String>,
    /// Width or height of panels in points, by key of their name.
    pub panel_sizes: BTreeMap<String, f32>,
    /// The camera, and the layout that it was pointed at.
    pub camera: Option<CameraPlace>,
    /// The tour has been shown.
    pub has_seen_tour: bool,
    /// The overlay.
    pub overlay: OverlaySettings,
    /// The clicks.
    pub sound: SoundSettings,
    /// The simulated hand.
    pub hand: HandSettings,
    /// The files of layouts that were opened last.
    pub recent_layouts: RecentFiles,
    /// The recordings that were chosen last.
    pub recent_recordings: RecentFiles,
}

/// A choice of colors.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum Theme {
    /// As the desktop.
    #[default]
    System,
    /// Dark on light.
    Light,
    /// Light on dark.
    Dark,
}

/// Position and size of the window, in points.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct WindowPlace {
    /// Upper left corner. `None` where the desktop does not report it.
    pub position: Option<[f32; 2]>,
    /// Width and height.
    pub size: [f32; 2],
}

/// A camera, and the layout that it was pointed at.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct CameraPlace {
    /// Name of the layout.
    pub layout: String,
    /// The point in the middle of the picture, in metres.
    pub target: [f32; 3],
    /// Direction of the eye about the vertical, in radians.
    pub azimuth: f32,
    /// Elevation of the eye, in radians.
    pub elevation: f32,
    /// Distance from the eye to the target, in metres.
    pub distance: f32,
}

/// Position and opacity of the overlay.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[serde(default)]
pub struct OverlaySettings {
    /// Upper left corner, in points. `None` before it was moved.
    pub position: Option<[f32; 2]>,
    /// Opacity, 0.1..=1.
    pub opacity: f32,
}

/// Clicks on presses.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[serde(default)]
pub struct SoundSettings {
    /// Presses click.
    pub is_on: bool,
    /// Volume as a fraction of the full volume, 0..=1.
    pub volume: f32,
}

/// The simulated hand of a session without a source.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(default)]
pub struct HandSettings {
    /// Factor of the speed of its person, [`HAND_SPEEDS`].
    pub speed: f32,
    /// Standard deviation of the noise of its sensors, in counts of a glove or millimetres of a camera, [`HAND_NOISES`].
    pub noise: f32,
    /// The person: the name of one that comes with the program, or a file. `None` for the person of the session.
    pub person: Option<String>,
}

impl Default for HandSettings {
    fn default() -> Self {
        Self {
            speed: 1.0,
            noise: 0.0,
            person: None,
        }
    }
}

impl Default for Settings {
    fn default() -> Self {
        Self {
            theme: Theme::default(),
            has_high_contrast: false,
            scale: 1.0,
            language: None,
            window: None,
            hidden_panels: Vec::new(),
            panel_sizes: BTreeMap::new(),
            camera: None,
            has_seen_tour: false,
            overlay: OverlaySettings::default(),
            sound: SoundSettings::default(),
            hand: HandSettings::default(),
            recent_layouts: RecentFiles::default(),
            recent_recordings: RecentFiles::default(),
        }
    }
}

impl Default for OverlaySettings {
    fn default() -> Self {
        Self {
            position: None,
            opacity: 0.8,
        }
    }
}

/// Off: a window is not expected to make a noise before it is asked to, and other people may be in the room.
impl Default for SoundSettings {
    fn default() -> Self {
        Self {
            is_on: false,
            volume: DEFAULT_VOLUME,
        }
    }
}

impl SoundSettings {
    /// Returns the volume, or 0 while clicks are off.
    pub fn level(self) -> f32 {
        if self.is_on { self.volume } else { 0.0 }
    }
}

impl Settings {
    /// Returns the settings with every number in its range.
    #[must_use]
    pub fn checked(mut self) -> Self {
        self.scale = in_range(self.scale, SCALES, 1.0);
        self.overlay.opacity = in_range(self.overlay.opacity, (MIN_OPACITY, 1.0), 0.8);
        self.sound.volume = in_range(self.sound.volume, (0.0, 1.0), DEFAULT_VOLUME);
        self.recent_layouts = self.recent_layouts.checked();
        self.recent_recordings = self.recent_recordings.checked();
        self.hand.speed = in_range(self.hand.speed, HAND_SPEEDS, 1.0);
        self.hand.noise = in_range(self.hand.noise, HAND_NOISES, 0.0);
        let is_finite = |position: &[f32; 2]| position.iter().all(|value| value.is_finite());
        self.overlay.position = self.overlay.position.filter(is_finite);
        self.window = self.window.filter(|window| {
            is_finite(&window.size) && window.position.as_ref().is_none_or(is_finite)
        });
        self.panel_sizes
            .retain(|_, size| size.is_finite() && *size > 0.0);
        self.camera = self.camera.filter(|place| {
            let mut values = place
                .target
                .iter()
                .chain([&place.azimuth, &place.elevation]);
            values.all(|value| value.is_finite()) && place.distance > 0.0
        });
        self
    }

    /// Adds the recent files that another window has written since `before` was read.
    pub fn merge_recent(&mut self, present: &Self, before: &Self) {
        self.recent_layouts
            .merge(&present.recent_layouts, &before.recent_layouts);
        self.recent_recordings
            .merge(&present.recent_recordings, &before.recent_recordings);
    }

    /// Returns the camera that was pointed at this layout.
    pub fn camera_for(&self, layout: &str) -> Option<Camera> {
        let place = self
            .camera
            .as_ref()
            .filter(|place| place.layout == layout)?;
        Some(place.camera())
    }
}

impl CameraPlace {
    /// Creates the place of a camera that is pointed at a layout.
    pub fn new(camera: &Camera, layout: &str) -> Self {
        Self {
            layout: layout.to_owned(),
            target: camera.target.to_array(),
            azimuth: camera.azimuth,
            elevation: camera.elevation,
            distance: camera.distance,
        }
    }

    fn camera(&self) -> Camera {
        let mut camera = Camera {
            target: self.target.into(),
            azimuth: self.azimuth,
            elevation: self.elevation,
            distance: self.distance,
        };
        // Limits the distance.
        camera.zoom(1.0);
        camera
    }
}

fn in_range(value: f32, (low, high): (f32, f32), default: f32) -> f32 {
    if value.is_finite() {
        value.clamp(low, high)
    } else {
        default
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn numbers_out_of_range_are_corrected() {
        let settings = Settings {
            scale: f32::NAN,
            window: Some(WindowPlace {
                position: Some([f32::INFINITY, 0.0]),
                size: [800.0, 600.0],
            }),
            panel_sizes: [("panel-scope".to_owned(), -1.0)].into(),
            overlay: OverlaySettings {
                position: None,
                opacity: 0.0,
            },
            sound: SoundSettings {
                is_on: false,
                volume: f32::INFINITY,
            },
            hand: HandSettings {
                speed: f32::NAN,
                noise: f32::NEG_INFINITY,
                person: None,
            },
            ..Settings::default()
        };
        let checked = settings.checked();
        let expected = Settings {
            overlay: OverlaySettings {
                position: None,
                opacity: MIN_OPACITY,
            },
            ..Settings::default()
        };
        assert_eq!(checked, expected);
    }

    #[test]
    fn a_camera_is_kept_for_its_layout_only() {
        let camera = Camera {
            azimuth: 0.5,
            ..Camera::default()
        };
        let settings = Settings {
            camera: Some(CameraPlace::new(&camera, "numpad")),
            ..Settings::default()
        };
        assert_eq!(settings.camera_for("numpad"), Some(camera));
        assert_eq!(settings.camera_for("piano"), None);
    }
}
