//! Merging of two sources, one for each hand.

use std::time::{Duration, Instant};

use crossbeam_channel::{Receiver, after, never, select};

use super::{
    CancelToken, CaptureError, CaptureEvent, CaptureThread, MAX_BLOCK, Reading, Source,
    SourceEvent, SourceStats, spawn,
};
use crate::hand::Side;
use crate::time::Timestamp;

/// The readings of a source for each hand as one source.
///
/// Each source runs on its own thread. Live readings are merged in order of arrival; the clock of each source is
/// shifted so that its first reading has its time of arrival. Other readings, such as those of recordings, are merged
/// in order of their own times. The loss of one device is a loss of both, so that all keys are released. The stream
/// ends when both sources have ended.
pub struct MergedSource {
    name: String,
    is_live: bool,
    start: Instant,
    inputs: [MergedInput; Side::COUNT],
    /// Time of the latest reading. Times never decrease.
    time: Timestamp,
    cancel: Option<CancelToken>,
}

struct MergedInput {
    side: Side,
    packet_period: Option<Duration>,
    events: Receiver<CaptureEvent>,
    /// Microseconds to add to the clock of the source. `None` until its first reading.
    clock_offset: Option<i64>,
    stats: SourceStats,
    /// Next reading of a source that is not live, until it is the earliest.
    head: Option<Reading>,
    has_ended: bool,
    /// Stops the source when it is dropped.
    _thread: CaptureThread,
}

impl MergedInput {
    fn start(side: Side, source: Box<dyn Source>) -> Result<Self, CaptureError> {
        let thread = spawn(source)?;
        Ok(Self {
            side,
            packet_period: thread.packet_period(),
            events: thread.events().clone(),
            clock_offset: None,
            stats: SourceStats::default(),
            head: None,
            has_ended: false,
            _thread: thread,
        })
    }

    fn end(&mut self) {
        self.has_ended = true;
        self.events = never();
    }
}

impl MergedSource {
    /// Starts both sources.
    pub fn start(sources: [(Side, Box<dyn Source>); Side::COUNT]) -> Result<Self, CaptureError> {
        let name = format!("{} and {}", sources[0].1.name(), sources[1].1.name());
        let is_live = sources.iter().any(|(_, source)| source.is_live());
        let [(first_side, first), (second_side, second)] = sources;
        Ok(Self {
            name,
            is_live,
            start: Instant::now(),
            inputs: [
                MergedInput::start(first_side, first)?,
                MergedInput::start(second_side, second)?,
            ],
            time: Timestamp::default(),
            cancel: None,
        })
    }

    /// Handles an event of input `index`; `None` is a disconnected channel. Returns its reading with side and common
    /// time.
    fn handle(
        &mut self,
        index: usize,
        event: Option<CaptureEvent>,
    ) -> Result<Option<Reading>, CaptureError> {
        let input = &mut self.inputs[index];
        match event {
            Some(CaptureEvent::Reading {
                mut reading,
                received_at,
                stats,
            }) => {
                input.stats = stats;
                reading.side = Some(input.side);
                if self.is_live {
                    let arrival = received_at
                        .saturating_duration_since(self.start)
                        .as_micros();
                    let time = reading.time.0 as i64;
                    let offset = *input.clock_offset.get_or_insert(arrival as i64 - time);
                    reading.time = Timestamp((time + offset).max(0) as u64).max(self.time);
                }
                Ok(Some(reading))
            }
            Some(CaptureEvent::Noise(stats)) => {
                input.stats = stats;
                Ok(None)
            }
            Some(CaptureEvent::Elapsed(_)) => Ok(None),
            Some(CaptureEvent::Lost(error)) => {
                input.stats.losses += 1;
                Err(error)
            }
            Some(CaptureEvent::Failed(error)) => {
                input.end();
                Err(error)
            }
            Some(CaptureEvent::End(stats)) => {
                input.stats = stats;
                input.end();
                Ok(None)
            }
            None => {
                input.end();
                Ok(None)
            }
        }
    }

    /// Waits for the next event of either source.
    fn next_arrival(&mut self) -> Result<Option<Reading>, CaptureError> {
        let [first, second] = self.inputs.each_ref().map(|input| input.events.clone());
        let (cancelled, timeout) = match &self.cancel {
            Some(cancel) => (cancel.channel().clone(), never()),
            None => (never(), after(MAX_BLOCK)),
        };
        select! {
            recv(first) -> event => self.handle(0, event.ok()),
            recv(second) -> event => self.handle(1, event.ok()),
            recv(cancelled) -> _ => Ok(None),
            recv(timeout) -> _ => Ok(None),
        }
    }

