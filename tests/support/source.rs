//! Sources for tests: waiting for an event, and the text lines of a typing hand.

use std::time::{Duration, Instant};

use ademan::capture::protocol::text_line;
use ademan::capture::{CaptureError, Hc11Format, Source, SourceEvent};
use ademan::estimate::{Estimator, EstimatorSettings, Smoothing};
use ademan::setup::Setup;

/// Returns the next event that is not `Idle`. Panics after `timeout`.
pub fn next_within(
    source: &mut dyn Source,
    timeout: Duration,
) -> Result<SourceEvent, CaptureError> {
    let start = Instant::now();
    while start.elapsed() < timeout {
        match source.next() {
            Ok(SourceEvent::Idle) => {}
            event => return event,
        }
    }
    panic!("no event within {timeout:?}");
}

/// Returns the text lines of joint angles of a hand that types `text` on the default layout, 174.5 per second.
///
/// The angles of the thumb are not exact, because its MCP and IP joints share a wire index.
pub fn text_lines(text: &str) -> Vec<String> {
    let setup = Setup::default().load_files().expect("the default setup");
    let hand = setup.typist(text, &Hc11Format::default(), 0.0, 0);
    let mut hand = hand.expect("the text can be typed");
    let settings = EstimatorSettings::unchecked(Smoothing::Off);
    let mut estimator =
        Estimator::new(settings).with_channels(&setup.glove.as_ref().expect("a glove").map);
    let mut lines = Vec::new();
    while let SourceEvent::Reading(reading) = hand.next().expect("the hand has no errors") {
        let estimate = estimator.update(&reading).expect("a valid reading");
        lines.push(text_line::encode(&estimate.angles));
    }
    lines
}
