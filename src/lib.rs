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
//! This library re-exports the crates of the workspace. The stages, in the order of the data flow; all but the sources and [`output`]
//! are the crate `ademan_core`, which touches no file, thread or clock:
//!
//! - [`capture`] decodes the bytes of a glove or another sensor into [`Reading`](capture::Reading)s. A source that has to
//!   block, such as a recording, several sources at once, or any outside Linux, has a thread and a bounded channel.
//! - [`estimate`] derives joint angles and rejects implausible readings.
//! - [`kinematics`] computes the positions of the fingertips.
//! - [`contact`] detects presses of the fingertips on the targets of virtual boards.
//! - [`device`] turns touches into events and commands: keyboards, sliders, joysticks, pointers.
//! - [`layout`] builds boards, controls, gloves, arms and persons from RON files.
//! - [`editing`] edits the text of a layout and leaves the rest of it as it is.
//! - [`pipeline`] runs these stages for one reading. It neither allocates nor blocks, and it reads no clock.
//! - [`snapshot`] shows observers the results of all stages for one step.
//! - [`output`] sends events to the desktop, the kernel or another program.
//!
//! Types and functions that all parts share:
//!
//! - [`time`] holds time stamps, which every stage receives as an argument.
//! - [`hand`] names sides, fingers, joints and degrees of freedom, and holds their angles and positions.
//! - [`geometry`] computes directions and rotations in three dimensions.
//! - [`names`] gives values one spelling, and suggests the nearest valid name for a misspelled one.
//! - [`message`] escapes foreign text in messages, and [`message_limits`] limits their number.
//! - [`objects`] are what other programs and pages read of layouts, poses, touches and events.
//! - [`document`] reads RON texts, and reports errors with line and column.
//! - [`command`] lists the commands to a running session, from layouts, sockets and people.
//! - [`files`] opens the files of a person: only regular files, and only trusted ones for what decides what is typed.
//! - [`advice`] explains missing permissions and services, with the shell commands that help.
//! - [`priority`] raises the priority of the threads that press and release keys.
//! - [`network`] connects machines: TLS, tokens with roles, and routers of zenoh.
//!
//! Parts around the pipeline, most of them in the crate `ademan_runtime`:
//!
//! - [`session`] owns the threads of a run: capture, layouts that are edited while they are used, the control socket, panic
//!   keys and recordings.
//! - [`setup`] reads the file that names sources, gloves, layouts and outputs, and loads what it names.
//! - [`text`] uses the text decoder of `ademan_text` in a run: what is typed with noise is corrected at the end of a word.
//! - [`sound`] plays a click for each press.
//! - [`doctor`] checks the machine against a setup.
//! - [`recorder`] writes recordings, and [`trace`] writes the results of each stage as JSON.
//! - [`share`] gives joint angles and poses to other programs.
//! - [`calibrate`] turns readings of known poses into the values of a glove file.
//! - `cameras`, with the feature `cli`, calibrates cameras that see markers.
//! - `layout_link`, with the feature `cli`, puts a layout into a link and reads it from one.
//! - [`sim`] simulates hands that type and play scripts, for demos and tests.
//! - [`people`], [`phrases`], [`trials`], [`measures`], [`shards`], [`study`] and [`report`] are the lab: simulated people score layouts,
//!   and real ones in a study.
//! - [`improve`] changes layouts until these people do better on them, [`import`] reads layouts of other programs, and [`readings`]
//!   compare the text decoder with simpler ways to read the same taps.
//! - [`batch`] computes forward kinematics and contact of many hands at once, for simulations.
//! - `studio`, with the feature of that name, shows a session in a window; it is the crate `ademan_studio`.
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
//! Vectors and poses have the types of [`parry3d`] in single and of [`glam`] in double precision.

pub use ademan_core::{arrayvec, glam, parry3d};

pub use ademan_core::{
    calibrate, command, contact, device, document, editing, estimate, geometry, hand, kinematics,
    layout, message, names, objects, pipeline, snapshot, time,
};

pub use ademan_lab::{
    batch, import, improve, measures, people, phrases, readings, report, shards, study, trials,
};

pub use ademan_runtime::{
    advice, capture, doctor, files, message_limits, network, output, priority, recorder, session,
    setup, share, sim, sound, text, trace,
};

#[cfg(feature = "cli")]
pub use ademan_runtime::{cameras, layout_link};

#[cfg(feature = "studio")]
pub use ademan_studio as studio;
