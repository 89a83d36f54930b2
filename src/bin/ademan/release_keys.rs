//! `ademan release-keys`: releases the keys of a run that was killed together with its watchdog.

use ademan::output::{self, AbandonedRelease};

use crate::failure::Failure;

/// Name of the hidden subcommand, which the systemd unit executes after each run.
pub const COMMAND: &str = "release-keys";

/// Release the keys that a killed run has left pressed on this display (for service managers)
#[derive(clap::Args)]
pub struct Args {}

pub fn run(_: Args) -> Result<(), Failure> {
    let result = output::release_abandoned_keys();
    report(&result);
    if result.failed.is_empty() {
        return Ok(());
    }
    let reasons = result.failed.join("; ");
    Err(Failure::job(format!("cannot release keys: {reasons}")))
}

/// Reports what was released, and what cannot be released here.
pub fn report(result: &AbandonedRelease) {
    if result.released > 0 {
        say!("released the keys of a killed run ({})", result.released);
    }
    for reason in &result.skipped {
        complain!("keys of a killed run may still be pressed: {reason}");
    }
}
