//! Optical markers: positions from the rays of calibrated cameras, and joint centers from markers on the skin.
//!
//! | step | function |
//! |---|---|
//! | rays of two cameras → gaps between them → pairs | [`gap_in_front`], [`assign`] |
//! | observations of all cameras → markers | [`match_cameras`] |
//! | markers of each instant → markers that keep their names | [`MarkerTracker`] |
//! | rays of one marker → its position | [`closest_points`] for two rays, [`triangulate`] for two or more |
//! | markers on the skin → joint centers | [`wrist_center`], [`ElbowCenter`] |
//! | joint centers → joints of bones of constant length | [`fit_bones`], [`LiveFit`] in a stream |
//!
//! All functions use `f64` and any unit of length.

mod assignment;
mod candidates;
mod joint_centers;
mod joint_matching;
mod live_fit;
mod ray;
mod skeleton_fit;
mod tracker;
mod triangulation;

pub use assignment::{CostMatrix, assign};
pub use joint_centers::{ElbowCenter, wrist_center};
pub use joint_matching::{Expected, MAX_CAMERAS, MatchedMarker, Observation, match_cameras};
pub use live_fit::{LiveFit, SeenBone};
pub use ray::{ClosestPoints, Ray, RayError, closest_points, gap_in_front};
pub use skeleton_fit::{Bone, fit_bones, median};
pub use tracker::{MarkerTracker, TrackedMarker};
pub use triangulation::{Triangulation, TriangulationError, triangulate};
