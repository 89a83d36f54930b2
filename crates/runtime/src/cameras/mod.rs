//! Cameras: their places and lenses, from what they see of a wand or of known points.
//!
//! | step | function |
//! |---|---|
//! | first estimate of each camera | [`camera_from_points`], [`camera_from_pair`] |
//! | all cameras and points together | [`adjust`] |
//! | the whole calibration | [`from_wand`], [`from_points`], [`refine`] |
//! | the file of the cameras | [`CamerasFile`] |
//! | an image → its marks | [`find_marks`] |

mod bundle;
mod calibration;
mod camera;
mod file;
mod linear;
mod marks;
#[cfg(test)]
mod tests;

pub use bundle::{Adjusted, Mark, PointGroup, adjust};
pub use calibration::{
    Calibration, CalibrationError, Frame, ImageError, MIN_WAND_FRAMES, from_points, from_wand,
    refine,
};
pub use camera::{Camera, PARAMETERS, Projection};
pub use file::{CamerasFile, CamerasFileError, CamerasFormat};
pub use linear::{LinearError, MIN_PAIRS, MIN_POINTS, camera_from_pair, camera_from_points};
pub use marks::{FoundMark, FoundMarks, MarkImage, MarkSettings, find_marks};
