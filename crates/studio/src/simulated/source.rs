//! Readings of the simulated hand.

use std::num::NonZeroU32;
use std::time::Duration;

use crossbeam_channel::Receiver;

use super::HandChange;
use ademan_lab::sim::{HandTask, SimulatedTypist};
use ademan_runtime::capture::{CaptureError, Hc11Format, Source, SourceEvent, SourceStats};
use ademan_runtime::setup::{LoadedSetup, SetupError};

/// Bit rate of the glove, which gives the time between two readings.
const BAUD: NonZeroU32 = NonZeroU32::new(115_200).expect("the rate is not 0");

/// A source of readings of a simulated person, who can be changed.
pub struct SimulatedHand {
    setup: LoadedSetup,
    hand: SimulatedTypist,
    changes: Receiver<HandChange>,
}

impl SimulatedHand {
    pub(super) fn new(
        setup: LoadedSetup,
        task: HandTask,
        changes: Receiver<HandChange>,
    ) -> Result<Self, SetupError> {
        let format = Hc11Format {
            baud: BAUD,
            ..Hc11Format::default()
        };
        Ok(Self {
            hand: setup.live_hand(task, &format)?,
            setup,
            changes,
        })
    }

    fn change(&mut self, HandChange { person, noise }: HandChange) {
        self.setup.simulated_person = person;
        // The control has checked the person.
        if let Err(error) = self.setup.change_live_hand(&mut self.hand, noise) {
            tracing::warn!("the simulated hand stays as it is: {error}");
        }
    }
}

impl Source for SimulatedHand {
    fn next(&mut self) -> Result<SourceEvent, CaptureError> {
        if let Some(change) = self.changes.try_iter().last() {
            self.change(change);
        }
        self.hand.next()
    }

    fn name(&self) -> &str {
        self.hand.name()
    }

    fn packet_period(&self) -> Option<Duration> {
        Some(self.hand.packet_period())
    }

    fn is_live(&self) -> bool {
        false
    }

    fn stats(&self) -> SourceStats {
        self.hand.stats()
    }
}
