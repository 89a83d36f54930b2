//! Detection of a stream with the wrong protocol or bit rate.

use std::time::{Duration, Instant};

/// Detector of bytes that form no packets.
#[derive(Default)]
pub(super) struct GarbageDetector {
    /// Times of the first and the last bytes since the last packet, or since a silence.
    span: Option<(Instant, Instant)>,
    has_warned: bool,
}

impl GarbageDetector {
    /// Time of bytes without a packet after which a warning is due.
    pub const TIMEOUT: Duration = Duration::from_secs(2);

    /// Handles bytes that arrived at `now`. Returns `true` if a warning is due: once until packets arrive again.
    pub fn update(&mut self, now: Instant, has_packet: bool) -> bool {
        if has_packet {
            *self = Self::default();
            return false;
        }
        // A silence is no sign of a wrong format.
        let is_silence = |last: Instant| now.saturating_duration_since(last) >= Self::TIMEOUT;
        let span = self.span.filter(|&(_, last)| !is_silence(last));
        let since = span.map_or(now, |(first, _)| first);
        self.span = Some((since, now));
        let is_due = !self.has_warned && now.saturating_duration_since(since) >= Self::TIMEOUT;
        self.has_warned |= is_due;
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
}
