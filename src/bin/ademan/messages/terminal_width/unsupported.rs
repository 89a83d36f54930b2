//! Systems whose terminals are not asked.

/// Returns `None`.
pub fn columns() -> Option<usize> {
    None
}

/// Returns `None`.
pub fn output_columns() -> Option<usize> {
    None
}
