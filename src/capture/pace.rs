//! Lets a recording play at the pace at which it was made.

use std::time::{Duration, Instant};

use super::{CaptureError, MAX_BLOCK, Reading, Source, SourceEvent, SourceStats};
use crate::time::Timestamp;

/// The longest wait for one reading; a longer gap is shortened to it.
pub const MAX_GAP: Duration = Duration::from_secs(2);

/// One wait is not longer, so that the inner source has the other half of the patience.
const MAX_SLEEP: Duration = MAX_BLOCK.checked_div(2).unwrap();

/// Lets the readings of a source that is not live come by their own timestamps.
///
/// A consumer that is slow does not shift the schedule, unless it is behind by more than [`PATIENCE`]: then
/// the schedule starts over, so that what was missed does not come in a burst.
pub struct PacedSource<S> {
    source: S,
    speed: f64,
    waiting: Option<(Reading, Instant)>,
    /// Timestamp of the reading before, and when it was due.
    previous: Option<(Timestamp, Instant)>,
}

impl<S: Source> PacedSource<S> {
    /// Plays `source` at `speed` times real time: from 0.01 to 1000, other values are moved to the nearer
    /// end. What is not a number counts as 1.
    pub fn new(source: S, speed: f64) -> Self {
        let speed = if speed.is_nan() { 1.0 } else { speed };
        Self {
            source,
            speed: speed.clamp(0.01, 1000.0),
            waiting: None,
            previous: None,
        }
    }

    fn schedule(&mut self, time: Timestamp) -> Instant {
        let now = Instant::now();
        let due = match self.previous {
            Some((previous, due)) => {
                let gap = time.since(previous).div_f64(self.speed);
                due + gap.min(MAX_GAP)
            }
            None => now,
        };
        let is_far_behind = now.saturating_duration_since(due) > MAX_BLOCK;
        let due = if is_far_behind { now } else { due };
        self.previous = Some((time, due));
        due
    }
}

impl<S: Source> Source for PacedSource<S> {
    fn next(&mut self) -> Result<SourceEvent, CaptureError> {
        let (reading, due) = match self.waiting.take() {
            Some(waiting) => waiting,
            None => match self.source.next()? {
                SourceEvent::Reading(reading) => {
                    let due = self.schedule(reading.time);
                    (reading, due)
                }
                other => return Ok(other),
            },
        };
        let wait = due.saturating_duration_since(Instant::now());
        std::thread::sleep(wait.min(MAX_SLEEP));
        if wait > MAX_SLEEP {
            self.waiting = Some((reading, due));
            return Ok(SourceEvent::Idle);
        }
        Ok(SourceEvent::Reading(reading))
    }

    fn name(&self) -> &str {
        self.source.name()
    }

    /// That of the source, whose times the readings keep at any speed.
    fn packet_period(&self) -> Option<Duration> {
        self.source.packet_period()
    }

    fn is_live(&self) -> bool {
        self.source.is_live()
    }

    fn stats(&self) -> SourceStats {
        self.source.stats()
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::capture::{Channels, Sample};

    struct Times(Vec<u64>);

    impl Source for Times {
        fn next(&mut self) -> Result<SourceEvent, CaptureError> {
            if self.0.is_empty() {
                return Ok(SourceEvent::End);
            }
            Ok(SourceEvent::Reading(Reading {
                time: Timestamp(self.0.remove(0) * 1000),
                side: None,
                sample: Sample::Channels(Channels {
                    full_scale: 255,
                    counts: Default::default(),
                }),
            }))
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

    /// Plays readings at the times given, in milliseconds; how long each took, and the times that were let out.
    fn play(times: &[u64], speed: f64) -> (Vec<Duration>, Vec<u64>) {
        let mut paced = PacedSource::new(Times(times.to_vec()), speed);
        let start = Instant::now();
        let (mut moments, mut out) = (Vec::new(), Vec::new());
        loop {
            let asked = Instant::now();
            let capture = paced.next().unwrap();
            assert!(
                asked.elapsed() < Duration::from_secs(1),
                "asked in vain for {:?}",
                asked.elapsed()
            );
            match capture {
                SourceEvent::Reading(reading) => {
                    moments.push(start.elapsed());
                    out.push(reading.time.0 / 1000);
                }
                SourceEvent::Idle => assert!(asked.elapsed() >= MAX_SLEEP),
                SourceEvent::End => return (moments, out),
            }
        }
    }

    #[test]
    fn readings_come_no_earlier_than_their_time_at_the_speed_asked_for() {
        let (moments, out) = play(&[500, 600, 620, 920], 2.0);
        assert_eq!(out, [500, 600, 620, 920]);
        for (moment, earliest) in moments.iter().zip([0, 50, 60, 210]) {
            assert!(*moment >= Duration::from_millis(earliest), "{moments:?}");
        }
    }

    #[test]
    fn a_gap_of_a_year_takes_two_seconds() {
        let (moments, _) = play(&[0, 365 * 86_400_000], 1.0);
        assert!(
            moments[1] >= MAX_GAP && moments[1] < Duration::from_secs(20),
            "{moments:?}"
        );
    }

    #[test]
    fn a_slow_consumer_is_not_given_a_burst() {
        let mut paced = PacedSource::new(Times(vec![0, 10, 20, 100]), 1.0);
        paced.next().unwrap();
        std::thread::sleep(MAX_BLOCK * 2);
        let start = Instant::now();
        paced.next().unwrap();
        paced.next().unwrap();
        assert!(start.elapsed() >= Duration::from_millis(10));
    }

    #[test]
    fn a_speed_out_of_range_is_moved_into_it() {
        for (speed, moved) in [
            (f64::NAN, 1.0),
            (0.0, 0.01),
            (-1.0, 0.01),
            (1e9, 1000.0),
            (2.0, 2.0),
        ] {
            assert_eq!(
                PacedSource::new(Times(Vec::new()), speed).speed,
                moved,
                "{speed}"
            );
        }
    }

    #[test]
    fn it_is_the_same_source_at_any_speed() {
        let paced = PacedSource::new(Times(Vec::new()), 20.0);
        assert_eq!(paced.packet_period(), Some(Duration::from_millis(10)));
        assert!(!paced.is_live());
    }
}
