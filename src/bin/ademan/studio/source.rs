//! The sources of Studio: simulated hands that type or play again and again, and none beside a recording.

use std::thread;

use ademan::capture::{CaptureError, Hc11Format, MAX_BLOCK, Source, SourceEvent, SourceStats};
use ademan::setup::LoadedSetup;
use ademan::sim::SimulatedTypist;

use crate::demo::looping;
use crate::failure::Failure;

/// Returns a hand that types or plays what suits the layout of a setup, without end. It leaves out what is beyond its reach.
pub fn simulated_hand(setup: &LoadedSetup) -> Result<SimulatedTypist, Failure> {
    let format = Hc11Format {
        baud: std::num::NonZeroU32::new(115_200).expect("the rate is not 0"),
        ..Hc11Format::default()
    };
    Ok(looping::hand(setup, &format)?)
}

/// A source without readings, for the session behind the window while that shows a recording.
pub struct NoReadings;

impl Source for NoReadings {
    fn next(&mut self) -> Result<SourceEvent, CaptureError> {
        thread::sleep(MAX_BLOCK);
        Ok(SourceEvent::Idle)
    }

    fn name(&self) -> &str {
        "none"
    }

    fn is_live(&self) -> bool {
        false
    }

    fn stats(&self) -> SourceStats {
        SourceStats::default()
    }
}
