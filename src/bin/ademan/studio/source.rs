//! The sources of Studio: a simulated hand that types again and again, and none beside a recording.

use std::thread;
use std::time::Duration;

use ademan::capture::{CaptureError, Hc11Format, MAX_BLOCK, Source, SourceEvent, SourceStats};
use ademan::setup::LoadedSetup;
use ademan::sim::SimulatedTypist;
use ademan::time::Timestamp;

use crate::demo::script;
use crate::demo::text::{self, TextChoice};
use crate::failure::Failure;

/// Returns a hand that types on the layout of a setup, or plays the script that comes with it, without end.
pub fn simulated_hand(setup: &LoadedSetup) -> Result<RepeatedTypist, Failure> {
    let format = Hc11Format {
        baud: std::num::NonZeroU32::new(115_200).expect("the rate is not 0"),
        ..Hc11Format::default()
    };
    let hand = match script::for_layout(&setup.setup.layout) {
        Some(script) => setup.scripted(script, &format, 0.0, 0)?,
        None => {
            let text = text::choose(TextChoice::Default, &setup.layout)?;
            setup.typist(&text, &format, 0.0, 0)?
        }
    };
    Ok(RepeatedTypist {
        present: hand.clone(),
        hand,
        period: format.packet_period(),
        start: Duration::ZERO,
        last: Timestamp::default(),
        readings: 0,
    })
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

/// A simulated hand that starts again when it is done, on a clock that goes on.
pub struct RepeatedTypist {
    hand: SimulatedTypist,
    present: SimulatedTypist,
    period: Duration,
    /// Time at which the present round started.
    start: Duration,
    last: Timestamp,
    readings: u64,
}

impl Source for RepeatedTypist {
    fn next(&mut self) -> Result<SourceEvent, CaptureError> {
        match self.present.next()? {
            SourceEvent::Reading(mut reading) => {
                reading.time = reading.time + self.start;
                self.last = reading.time;
                self.readings += 1;
                Ok(SourceEvent::Reading(reading))
            }
            SourceEvent::End => {
                self.present = self.hand.clone();
                self.start = self.last.since(Timestamp::default()) + self.period;
                Ok(SourceEvent::Idle)
            }
            other => Ok(other),
        }
    }

    fn name(&self) -> &str {
        self.hand.name()
    }

    fn packet_period(&self) -> Option<Duration> {
        Some(self.period)
    }

    fn is_live(&self) -> bool {
        self.hand.is_live()
    }

    fn stats(&self) -> SourceStats {
        SourceStats {
            readings: self.readings,
            ..SourceStats::default()
        }
    }
}
