//! Systems without signals.

use crate::failure::Failure;

/// Does nothing.
pub fn block_all() -> Result<(), Failure> {
    Ok(())
}

/// Does nothing.
pub fn block_unused() -> Result<(), Failure> {
    Ok(())
}
