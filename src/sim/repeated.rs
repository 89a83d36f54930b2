//! A simulated person who starts again at the end.

use std::time::Duration;

use super::SimulatedTypist;
use crate::capture::{CaptureError, Source, SourceEvent, SourceStats};

/// A [`SimulatedTypist`] without an end, for a viewer.
pub struct RepeatedTypist {
    start: SimulatedTypist,
    typist: SimulatedTypist,
}

impl RepeatedTypist {
    /// Repeats a person who has not begun.
    pub fn new(typist: SimulatedTypist) -> Self {
        Self {
            start: typist.clone(),
            typist,
        }
    }
}

impl Source for RepeatedTypist {
    fn next(&mut self) -> Result<SourceEvent, CaptureError> {
        match self.typist.next()? {
            SourceEvent::End => {
                self.typist.repeat(&self.start);
                self.typist.next()
            }
            event => Ok(event),
        }
    }

    fn name(&self) -> &str {
        self.typist.name()
    }

    fn packet_period(&self) -> Option<Duration> {
        Source::packet_period(&self.typist)
    }

    fn is_live(&self) -> bool {
        false
    }

    fn stats(&self) -> SourceStats {
        self.typist.stats()
    }
}
