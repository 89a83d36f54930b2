//! The permission to press keys that a person gives while a session runs, and the sender that it is for.

use super::SessionLoop;
use crate::capture::SourceStats;
use crate::session::SessionError;

impl SessionLoop<'_> {
    /// Sets the statistics of the source. If another sender has followed the one that keys were allowed for, releases
    /// everything and withdraws the permission, before a reading of that sender counts.
    pub(super) fn follow_source(&mut self, stats: &SourceStats) -> Result<(), SessionError> {
        let has_changed = stats.sender_changes > self.stats.source.sender_changes;
        self.set_source_stats(stats);
        self.events.clear();
        if has_changed && self.pipeline.withdraw_allowed_keys(&mut self.events) {
            tracing::warn!(
                "another sender has followed the one that keys were allowed for: the roles of the setup apply again; `ademan ctl allow-keys` allows keys"
            );
            self.send_events()?;
            self.publish(None, false, None);
        }
        Ok(())
    }
}

#[cfg(test)]
mod tests {
    use std::time::Instant;

    use super::*;
    use crate::session::command_channel::CommandReceiver;
    use crate::session::event_loop::capture::Capture;
    use crate::session::event_loop::layouts::tests::{CountingSink, EmptyRecording};
    use crate::setup::Setup;
    use ademan_core::command::{Command, CommandOrigin};
    use ademan_core::device::Events;
    use ademan_core::pipeline::Pipeline;
    use ademan_core::snapshot::StepView;

    #[test]
    fn keys_are_allowed_for_the_present_sender_and_not_for_the_next_one() {
        let setup = Setup {
            source: Some("udp:127.0.0.1:9000?protocol=text-line".parse().unwrap()),
            ..Setup::default()
        };
        let commands = CommandReceiver::disconnected();
        let mut pipeline = setup.load_files().unwrap().pipeline();
        let mut sink = CountingSink::default();
        let observer = &mut |_: &StepView, _: Instant, _: &Pipeline| {};
        let capture = Capture::start(EmptyRecording).unwrap();
        let mut session = SessionLoop::new(capture, &commands, &mut pipeline, &mut sink, observer);
        let mut is_withdrawn = |sender_changes| {
            let (allow, origin) = (Command::AllowKeys, CommandOrigin::Client);
            let mut events = Events::new();
            session
                .pipeline
                .execute(&allow, origin, &mut events)
                .unwrap();
            let stats = SourceStats {
                sender_changes,
                ..SourceStats::default()
            };
            session.follow_source(&stats).unwrap();
            !session.pipeline.withdraw_allowed_keys(&mut events)
        };
        assert_eq!(
            [0, 1, 1, 2].map(&mut is_withdrawn),
            [false, true, false, true]
        );
    }
}
