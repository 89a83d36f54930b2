//! Views: what a display shows of a running session, at most about 30 times a second.
//!
//! The session loop hands views to a thread, which passes each to all viewers. Neither waits: a viewer that is busy misses
//! views, which are counted, and always receives the newest one next.
//!
//! ```text
//!  session loop ─ ViewPublisher ──▶ thread of the ViewHub ──▶ Viewer (terminal, client of the control socket)
//!                        notices ─▶
//! ```

mod hand;
mod hub;
mod publisher;
mod replay;
mod state;

use std::sync::Arc;

use parry3d::math::Pose;

pub use self::hand::ViewHand;
pub(super) use self::hand::{PoseNumbers, pose_from, pose_numbers};
pub use self::hub::{ViewHub, Viewer};
pub(super) use self::hub::{ViewerSlot, viewer};
pub(super) use self::publisher::{SessionNames, ViewPublisher};
pub(super) use self::replay::ReplayViews;
pub use self::state::{FingerBend, Fingertip, ViewCounts, ViewState};
use ademan_core::contact::surface::{Scene, Surface};
use ademan_core::layout::Layout;

/// The state of a session at one time, for displays. Cloning is cheap.
#[derive(Clone, Debug)]
pub struct View {
    /// The active layout.
    pub layout: Arc<Layout>,
    /// The state.
    pub state: Arc<ViewState>,
    /// The present pose of each board relative to its anchor, in the axes of the world.
    pub boards: Arc<[Pose]>,
    /// The latest notices of the session, at most [`MAX_MESSAGES`], oldest first.
    pub messages: Arc<[String]>,
    /// The number of views that this viewer has missed so far.
    pub missed: u64,
}

/// The maximum number of notices of a view.
pub const MAX_MESSAGES: usize = 8;

/// Returns the pose of each board of a scene relative to its anchor.
pub(super) fn board_poses(scene: &Scene) -> Arc<[Pose]> {
    let surfaces = scene.surfaces().iter();
    surfaces.map(Surface::anchor_from_surface).collect()
}
