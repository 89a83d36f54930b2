//! **Ademán** turns a captured hand into any input device.
//!
//! Data flows one way. A stage owns the type that it produces, imports what comes before it and
//! nothing after it:
//!
//! ```text
//!  Source ──Reading──▶ Estimator ──JointAngles──▶ ArmModel ──HandPose──▶ ContactTracker ──Touches──▶ VirtualDevice ──Events──▶ Sink
//!  capture             estimate                   kinematics             contact                     device                    output
//!  └ own thread ┘└─bounded channel─┘└────────────── one loop thread: Pipeline::step, then Sink::send ───────────────────────────┘
//!                                                           └──Snapshot, try_send, dropped when full──▶ display, recorder, trace
//! ```
//!
//! The modules below stand in the order of that flow. What changes while a run is on, such as a layout
//! that is saved, is built outside the loop and put in force between two frames: [`reload`]. Other programs ask
//! a run for things, and hear what happens in it, on a socket: [`control`]. Keys of a real keyboard can stop it at
//! once: [`emergency`]. What a setup needs of the machine is looked up
//! beforehand: [`doctor`].
//!
//! All of it in a few lines, with a simulated hand in place of a glove:
//!
//! ```
//! use ademan::{output, runtime::drive, settings::Setup};
//!
//! let assembly = Setup::default().assemble()?;
//! let hand = assembly.open(&"typist:hi".parse()?)?;
//! let mut sink = output::open("transcript", &assembly.needs())?;
//! let stop = crossbeam_channel::never();
//! let mut readings = 0;
//! drive(hand, &mut assembly.pipeline(), &mut *sink, &stop, &mut |frame| {
//!     readings += u64::from(frame.reading.is_some());
//! })?;
//! assert!(readings > 100);
//! # Ok::<(), Box<dyn std::error::Error>>(())
//! ```
//!
//! **World frame**: right-handed, metres, +X to the wearer's right, +Y up, −Z forward. Angles are in
//! radians, times in microseconds.

// Types shared by every stage.
pub mod time;
pub mod names;
pub mod hand;
pub mod document;
pub mod command;
pub mod advice;

// Stages, in the order of the data flow. A browser has no devices, files and threads: outputs and sessions are not built
// for WebAssembly.
pub mod capture;
pub mod estimate;
pub mod kinematics;
pub mod contact;
pub mod device;
#[cfg(not(target_family = "wasm"))]
pub mod output;
pub mod layout;
pub mod pipeline;
pub mod snapshot;

// Parts around the pipeline.
#[cfg(not(target_family = "wasm"))]
pub mod trace;
#[cfg(not(target_family = "wasm"))]
pub mod recorder;
pub mod sim;
#[cfg(not(target_family = "wasm"))]
pub mod setup;
#[cfg(not(target_family = "wasm"))]
pub mod session;
#[cfg(not(target_family = "wasm"))]
pub mod doctor;
