//! Hands whose readings stop, and the release of what they hold.

use super::hand_pipeline::HandPipeline;
use super::{Pipeline, PipelineState};
use crate::command::CommandOrigin;
use crate::device::Events;
use crate::estimate::Implausible;
use crate::hand::{Dof, HandPart, Side};
use crate::time::Timestamp;

/// The reason why a hand touches nothing although the session continues.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum HandLoss {
    /// The source of the hand sends nothing.
    NoReadings,
    /// The source of the hand sends, but does not show the hand, or not all of it.
    NotSeen,
    /// The source of the hand has repeated all positions exactly for more than 5 s.
    Stuck,
    /// The hand has pressed faster than the rate limit.
    TooFast,
}

impl Pipeline {
    /// Releases everything because readings stopped for longer than the [`stall_timeout`](Self::stall_timeout).
    ///
    /// Output is armed again after the hand has been clear of every control.
    pub fn stall(&mut self, events: &mut Events) {
        if self.state == PipelineState::Stopped {
            return;
        }
        let Some(last) = self.last_accepted() else {
            return;
        };
        for hand in &mut self.hands {
            hand.last_accepted = None;
            hand.is_clear = false;
        }
        self.stalls += 1;
        let time = last + self.settings.stall_timeout;
        self.disarm(time, PipelineState::Stalled, events);
    }

    /// Releases everything as [`stall`](Self::stall) does if, at `time`, no hand has had a reading for longer than the
    /// [`stall_timeout`](Self::stall_timeout). Returns `true` if it did.
    ///
    /// The first later reading would detect the same gap with the same result, so that a replay emits the same events whether
    /// it waits for that reading or not.
    pub fn stall_if_overdue(&mut self, time: Timestamp, events: &mut Events) -> bool {
        let last = self.last_accepted();
        let is_overdue = last.is_some_and(|last| time.since(last) > self.settings.stall_timeout);
        if is_overdue {
            self.stall(events);
        }
        is_overdue
    }

    /// Releases everything because an output has dropped a press, or its watchdog has released keys: a locked modifier may
    /// be up for the receiver, and later keys would arrive without it.
    ///
    /// Output is armed again after the hand has been clear of every control.
    pub fn stall_output(&mut self, events: &mut Events) {
        self.rearm(events);
    }

    /// Releases what a hand holds because the source of the hand, or of a part of it, was lost. The other hand and controls that
    /// the remaining part drives continue. Everything [stalls](Self::stall) if nothing is left.
    pub fn lose(&mut self, side: Option<Side>, part: Option<HandPart>, events: &mut Events) {
        if self.state == PipelineState::Stopped {
            return;
        }
        let expected_readings = self.expects_readings();
        for index in 0..self.hands.len() {
            if side.is_none_or(|side| side == self.hands[index].side()) {
                self.lose_hand(index, part, events);
            }
        }
        if expected_readings && !self.expects_readings() {
            self.stalls += 1;
            self.disarm(self.time, PipelineState::Stalled, events);
        }
    }

    /// Returns, by side, `true` for a hand that was tracked and is lost, although readings of the other hand, or of its own
    /// fingers, may still arrive.
    pub fn lost_hands(&self) -> [bool; Side::COUNT] {
        let mut lost = [false; Side::COUNT];
        for hand in &self.hands {
            lost[hand.side().index()] = hand.is_lost();
        }
        lost
    }

    /// Returns, by side, the parts of a hand that are not trusted because their readings are implausible.
    pub fn implausible(&self) -> [Implausible; Side::COUNT] {
        let mut implausible = [Implausible::default(); Side::COUNT];
        for hand in &self.hands {
            implausible[hand.side().index()] = hand.estimator.implausible();
        }
        implausible
    }

    /// Returns the sensor channel that measures an angle of a hand, if a glove does.
    pub fn channel_of(&self, side: Side, dof: Dof) -> Option<usize> {
        let mut hands = self.hands.iter();
        let hand = hands.find(|hand| hand.side() == side)?;
        hand.estimator.channel_of(dof)
    }

    /// Returns, by side, the reason why a hand is [lost](Self::lost_hands).
    pub fn hand_losses(&self) -> [Option<HandLoss>; Side::COUNT] {
        let mut losses = [None; Side::COUNT];
        for hand in self.hands.iter().filter(|hand| hand.is_lost()) {
            let loss = if hand.is_suspended {
                HandLoss::TooFast
            } else if hand.last_accepted.is_none() {
                HandLoss::NoReadings
            } else if hand.is_stuck {
                HandLoss::Stuck
            } else {
                HandLoss::NotSeen
            };
            losses[hand.side().index()] = Some(loss);
        }
        losses
    }

    /// Stalls, or loses one hand, if its readings stopped for longer than the stall timeout before `time`. Only time stamps of
    /// readings count, so that a replay repeats a recorded stall.
    pub(super) fn detect_gaps(&mut self, time: Timestamp, events: &mut Events) {
        let timeout = self.settings.stall_timeout;
        let is_expected = |hand: &&HandPipeline| hand.last_accepted.is_some();
        let is_overdue = |hand: &HandPipeline| {
            hand.last_accepted
                .is_some_and(|last| time.since(last) > timeout)
        };
        if !self.hands.iter().any(is_overdue) {
            return;
        }
        if self.hands.iter().filter(is_expected).all(is_overdue) {
            self.stall(events);
            return;
        }
        self.stalls += 1;
        for index in 0..self.hands.len() {
            if is_overdue(&self.hands[index]) {
                self.lose_hand(index, None, events);
            }
        }
    }

    /// Suspends a hand that presses faster than the rate limit: its next reading releases what it holds, and it touches
    /// nothing until [`resume`](Self::resume). Returns `false` and changes nothing if no other hand is tracked.
    pub(super) fn suspend(&mut self, index: usize) -> bool {
        let mut others = self.hands.iter().enumerate();
        let has_other = others.any(|(other, hand)| other != index && hand.last_accepted.is_some());
        self.hands[index].is_suspended |= has_other;
        has_other
    }

    /// Ends the suspension of hands, if `origin` may end a pause of the rate limit.
    pub(super) fn end_suspensions(&mut self, origin: CommandOrigin) {
        if origin.may_end_pause_of(CommandOrigin::RateLimit) {
            for hand in &mut self.hands {
                hand.is_suspended = false;
            }
        }
    }

    /// Returns the time of the latest accepted reading of any hand; `None` if no hand expects readings.
    fn last_accepted(&self) -> Option<Timestamp> {
        let tracked = self.hands.iter().filter_map(|hand| hand.last_accepted);
        tracked.max()
    }

    /// Releases what a hand holds, has locked or has switched on, because the source of it, or of a part of it, was lost.
    fn lose_hand(&mut self, index: usize, part: Option<HandPart>, events: &mut Events) {
        self.hands[index].lose(part);
        let side = self.hands[index].side();
        self.active_layout().lose_hand(side);
        self.release_lost(index, events);
        self.release_followers(index, events);
    }

    /// Updates the devices with a hand that has lost a part: they release what that part held.
    pub(super) fn release_lost(&mut self, index: usize, events: &mut Events) {
        self.lose_hand_in_filters(self.hands[index].side());
        let estimate = &mut self.hands[index].output.estimate;
        estimate.time = estimate.time.max(self.time);
        self.update_pose(index);
        self.update_devices(index, events);
    }
}
