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
        let was_armed = self.pipeline.state() == PipelineState::Running;
        self.stats.output_stalls += u64::from(was_armed);
        let sent = self.events.len();
        self.pipeline.stall_output(&mut self.events);
        self.sink.0.void_presses();
        Ok(self.sink.0.send(&self.events[sent..])?)
    }
}

#[cfg(test)]
mod tests {
    use std::time::Instant;

    use super::*;
    use crate::output::{OutputError, Sink};
    use crate::session::command_channel::CommandReceiver;
    use crate::session::event_loop::capture::Capture;
    use crate::session::event_loop::layouts::tests::{EmptyRecording, tracking_pipeline};
    use ademan_core::device::OutputEvent;
    use ademan_core::pipeline::Pipeline;
    use ademan_core::snapshot::StepView;

    /// An output whose watchdog has released the keys.
    struct StalledSink(bool);

    impl Sink for StalledSink {
        fn send(&mut self, _: &[OutputEvent]) -> Result<(), OutputError> {
            Ok(())
        }

        fn void_presses(&mut self) {
            self.0 = false;
        }

        fn has_stalled(&self) -> bool {
            self.0
        }

        fn close(&mut self) -> Result<(), OutputError> {
            Ok(())
        }
    }

    #[test]
    fn a_stall_of_an_armed_output_is_counted_and_shown_to_the_observers() {
        let commands = CommandReceiver::disconnected();
        let mut pipeline = tracking_pipeline();
        assert_eq!(pipeline.state(), PipelineState::Running);
        let mut sink = StalledSink(true);
        let mut seen = Vec::new();
        let observer = &mut |step: &StepView, _: Instant, _: &Pipeline| {
            seen.push((step.state, step.stats.output_stalls));
        };
        let capture = Capture::start(EmptyRecording).unwrap();
        let mut session = SessionLoop::new(capture, &commands, &mut pipeline, &mut sink, observer);
        session.keep_output_alive().unwrap();
        session.keep_output_alive().unwrap();
        drop(session);
        assert_eq!(seen, [(PipelineState::Paused, 1)]);
    }
}
