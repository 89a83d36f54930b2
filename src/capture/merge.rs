//! Two sources, one for each hand, as one.

use std::time::Instant;

use crossbeam_channel::{Receiver, after, never, select};

use super::{
    CancelToken, CaptureError, CaptureEvent, CaptureThread, MAX_BLOCK, Reading, Source,
    SourceEvent, SourceStats, spawn,
};
use crate::hand::Side;
use crate::time::Timestamp;

/// A glove on each hand: their readings in one stream, each with its side.
///
/// Each source runs on a thread of its own and keeps its pace; its clock is moved so that its first
/// reading has the time at which it arrived. Sources that are not live, such as recordings, are merged
/// in order of their own times. When one device is lost, both hands are: nobody types on with half of
/// what was held. The stream ends when both have ended.
pub struct MergedSource {
    name: String,
    is_live: bool,
    start: Instant,
    hands: [MergedInput; Side::COUNT],
    /// The time of the latest reading; none is told with an earlier one.
    time: Timestamp,
    interrupt: Option<CancelToken>,
}

struct MergedInput {
    side: Side,
    captured: CaptureThread,
    arrivals: Receiver<CaptureEvent>,
    /// Microseconds from the source's clock to the common one.
    clock: Option<i64>,
    counts: SourceStats,
    /// The next reading of a source that is not live, until it is its turn.
    head: Option<Reading>,
    is_over: bool,
}

impl MergedInput {
    fn start(side: Side, source: Box<dyn Source>) -> Result<Self, CaptureError> {
        let captured = spawn(source)?;
        Ok(Self {
            side,
            arrivals: captured.events().clone(),
            captured,
            clock: None,
            counts: SourceStats::default(),
            head: None,
            is_over: false,
        })
    }

    fn end(&mut self) {
        self.is_over = true;
        self.arrivals = never();
    }
}

impl MergedSource {
    /// Starts both sources.
    pub fn start(sources: [(Side, Box<dyn Source>); Side::COUNT]) -> Result<Self, CaptureError> {
        let name = format!("{} and {}", sources[0].1.name(), sources[1].1.name());
        let is_live = sources.iter().any(|(_, source)| source.is_live());
        let [(one_side, one), (other_side, other)] = sources;
        Ok(Self {
            name,
            is_live,
            start: Instant::now(),
            hands: [
                MergedInput::start(one_side, one)?,
                MergedInput::start(other_side, other)?,
            ],
            time: Timestamp::default(),
            interrupt: None,
        })
    }

    /// Takes what a source says; a reading comes back with its side and the common time.
    fn take(
        &mut self,
        place: usize,
        arrival: Option<CaptureEvent>,
    ) -> Result<Option<Reading>, CaptureError> {
        let hand = &mut self.hands[place];
        match arrival {
            Some(CaptureEvent::Reading {
                mut reading,
                received_at: arrived,
                stats: counts,
            }) => {
                hand.counts = counts;
                reading.side = Some(hand.side);
                if self.is_live {
                    let now = arrived.saturating_duration_since(self.start).as_micros() as i64;
                    let time = reading.time.0 as i64;
                    let clock = *hand.clock.get_or_insert(now - time);
                    reading.time = Timestamp((time + clock).max(0) as u64).max(self.time);
                }
                Ok(Some(reading))
            }
            Some(CaptureEvent::Noise(counts)) => {
                hand.counts = counts;
                Ok(None)
            }
            Some(CaptureEvent::Lost(error)) => {
                hand.counts.losses += 1;
                Err(error)
            }
            Some(CaptureEvent::Failed(error)) => {
                hand.end();
                Err(error)
            }
            Some(CaptureEvent::End(counts)) => {
                hand.counts = counts;
                hand.end();
                Ok(None)
            }
            None => {
                hand.end();
                Ok(None)
            }
        }
    }

    /// The next that comes, from whichever source.
    fn next_arrived(&mut self) -> Result<Option<Reading>, CaptureError> {
        let [one, other] = [0, 1].map(|place: usize| self.hands[place].arrivals.clone());
        let (rung, patience) = match &self.interrupt {
            Some(interrupt) => (interrupt.channel().clone(), never()),
            None => (never(), after(MAX_BLOCK)),
        };
        select! {
            recv(one) -> arrival => self.take(0, arrival.ok()),
            recv(other) -> arrival => self.take(1, arrival.ok()),
            recv(rung) -> _ => Ok(None),
            recv(patience) -> _ => Ok(None),
        }
    }

