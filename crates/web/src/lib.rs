//! The stages of Ademán in a page: a layout, hands, and what they type.
//!
//! ```text
//!  layout text ──▶ PageSession ──▶ objects of the layout, faults with lines
//!  text, script, pointer, lines of a protocol ──▶ hand ──Reading──▶ Pipeline ──▶ objects: scene, pose, touches, events, typed
//! ```
//!
//! - [`PageSession`] is the session. It has no clock: the page says how much time has passed.
//! - [`abi`] is the boundary to JavaScript: functions that take numbers, and texts in one buffer for each direction.
//!
//! Objects are those of `ademan share` (`docs/sharing.md`), one per line, so that its viewer draws both.

pub mod abi;
mod faults;
mod hand;
mod objects;
mod plan;
mod pointer;
mod session;

pub use faults::Fault;
pub use hand::HandState;
pub use plan::PlanEdit;
pub use pointer::Pointed;
pub use session::PageSession;
