//! Simulated people type phrases and do tasks on a layout, through the whole pipeline.
//!
//! ```text
//!  Participant ─▶ FluentHand ─▶ Reading ─▶ Pipeline (estimate, contact, devices, gate) ─▶ events ─▶ text, presses
//! ```
//!
//! Nothing reads a clock: a second of typing takes about a millisecond. Each person has a pipeline and random numbers of its own,
//! so results do not depend on the number of threads.

mod jobs;
mod nearest;
mod observed;
mod phrase;
mod pointing;
mod proofreader;
mod retraced;
mod session;
mod station;
mod tasks;

pub use jobs::{Cancelled, for_each};
pub use observed::{KeyTally, Observed, Stroke, StrokeKind};
pub use phrase::Strokes;
pub(crate) use phrase::speed;
pub use pointing::{PointingScore, PointingSeries};
pub use retraced::{FingerPath, NearMiss, NearPress, Retraced, Retracer};
pub use session::Watch;
pub use station::{Station, TrialError};
pub use tasks::{TaskKind, TaskResult, TasksDone};
