//! Systems without these signals.

use ademan::session::CommandSender;

use crate::failure::Failure;

/// Does nothing.
pub fn install(_: CommandSender) -> Result<(), Failure> {
    Ok(())
}

/// Does nothing.
pub fn install_without_session() -> Result<(), Failure> {
    Ok(())
}
