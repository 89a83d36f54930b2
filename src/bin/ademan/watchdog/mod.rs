//! `ademan watchdog`: the second process, which releases keys if the main process dies or hangs.

#[cfg(target_os = "linux")]
mod linux;
#[cfg(not(target_os = "linux"))]
mod other;

#[cfg(target_os = "linux")]
use linux as system;
#[cfg(not(target_os = "linux"))]
use other as system;

use ademan::command::Command;
use ademan::output;
use ademan::session::WatchdogProgram;

use crate::failure::Failure;
use crate::messages;

/// Name of the hidden subcommand.
pub const COMMAND: &str = "watchdog";

/// Release the keys of a main process that died or hangs (started by the main process)
#[derive(clap::Args)]
pub struct Args {}

pub fn run(_: Args) -> Result<(), Failure> {
    system::detach();
    messages::start()?;
    output::run_watchdog(|line| say!("watchdog: {line}")).map_err(Failure::wrong_use)
}

/// This program as its own watchdog. `on_lost` is executed if the watchdog is lost.
pub fn program(on_lost: Command) -> Result<WatchdogProgram, Failure> {
    Ok(WatchdogProgram {
        program: system::running_image()?,
        arguments: vec![COMMAND.into()],
        on_lost,
    })
}
