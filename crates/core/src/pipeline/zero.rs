//! Changes of the angles that readings mean: zeroing of a hand at rest, and another calibration.

use std::time::Duration;

use super::{CommandError, Pipeline, PipelineState};
use crate::device::Events;
use crate::estimate::{Estimator, Zeroed};

/// The time within which a hand must rest after a key or a gesture of the layout has asked for it.
const REST_TIMEOUT: Duration = Duration::from_secs(5);

impl Pipeline {
    /// Zeroes the hand that was tracked last: its present angles become its rest pose. Everything is released, and output
    /// is armed again after the hand has been clear of every control, as the fingertips jump.
    ///
    /// Refused without a tracked hand that is still, while a key is down, and for a change that no slipped glove explains.
    pub fn zero(&mut self, events: &mut Events) -> Result<(), CommandError> {
        let index = self.last_tracked_hand().ok_or(CommandError::NoHand)?;
        if !self.is_paused() && self.layout().is_in_use() {
            return Err(CommandError::KeyDown);
        }
        self.zero_hand(index, events)
    }

    /// Removes what [`zero`](Self::zero) has changed, for both hands.
    pub fn undo_zero(&mut self, events: &mut Events) -> Result<(), CommandError> {
        self.zero_until = None;
        let undone = self.hands.iter_mut().map(|hand| hand.estimator.undo_zero());
        let outcome = undone.reduce(Result::or).unwrap_or(Ok(()));
        outcome?;
        self.rearm(events);
        Ok(())
    }

    /// Repeats a `zero` of a recording. The recorded session may have been paused, which this one is not.
    pub(super) fn replay_zero(&mut self, events: &mut Events) -> Result<(), CommandError> {
        let index = self.last_tracked_hand().ok_or(CommandError::NoHand)?;
        self.zero_hand(index, events)
    }

    /// Exchanges the estimator of the first hand for one with another calibration or filter. `estimator` is the old one
    /// afterwards. Everything is released, and output is armed again as after [`zero`](Self::zero).
    pub fn exchange_estimator(&mut self, estimator: &mut Estimator, events: &mut Events) {
        self.hands[0].estimator.exchange(estimator);
        self.rearm(events);
    }

    /// Returns what [`zero`](Self::zero) has changed of the hand that was tracked last.
    pub fn zeroed(&self) -> Option<Zeroed> {
        let hand = &self.hands[self.last_tracked_hand()?];
        hand.estimator.zeroed()
    }

    /// Zeroes the hand as soon as it rests: the finger that presses a key cannot rest yet.
    pub(super) fn zero_when_at_rest(&mut self) {
        self.zero_until = Some(self.time + REST_TIMEOUT);
    }

    /// Carries out a request of the layout once the hand is at rest and no key is down. A hand that is still in another pose,
    /// such as the pose of the gesture, is not at rest.
    pub(super) fn zero_if_at_rest(&mut self, events: &mut Events) {
        let Some(deadline) = self.zero_until else {
            return;
        };
        let is_over = self.time > deadline || self.state() != PipelineState::Running;
        if is_over || self.zero(events).is_ok() {
            self.zero_until = None;
        }
    }

    fn zero_hand(&mut self, index: usize, events: &mut Events) -> Result<(), CommandError> {
        self.hands[index].estimator.zero()?;
        self.rearm(events);
        Ok(())
    }
}
