//! Changes of the angles that readings mean: zeroing of a hand at rest, and another calibration.

use std::ops::Range;
use std::time::Duration;

use super::{CommandError, Pipeline, PipelineState};
use crate::device::Events;
use crate::estimate::{Estimator, ZeroError, Zeroed};
use crate::hand::Side;
use crate::time::Timestamp;

/// The time within which a hand must rest after a key or a gesture of the layout has asked for it.
const REST_TIMEOUT: Duration = Duration::from_secs(5);

/// A request of the layout to zero a hand.
#[derive(Clone, Copy, Debug)]
pub(super) struct ZeroRequest {
    /// The index of the hand.
    hand: usize,
    deadline: Timestamp,
}

impl Pipeline {
    /// Zeroes each tracked hand that is still: its present angles become its rest pose. Everything is released, and output
    /// is armed again after the hand has been clear of every control, as the fingertips jump.
    ///
    /// Refused without a tracked hand that is still, while a key is down, and for a change that no slipped glove explains. Of two
    /// hands, one that is refused keeps its angles.
    pub fn zero(&mut self, events: &mut Events) -> Result<(), CommandError> {
        self.check_no_key_is_down()?;
        self.zero_each(0..self.hands.len(), events)
    }

    /// Removes what [`zero`](Self::zero) has changed, for both hands.
    pub fn undo_zero(&mut self, events: &mut Events) -> Result<(), CommandError> {
        self.zero_request = None;
        let undone = self.hands.iter_mut().map(|hand| {
            hand.is_zeroed = false;
            hand.estimator.undo_zero()
        });
        let outcome = undone.reduce(Result::or).unwrap_or(Ok(()));
        outcome?;
        self.rearm(events);
        Ok(())
    }

    /// Repeats a `zero` of a recording. The recorded session may have been paused, which this one is not.
    pub(super) fn replay_zero(&mut self, events: &mut Events) -> Result<(), CommandError> {
        self.zero_each(0..self.hands.len(), events)
    }

    /// Exchanges the estimator of the first hand for one with another calibration or filter. `estimator` is the old one
    /// afterwards. Everything is released, and output is armed again as after [`zero`](Self::zero).
    pub fn exchange_estimator(&mut self, estimator: &mut Estimator, events: &mut Events) {
        self.hands[0].estimator.exchange(estimator);
        self.rearm(events);
    }

    /// Iterates over the hands that the latest [`zero`](Self::zero), or the latest request of the layout, has changed.
    pub fn zeroed(&self) -> impl Iterator<Item = (Side, Zeroed)> {
        let hands = self.hands.iter().filter(|hand| hand.is_zeroed);
        hands.filter_map(|hand| Some((hand.side(), hand.estimator.zeroed()?)))
    }

    /// Zeroes the hand that has asked for it as soon as it rests: the finger that presses a key cannot rest yet.
    pub(super) fn zero_when_at_rest(&mut self) {
        let side = self.layout().hand_to_zero();
        let mut hands = self.hands.iter();
        self.zero_request = Some(ZeroRequest {
            hand: hands.position(|hand| hand.side() == side).unwrap_or(0),
            deadline: self.time + REST_TIMEOUT,
        });
    }

    /// Carries out a request of the layout once the hand is at rest and no key is down. A hand that is still in another pose,
    /// such as the pose of the gesture, is not at rest.
    pub(super) fn zero_if_at_rest(&mut self, events: &mut Events) {
        let Some(request) = self.zero_request else {
            return;
        };
        let is_over = self.time > request.deadline || self.state() != PipelineState::Running;
        if is_over || self.zero_asked(request.hand, events).is_ok() {
            self.zero_request = None;
        }
    }

    fn zero_asked(&mut self, hand: usize, events: &mut Events) -> Result<(), CommandError> {
        self.check_no_key_is_down()?;
        self.zero_each(hand..hand + 1, events)
    }

    fn check_no_key_is_down(&self) -> Result<(), CommandError> {
        if !self.is_paused() && self.layout().is_in_use() {
            return Err(CommandError::KeyDown);
        }
        Ok(())
    }

    /// Zeroes each of these hands that is tracked and can be zeroed. Fails if there is none.
    fn zero_each(&mut self, hands: Range<usize>, events: &mut Events) -> Result<(), CommandError> {
        let mut outcome = Err(CommandError::NoHand);
        for index in 0..self.hands.len() {
            let is_meant = hands.contains(&index) && self.is_tracked(index);
            let hand = &mut self.hands[index];
            let zeroed = if is_meant {
                hand.estimator.zero().map_err(CommandError::from)
            } else {
                Err(CommandError::NoHand)
            };
            hand.is_zeroed = zeroed.is_ok();
            outcome = of_both(outcome, zeroed);
        }
        outcome?;
        self.rearm(events);
        Ok(())
    }
}

/// Returns the outcome of two hands. If neither was zeroed, it is the error of the one that could have been.
fn of_both(
    first: Result<(), CommandError>,
    second: Result<(), CommandError>,
) -> Result<(), CommandError> {
    match (first, second) {
        (Ok(()), _) | (_, Ok(())) => Ok(()),
        (Err(error), Err(CommandError::NoHand | CommandError::Zero(ZeroError::NoAngles)))
            if error != CommandError::NoHand =>
        {
            Err(error)
        }
        (Err(_), Err(error)) => Err(error),
    }
}
