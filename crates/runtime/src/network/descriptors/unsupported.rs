//! Operating systems without such a limit.

/// Returns `None`.
pub(super) fn limit() -> Option<usize> {
    None
}
