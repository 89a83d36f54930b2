//! The permission to press keys that a person gives to one sender while a session runs.

use super::SessionLoop;
use crate::capture::SourceStats;
use crate::session::SessionError;
use ademan_core::command::Command;

impl SessionLoop<'_> {
    /// Sets the statistics of the source. If another sender has followed the sender that a person has allowed to press keys, releases
    /// everything and withdraws the permission, before a reading of the new sender counts.
    pub(super) fn follow_source(&mut self, stats: &SourceStats) -> Result<(), SessionError> {
        let has_changed = stats.sender_changes > self.stats.source.sender_changes;
        self.set_source_stats(stats);
        self.events.clear();
        if has_changed && self.pipeline.withdraw_allowed_keys(&mut self.events) {
            self.send_events()?;
            tracing::warn!(
                "another sender has replaced the sender that was allowed to press keys: the roles of the setup apply again; run `ademan ctl allow-keys` again if the new sender may type"
            );
            // A replay has no senders.
            self.publish_command(Command::ForbidKeys, true);
        }
        Ok(())
    }
}

#[cfg(test)]
mod tests {
    use std::time::Instant;

    use super::*;
    use crate::output::{self, Sink};
    use crate::session::command_channel::CommandReceiver;
    use crate::session::event_loop::capture::Capture;
    use crate::session::event_loop::layouts::tests::{CountingSink, EmptyRecording};
    use crate::setup::Setup;
    use ademan_core::command::CommandOrigin;
    use ademan_core::device::{Capabilities, Events};
    use ademan_core::pipeline::Pipeline;
    use ademan_core::snapshot::StepView;

    /// Returns the pipeline of a source that only points.
    fn pointing_pipeline() -> Pipeline {
        let setup = Setup {
            source: Some("udp:127.0.0.1:9000?protocol=text-line".parse().unwrap()),
            ..Setup::default()
        };
        setup.load_files().unwrap().pipeline()
    }

    #[test]
    fn a_recording_allows_keys_only_if_no_output_has_an_effect() {
        let is_allowed = |sink: &mut dyn Sink| {
            let commands = CommandReceiver::disconnected();
            let mut pipeline = pointing_pipeline();
            let observer = &mut |_: &StepView, _: Instant, _: &Pipeline| {};
            let capture = Capture::start(EmptyRecording).unwrap();
            let mut session = SessionLoop::new(capture, &commands, &mut pipeline, sink, observer);
            session.replay_command(Command::AllowKeys).unwrap();
            session.pipeline.withdraw_allowed_keys(&mut Events::new())
        };
        let mut none = output::open("none", &Capabilities::default()).unwrap();
        assert!(is_allowed(&mut *none));
        assert!(!is_allowed(&mut CountingSink::default()));
    }

    #[test]
    fn keys_are_allowed_for_the_present_sender_and_not_for_the_next_one() {
        let commands = CommandReceiver::disconnected();
        let mut pipeline = pointing_pipeline();
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
