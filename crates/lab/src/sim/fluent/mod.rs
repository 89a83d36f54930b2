//! The fluent motion of a simulated typist: strokes of fingers that overlap with the way to the next key.
//!
//! A hand is at a posture that moves from above one key to above the next (minimum jerk in the joints), and fingers bend on top
//! of that. Inverse kinematics runs a few times for each stroke and not for each reading, so a second of typing takes about a
//! millisecond. Nothing here knows the estimator, the filters or the contact test of the pipeline: the person learns where the
//! pipeline shows the fingertips, and adapts to it in part.

mod aim;
mod hand;
mod motion;
mod pointing;
mod sensors;
mod timeline;

pub use hand::{FluentHand, HandSetup, Load, StartPosture, StrokePlan};
pub use motion::Tap;
pub use pointing::PointingPosture;
pub use sensors::{SourceKind, SourceModel};
