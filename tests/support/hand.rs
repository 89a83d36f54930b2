//! A source that presses one key.

use std::time::{Duration, Instant};

use ademan::capture::{CaptureError, Source, SourceEvent};
use ademan::time::Timestamp;

use super::press::{Posture, Press, glove_format, reading};

/// A source that presses a key, holds it, and releases it.
pub struct HoldingHand {
    approach: std::vec::IntoIter<Posture>,
    pressed: Posture,
    lift: std::vec::IntoIter<Posture>,
    hold: Duration,
    start: Instant,
    pressed_at: Option<Instant>,
}

impl HoldingHand {
    /// Creates a source that holds the key of `press` for the duration `hold`.
    pub fn new(press: &Press, hold: Duration) -> Self {
        Self {
            approach: press.approach.clone().into_iter(),
            pressed: press.pressed(),
            lift: press.lift.clone().into_iter(),
            hold,
            start: Instant::now(),
            pressed_at: None,
        }
    }

    fn next_posture(&mut self) -> Option<Posture> {
        if let Some(posture) = self.approach.next() {
            return Some(posture);
        }
        let pressed_at = *self.pressed_at.get_or_insert_with(Instant::now);
        if pressed_at.elapsed() < self.hold {
            return Some(self.pressed);
        }
        self.lift.next()
    }
}

impl Source for HoldingHand {
    fn next(&mut self) -> Result<SourceEvent, CaptureError> {
        std::thread::sleep(glove_format().packet_period());
        let time = Timestamp(0) + self.start.elapsed();
        let posture = self.next_posture();
        Ok(posture.map_or(SourceEvent::End, |posture| {
            SourceEvent::Reading(reading(time, &posture))
        }))
    }

    fn name(&self) -> &str {
        "a hand"
    }
}
