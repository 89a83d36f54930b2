//! Systems whose desktops draw without Mesa.

/// Does nothing.
pub fn draw_in_one_thread() {}
