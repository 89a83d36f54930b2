//! The terminal that the live view covers. Nothing here waits for it: a terminal that is stopped (Ctrl-S) or not read must
//! not delay the end of the program.

#[cfg(unix)]
mod unix;
#[cfg(not(unix))]
mod unsupported;

#[cfg(unix)]
pub use unix::{
    HAS_LOCALE, Output, check_keys, end_output, is_covered, is_usable, restore, take_over,
    takeover, typed_keys, write_after,
};
#[cfg(not(unix))]
pub use unsupported::{
    HAS_LOCALE, Output, check_keys, end_output, is_covered, is_usable, restore, take_over,
    takeover, typed_keys, write_after,
};

/// Switches to a screen of its own without a cursor.
const ENTER: &[u8] = b"\x1b[?1049h\x1b[?25l\x1b[2J";

/// Returns to the screen from before the program.
const LEAVE: &[u8] = b"\x1b[0m\x1b[?25h\x1b[?1049l";
