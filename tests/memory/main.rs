//! Memory: after the start nothing is allocated, and in a day of faults nothing piles up.

#[path = "../support/mod.rs"]
mod support;

#[cfg(target_os = "linux")]
mod in_place;
mod landmarks;
mod learning;
mod lucidgloves;
mod motion;
mod network_poses;
mod recordings;
mod soak;
mod steady_state;
mod tracked_hands;
