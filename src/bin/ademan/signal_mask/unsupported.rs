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

/// Does nothing.
pub fn block_emergency_stop() -> Result<(), Failure> {
    Ok(())
}

/// Does nothing.
#[cfg(feature = "tls")]
pub fn block_background_reads() -> Result<(), Failure> {
    Ok(())
}
