//! Learning of the ranges of sensors while a hand types.

use super::{CommandError, Pipeline, PipelineState};
use crate::device::Events;
use crate::estimate::{HandEstimator, LearnedRange};

impl Pipeline {
    /// Returns to the calibrated ranges of the sensors, for both hands. Everything is released, and output is armed again after
    /// the hand has been clear of every control, as the fingertips jump.
    pub fn undo_learning(&mut self, events: &mut Events) -> Result<(), CommandError> {
        if self.learned_ranges().next().is_none() {
            return Err(CommandError::NothingLearned);
        }
        let estimators = self.hands.iter_mut().map(|hand| &mut hand.estimator);
        estimators.for_each(HandEstimator::undo_learning);
        self.rearm(events);
        Ok(())
    }

    /// Iterates over the ranges of sensors that were widened, of both hands.
    pub fn learned_ranges(&self) -> impl Iterator<Item = LearnedRange> {
        let hands = self.hands.iter();
        hands.flat_map(|hand| hand.estimator.learned_ranges())
    }

    /// Widens the ranges of sensors that have been beyond them, while the hand is clear of every control and nothing is held.
    ///
    /// A wider range moves fingertips although the hand does not move. Nothing is down that this could release, and as the
    /// estimate jumps, a fingertip that it moves into a control has to leave that before it can touch. During a pause the hand may
    /// do anything, also take off the glove, so nothing is learned of it.
    pub(super) fn learn_ranges(&mut self, index: usize) {
        let is_running = self.state() == PipelineState::Running;
        let hand = &mut self.hands[index];
        if !is_running {
            hand.estimator.forget_excursions();
            return;
        }
        if !hand.estimator.is_widening_due() {
            return;
        }
        let layout = &self.profiles[self.active_profile].layout;
        if !layout.is_in_use() && layout.is_clear(&hand.output.pose, &hand.output.bends) {
            hand.estimator.widen_ranges();
        }
    }
}
