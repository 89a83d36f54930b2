//! Simulated hands and people for Ademán.
//!
//! - [`sim`] simulates hands that type and play scripts, for demos, tests and scores.
//! - [`people`] draws simulated people from published ranges.
//! - [`phrases`] are the texts that they type.
//! - [`trials`] let people type and do tasks through the whole pipeline.
//! - [`measures`] are figures of speed and errors, with intervals over people.
//! - [`import`] reads layouts of other programs.
//! - [`improve`] changes layouts until people do better on them.
//! - [`readings`] compare a text decoder with simpler ways to read the same taps.
//! - [`shards`] are parts of a run, for many machines.
//! - [`study`] measures real people with the same tasks.
//! - [`report`] writes results as HTML and CSV.
//! - [`batch`] computes forward kinematics and contact of many hands at once.

use ademan_core::{
    calibrate, capture, command, contact, device, document, editing, estimate, hand, kinematics,
    layout, message, names, pipeline, time,
};

pub mod batch;
pub mod import;
pub mod improve;
pub mod measures;
pub mod people;
pub mod phrases;
pub mod readings;
pub mod report;
pub mod shards;
pub mod sim;
pub mod study;
pub mod trials;
