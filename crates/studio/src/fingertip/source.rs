//! Readings of hands that follow the mouse.

use std::time::Duration;

use crossbeam_channel::{Receiver, TryRecvError};

use ademan_core::hand::Side;
use ademan_core::time::Timestamp;
use ademan_lab::sim::{Pointed, PointerHand};
use ademan_runtime::capture::{CaptureError, Reading, Source, SourceEvent, SourceStats};
use ademan_runtime::setup::LoadedSetup;

/// Time between two readings of a hand.
const PERIOD: Duration = Duration::from_millis(10);

/// The name of the source.
pub const MOUSE: &str = "mouse";

/// A movement of the mouse.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum PointerMove {
    /// The index finger of a hand points at a front.
    To(Side, Pointed),
    /// All fingers lift.
    Lift,
}

/// A source of the positions of joints of hands that follow the mouse. It ends with the sender of the movements.
pub struct PointerSource {
    hands: Vec<PointerHand>,
    moves: Receiver<PointerMove>,
    time: Timestamp,
    /// The hand of the next reading.
    next: usize,
    readings: u64,
}

impl PointerSource {
    /// Creates the source of the hands of a setup, which rest.
    pub fn new(setup: &LoadedSetup, moves: Receiver<PointerMove>) -> Self {
        let is_opened = setup.layout.scene.starts_at_hand();
        let other = setup.other_hand.as_ref().map(|hand| &hand.arm);
        let arms = std::iter::once(&setup.arm).chain(other);
        let hand = |arm| {
            if is_opened {
                PointerHand::new(arm).opened()
            } else {
                PointerHand::new(arm)
            }
        };
        Self {
            hands: arms.map(hand).collect(),
            moves,
            time: Timestamp(0),
            next: 0,
            readings: 0,
        }
    }

    fn follow(&mut self, change: PointerMove) {
        match change {
            PointerMove::To(side, pointed) => {
                let own = self.hands.iter_mut().find(|hand| hand.side() == side);
                if let Some(hand) = own {
                    hand.point(pointed);
                }
            }
            PointerMove::Lift => self.hands.iter_mut().for_each(PointerHand::lift),
        }
    }
}

impl Source for PointerSource {
    fn next(&mut self) -> Result<SourceEvent, CaptureError> {
        loop {
            match self.moves.try_recv() {
                Ok(change) => self.follow(change),
                Err(TryRecvError::Empty) => break,
                Err(TryRecvError::Disconnected) => return Ok(SourceEvent::End),
            }
        }
        if self.next == 0 {
            self.time = self.time + PERIOD;
        }
        let count = self.hands.len();
        let hand = &mut self.hands[self.next];
        self.next = (self.next + 1) % count;
        let (side, sample) = (hand.side(), hand.advance(PERIOD.as_secs_f32()));
        self.readings += 1;
        let reading = Reading::new(self.time, Some(side), sample);
        Ok(SourceEvent::Reading(reading))
    }

    fn name(&self) -> &str {
        MOUSE
    }

    fn packet_period(&self) -> Option<Duration> {
        Some(PERIOD)
    }

    fn is_live(&self) -> bool {
        false
    }

    fn stats(&self) -> SourceStats {
        SourceStats {
            readings: self.readings,
            ..SourceStats::default()
        }
    }
}
