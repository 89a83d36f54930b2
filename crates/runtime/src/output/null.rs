//! The output `none`, which discards every event.

use super::{Backend, OutputError, Sink};
use ademan_core::device::{Capabilities, OutputEvent};

/// The backend `none`.
pub const BACKEND: Backend = Backend {
    name: "none",
    argument: None,
    is_argument_required: false,
    summary: "discards every event",
    capabilities: Capabilities::all,
    is_log: false,
    is_fixed_when_open: false,
    check: None,
    open: |_| Ok(Box::new(NullSink)),
};

/// A sink that discards every event.
struct NullSink;

impl Sink for NullSink {
    fn send(&mut self, _: &[OutputEvent]) -> Result<(), OutputError> {
        Ok(())
    }

    fn has_effect(&self) -> bool {
        false
    }

    fn close(&mut self) -> Result<(), OutputError> {
        Ok(())
    }
}
