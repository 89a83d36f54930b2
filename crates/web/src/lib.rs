//! The stages of Ademán in a page: a layout, hands, and what they type.
//!
//! ```text
//!  layout text ──▶ PageSession ──▶ objects of the layout, faults with lines
//!  text, script, pointer, lines of a protocol ──▶ hand ──Reading──▶ Pipeline ──▶ objects: scene, pose, touches, events, typed
//! ```
//!
//! - [`PageSession`] is the session. It has no clock: the page says how much time has passed.
//! - [`Scoring`] lets simulated people type on a layout.
//! - [`abi`] is the boundary to JavaScript: functions that take numbers, and texts in one buffer for each direction. [`abi_score`] is
//!   the same for scores, and [`abi_words`] for the text decoder. `web/build` makes a module of the page without the decoder, one with
//!   it and one of scores: a page loads the second and the third one when a person asks for what they do.
//!
//! The objects have the form of `ademan share` (`docs/sharing.md`), one per line, so that its viewer draws them.

#[cfg(feature = "page")]
pub mod abi;
#[cfg(feature = "recordings")]
pub mod abi_recordings;
#[cfg(feature = "score")]
pub mod abi_score;
#[cfg(feature = "words")]
pub mod abi_words;
mod faults;
mod hand;
mod live;
mod objects;
mod plan;
mod recorded;
mod rehearsal;
mod score;
mod session;
mod under_hand;
mod words;

pub use ademan_lab::sim::Pointed;
pub use faults::Fault;
pub use hand::HandState;
pub use plan::PlanEdit;
pub use recorded::PlayedRecording;
pub use rehearsal::Rehearsal;
pub use score::{LayoutScore, Scoring};
pub use session::{PageSession, preview, shipped};
pub use words::DecoderOf;
