//! Playback of recordings at their own pace.

use std::time::{Duration, Instant};

use super::{CaptureError, Reading, Source, SourceEvent, SourceStats};
use ademan_core::time::Timestamp;

/// Longest wait for one reading. Longer gaps are shortened to it.
pub const MAX_GAP: Duration = Duration::from_secs(2);

/// Longest time in which a source that is not live, and whose keys are pressed, may neither return a reading nor state the time. A longer
/// silence means that the disk of a recording hangs, or that a busy machine has not run the thread of the source: then a session releases
/// everything.
///
/// With the 150 ms for which a person holds a key, the release comes before a desktop repeats the key: GNOME after 500 ms, sway
/// after 600 ms, an X server after 660 ms. A live source has the shorter stall timeout.
pub const MAX_SILENCE: Duration = Duration::from_millis(300);

/// Longest sleep per call, and so the delay with which a gap in the readings is detected.
const MAX_SLEEP: Duration = Duration::from_millis(10);

/// A source that is not live, whose readings are returned at the pace of their timestamps.
///
/// A delay does not shift the schedule unless it is longer than [`MAX_SILENCE`]. The schedule then starts over, so that the late readings do
/// not come in a burst. Shorter delays are caught up with: if several of them shifted the schedule while a key is pressed, the key would be
/// held for the sum of them, and the desktop would repeat it.
pub struct PacedSource<S> {
    source: S,
    speed: f64,
    pending: Option<Pending>,
    /// Timestamp of the last reading of the inner source, and the time at which it is due.
    last: Option<(Timestamp, Instant)>,
}

/// A reading that waits.
struct Pending {
    reading: Reading,
    /// Time at which it is due.
    due: Instant,
    /// Timestamp of the reading before it, and the time at which that was due.
    previous: Option<(Timestamp, Instant)>,
}

impl<S: Source> PacedSource<S> {
    /// Plays `source` at `speed` times real time, clamped to 0.01..=1000. NaN counts as 1.
    pub fn new(source: S, speed: f64) -> Self {
        let speed = if speed.is_nan() { 1.0 } else { speed };
        Self {
            source,
            speed: speed.clamp(0.01, 1000.0),
            pending: None,
            last: None,
        }
    }

    /// Returns the time at which a reading with timestamp `time`, which the source returns `now`, is due.
    fn schedule(&mut self, time: Timestamp, now: Instant) -> Instant {
        let due = match self.last {
            Some((previous, due)) => {
                let gap = time.since(previous).div_f64(self.speed);
                due + gap.min(MAX_GAP)
            }
            None => now,
        };
        let is_far_behind = now.saturating_duration_since(due) > MAX_SILENCE;
        let due = if is_far_behind { now } else { due };
        self.last = Some((time, due));
        due
    }
}

impl<S: Source> Source for PacedSource<S> {
    fn next(&mut self) -> Result<SourceEvent, CaptureError> {
        let pending = match self.pending.take() {
            Some(pending) => pending,
            None => match self.source.next()? {
                SourceEvent::Reading(reading) => Pending {
                    previous: self.last,
                    due: self.schedule(reading.time, Instant::now()),
                    reading,
                },
                idle_or_end => return Ok(idle_or_end),
            },
        };
        let wait = pending.due.saturating_duration_since(Instant::now());
        std::thread::sleep(wait.min(MAX_SLEEP));
        if wait > MAX_SLEEP {
            self.pending = Some(pending);
            return Ok(SourceEvent::Idle);
        }
        Ok(SourceEvent::Reading(pending.reading))
    }

    fn name(&self) -> &str {
        self.source.name()
    }

    /// Returns the period of the inner source: readings keep their timestamps at any speed.
    fn packet_period(&self) -> Option<Duration> {
        self.source.packet_period()
    }

    fn is_live(&self) -> bool {
        self.source.is_live()
    }

    /// Returns the time of the recording that the playback has reached while a reading waits.
    fn clock(&self) -> Option<Timestamp> {
        let pending = self.pending.as_ref()?;
        let (previous, due) = pending.previous?;
        let elapsed = Instant::now().saturating_duration_since(due);
        let time = previous + elapsed.mul_f64(self.speed);
        // The reading itself is not due yet, even if a long gap is shortened or this thread is late.
        Some(Timestamp(
            time.0.min(pending.reading.time.0.saturating_sub(1)),
        ))
    }

    fn stop(&mut self) {
        self.source.stop();
    }

