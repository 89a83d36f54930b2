//! Waits of the loop: until a message, a capture event, a stall or a heartbeat.

use std::time::{Duration, Instant};

use super::SessionLoop;
use crate::capture::MAX_SILENCE;
use crate::session::SessionError;
use ademan_core::time::NO_DEADLINE;

/// Longest time without a call of the output while readings are expected. The thread of an output, or the watchdog, releases all
/// keys after some 200 ms without one.
pub(super) const HEARTBEAT_PERIOD: Duration = Duration::from_millis(50);

/// Longest time without a call of an output with an effect while no readings are expected. By the result of the call, the output reports
/// that its display is gone.
const IDLE_PERIOD: Duration = Duration::from_millis(400);

impl SessionLoop<'_> {
    /// Waits for a message or a capture event, or until a stall or heartbeat is due.
    pub(super) fn wait(&mut self) -> Result<(), SessionError> {
        let timeout = self.time_to_stall().min(self.time_to_heartbeat());
        self.capture.wait(timeout);
        if !self.capture.has_events() {
            self.now = Instant::now();
            self.keep_output_alive()?;
            self.stall_if_overdue()?;
        }
        Ok(())
    }

    fn time_to_heartbeat(&self) -> Duration {
        if self.pipeline.expects_readings() {
            HEARTBEAT_PERIOD
        } else if self.sink.0.has_effect() {
            IDLE_PERIOD
        } else {
            NO_DEADLINE
        }
    }

    /// Returns the time until the source counts as stalled if it sends nothing. For a source that is not live, gaps show in the times of
    /// its readings; it has a deadline only if keys may stay pressed outside of this process.
    pub(super) fn time_to_stall(&self) -> Duration {
        let timeout = self.pipeline.stall_timeout();
        let timeout = if self.capture.is_live() {
            timeout
        } else if self.sink.0.has_effect() {
            timeout.max(MAX_SILENCE)
        } else {
            return NO_DEADLINE;
        };
        match self.last_reading_at {
            Some(last) if self.pipeline.expects_readings() => {
                (last + timeout).saturating_duration_since(self.now)
            }
            _ => NO_DEADLINE,
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::session::command_channel::CommandReceiver;
    use crate::session::event_loop::capture::Capture;
    use crate::session::event_loop::layouts::tests::{
        CountingSink, EmptyRecording, tracking_pipeline,
    };
    use ademan_core::pipeline::Pipeline;
    use ademan_core::snapshot::StepView;

    #[test]
    fn a_silent_replay_stalls_before_a_desktop_repeats_a_key() {
        const SHORTEST_REPEAT_DELAY: Duration = Duration::from_millis(500);
        const KEYSTROKE: Duration = Duration::from_millis(150);
        let commands = CommandReceiver::disconnected();
        let mut pipeline = tracking_pipeline();
        let mut sink = CountingSink::default();
        let observer = &mut |_: &StepView, _: Instant, _: &Pipeline| {};
        let capture = Capture::start(EmptyRecording).unwrap();
        let mut session = SessionLoop::new(capture, &commands, &mut pipeline, &mut sink, observer);
        let reading_at = session.now;
        session.last_reading_at = Some(reading_at);
        assert!(session.time_to_stall() > session.pipeline.stall_timeout());
        session.now = reading_at + (SHORTEST_REPEAT_DELAY - KEYSTROKE);
        assert_eq!(session.time_to_stall(), Duration::ZERO);
    }
}
