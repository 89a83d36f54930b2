//! Landmarks of a body.

use arrayvec::ArrayVec;
use serde::{Deserialize, Serialize};

/// Number of landmarks of a body, in the order of the pose models of MediaPipe: 11 to 22 are shoulders, elbows, wrists,
/// little fingers, index fingers and thumbs, left before right, and 23 and 24 the hips.
pub const BODY_LANDMARKS: usize = 33;

/// Positions of the landmarks of a body at one moment.
///
/// Positions are in metres: x to the right of the image, y down, z away from the camera. The origin does not matter.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct BodyLandmarks {
    /// The landmarks, [`BODY_LANDMARKS`] of them.
    #[serde(rename = "body_landmarks")]
    pub points: ArrayVec<Landmark, BODY_LANDMARKS>,
}

/// A position with a confidence. As JSON `[x,y,z,confidence]`, or `[x,y,z]` with the confidence 1.
///
/// Its numbers have single precision, as the models give them, which keeps readings small.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[serde(try_from = "ArrayVec<f32, 4>", into = "[f32; 4]")]
pub struct Landmark {
    /// Position in metres.
    pub position: [f32; 3],
    /// Probability that the landmark is visible, 0..=1.
    pub confidence: f32,
}

impl TryFrom<ArrayVec<f32, 4>> for Landmark {
    type Error = &'static str;

    fn try_from(numbers: ArrayVec<f32, 4>) -> Result<Self, Self::Error> {
        match numbers[..] {
            [x, y, z, confidence] => Ok(Self {
                position: [x, y, z],
                confidence,
            }),
            [x, y, z] => Ok(Self {
                position: [x, y, z],
                confidence: 1.0,
            }),
            _ => Err("a landmark has three or four numbers"),
        }
    }
}

impl From<Landmark> for [f32; 4] {
    fn from(landmark: Landmark) -> Self {
        let [x, y, z] = landmark.position;
        [x, y, z, landmark.confidence]
    }
}