    fn stats(&self) -> SourceStats {
        self.source.stats()
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::capture::Sample;

    /// Longest time for anything on a busy machine.
    const TIMEOUT: Duration = Duration::from_secs(60);

    /// Source with readings at these times, in milliseconds.
    struct TimedSource(Vec<u64>);

    impl Source for TimedSource {
        fn next(&mut self) -> Result<SourceEvent, CaptureError> {
            if self.0.is_empty() {
                return Ok(SourceEvent::End);
            }
            let time = Timestamp(self.0.remove(0) * 1000);
            let angles = Default::default();
            let reading = Reading::new(time, None, Sample::Angles { angles });
            Ok(SourceEvent::Reading(reading))
        }

        fn name(&self) -> &str {
            "times"
        }

        fn packet_period(&self) -> Option<Duration> {
            Some(Duration::from_millis(10))
        }

        fn is_live(&self) -> bool {
            false
        }
    }

    /// Plays readings at these times, in milliseconds. Returns the time at which each was returned, and its timestamp.
    fn play(times: &[u64], speed: f64) -> (Vec<Duration>, Vec<u64>) {
        let mut paced = PacedSource::new(TimedSource(times.to_vec()), speed);
        let start = Instant::now();
        let (mut returned_at, mut played) = (Vec::new(), Vec::new());
        loop {
            let called_at = Instant::now();
            let event = paced.next().unwrap();
            assert!(
                called_at.elapsed() < TIMEOUT,
                "blocked for {:?}",
                called_at.elapsed()
            );
            match event {
                SourceEvent::Reading(reading) => {
                    returned_at.push(start.elapsed());
                    played.push(reading.time.0 / 1000);
                }
                SourceEvent::Command(command) => panic!("nothing was recorded: {command}"),
                SourceEvent::Idle => assert!(called_at.elapsed() >= MAX_SLEEP),
                SourceEvent::End => return (returned_at, played),
            }
        }
    }

    #[test]
    fn readings_are_not_early_at_any_speed() {
        let (returned_at, times) = play(&[500, 600, 620, 920], 2.0);
        assert_eq!(times, [500, 600, 620, 920]);
        for (moment, earliest) in returned_at.iter().zip([0, 50, 60, 210]) {
            assert!(*moment >= Duration::from_millis(earliest), "{moment:?}");
        }
    }

    #[test]
    fn a_gap_of_a_year_takes_two_seconds() {
        let (returned_at, _) = play(&[0, 365 * 86_400_000], 1.0);
        assert!(
            returned_at[1] >= MAX_GAP && returned_at[1] < TIMEOUT,
            "{returned_at:?}"
        );
    }

    #[test]
    fn the_clock_passes_through_a_gap_and_stays_before_the_next_reading() {
        for (speed, gap_ms) in [(1.0, 1_500), (20.0, 30_000), (1.0, 365 * 86_400_000)] {
            let mut paced = PacedSource::new(TimedSource(vec![0, gap_ms]), speed);
            paced.next().unwrap();
            let mut clock = Vec::new();
            while paced.next().unwrap() == SourceEvent::Idle {
                clock.extend(paced.clock());
            }
            assert!(clock.is_sorted(), "{clock:?}");
            let passes_stall_timeout = |time: &Timestamp| time.0 > 200_000;
            assert!(clock.iter().any(passes_stall_timeout), "{clock:?}");
            assert!(clock.iter().all(|time| time.0 < gap_ms * 1000), "{clock:?}");
            assert_eq!(paced.clock(), None);
        }
    }

    #[test]
    fn silences_in_which_nothing_is_released_do_not_add_up() {
        let mut paced = PacedSource::new(TimedSource(Vec::new()), 1.0);
        let (start, ms) = (Instant::now(), Duration::from_millis);
        let mut due = |time_ms: u64, now_ms: u64| {
            let due = paced.schedule(Timestamp(time_ms * 1000), start + ms(now_ms));
            due.saturating_duration_since(start)
        };
        assert_eq!(due(0, 0), Duration::ZERO);
        // The thread of the source is not run for 290 ms, twice.
        assert_eq!(due(10, 290), ms(10));
        assert_eq!(due(290, 290), ms(290));
        assert_eq!(due(300, 580), ms(300));
        // In a longer silence the session releases everything.
        assert_eq!(due(310, 611), ms(611));
        assert_eq!(due(320, 611), ms(621));
    }

    #[test]
    fn a_late_consumer_gets_no_burst() {
        let mut paced = PacedSource::new(TimedSource(vec![0, 10, 20, 100]), 1.0);
        paced.next().unwrap();
        std::thread::sleep(MAX_SILENCE * 2);
        let start = Instant::now();
        paced.next().unwrap();
        paced.next().unwrap();
        assert!(start.elapsed() >= Duration::from_millis(10));
    }

    #[test]
    fn the_speed_is_clamped() {
        for (speed, clamped) in [
            (f64::NAN, 1.0),
            (0.0, 0.01),
            (-1.0, 0.01),
            (1e9, 1000.0),
            (2.0, 2.0),
        ] {
            assert_eq!(
                PacedSource::new(TimedSource(Vec::new()), speed).speed,
                clamped,
                "{speed}"
            );
        }
    }

    #[test]
    fn packet_period_and_liveness_are_those_of_the_source() {
        let paced = PacedSource::new(TimedSource(Vec::new()), 20.0);
        assert_eq!(paced.packet_period(), Some(Duration::from_millis(10)));
        assert!(!paced.is_live());
    }
}
