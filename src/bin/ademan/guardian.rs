//! `ademan guardian`, which the program starts for itself: it lets go of keys when the program cannot.

use std::sync::Arc;

use ademan::device::Capabilities;
use ademan::output::{self, OutputError, Sink, watchdog};

use crate::failure::Failure;

/// What the program calls to start its guardian.
pub const COMMAND: &str = "guardian";

/// Opens outputs with a guardian for those whose keys would outlive the program. `on_loss` is called, and must
/// not wait, when the guardian is ended by somebody.
pub fn open_outputs(
    names: &str,
    needs: &Capabilities,
    on_loss: impl Fn() + Send + Sync + 'static,
) -> Result<Box<dyn Sink>, OutputError> {
    let open_error = |error: std::io::Error| OutputError::Open {
        output: names.into(),
        reason: format!("this program does not find itself, to start its guardian: {error}"),
    };
    let launch = watchdog::WatchdogSettings {
        program: std::env::current_exe().map_err(open_error)?,
        arguments: vec![COMMAND.into()],
        on_lost: Arc::new(move || {
            say!("the guardian was ended: everything is released");
            on_loss();
        }),
    };
    output::open_with_watchdog(names, needs, &launch)
}

pub fn run() -> Result<(), Failure> {
    // Whoever asks the program to end does not ask its guardian.
    ctrlc::set_handler(|| {})
        .map_err(|error| Failure::job(format!("cannot ignore signals: {error}")))?;
    watchdog::run(|line| say!("guardian: {line}")).map_err(Failure::wrong_use)
}
