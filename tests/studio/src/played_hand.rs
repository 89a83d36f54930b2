//! A simulated hand that stops at a fixed reading, so that every run shows the same picture.

use std::path::Path;
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
    left: usize,
}

impl PlayedHand {
    /// Returns the hand that plays the script of the layout, or else types a text on it.
    pub fn new(setup: &LoadedSetup, readings: usize) -> Result<Self, SetupError> {
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
            left: readings,
        })
    }
}

impl Source for PlayedHand {
    fn next(&mut self) -> Result<SourceEvent, CaptureError> {
        if self.left == 0 {
            thread::sleep(IDLE);
            return Ok(SourceEvent::Idle);
        }
        let event = self.hand.next()?;
        match event {
            SourceEvent::Reading(_) => self.left -= 1,
            // The session, and with it the picture, stays as it is.
            SourceEvent::End => self.left = 0,
            _ => {}
        }
        Ok(match event {
            SourceEvent::End => SourceEvent::Idle,
            event => event,
        })
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
