//! Simulated hands and people for Ademán.
//!
//! - [`sim`] simulates hands that type and play scripts, for demos, tests and scores.
//! - [`people`] draws simulated people from published ranges.
//! - [`phrases`] are what they type.
//! - [`trials`] let people type and do tasks through the whole pipeline.
//! - [`measures`] are what came of it, with intervals over people.
//! - [`report`] writes them as HTML and CSV.
//! - [`batch`] computes forward kinematics and contact of many hands at once.

use ademan_core::{
    calibrate, capture, command, contact, device, document, estimate, hand, kinematics, layout,
    message, names, pipeline, time,
};

pub mod batch;
pub mod measures;
pub mod people;
pub mod phrases;
pub mod report;
pub mod sim;
pub mod trials;
