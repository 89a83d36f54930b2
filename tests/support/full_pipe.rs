//! A standard stream that nobody reads.

use std::io::{self, PipeReader, Write};
use std::process::Stdio;

/// The capacity of a new pipe on Linux, in bytes.
const CAPACITY: usize = 65_536;

/// Returns a stream that accepts no byte, and the other end, which must be kept: without it, a write fails at once.
pub fn full_pipe() -> (PipeReader, Stdio) {
    let (reader, mut writer) = io::pipe().expect("a pipe");
    writer.write_all(&[b'\n'; CAPACITY]).expect("it fits");
    (reader, writer.into())
}
