//! Sources on pseudo-terminals and sockets, and the loop of a run around them, in real time.

#[path = "../support/mod.rs"]
mod support;

mod body_landmarks;
#[cfg(unix)]
mod bvh;
mod bvh_readers;
mod commands;
mod file;
mod gap;
mod haptics;
mod late_readings;
mod lost_source;
#[cfg(unix)]
mod lucidgloves;
#[cfg(unix)]
mod markers;
#[cfg(unix)]
mod serial;
mod network_poses;
#[cfg(feature = "cli")]
mod peer_cameras;
mod peers;
mod simulated_glove;
mod statistics;
mod tcp;
#[cfg(unix)]
mod text_line;
mod views;
mod websocket;
