//! The size that a recording grows to.

use std::path::Path;

use ademan::capture::SourceUri;
use ademan::files;
use ademan::message::escape_path;
use ademan::session::SessionHandle;
use ademan::setup::LoadedSetup;

/// Bytes of a reading with the results of all stages, for one hand with a noise of one count in each channel. A steady one takes
/// less than half.
const BYTES_PER_READING: f64 = 280.0;

/// Readings per second of a glove on the fastest line, for a source that states no rate.
const READINGS_PER_SECOND: f64 = 175.0;

/// Returns the readings per second of all sources of a setup.
pub fn readings_per_second(setup: &LoadedSetup) -> f64 {
    setup.sources().map(|(source, _)| rate_of(source)).sum()
}

fn rate_of(source: Option<&SourceUri>) -> f64 {
    let format = source.and_then(SourceUri::format);
    let nominal = format.and_then(|format| (format.protocol.nominal_rate_hz)(&format.options));
    nominal.unwrap_or(READINGS_PER_SECOND)
}

/// Waits until a session has created its recording, and prints that it begins, how fast it grows, and for how long the disk has room.
/// Prints nothing if the session ends before.
pub fn announce(session: &SessionHandle, path: &Path, rate_hz: f64) {
    if !session.wait_until_started() {
        return;
    }
    let per_hour = BYTES_PER_READING * rate_hz * 3600.0;
    let left = files::free_bytes(path).map_or(String::new(), |free| {
        let (free, hours) = (free as f64 / 1e9, free as f64 / per_hour);
        format!("; {free:.1} GB are free on its disk, enough for {hours:.0} hours")
    });
    say!(
        "recording to {}: up to {:.0} MB an hour at {rate_hz} readings per second{left}",
        escape_path(path),
        per_hour / 1e6,
    );
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_rate_is_that_of_the_protocol_if_it_has_one() {
        let rate = |source: &str| rate_of(Some(&source.parse().unwrap()));
        assert_eq!(rate("file:a?protocol=text-line&rate_hz=50"), 50.0);
        assert_eq!(rate("tcp:127.0.0.1:9?protocol=hc11"), READINGS_PER_SECOND);
        assert_eq!(rate_of(None), READINGS_PER_SECOND);
    }
}
