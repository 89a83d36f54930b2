//! **Ademán** turns a captured hand into any input device: sensor readings in, key and pointer events out.
//!
//! Data flows in one direction. A stage owns the type that it produces and imports only earlier stages:
//!
//! ```text
//!  Source ──Reading──▶ Estimator ──Estimate──▶ ArmModel ──HandPose──▶ ContactTracker ──Touches──▶ Devices ──Events──▶ OutputGate ──▶ Sink
//!  capture             estimate                kinematics             contact                     device              pipeline       output
//!  └─────────────────────────────────────────── session loop: Source::next, Pipeline::step, Sink::send ───────────────────────────────────┘
//!
//!  keys, gestures, control socket, panic keys, library ──Command──▶ Session ──Snapshot──▶ recorder, trace, control socket, observers
//!                                                                         └───View──▶ terminal, control socket
//! ```
//!
//! - [`capture`] decodes the bytes of a glove or another sensor into [`Reading`](capture::Reading)s. A source that has to
//!   block, such as a recording, several sources at once, or any outside Linux, has a thread of its own and a bounded channel.
//! - [`estimate`] derives joint angles and rejects implausible readings.
//! - [`kinematics`] computes the positions of the fingertips.
//! - [`contact`] detects presses of the fingertips on the targets of virtual boards.
//! - [`device`] turns touches into events and [`command`]s: keyboards, sliders, joysticks, pointers.
//! - [`pipeline`] runs these stages for one reading. It neither allocates nor blocks, and it reads no clock.
//! - [`output`] sends events to the desktop, the kernel or another program.
//! - [`session`] owns the threads around the pipeline: capture, layouts that are edited while they are used, the control
//!   socket, panic keys and recordings.
//! - [`calibrate`] turns readings of known poses into the values of a glove file.
//! - [`network`] connects machines: TLS, tokens with roles, and routers of zenoh.
//! - [`share`] gives joint angles and poses to other programs.
//! - [`layout`] and [`setup`] read the RON files of users; [`doctor`] checks the machine against a setup.
//! - `studio`, with the feature of that name, shows a session in a window.
//! - [`batch`] computes forward kinematics and contact of many hands at once, for simulations.
//! - [`sim`] simulates hands that type and play scripts, for demos and tests.
//!
//! # Example
//!
//! A simulated hand types "hi" in place of a glove:
//!
//! ```
//! use ademan::session::{Session, SessionOptions};
//! use ademan::setup::Setup;
//!
//! let setup = Setup {
//!     source: Some("typist:hi".parse()?),
//!     output: "transcript".into(),
//!     ..Setup::default()
//! };
//! let session = Session::start(setup.load_files()?, SessionOptions::default())?;
//! let summary = session.join()?;
//! assert!(summary.stats.accepted > 100);
//! # Ok::<(), Box<dyn std::error::Error>>(())
//! ```
//!
//! # Units and frames
//!
//! The world frame is right-handed: +X to the wearer's right, +Y up, −Z forward. Lengths are in metres, angles in radians,
//! times in microseconds. Files for users have their units in the names of their fields, such as `pitch_mm`.

pub use ademan_core::{
    calibrate, command, contact, device, document, estimate, geometry, hand, kinematics, layout,
    message, names, pipeline, snapshot, time,
};

pub use ademan_lab::batch;

// Types shared by every part.
pub mod files;
pub mod message_limits;
pub mod advice;
pub mod priority;
#[cfg(not(target_family = "wasm"))]
pub mod network;

// The ends of the data flow. A browser has no devices, files and threads: outputs and sessions are not built
// for WebAssembly.
pub mod capture;
#[cfg(not(target_family = "wasm"))]
pub mod output;

// Parts around the pipeline.
#[cfg(not(target_family = "wasm"))]
pub mod trace;
#[cfg(not(target_family = "wasm"))]
pub mod recorder;
#[cfg(not(target_family = "wasm"))]
pub mod share;
pub mod sim;
#[cfg(not(target_family = "wasm"))]
pub mod setup;
#[cfg(not(target_family = "wasm"))]
pub mod session;
#[cfg(not(target_family = "wasm"))]
pub mod doctor;
#[cfg(feature = "studio")]
pub mod studio;
