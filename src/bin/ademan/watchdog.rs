//! `ademan watchdog`, a hidden command with which the program starts its watchdog.

use std::sync::Arc;

use ademan::device::Capabilities;
use ademan::output::watchdog::WatchdogSettings;
use ademan::output::{self, OutputError, Sink};

use crate::failure::Failure;

/// The name of the command.
pub const COMMAND: &str = "watchdog";

/// Opens outputs with a watchdog for those whose keys would outlive the process. Calls `on_lost`, which must not block,
/// when the watchdog exits unexpectedly.
pub fn open_outputs(
    names: &str,
    required: &Capabilities,
    on_lost: impl Fn() + Send + Sync + 'static,
) -> Result<Box<dyn Sink>, OutputError> {
    let open_error = |error: std::io::Error| OutputError::Open {
        output: names.into(),
        reason: format!("cannot find the executable to start the watchdog: {error}"),
    };
    let settings = WatchdogSettings {
        program: std::env::current_exe().map_err(open_error)?,
        arguments: vec![COMMAND.into()],
        on_lost: Arc::new(move || {
            say!("the watchdog exited: everything is released");
            on_lost();
        }),
    };
    output::open_with_watchdog(names, required, &settings)
}

/// Runs the watchdog until the program that has started it exits.
pub fn run() -> Result<(), Failure> {
    // A signal for the program, such as SIGTERM to the session, must not end its watchdog.
    ctrlc::set_handler(|| {})
        .map_err(|error| Failure::job(format!("cannot ignore signals: {error}")))?;
    output::run_watchdog(|line| say!("watchdog: {line}")).map_err(Failure::wrong_use)
}
