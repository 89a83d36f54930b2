//! The steps that observers see, and the state and the statistics of the session.

use super::SessionLoop;
use crate::capture::{CaptureError, Reading, SourceStats};
use crate::session::reply::{LearnedRanges, SessionStatus};
use crate::text;
use ademan_core::command::Command;
use ademan_core::device::TimedCommand;
use ademan_core::snapshot::StepView;

impl SessionLoop<'_> {
    /// Shows the step of a reading to the observers, with its results if it was accepted.
    pub(super) fn publish_reading(&mut self, reading: &Reading, is_accepted: bool) {
        self.publish(Some(reading), is_accepted, None);
    }

    /// Shows a step without a reading to the observers.
    pub(super) fn publish_state(&mut self, source_error: Option<&CaptureError>) {
        self.publish(None, false, source_error);
    }

    /// Shows this step to the observers, with the results for `reading` if it was accepted. Its events belong to the profile
    /// that was active before them.
    fn publish(
        &mut self,
        reading: Option<&Reading>,
        is_accepted: bool,
        source_error: Option<&CaptureError>,
    ) {
        self.update_stats();
        let accepted = reading.filter(|_| is_accepted);
        let output = accepted.map(|it| self.pipeline.output_for(it));
        let step = StepView {
            state: self.pipeline.state(),
            paused_by: self.pipeline.paused_by(),
            profile: self.profile,
            target_names: &self.target_names,
            reading,
            source_error,
            angles: output.map(|output| &output.estimate.angles),
            pose: output.map(|output| &output.pose),
            touches: output.map_or(&[], |output| &output.touches),
            presses: output.map_or(&[], |output| &output.presses),
            events: &self.events,
            commands: output.map_or(&[], |output| &output.commands),
            executed: self.executed.as_ref(),
            lost_hands: self.pipeline.lost_hands(),
            text: self.pipeline.text_state(),
            stats: &self.stats,
            latency: self.latency.take(),
        };
        self.observer.observe(&step, self.now, self.pipeline);
        self.executed = None;
        if self.profile != self.pipeline.active_profile() {
            self.update_target_names();
        }
    }

    /// Shows a step without a reading to the observers, with a command if it was executed.
    pub(super) fn publish_command(&mut self, command: Command, is_executed: bool) {
        self.executed = is_executed.then_some(TimedCommand {
            time: self.pipeline.time(),
            command,
        });
        self.publish_state(None);
    }

    pub(super) fn status(&mut self) -> SessionStatus {
        self.update_stats();
        SessionStatus {
            state: self.pipeline.state(),
            paused_by: self.pipeline.paused_by(),
            profile: self.pipeline.active_profile(),
            stats: self.stats,
            cursor: self.pipeline.layout().cursor(),
            learned: LearnedRanges::new(self.pipeline.learned_ranges()),
            typing: self
                .pipeline
                .layout()
                .filter()
                .and_then(text::learned_summary),
        }
    }

    /// Sets the statistics of the source, and adds what the loop has dropped to them.
    pub(super) fn set_source_stats(&mut self, stats: &SourceStats) {
        self.stats.source = *stats;
        self.stats.source.dropped += self.dropped;
    }

    /// Counts readings that the loop drops.
    pub(super) fn drop_readings(&mut self, count: u64) {
        self.dropped += count;
        self.stats.source.dropped += count;
    }

    /// Sets the statistics of the pipeline and the output to those after this step.
    fn update_stats(&mut self) {
        let stats = &mut self.stats;
        stats.accepted = self.pipeline.accepted();
        stats.rejected = self.pipeline.rejected();
        stats.stalls = self.pipeline.stalls();
        stats.suppressed = self.pipeline.suppressed();
        stats.dropped_presses = self.sink.0.dropped_presses();
    }

    pub(super) fn update_target_names(&mut self) {
        self.profile = self.pipeline.active_profile();
        if let Some(link) = self.commands.layouts() {
            link.set_active_profile(self.profile);
        }
        self.target_names = self.pipeline.target_names().clone();
        self.sink.0.set_target_names(&self.target_names);
        self.sink.0.set_signals(&self.pipeline.layout().signals());
    }
}
