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
//! microseconds. Vectors and poses have the types of [`parry3d`] in single and of [`glam`] in double precision; lists of a fixed capacity
//! come from [`arrayvec`].
//!
//! # Example
//!
//! The bytes of a glove become joint angles, and these the positions of fingertips. [`Pipeline`](pipeline::Pipeline) has an example with a
//! layout.
//!
//! ```
//! use ademan_core::capture::hc11::{self, Framing};
//! use ademan_core::capture::{Reading, StreamFormat};
//! use ademan_core::document::Document;
//! use ademan_core::estimate::{Estimator, EstimatorSettings};
//! use ademan_core::hand::Finger;
//! use ademan_core::kinematics::ArmModel;
//! use ademan_core::layout::Glove;
//!
//! let glove = Glove::parse(&Document::shipped("unam-hc11")?)?;
//! let arm = ArmModel::parse(&Document::shipped("unam")?)?;
//! let mut estimator = Estimator::new(EstimatorSettings::default()).with_channels(&glove.map);
//!
//! // What the glove sends: the counts of a hand over a board, with its index finger half bent.
//! let mut counts = [127; hc11::BODY_BYTES];
//! for (channel, count) in [
//!     (4, 63), (9, 30), (12, 123), (17, 77), (20, 68), (25, 100), (28, 234), (33, 17),
//!     (34, 16), (36, 48), (41, 153), (44, 62), (49, 30), (52, 30), (57, 36), (60, 92),
//! ] {
//!     counts[channel] = count;
//! }
//! let bytes = hc11::encode(Framing::Double06, &counts);
//!
//! let format = StreamFormat::new(&hc11::PROTOCOL);
//! let mut decoder = format.decoder();
//! let mut samples = Vec::new();
//! decoder.push(&bytes, &mut |packet| samples.push(packet.sample));
//! // The end of the stream confirms the last packet.
//! decoder.finish(&mut |packet| samples.push(packet.sample));
//!
//! for (number, sample) in (1..).zip(samples) {
//!     // A device has the time of arrival; a file has the time at which the line would have carried the packet.
//!     let reading = Reading::new(format.nominal_time(number), None, sample);
//!     let pose = arm.forward(estimator.update(&reading)?);
//!     let tip = pose.fingertip(Finger::Index).expect("a finger that the arm model has");
//!     assert_eq!(tip.to_array().map(|metres| (metres * 1e3).round()), [75.0, -26.0, -490.0]);
//! }
//! assert_eq!(decoder.stats().readings, 1);
//! # Ok::<(), Box<dyn std::error::Error>>(())
//! ```

pub use {arrayvec, glam, parry3d};

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
