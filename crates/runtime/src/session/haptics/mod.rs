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

/// The feedback to all gloves of a session. Dropping it frees all fingers, and waits for each glove 0.2 s at most.
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

    /// Frees all fingers without waiting for that.
    fn release(&mut self) {
        for (_, thread) in &mut self.hands {
            thread.release();
        }
    }
}

impl Drop for SessionHaptics {
    fn drop(&mut self) {
        // The drop of each thread waits: no glove may be held until another one has answered.
        self.release();
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

#[cfg(test)]
mod tests {
    use std::io::Write;
    use std::time::Duration;

    use crossbeam_channel::{Receiver, Sender, bounded, unbounded};

    use super::thread::FeedbackState;
    use super::*;
    use crate::capture::feedback::{FeedbackDevice, FeedbackFormat};
    use ademan_core::hand::Finger;

    /// Longest wait for something that a busy machine does late.
    const TIMEOUT: Duration = Duration::from_secs(60);

    /// Messages of one byte: 1 if a finger is held.
    static FORMAT: FeedbackFormat = FeedbackFormat {
        curl: |_, _| None,
        encode: |feedback, bytes| {
            let forces = feedback.forces.unwrap_or_default();
            bytes.push(u8::from(forces.iter().any(|force| *force > 0.0)));
        },
    };

    /// A glove that does not read until the other end of the channel is dropped.
    struct Deaf(Receiver<()>);

    impl Write for Deaf {
        fn write(&mut self, bytes: &[u8]) -> io::Result<usize> {
            let _ = self.0.recv();
            Ok(bytes.len())
        }

        fn flush(&mut self) -> io::Result<()> {
            Ok(())
        }
    }

    /// A glove that passes on what it reads.
    struct Listening(Sender<Vec<u8>>);

    impl Write for Listening {
        fn write(&mut self, bytes: &[u8]) -> io::Result<usize> {
            let _ = self.0.send(bytes.to_vec());
            Ok(bytes.len())
        }

        fn flush(&mut self) -> io::Result<()> {
            Ok(())
        }
    }

    fn hand(side: Side, writer: impl Write + Send + 'static) -> (HandFeedback, FeedbackThread) {
        let device = FeedbackDevice::new(&FORMAT);
        device.connect(Some(Box::new(writer)));
        (
            HandFeedback::new(side, Haptics::Force, &FORMAT),
            FeedbackThread::start(Haptics::Force, device).unwrap(),
        )
    }

    #[test]
    fn a_glove_is_freed_while_the_other_one_does_not_read() {
        let (hear, deaf) = bounded(0);
        let (sender, messages) = unbounded();
        let hands = [
            hand(Side::Right, Deaf(deaf)),
            hand(Side::Left, Listening(sender)),
        ];
        let mut haptics = SessionHaptics {
            hands: hands.into(),
        };
        let next = || messages.recv_timeout(TIMEOUT).unwrap();
        assert_eq!(next(), [0]);
        let mut held = FeedbackState::default();
        held.forces[Finger::Ring.index()] = 1.0;
        haptics.hands[1].1.send(held);
        assert_eq!(next(), [1]);
        haptics.release();
        assert_eq!(next(), [0]);
        drop(hear);
    }
}
