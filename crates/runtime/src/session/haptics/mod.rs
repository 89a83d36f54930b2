//! Feedback to the gloves of a session: a finger that presses is held, and touches are felt as pulses.
//!
//! The loop compares each step with the feedback that was sent last, and sends a change to the thread of that glove, which
//! writes it. The newest state replaces one that the thread has not received yet, so a glove that does not read delays nothing,
//! and no release is lost.

mod hand;
mod thread;

use std::io;
use std::time::Instant;

use arrayvec::ArrayVec;

use self::hand::HandFeedback;
use self::thread::FeedbackThread;
use super::observer::Observer;
use crate::capture::{Haptics, Source};
use ademan_core::hand::Side;
use ademan_core::pipeline::Pipeline;
use ademan_core::snapshot::StepView;

/// The feedback to all gloves of a session. Dropping it frees all fingers, and waits 0.2 s for that at most.
pub(super) struct SessionHaptics {
    hands: ArrayVec<(HandFeedback, FeedbackThread), { Side::COUNT }>,
}

impl SessionHaptics {
    /// Starts a thread for each glove of `source` that takes feedback.
    pub fn start(
        haptics: Haptics,
        source: &mut dyn Source,
        sides: impl IntoIterator<Item = Side>,
    ) -> io::Result<Self> {
        let mut hands = ArrayVec::new();
        if haptics == Haptics::Off {
            return Ok(Self { hands });
        }
        for side in sides {
            if let Some(device) = source.take_feedback_device(side) {
                let hand = HandFeedback::new(side, haptics, device.format());
                hands.push((hand, FeedbackThread::start(haptics, device)?));
            }
        }
        Ok(Self { hands })
    }

    /// Returns `true` if no glove takes feedback.
    pub fn is_empty(&self) -> bool {
        self.hands.is_empty()
    }
}

impl Observer for SessionHaptics {
    fn observe(&mut self, step: &StepView, _: Instant, _: &Pipeline) {
        for (hand, thread) in &mut self.hands {
            if hand.update(step) {
                thread.send(hand.state());
            }
        }
    }
}
