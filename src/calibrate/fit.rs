//! The fit of a glove to a hand: gains and offsets, and the faults of its sensors.

use super::error::CalibrationError;
use super::observation::Observations;
use super::problem::Problem;
use crate::estimate::ChannelMap;

/// The calibration of a glove for a hand.
#[derive(Clone, Debug, PartialEq)]
pub struct CalibrationResult {
    /// The rows of the starting glove with new maps, in the same order.
    pub map: ChannelMap,
    /// The quality, 0..=100: 100 less a part for each problem and for poses that contradict each other.
    pub score: u8,
    /// The problems, the worst first.
    pub problems: Vec<Problem>,
}

/// Fits a glove to a hand. `start` is the glove from which the calibration starts, such as a shipped one.
///
/// # Errors
/// Fails if the observations do not determine a calibration that a hand could use, with all reasons.
pub fn fit(
    observations: &Observations,
    start: &ChannelMap,
) -> Result<CalibrationResult, CalibrationError> {
    if start.rows().is_empty() {
        return Err(CalibrationError::EmptyGlove);
    }
    if observations.poses().len() < 2 {
        let observed = observations.poses().len();
        return Err(CalibrationError::TooFewPoses { observed });
    }
    Ok(CalibrationResult {
        map: start.clone(),
        score: 0,
        problems: Vec::new(),
    })
}
