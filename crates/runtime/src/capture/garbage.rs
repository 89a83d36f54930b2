//! Detection of a stream with the wrong protocol or bit rate, or of a sender whose packets are invalid.

use std::time::{Duration, Instant};

/// Detector of bytes that form no packets.
#[derive(Default)]
pub(super) struct GarbageDetector {
    /// Times of the first and the last bytes since the last packet, or since a silence.
    span: Option<(Instant, Instant)>,
    has_warned: bool,
}

impl GarbageDetector {
    /// Longest time of bytes without a packet before a warning.
    pub const TIMEOUT: Duration = Duration::from_secs(2);

    /// Handles bytes that arrived at `now`. Returns `true` if a warning is due: once until packets arrive again.
    pub fn update(&mut self, now: Instant, has_packet: bool) -> bool {
        if has_packet {
            *self = Self::default();
            return false;
        }
        // A silence is not a sign of a wrong format.
        let is_silence = |last: Instant| now.saturating_duration_since(last) >= Self::TIMEOUT;
        let span = self.span.filter(|&(_, last)| !is_silence(last));
        let since = span.map_or(now, |(first, _)| first);
        self.span = Some((since, now));
        let is_due = !self.has_warned && now.saturating_duration_since(since) >= Self::TIMEOUT;
        self.has_warned |= is_due;
        is_due
    }
}

/// Detector of packets of which nearly all are invalid, although a valid one arrives now and then.
#[derive(Default)]
pub(super) struct InvalidDetector {
    /// Time and numbers of valid and invalid packets at the start of the current interval.
    start: Option<(Instant, u64, u64)>,
    has_warned: bool,
}

impl InvalidDetector {
    /// Largest number of invalid packets for each valid one without a warning.
    const MAX_RATIO: u64 = 9;

    /// Handles the numbers of all packets so far. Returns `true` if a warning is due: once until more of them are valid.
    pub fn update(&mut self, now: Instant, valid: u64, invalid: u64) -> bool {
        let (since, first_valid, first_invalid) = *self.start.get_or_insert((now, valid, invalid));
        if now.saturating_duration_since(since) < GarbageDetector::TIMEOUT {
            return false;
        }
        self.start = Some((now, valid, invalid));
        let new = valid - first_valid;
        let is_bad = new > 0 && invalid - first_invalid > new * Self::MAX_RATIO;
        let is_due = is_bad && !self.has_warned;
        // An interval without a valid packet is a case for `GarbageDetector`. It does not show that packets are valid again.
        self.has_warned = is_bad || self.has_warned && new == 0;
        is_due
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_silence_is_no_garbage() {
        let start = Instant::now();
        let mut detector = GarbageDetector::default();
        // The rest of a packet that a silence has cut, and then bytes of a wrong format.
        for (millis, is_due) in [(0, false), (9_000, false), (10_000, false), (11_000, true)] {
            let now = start + Duration::from_millis(millis);
            assert_eq!(detector.update(now, false), is_due, "{millis}");
        }
    }

    #[test]
    fn garbage_is_reported_once_until_packets_arrive() {
        let start = Instant::now();
        let mut detector = GarbageDetector::default();
        let table = [
            (0, false, false),
            (1_900, false, false),
            (2_000, false, true),
            (5_000, false, false),
            (5_100, true, false),
            (5_200, false, false),
            (7_100, false, false),
            (7_200, false, true),
        ];
        for (millis, has_packet, is_due) in table {
            let now = start + Duration::from_millis(millis);
            assert_eq!(detector.update(now, has_packet), is_due, "{millis}");
        }
    }

    #[test]
    fn a_valid_packet_now_and_then_hides_no_invalid_ones() {
        let start = Instant::now();
        let mut detector = InvalidDetector::default();
        let table = [
            (0, 0, 0, false),
            (1_900, 2, 50, false),
            (2_000, 2, 58, true),
            (4_000, 4, 116, false),
            (6_000, 204, 117, false),
            (8_000, 206, 175, true),
            // Packets that are all invalid are garbage.
            (10_000, 206, 275, false),
            (12_000, 208, 333, false),
        ];
        for (millis, valid, invalid, is_due) in table {
            let now = start + Duration::from_millis(millis);
            assert_eq!(detector.update(now, valid, invalid), is_due, "{millis}");
        }
    }
}