    /// Returns the earliest reading of both sources, once each has one or has ended.
    fn next_in_time(&mut self) -> Result<Option<Reading>, CaptureError> {
        for index in 0..self.inputs.len() {
            let input = &self.inputs[index];
            if input.head.is_some() || input.has_ended {
                continue;
            }
            let Ok(event) = input.events.recv_timeout(MAX_BLOCK) else {
                return Ok(None);
            };
            self.inputs[index].head = self.handle(index, Some(event))?;
        }
        let heads = self.inputs.iter_mut().map(|input| &mut input.head);
        let earliest = heads
            .filter(|head| head.is_some())
            .min_by_key(|head| head.as_ref().map(|reading| reading.time));
        Ok(earliest.and_then(Option::take))
    }
}

impl Source for MergedSource {
    fn next(&mut self) -> Result<SourceEvent, CaptureError> {
        let reading = match self.is_live {
            true => self.next_arrival()?,
            false => self.next_in_time()?,
        };
        if let Some(reading) = reading {
            self.time = reading.time;
            return Ok(SourceEvent::Reading(reading));
        }
        let has_ended = |input: &MergedInput| input.has_ended && input.head.is_none();
        match self.inputs.iter().all(has_ended) {
            true => Ok(SourceEvent::End),
            false => Ok(SourceEvent::Idle),
        }
    }

    fn set_cancel_token(&mut self, cancel: &CancelToken) {
        self.cancel = Some(cancel.clone());
    }

    fn name(&self) -> &str {
        &self.name
    }

    /// Returns the period of the slower source.
    fn packet_period(&self) -> Option<Duration> {
        let periods = self.inputs.iter().map(|input| input.packet_period);
        periods.flatten().max()
    }

    fn is_live(&self) -> bool {
        self.is_live
    }

    fn stats(&self) -> SourceStats {
        let [first, second] = self.inputs.each_ref().map(|input| input.stats);
        SourceStats {
            bytes: first.bytes + second.bytes,
            skipped_bytes: first.skipped_bytes + second.skipped_bytes,
            resyncs: first.resyncs + second.resyncs,
            invalid: first.invalid + second.invalid,
            readings: first.readings + second.readings,
            dropped: first.dropped + second.dropped,
            losses: first.losses + second.losses,
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::capture::{Channels, Sample};

    /// Source with a name and readings at these times, in microseconds. One named `live` is live.
    struct TimedSource(&'static str, Vec<u64>);

    impl Source for TimedSource {
        fn next(&mut self) -> Result<SourceEvent, CaptureError> {
            if self.1.is_empty() {
                return Ok(SourceEvent::End);
            }
            Ok(SourceEvent::Reading(Reading::new(
                Timestamp(self.1.remove(0)),
                None,
                Sample::Channels(Channels {
                    full_scale: 255,
                    counts: Default::default(),
                }),
            )))
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

    fn merge(left: TimedSource, right: TimedSource) -> (Vec<(Side, u64)>, MergedSource) {
        let sources: [(Side, Box<dyn Source>); 2] =
            [(Side::Left, Box::new(left)), (Side::Right, Box::new(right))];
        let mut merged = MergedSource::start(sources).unwrap();
        let mut readings = Vec::new();
        loop {
            match merged.next().unwrap() {
                SourceEvent::Reading(reading) => {
                    readings.push((reading.side.unwrap(), reading.time.0));
                }
                SourceEvent::Idle => {}
                SourceEvent::End => return (readings, merged),
            }
        }
    }

    #[test]
    fn recordings_of_two_hands_are_merged_in_order_of_time() {
        let left = TimedSource("a", vec![10, 30, 31]);
        let right = TimedSource("b", vec![20, 30, 50, 60]);
        let (readings, merged) = merge(left, right);
        let expected = [
            (Side::Left, 10),
            (Side::Right, 20),
            (Side::Left, 30),
            (Side::Right, 30),
            (Side::Left, 31),
            (Side::Right, 50),
            (Side::Right, 60),
        ];
        assert_eq!(readings, expected);
        assert_eq!((merged.name(), merged.stats().readings), ("a and b", 2));
    }

    #[test]
    fn live_sources_share_a_clock_that_never_decreases() {
        let left = TimedSource("live", vec![5_000_000, 5_000_100, 5_000_200]);
        let right = TimedSource("live", vec![7, 8, 9]);
        let (readings, _) = merge(left, right);
        assert_eq!(readings.len(), 6);
        assert!(
            readings.windows(2).all(|pair| pair[0].1 <= pair[1].1),
            "{readings:?}"
        );
        assert!(
            readings[5].1 < 4_000_000,
            "not the time since the start: {readings:?}"
        );
    }
}
