//! Calibration of sources that measure the positions of joints: cameras, headsets, markers.
//!
//! They need no gains. [`measure_lengths`] takes hand and forearm length from poses of any kind, [`TablePlane`] the table from five
//! fingertips that touch it, and [`board_on_table`] places a board under the hand. [`OpenHand`] waits for a hand that is held open,
//! and [`measure_palm`] shows where its palm is. The delay of a camera behind another source is
//! measured by [`estimate_delay`](crate::estimate::delay::estimate_delay).

mod lengths;
mod open_hand;
mod palm;
mod table;

pub use lengths::{HandLengths, measure_lengths};
pub use open_hand::{HoldAdvice, OpenHand};
pub use palm::{measure_palm, typing_palm};
pub use table::{TablePlane, board_on_table};

use glam::DVec3;

use super::capture::percentile;
use crate::hand::{Finger, Joint, JointPositions};

/// The reason why positions show no length or no table. Each message states what is wrong and what to do.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum PositionError {
    /// Too few readings show the joints.
    #[error("only {readings} readings show the {part}; keep the whole hand in view for 2 s")]
    NotSeen {
        /// The joints.
        part: &'static str,
        /// The number of readings.
        readings: usize,
    },
    /// A bone changes its length.
    #[error(
        "the length of the {part} changes by {percent:.0} % from reading to reading; turn on a light or move closer to the camera"
    )]
    Unsteady {
        /// The bone.
        part: &'static str,
        /// Ten to ninety per cent of the readings, in percent of the median.
        percent: f64,
    },
    /// No person has this length.
    #[error("{reason}; check the unit and the scale of the positions")]
    NotHuman {
        /// The length and the limits.
        reason: String,
    },
    /// The fingertips are on a line.
    #[error(
        "the fingertips are on a line, so they define no plane; spread the thumb and the fingers"
    )]
    OnALine,
    /// The fingertips are not in a plane.
    #[error(
        "the tip of the {finger} is {millimetres:.0} mm off the plane of the others; touch the table with all five fingertips"
    )]
    NotPlane {
        /// The finger that is farthest off.
        finger: Finger,
        /// The distance in millimetres.
        millimetres: f64,
    },
    /// The plane is too steep for a table.
    #[error(
        "the plane of the fingertips has a slope of {degrees:.0}°, and a table has at most 45°; check which axis of the source points up"
    )]
    TooSteep {
        /// The slope in degrees.
        degrees: f64,
    },
}

/// The fewest readings from which a median is taken.
const MIN_READINGS: usize = 10;

/// Returns the median position of a joint: of each coordinate. `None` if fewer than ten readings show it.
fn median_position(readings: &[JointPositions], joint: Joint) -> Option<DVec3> {
    let positions = readings.iter().filter_map(|positions| positions.get(joint));
    let positions: Vec<DVec3> = positions.filter(|position| position.is_finite()).collect();
    if positions.len() < MIN_READINGS {
        return None;
    }
    let median = |axis: usize| {
        let values: Vec<f64> = positions.iter().map(|position| position[axis]).collect();
        percentile(&values, 0.5)
    };
    Some(DVec3::new(median(0), median(1), median(2)))
}
