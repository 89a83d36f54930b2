//! The check that root types only on request, for every command that may type.

use ademan::{advice, doctor};

use crate::failure::Failure;

/// The option of commands that may type.
#[derive(Clone, Copy, Default, clap::Args)]
pub struct RootArgs {
    /// Run as root with an output that types
    #[arg(long)]
    pub allow_root: bool,
}

impl RootArgs {
    /// Fails if the process runs as root without the option, and may type.
    pub fn check(self, may_type: bool) -> Result<(), Failure> {
        if may_type && !self.allow_root && doctor::is_running_as_root() {
            Err(Failure::wrong_use(advice::running_as_root().to_string()))
        } else {
            Ok(())
        }
    }
}
