//! The stages of Ademán: from the bytes of a sensor to key and pointer events.
//!
//! Data flows in one direction. A stage owns the type that it produces and imports only earlier stages:
//!
//! ```text
//!  bytes ──▶ Decoder ──Reading──▶ Estimator ──Estimate──▶ ArmModel ──HandPose──▶ ContactTracker ──Touches──▶ Devices ──Events──▶ OutputGate
//!            capture              estimate                kinematics             contact                     device              pipeline
//! ```
//!
//! - [`time`], [`message`], [`names`], [`hand`] and [`geometry`] hold the types that every stage shares.
//! - [`document`] reads RON texts, with errors that show the line.
//! - [`command`] lists the commands that layouts and people give to a running session.
//! - [`capture`] decodes bytes into [`Reading`](capture::Reading)s.
//! - [`estimate`] derives joint angles and rejects implausible readings.
//! - [`kinematics`] computes the positions of the fingertips.
//! - [`contact`] detects presses of the fingertips on the targets of virtual boards.
//! - [`device`] turns touches into events and commands: keyboards, sliders, joysticks, pointers.
//! - [`layout`] builds boards, gloves, arms and persons from documents.
//! - [`editing`] edits the text of a layout and leaves the rest of it as it is.
//! - [`pipeline`] runs the stages for one reading, without an allocation.
//! - [`snapshot`] is the state of the pipeline after a reading.
//! - [`objects`] are what other programs and pages read of layouts, poses, touches and events.
//! - [`calibrate`] turns readings of known poses into the values of a glove file.
//!
//! The world frame is right-handed: +X to the wearer's right, +Y up, −Z forward. Lengths are in metres, angles in radians, times in
//! microseconds.

pub mod time;
pub mod message;
pub mod names;
pub mod hand;
pub mod geometry;
pub mod document;
pub mod command;
pub mod capture;
pub mod estimate;
pub mod kinematics;
pub mod contact;
pub mod device;
pub mod layout;
pub mod editing;
pub mod pipeline;
pub mod snapshot;
pub mod objects;
pub mod calibrate;
