//! A sink that a panic of the session loop closes.

use std::thread;

use crate::output::Sink;

/// Closes the sink when the loop panics.
pub(super) struct CloseOnPanic<'a>(pub &'a mut dyn Sink);

impl Drop for CloseOnPanic<'_> {
    fn drop(&mut self) {
        if thread::panicking()
            && let Err(error) = self.0.close()
        {
            tracing::error!("{error}");
        }
    }
}
