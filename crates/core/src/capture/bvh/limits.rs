//! Limits on BVH texts, so that a file of any content takes a bounded amount of memory.

/// Most joints and End Sites. A whole body with a face has about 250.
pub const MAX_NODES: usize = 4096;

/// Deepest nesting of joints. A body from hips to fingertips has about 12 levels.
pub const MAX_DEPTH: usize = 256;

/// Most channels of all joints together: six for each joint.
pub const MAX_CHANNELS: usize = 6 * MAX_NODES;

/// Most frames: 11 days at 100 Hz.
pub const MAX_FRAMES: u64 = 100_000_000;

/// Longest word in bytes: a name or a number.
pub const MAX_TOKEN_BYTES: usize = 256;

/// Most characters of a word in messages.
pub(super) const MAX_SHOWN_CHARS: usize = 40;
