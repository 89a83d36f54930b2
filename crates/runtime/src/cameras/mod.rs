//! Cameras: their places and lenses, from what they see of a wand or of known points.
//!
//! | step | function |
//! |---|---|
//! | the calibration | [`from_wand`], [`from_points`], [`refine`] |
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

pub use calibration::{
    Calibration, CalibrationError, Frame, ImageError, from_points, from_wand, refine,
};
pub use camera::{Camera, PARAMETERS, Projection};
pub use file::{CamerasFile, CamerasFileError, CamerasFormat};
pub use linear::LinearError;
pub use marks::{FoundMark, FoundMarks, MarkImage, MarkSettings, find_marks};
