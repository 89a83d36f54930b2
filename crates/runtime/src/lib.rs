//! Everything of [Ademán](https://docs.rs/ademan) with a file, socket, device, thread or clock.
//!
//! The stages of `ademan_core` compute; this crate feeds them and carries out what they return.
//!
//! The ends of the data flow:
//!
//! - [`capture`] opens sources: serial lines, sockets, recordings, other programs.
//! - [`output`] sends events to the desktop, the kernel or another program, and its watchdog releases keys when the
//!   program cannot.
//!
//! Around the pipeline:
//!
//! - [`session`] owns the threads of a run.
//! - [`setup`] reads the file that names sources, gloves, layouts and outputs, and loads what it names.
//! - [`text`] uses the text decoder of `ademan_text` in a run.
//! - [`sim`] makes simulated people sources of readings.
//! - [`recorder`] writes recordings, [`trace`] the results of each stage, and [`share`] gives them to other programs.
//! - [`sound`] plays a click for each press.
//! - [`doctor`] checks the machine against a setup.
//! - `cameras`, with the feature of that name, calibrates cameras that see markers.
//! - `layout_link`, with the feature `links`, puts a layout into a link and reads it from one.
//!
//! Shared by all:
//!
//! - [`files`] opens the files of a person, [`network`] connects machines, [`priority`] raises the priority of threads.
//! - [`advice`] explains missing permissions and services, and [`message_limits`] limits the number of messages.

// Types shared by every part.
pub mod advice;
pub mod files;
pub mod message_limits;
pub mod network;
pub mod priority;

// The ends of the data flow.
pub mod capture;
pub mod output;

// Parts around the pipeline.
#[cfg(feature = "cameras")]
pub mod cameras;
pub mod doctor;
#[cfg(feature = "links")]
pub mod layout_link;
pub mod recorder;
pub mod session;
pub mod setup;
pub mod share;
pub mod sim;
pub mod sound;
pub mod text;
pub mod trace;
