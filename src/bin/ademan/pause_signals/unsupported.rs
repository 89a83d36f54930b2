//! Systems without these signals.

use ademan::session::CommandSender;

use crate::failure::Failure;

/// Does nothing.
pub fn install(_: CommandSender) -> Result<(), Failure> {
    Ok(())
}
