//! Offset of the clock of a source.

use std::time::Duration;

/// Time after which an observation is forgotten, so that the offset follows clocks that drift apart: 10 s let a clock that
/// is wrong by 100 parts per million err by 2 ms at most.
const WINDOW: Duration = Duration::from_secs(10);

/// Offset of the clock of a source from the clock of the receiver: the smallest difference between the arrival of a
/// reading and its own time in the last 10 to 20 s. A reading that was delayed on its way does not change it.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct ClockOffset {
    /// Start of the present window on the clock of the receiver, in microseconds.
    started_at: i64,
    /// Smallest difference of the present and of the previous window, in microseconds.
    smallest: Option<[i64; 2]>,
}

impl ClockOffset {
    /// Updates the offset with a reading and returns it, in microseconds. `arrival` is in microseconds on the clock of the
    /// receiver, `time` on the clock of the source.
    pub fn update(&mut self, arrival: i64, time: i64) -> i64 {
        let difference = arrival - time;
        let [present, previous] = self.smallest.get_or_insert([difference; 2]);
        if arrival - self.started_at >= WINDOW.as_micros() as i64 {
            self.started_at = arrival;
            *previous = *present;
            *present = difference;
        }
        *present = difference.min(*present);
        *present.min(previous)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_late_first_reading_and_a_fast_clock_are_corrected() {
        let mut offset = ClockOffset::default();
        assert_eq!(offset.update(1_030_000, 0), 1_030_000, "30 ms late");
        assert_eq!(offset.update(1_010_000, 10_000), 1_000_000);
        assert_eq!(offset.update(1_025_000, 20_000), 1_000_000, "5 ms late");
        let mut last = 0;
        for second in 1..=100 {
            // A clock that loses 100 µs a second.
            last = offset.update(1_000_000 + second * 1_000_000, second * 999_900);
        }
        let exact = 1_000_000 + 100 * 100;
        assert!((exact - 2_000..=exact).contains(&last), "{last}");
    }
}
