//! `ademan watchdog`: the second process, which releases keys if the main process dies or hangs.

use ademan::command::Command;
use ademan::output;
use ademan::session::WatchdogProgram;

use crate::failure::Failure;

/// Name of the hidden subcommand.
pub const COMMAND: &str = "watchdog";

/// Release the keys of a main process that died or hangs (started by the main process)
#[derive(clap::Args)]
pub struct Args {}

pub fn run(_: Args) -> Result<(), Failure> {
    // A signal to the process group, such as SIGTERM, must not end the watchdog before the main process.
    ctrlc::set_handler(|| {})
        .map_err(|error| Failure::job(format!("cannot ignore signals: {error}")))?;
    output::run_watchdog(|line| say!("watchdog: {line}")).map_err(Failure::wrong_use)
}

/// This program as its own watchdog. `on_lost` is executed if the watchdog is killed.
pub fn program(on_lost: Command) -> Result<WatchdogProgram, Failure> {
    let program = std::env::current_exe().map_err(|error| {
        Failure::wrong_use(format!(
            "cannot find the path of this program, which starts itself as the watchdog: {error}"
        ))
    })?;
    Ok(WatchdogProgram {
        program,
        arguments: vec![COMMAND.into()],
        on_lost,
    })
}
