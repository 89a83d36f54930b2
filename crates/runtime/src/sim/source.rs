//! A simulated person as a source of readings.

use std::time::Duration;

use super::SimulatedTypist;
use crate::capture::{CaptureError, Source, SourceEvent, SourceStats};

impl Source for SimulatedTypist {
    fn next(&mut self) -> Result<SourceEvent, CaptureError> {
        Ok(self
            .next_reading()
            .map_or(SourceEvent::End, SourceEvent::Reading))
    }

    fn name(&self) -> &str {
        self.name()
    }

    fn packet_period(&self) -> Option<Duration> {
        Some(self.packet_period())
    }

    fn is_live(&self) -> bool {
        false
    }

    fn stats(&self) -> SourceStats {
        SourceStats {
            readings: self.reading_count(),
            ..SourceStats::default()
        }
    }
}