    /// The earliest of what both recordings have next.
    fn next_in_time(&mut self) -> Result<Option<Reading>, CaptureError> {
        for place in 0..self.hands.len() {
            let hand = &self.hands[place];
            if hand.head.is_some() || hand.is_over {
                continue;
            }
            let Ok(arrival) = hand.arrivals.recv_timeout(MAX_BLOCK) else {
                return Ok(None);
            };
            self.hands[place].head = self.take(place, Some(arrival))?;
        }
        let heads = self.hands.iter_mut().map(|hand| &mut hand.head);
        let first = heads
            .filter(|head| head.is_some())
            .min_by_key(|head| head.as_ref().map(|reading| reading.time));
        Ok(first.and_then(Option::take))
    }
}

impl Source for MergedSource {
    fn next(&mut self) -> Result<SourceEvent, CaptureError> {
        let reading = match self.is_live {
            true => self.next_arrived()?,
            false => self.next_in_time()?,
        };
        if let Some(reading) = reading {
            self.time = reading.time;
            return Ok(SourceEvent::Reading(reading));
        }
        let is_over = self
            .hands
            .iter()
            .all(|hand| hand.is_over && hand.head.is_none());
        Ok(if is_over {
            SourceEvent::End
        } else {
            SourceEvent::Idle
        })
    }

    fn set_cancel_token(&mut self, interrupt: &CancelToken) {
        self.interrupt = Some(interrupt.clone());
    }

    fn name(&self) -> &str {
        &self.name
    }

    /// That of the slower one.
    fn packet_period(&self) -> Option<std::time::Duration> {
        let periods = self.hands.iter().map(|hand| hand.captured.packet_period());
        periods.flatten().max()
    }

    fn is_live(&self) -> bool {
        self.is_live
    }

    fn stats(&self) -> SourceStats {
        let [one, other] = &self.hands;
        SourceStats {
            bytes: one.counts.bytes + other.counts.bytes,
            skipped_bytes: one.counts.skipped_bytes + other.counts.skipped_bytes,
            resyncs: one.counts.resyncs + other.counts.resyncs,
            readings: one.counts.readings + other.counts.readings,
            dropped: one.counts.dropped + other.counts.dropped,
            losses: one.counts.losses + other.counts.losses,
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::capture::{Channels, Sample};

    /// Readings at these times, in microseconds.
    struct Times(&'static str, Vec<u64>);

    impl Source for Times {
        fn next(&mut self) -> Result<SourceEvent, CaptureError> {
            if self.1.is_empty() {
                return Ok(SourceEvent::End);
            }
            Ok(SourceEvent::Reading(Reading {
                time: Timestamp(self.1.remove(0)),
                side: None,
                sample: Sample::Channels(Channels {
                    full_scale: 255,
                    counts: Default::default(),
                }),
            }))
        }

        fn name(&self) -> &str {
            self.0
        }

        fn is_live(&self) -> bool {
            self.0 == "live"
        }

        fn stats(&self) -> SourceStats {
            SourceStats {
                readings: 1,
                ..SourceStats::default()
            }
        }
    }

    fn readings(left: Times, right: Times) -> (Vec<(Side, u64)>, MergedSource) {
        let sources: [(Side, Box<dyn Source>); 2] =
            [(Side::Left, Box::new(left)), (Side::Right, Box::new(right))];
        let mut both = MergedSource::start(sources).unwrap();
        let mut found = Vec::new();
        loop {
            match both.next().unwrap() {
                SourceEvent::Reading(reading) => {
                    found.push((reading.side.unwrap(), reading.time.0))
                }
                SourceEvent::Idle => {}
                SourceEvent::End => return (found, both),
            }
        }
    }

    #[test]
    fn recordings_of_two_hands_are_merged_in_order_of_time() {
        let left = Times("a", vec![10, 30, 31]);
        let right = Times("b", vec![20, 30, 50, 60]);
        let (found, both) = readings(left, right);
        let expected = [
            (Side::Left, 10),
            (Side::Right, 20),
            (Side::Left, 30),
            (Side::Right, 30),
            (Side::Left, 31),
            (Side::Right, 50),
            (Side::Right, 60),
        ];
        assert_eq!(found, expected);
        assert_eq!((both.name(), both.stats().readings), ("a and b", 2));
    }

    #[test]
    fn live_hands_share_a_clock_that_never_goes_back() {
        let left = Times("live", vec![5_000_000, 5_000_100, 5_000_200]);
        let right = Times("live", vec![7, 8, 9]);
        let (found, _) = readings(left, right);
        assert_eq!(found.len(), 6);
        assert!(
            found.windows(2).all(|pair| pair[0].1 <= pair[1].1),
            "{found:?}"
        );
        assert!(
            found[5].1 < 4_000_000,
            "the time since the start: {found:?}"
        );
    }
}
