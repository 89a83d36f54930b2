//! Arming: output begins once the hands have been clear of every control for a while.

use super::hand_pipeline::HandPipeline;
use super::{Pipeline, PipelineState};
use crate::device::Events;
use crate::time::Timestamp;

impl Pipeline {
    /// Releases everything and sets a state in which no events are emitted.
    pub(super) fn disarm(&mut self, time: Timestamp, state: PipelineState, events: &mut Events) {
        self.release_all(time, events);
        self.state = state;
    }

    /// Releases everything. Output that is armed has to be armed again, as after a pause.
    pub(super) fn rearm(&mut self, events: &mut Events) {
        let state = match self.state {
            PipelineState::Running => PipelineState::Paused,
            state => state,
        };
        self.disarm(self.time, state, events);
    }

    /// Arms output if all hands have been clear of every control for the arm delay.
    pub(super) fn arm_if_clear(&mut self, index: usize) {
        if self.is_paused() {
            return;
        }
        match self.state {
            PipelineState::Running | PipelineState::Stopped => return,
            PipelineState::Starting if self.settings.arm_immediately => {
                self.state = PipelineState::Running;
                return;
            }
            PipelineState::Starting => self.state = PipelineState::Paused,
            PipelineState::Paused | PipelineState::Stalled => {}
        }
        let hand = &mut self.hands[index];
        let layout = &self.profiles[self.active_profile].layout;
        hand.is_clear = layout.is_clear(&hand.output.pose, &hand.output.bends);
        let is_clear = self.hands.iter().any(|it| it.is_clear);
        if !is_clear || self.hands.iter().any(HandPipeline::blocks_arming) {
            self.clear_since = None;
            return;
        }
        let since = *self.clear_since.get_or_insert(self.time);
        if self.time.since(since) >= self.settings.arm_delay {
            self.state = PipelineState::Running;
        }
    }
}
