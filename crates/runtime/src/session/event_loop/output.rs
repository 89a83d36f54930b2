//! The events of a step on their way to the sink, and stalls of the sink.

use super::SessionLoop;
use crate::session::SessionError;
use ademan_core::pipeline::PipelineState;

impl SessionLoop<'_> {
    /// Calls the output without events, as a heartbeat, and shows a stall of the output to the observers.
    pub(super) fn keep_output_alive(&mut self) -> Result<(), SessionError> {
        let state = self.pipeline.state();
        self.events.clear();
        self.send_events()?;
        if self.pipeline.state() != state {
            self.publish_state(None);
        }
        Ok(())
    }

    /// Sends the events of this step to the sink, even if there are none: a sink with its own thread reports an earlier
    /// failure at the next call.
    pub(super) fn send_events(&mut self) -> Result<(), SessionError> {
        // A press that still waits in a queue must not follow the releases of a pause or stall.
        if matches!(
            self.pipeline.state(),
            PipelineState::Paused | PipelineState::Stalled
        ) {
            self.sink.0.void_presses();
        }
        self.sink.0.send(&self.events)?;
        self.sink.0.show_text(self.pipeline.text_state());
        if self.sink.0.has_stalled() {
            self.stall_output()
        } else {
            Ok(())
        }
    }

    /// Releases everything, including locked modifiers, after the output has dropped a press or the watchdog has released keys.
    fn stall_output(&mut self) -> Result<(), SessionError> {
        let sent = self.events.len();
        self.pipeline.stall_output(&mut self.events);
        self.sink.0.void_presses();
        Ok(self.sink.0.send(&self.events[sent..])?)
    }
}
