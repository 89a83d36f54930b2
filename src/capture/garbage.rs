//! Tells a line that carries something else, or at another baud, from one that is only quiet.

use std::time::{Duration, Instant};

/// Notices bytes that never become a frame.
#[derive(Default)]
pub(super) struct GarbageDetector {
    since: Option<Instant>,
    has_warned: bool,
}

impl GarbageDetector {
    /// Bytes without a frame for so long are garbage.
    pub const LIMIT: Duration = Duration::from_secs(2);

    /// Tells once that it is time to warn; again only after frames came in between.
    pub fn is_due(&mut self, now: Instant, no_frame: bool) -> bool {
        if !no_frame {
            *self = Self::default();
            return false;
        }
        let since = *self.since.get_or_insert(now);
        let is_due = !self.has_warned && now.saturating_duration_since(since) >= Self::LIMIT;
        self.has_warned |= is_due;
        is_due
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn garbage_is_told_once_until_frames_come_in_between() {
        let start = Instant::now();
        let mut watch = GarbageDetector::default();
        let table = [
            (0, true, false),
            (1_900, true, false),
            (2_000, true, true),
            (5_000, true, false),
            (5_100, false, false),
            (5_200, true, false),
            (7_100, true, false),
            (7_200, true, true),
        ];
        for (millis, no_frame, is_due) in table {
            let now = start + Duration::from_millis(millis);
            assert_eq!(watch.is_due(now, no_frame), is_due, "{millis}");
        }
    }
}
