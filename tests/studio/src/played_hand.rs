//! A simulated hand that stops at a fixed reading, so that every run shows the same picture, and continues when a test says so.

use std::path::Path;
use std::sync::Arc;
use std::sync::atomic::{AtomicUsize, Ordering};
use std::thread;
use std::time::Duration;

use ademan::capture::{CaptureError, Hc11Format, Source, SourceEvent, SourceStats};
use ademan::setup::{LoadedSetup, SetupError};
use ademan::sim::SimulatedTypist;

/// Texts for a hand; it types the first one that the layout can type.
const TEXTS: [&str; 4] = ["hola mundo", "1234567890", "ab", "a"];

/// Time that the source blocks once the hand has stopped.
const IDLE: Duration = Duration::from_millis(5);

/// A hand that keeps still after a number of readings.
pub struct PlayedHand {
    hand: SimulatedTypist,
    sent: usize,
    /// Number of readings after which it keeps still.
    limit: Arc<AtomicUsize>,
    has_ended: bool,
}

impl PlayedHand {
    /// Returns the hand that plays the script of the layout, or else types a text on it, up to a number of readings.
    pub fn new(setup: &LoadedSetup, limit: Arc<AtomicUsize>) -> Result<Self, SetupError> {
        let format = Hc11Format::default();
        let root = Path::new(env!("CARGO_MANIFEST_DIR")).join("../..");
        let script = root.join(format!("examples/scripts/{}.txt", setup.setup.layout));
        let hand = match script.to_str().filter(|_| script.exists()) {
            Some(script) => setup.scripted(script, &format, 0.0, 0)?,
            None => {
                let hands = TEXTS.map(|text| setup.typist(text, &format, 0.0, 0));
                hands
                    .into_iter()
                    .reduce(Result::or)
                    .expect("there are texts")?
            }
        };
        Ok(Self {
            hand,
            sent: 0,
            limit,
            has_ended: false,
        })
    }
}

impl Source for PlayedHand {
    fn next(&mut self) -> Result<SourceEvent, CaptureError> {
        if self.has_ended || self.sent >= self.limit.load(Ordering::Relaxed) {
            thread::sleep(IDLE);
            return Ok(SourceEvent::Idle);
        }
        let event = self.hand.next()?;
        match event {
            SourceEvent::Reading(_) => self.sent += 1,
            // The session, and with it the picture, stays as it is.
            SourceEvent::End => {
                self.has_ended = true;
                return Ok(SourceEvent::Idle);
            }
            _ => {}
        }
        Ok(event)
    }

    fn name(&self) -> &str {
        self.hand.name()
    }

    fn packet_period(&self) -> Option<Duration> {
        Source::packet_period(&self.hand)
    }

    fn is_live(&self) -> bool {
        false
    }

    fn stats(&self) -> SourceStats {
        self.hand.stats()
    }
}
