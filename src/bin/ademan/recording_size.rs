//! The size that a recording grows to.

use std::path::Path;

use ademan::capture::{SampleKind, SourceUri};
use ademan::files;
use ademan::message::escape_path;
use ademan::session::SessionHandle;
use ademan::setup::LoadedSetup;

/// Readings per second of a glove on the fastest line, for a source that states no rate.
const READINGS_PER_SECOND: f64 = 175.0;

/// The growth of a recording while all sources of its setup send.
#[derive(Clone, Copy)]
pub struct Growth {
    readings_per_second: f64,
    bytes_per_second: f64,
}

impl Growth {
    /// Returns the growth of a recording with this setup.
    pub fn new(setup: &LoadedSetup) -> Self {
        let has_two_hands = setup.other_hand.is_some();
        let mut growth = Self {
            readings_per_second: 0.0,
            bytes_per_second: 0.0,
        };
        for source in setup.named_sources() {
            let rate = rate_of(source.uri) * readings_per_packet(source.uri, has_two_hands);
            growth.readings_per_second += rate;
            growth.bytes_per_second += rate * bytes_per_reading(source.uri);
        }
        growth
    }
}

/// Returns the readings that follow from a packet: one for each hand, and for each part of it.
fn readings_per_packet(source: Option<&SourceUri>, has_two_hands: bool) -> f64 {
    let shows_both = has_two_hands && source.is_some_and(SourceUri::has_both_hands);
    let has_parts = source.is_some_and(SourceUri::has_parts);
    let hands = if shows_both { 2.0 } else { 1.0 };
    if has_parts { 2.0 * hands } else { hands }
}

/// Returns the bytes of a reading with the results of all stages if every number has noise. A steady hand takes less than half.
fn bytes_per_reading(source: Option<&SourceUri>) -> f64 {
    let protocol = source.and_then(SourceUri::protocol);
    match protocol.map(|protocol| protocol.sample) {
        None | Some(SampleKind::Channels | SampleKind::Displacement) => 280.0,
        Some(SampleKind::Angles) => 450.0,
        // Up to 30 joints, landmarks or bones with three or four numbers each.
        Some(_) => 1000.0,
    }
}

fn rate_of(source: Option<&SourceUri>) -> f64 {
    let format = source.and_then(SourceUri::format);
    let nominal = format.and_then(|format| (format.protocol.nominal_rate_hz)(&format.options));
    nominal.unwrap_or(READINGS_PER_SECOND)
}

/// Waits until a session has created its recording, and prints that it begins, how fast it grows, and for how long the disk has room.
/// Prints nothing if the session ends before.
pub fn announce(session: &SessionHandle, path: &Path, growth: Growth) {
    if !session.wait_until_started() {
        return;
    }
    let per_hour = growth.bytes_per_second * 3600.0;
    let left = files::free_bytes(path).map_or(String::new(), |free| {
        let (free, hours) = (free as f64 / 1e9, free as f64 / per_hour);
        format!("; {free:.1} GB are free on its disk, enough for {hours:.0} hours")
    });
    say!(
        "recording to {}: up to {:.0} MB an hour at {} readings per second{left}",
        escape_path(path),
        per_hour / 1e6,
        growth.readings_per_second,
    );
}

#[cfg(test)]
mod tests {
    use super::*;
    use ademan::setup::{OtherHand, Setup};

    #[test]
    fn each_hand_and_part_of_a_packet_is_a_reading_and_positions_take_more_than_counts() {
        let growth = |source: &str, other_hand: Option<OtherHand>| {
            let setup = Setup {
                source: Some(source.parse().unwrap()),
                other_hand,
                ..Setup::default()
            };
            let found = Growth::new(&setup.load_files().unwrap());
            (found.readings_per_second, found.bytes_per_second)
        };
        let second_hand = || Some(OtherHand::default());
        assert_eq!(growth("tcp:127.0.0.1:9?protocol=hc11", None).0, 175.0);
        let headset = "file:a?protocol=openxr&rate_hz=100";
        assert_eq!(growth(headset, None), (100.0, 1e5));
        assert_eq!(growth(headset, second_hand()), (200.0, 2e5));
        let holistic = "file:a?protocol=holistic&camera=head&rate_hz=30";
        assert_eq!(growth(holistic, None).0, 60.0);
        assert_eq!(growth(holistic, second_hand()).0, 120.0);
    }

    #[test]
    fn the_rate_is_that_of_the_protocol_if_it_has_one() {
        let rate = |source: &str| rate_of(Some(&source.parse().unwrap()));
        assert_eq!(rate("file:a?protocol=text-line&rate_hz=50"), 50.0);
        assert_eq!(rate("tcp:127.0.0.1:9?protocol=hc11"), READINGS_PER_SECOND);
        assert_eq!(rate_of(None), READINGS_PER_SECOND);
    }
}
