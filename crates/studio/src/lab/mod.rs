//! The lab in Studio: simulated people use the layout of the editor, without a view.
//!
//! A [`LabRun`] scores a layout, and perhaps another one to compare it with, on threads of its own. A [`WatchedPerson`] is one of
//! its people again: the readings of the phrase that the person typed worst, in a recording that a
//! [`Player`](crate::playback::Player) passes through a pipeline without an output.
//!
//! ```text
//!  LabRequest ─▶ LabRun (threads) ─ progress ─▶ panels/lab
//!                   └──▶ LabOutcome ─▶ figures, heat map, bars ─ click ─▶ WatchedPerson ─▶ Player ─▶ 3D view
//! ```

mod outcome;
mod run;
mod settings;
mod watched;

pub use self::outcome::{LabOutcome, PersonBar, Scored};
pub use self::run::{LabRequest, LabRun};
pub use self::settings::{LabDecoder, LabSettings};
pub use self::watched::{WatchedPerson, watch};
