//! The stand-in on operating systems whose priorities are not used yet.

/// Changes nothing.
pub fn raise_thread_priority() {}

/// Returns the normal priority.
pub fn granted_nice() -> i32 {
    0
}

/// Changes nothing.
pub fn shorten_time_slice() {}
