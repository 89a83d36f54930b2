//! The form of a line of hand landmarks.

use arrayvec::ArrayVec;
use serde::Deserialize;

use super::camera::HAND_LANDMARKS;
use crate::capture::protocol::tracked_hands::{Label, MAX_HANDS, Position, certain};

/// The hands of one image.
#[derive(Debug, Deserialize)]
pub(super) struct Line {
    pub time_us: Option<u64>,
    /// Width and height of the image in pixels.
    pub image_size: Option<[f64; 2]>,
    pub hands: ArrayVec<Hand, MAX_HANDS>,
}

/// A hand as MediaPipe returns it.
#[derive(Debug, Deserialize)]
pub(in crate::capture::protocol) struct Hand {
    pub label: Label,
    #[serde(default = "certain")]
    pub score: f64,
    pub world: Option<ArrayVec<Position, HAND_LANDMARKS>>,
    pub image: Option<ArrayVec<Position, HAND_LANDMARKS>>,
}
