//! Simulated hands and people for Ademán.
//!
//! - [`sim`] simulates hands that type and play scripts, for demos, tests and scores.
//! - [`batch`] computes forward kinematics and contact of many hands at once.

use ademan_core::{
    calibrate, capture, command, contact, device, document, estimate, hand, kinematics, layout,
    message, names, time,
};

pub mod batch;
pub mod sim;
