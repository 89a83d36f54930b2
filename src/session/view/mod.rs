//! Views: what a display shows of a running session, at most about 30 times a second.
//!
//! The session loop hands views to a thread, which passes each to all viewers. Neither waits: a viewer that is busy misses
//! views, which are counted, and always receives the newest one next.
//!
//! ```text
//!  session loop ─ ViewPublisher ──▶ thread of the ViewHub ──▶ Viewer (terminal, client of the control socket)
//!                        notices ─▶
//! ```

mod hub;
mod publisher;
mod state;

use std::sync::Arc;

pub use self::hub::{ViewHub, Viewer};
pub(super) use self::publisher::{SessionNames, ViewPublisher};
pub use self::state::{Fingertip, ViewCounts, ViewState};
use crate::layout::Layout;

/// The state of a session at one time, for displays. Cloning is cheap.
#[derive(Clone, Debug)]
pub struct View {
    /// The active layout.
    pub layout: Arc<Layout>,
    /// The state.
    pub state: Arc<ViewState>,
    /// The latest notices of the session, at most [`MAX_MESSAGES`], oldest first.
    pub messages: Arc<[String]>,
    /// The number of views that this viewer has missed so far.
    pub missed: u64,
}

/// The maximum number of notices of a view.
pub const MAX_MESSAGES: usize = 8;
