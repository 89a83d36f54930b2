//! The time between two frames.

use std::time::Duration;

/// Shortest time from one frame to the next: 60 per second.
const PERIOD: Duration = Duration::from_micros(16_667);

/// Shortest time from one frame to the next without a graphics card: 25 per second. Mesa takes more than a core for 40.
const SOFTWARE_PERIOD: Duration = Duration::from_millis(40);

/// Time from one frame to the next while nothing changes.
const IDLE_PERIOD: Duration = Duration::from_millis(200);

/// Time without changes after which a session counts as idle, in seconds. Until then plots and trails move on.
const IDLE_AFTER: f64 = 1.0;

/// Shortest pause in percent of the cost of a frame. The cost lacks the time in which Mesa fills the frame.
const REST_PERCENT: u32 = 150;

/// Decides when the next frame is drawn.
#[derive(Debug)]
pub struct Pace {
    period: Duration,
    /// Time of the last change, in seconds.
    changed_at: f64,
}

impl Pace {
    /// Creates the pace of a window that a graphics card draws, or software.
    pub const fn new(has_card: bool) -> Self {
        Self {
            period: if has_card { PERIOD } else { SOFTWARE_PERIOD },
            changed_at: 0.0,
        }
    }

    /// Returns the pause after a frame that is drawn at `now`, in seconds; `cost` is the processor time of the previous frame.
    ///
    /// Input ends a pause.
    pub fn pause(&mut self, now: f64, has_changed: bool, cost: Duration) -> Duration {
        if has_changed {
            self.changed_at = now;
        }
        if now - self.changed_at > IDLE_AFTER {
            return IDLE_PERIOD;
        }
        self.period
            .saturating_sub(cost)
            .max(cost * REST_PERCENT / 100)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const MS: Duration = Duration::from_millis(1);

    #[test]
    fn a_session_that_changes_has_sixty_frames_per_second() {
        let pause = Pace::new(true).pause(9.0, true, 3 * MS);
        assert_eq!(pause + 3 * MS, PERIOD);
    }

    #[test]
    fn a_window_without_a_graphics_card_has_fewer_frames() {
        let pause = Pace::new(false).pause(9.0, true, 3 * MS);
        assert_eq!(pause + 3 * MS, SOFTWARE_PERIOD);
    }

    #[test]
    fn a_slow_machine_rests_most_of_the_time() {
        assert_eq!(Pace::new(true).pause(9.0, true, 40 * MS), 60 * MS);
    }

    #[test]
    fn an_idle_session_has_few_frames_until_something_changes() {
        let mut pace = Pace::new(true);
        assert!(pace.pause(5.0, true, MS) < PERIOD);
        assert!(pace.pause(5.9, false, MS) < PERIOD);
        assert_eq!(pace.pause(6.1, false, MS), IDLE_PERIOD);
        assert!(pace.pause(6.3, true, MS) < PERIOD);
    }
}
