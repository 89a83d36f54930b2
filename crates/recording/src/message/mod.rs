//! Messages of recordings as protocol buffers, with the schema `ademan.proto`.
//!
//! The numbers of the fields stand in that schema. The numbers of readings keep all their bits, so that a replay has the
//! readings of the recorded session; the angles, which follow from them, are rounded to single precision.

mod command;
mod reading;
mod values;
pub mod wire;

pub use command::{decode_external_command, encode_command};
pub use reading::{decode_reading, encode_reading};
pub use values::{put_rounded_angles, put_side};

/// The schema as text.
pub const SCHEMA_TEXT: &str = include_str!("ademan.proto");

/// The schema as a `FileDescriptorSet`, as readers of MCAP expect it. `protoc` creates it from [`SCHEMA_TEXT`].
pub const SCHEMA: &[u8] = include_bytes!("ademan.binpb");

#[cfg(test)]
mod tests;
