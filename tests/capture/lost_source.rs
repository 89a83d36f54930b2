//! A source that is lost for a moment while a key is held.

use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};
use std::thread;
use std::time::{Duration, Instant};

use ademan::capture::{CaptureError, Source, SourceEvent};
use ademan::device::EventKind;
use ademan::time::Timestamp;

use crate::gap::play_source;
use crate::support::press::{Posture, Press, glove_format, reading};

/// Longest wait for the release after the loss.
const TIMEOUT: Duration = Duration::from_secs(60);

/// A glove that is lost while its wearer holds a key, and continues with the next packet. The finger stays on the key until the key is
/// released, and for a second after that.
struct LostGlove {
    before: std::vec::IntoIter<Posture>,
    is_lost: bool,
    pressed: Posture,
    is_released: Arc<AtomicBool>,
    after: std::vec::IntoIter<Posture>,
    time: Timestamp,
    started_at: Instant,
}

impl LostGlove {
    fn new(is_released: &Arc<AtomicBool>) -> Self {
        let press = Press::for_text("h");
        let mut after = vec![press.pressed(); 180];
        after.extend(&press.lift);
        // The hand is clear of all keys for long enough to arm.
        after.extend([press.clear(); 80]);
        after.extend(&press.approach);
        after.extend(&press.lift);
        Self {
            before: press.approach.clone().into_iter(),
            is_lost: false,
            pressed: press.pressed(),
            is_released: is_released.clone(),
            after: after.into_iter(),
            time: Timestamp(0),
            started_at: Instant::now(),
        }
    }

    fn show(&mut self, posture: &Posture) -> SourceEvent {
        self.time = self.time + glove_format().packet_period();
        SourceEvent::Reading(reading(self.time, posture))
    }
}

impl Source for LostGlove {
    fn next(&mut self) -> Result<SourceEvent, CaptureError> {
        if let Some(posture) = self.before.next() {
            return Ok(self.show(&posture));
        }
        if !self.is_lost {
            self.is_lost = true;
            return Err(CaptureError::Lost {
                source_name: self.name().to_owned(),
                reason: "it was unplugged".to_owned(),
            });
        }
        if !self.is_released.load(Ordering::Relaxed) {
            let is_late = self.started_at.elapsed() > TIMEOUT;
            assert!(!is_late, "the key is held after the loss");
            thread::sleep(Duration::from_millis(1));
            let pressed = self.pressed;
            return Ok(self.show(&pressed));
        }
        let next = self.after.next();
        Ok(next.map_or(SourceEvent::End, |posture| self.show(&posture)))
    }

    fn name(&self) -> &str {
        "a glove"
    }

    fn is_live(&self) -> bool {
        false
    }
}

/// Readings go on, so that no stall releases the key.
#[test]
fn a_key_is_released_at_a_loss_and_not_pressed_until_the_finger_has_left_it() {
    let (events, stalls) = play_source(10_000, LostGlove::new);
    let names: Vec<_> = events
        .iter()
        .map(|event| match event.kind {
            EventKind::KeyDown(_) => "down",
            EventKind::KeyUp(_) => "up",
            _ => "other",
        })
        .collect();
    assert_eq!(names, ["down", "up", "down", "up"], "{events:?}");
    assert_eq!(stalls, 1, "the loss");
}
