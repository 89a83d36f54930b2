//! `ademan release-keys`: releases the keys of a run that was killed together with its watchdog.

use ademan::output;

use crate::failure::Failure;

/// Name of the hidden subcommand, which the systemd unit executes after each run.
pub const COMMAND: &str = "release-keys";

/// Release the keys that a killed run has left pressed on this display (for service managers)
#[derive(clap::Args)]
pub struct Args {}

pub fn run(_: Args) -> Result<(), Failure> {
    match output::release_abandoned_keys() {
        Ok(0) => {}
        Ok(count) => say!("released the keys of a killed run ({count})"),
        Err(error) => return Err(Failure::job(format!("cannot release keys: {error}"))),
    }
    Ok(())
}
