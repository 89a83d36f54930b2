//! Simulated people as sources of readings, for demos and tests.
//!
//! A [`SimulatedTypist`] of the crate `ademan-lab` performs a text or a [`Script`]. A [`SimulatedStream`] passes its readings through the
//! bytes of a protocol, and [`play`] writes them to lines at their pace.

mod open_script;
mod player;
mod source;
mod stream;

pub use ademan_lab::sim::*;
pub use open_script::open_script;
pub(crate) use open_script::resolve_script;
pub use player::{PacketWriters, PlaybackStats, play};
pub use stream::{SimulatedStream, packet_period};
