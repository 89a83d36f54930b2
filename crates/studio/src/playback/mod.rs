//! Recordings in Studio: forwards, backwards and step by step.
//!
//! A thread plays the recording through the same pipeline as a session, as fast as possible, and sends the results of its steps
//! to the player:
//!
//! ```text
//!  loader thread ─ steps, keyframes ──▶ Player ── StudioModel ──▶ panels
//!               ◀── first step ──────     ◀───── Move ─────
//! ```
//!
//! The player shows a step by starting at a keyframe, a copy of the model, and applying the steps from there, so that the
//! pictures are the same as when playing from the start. It keeps at most [`MAX_STEPS`] steps (75 MB, 4 minutes at 100 readings per
//! second) and the times of all. For a step outside, the thread plays the recording from the start again and sends the
//! steps around that one.

mod comparison;
mod export;
mod job;
mod loader;
mod player;
mod step;
#[cfg(test)]
mod tests;

pub use self::comparison::{Comparison, Match, Press, compare};
pub use self::export::{ExportError, default_name, export};
pub use self::job::{Job, JobLost};
pub use self::loader::{OpenError, Recording};
pub use self::player::{Move, Player, SPEEDS};
pub use self::step::RecordedStep;

/// The most steps that are kept: 75 MB, as a step takes 3 kB with its share of views and keyframes.
pub const MAX_STEPS: usize = 24 * 1024;
