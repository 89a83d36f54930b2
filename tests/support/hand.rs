//! A hand that presses one key, as a source.

use std::time::{Duration, Instant};

use ademan::capture::{CaptureError, Source, SourceEvent};
use ademan::time::Timestamp;

use super::press::{Posture, Press, line, reading};

/// A hand that presses a key, holds it and lets go, as a source.
pub struct Hand {
    approach: std::vec::IntoIter<Posture>,
    held: Posture,
    lift: std::vec::IntoIter<Posture>,
    hold: Duration,
    start: Instant,
    pressed: Option<Instant>,
}

impl Hand {
    /// The hand that holds the key of a press down for `hold`.
    pub fn that_holds(press: &Press, hold: Duration) -> Self {
        Self {
            approach: press.approach.clone().into_iter(),
            held: press.held(),
            lift: press.lift.clone().into_iter(),
            hold,
            start: Instant::now(),
            pressed: None,
        }
    }

    fn next_posture(&mut self) -> Option<Posture> {
        if let Some(posture) = self.approach.next() {
            return Some(posture);
        }
        let pressed = *self.pressed.get_or_insert_with(Instant::now);
        if pressed.elapsed() < self.hold {
            return Some(self.held);
        }
        self.lift.next()
    }
}

impl Source for Hand {
    fn next(&mut self) -> Result<SourceEvent, CaptureError> {
        std::thread::sleep(line().packet_period());
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
