//! The JSON objects of layouts, poses, touches and events that other programs and pages read.
//!
//! `docs/sharing.md` describes their fields. Poses are seven numbers: the position in metres, and the orientation as a quaternion
//! x, y, z, w.

mod event;
mod layout;
mod pose;
mod scene;
mod touch;

pub use event::EventObject;
pub use layout::layout_object;
pub use pose::write_pose;
pub use scene::SceneState;
pub use touch::TouchObject;
