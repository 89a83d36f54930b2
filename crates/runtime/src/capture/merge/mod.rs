//! Merging of several sources: of both hands, or of the arm and the fingers of a hand.

#[cfg(test)]
mod tests;

use std::collections::VecDeque;
use std::time::{Duration, Instant};

use arrayvec::ArrayVec;
use crossbeam_channel::{Receiver, RecvTimeoutError, never, select};

use super::clock_offset::ClockOffset;
use super::event::NOISE_INTERVAL;
use super::feedback::FeedbackDevice;
use super::{
    CancelToken, CaptureError, CaptureEvent, CaptureThread, HeadsetList, MAX_BLOCK, PacedSource,
    Reading, Source, SourceEvent, SourceStats, spawn,
};
use ademan_core::hand::{HandPart, Side};
use ademan_core::time::{NO_DEADLINE, Timestamp};

/// Maximum number of sources that are merged: the arm and the fingers of both hands.
pub const MAX_SOURCES: usize = Side::COUNT * HandPart::COUNT;

/// Maximum number of readings of a source that are held back: 0.5 s at 1 kHz.
const MAX_HELD: usize = 512;

/// A source with the part of a hand that it measures and the delay of its readings.
pub struct PartialSource {
    /// The source.
    pub source: Box<dyn Source>,
    /// The hand. `None` if its readings have a side of their own.
    pub side: Option<Side>,
    /// The part of the hand that counts; `None` for all of it.
    pub part: Option<HandPart>,
    /// Time from a movement to the arrival of its reading.
    pub delay: Duration,
}

/// The readings of several sources as one source.
///
/// Each source runs on its own thread. Live readings are merged in the order of the movements that they show: the clock of
/// each source is shifted to the clock of arrival, and the readings of a source with a short delay are held back until the
/// source with the longest delay shows the same moment. Other readings, such as readings of recordings, are merged in order
/// of their own times; beside a live source they are returned at their own pace. The loss of a source is the loss of its part only; see
/// [`CaptureError::PartLost`]. The stream ends when all sources have ended.
pub struct MergedSource {
    name: String,
    is_live: bool,
    start: Instant,
    inputs: ArrayVec<MergedInput, MAX_SOURCES>,
    /// The headsets of the first source that has any.
    headsets: Option<HeadsetList>,
    /// Time of the latest reading. Times never decrease, and the times of each part increase.
    time: Timestamp,
    cancel: Option<CancelToken>,
    /// Time at which a call returns although no reading is due, so that packets that were refused since the last reading are reported.
    report_at: Option<Instant>,
}

struct MergedInput {
    side: Option<Side>,
    part: Option<HandPart>,
    /// Time by which its readings are held back.
    hold: Duration,
    packet_period: Option<Duration>,
    events: Receiver<CaptureEvent>,
    clock_offset: ClockOffset,
    stats: SourceStats,
    /// Readings that were held back and then dropped.
    dropped: u64,
    /// Readings that wait for slower sources, each with the time at which it is due. For a source that is not live, the next reading,
    /// until it is the earliest of all sources.
    held: VecDeque<(Instant, Reading)>,
    has_ended: bool,
    feedback: Option<FeedbackDevice>,
    /// Stops the source when it is dropped.
    thread: CaptureThread,
}

impl MergedInput {
    /// Starts a source; `is_live` is `true` if any of the merged ones is live.
    fn start(
        mut source: PartialSource,
        longest_delay: Duration,
        is_live: bool,
    ) -> Result<Self, CaptureError> {
        let has_fingers = source.part != Some(HandPart::Arm);
        let side = source.side.filter(|_| has_fingers);
        let feedback = side.and_then(|side| source.source.take_feedback_device(side));
        let opened: Box<dyn Source> = if is_live && !source.source.is_live() {
            // At the speed of the disk, all of its readings would show the present moment.
            Box::new(PacedSource::new(source.source, 1.0))
        } else {
            source.source
        };
        let thread = spawn(opened)?;
        Ok(Self {
            side: source.side,
            part: source.part,
            hold: longest_delay - source.delay,
            packet_period: thread.packet_period(),
            events: thread.events().clone(),
            clock_offset: ClockOffset::default(),
            stats: SourceStats::default(),
            dropped: 0,
            held: VecDeque::with_capacity(MAX_HELD),
            has_ended: false,
            feedback,
            thread,
        })
    }

    /// Handles an event; `None` is a disconnected channel. `start` is the origin of the common clock, or `None` if readings
    /// keep their own.
    fn handle(
        &mut self,
        event: Option<CaptureEvent>,
        start: Option<Instant>,
    ) -> Result<(), CaptureError> {
        match event {
            Some(CaptureEvent::Reading {
                reading,
                received_at,
                stats,
            }) => {
                self.stats = stats;
                self.hold_back(reading, received_at, start);
            }
            Some(CaptureEvent::Noise(stats)) => self.stats = stats,
            // Only a recording has commands, and a recording is not merged, as it has both hands. `spawn` sends readings one by one.
            Some(
                CaptureEvent::Elapsed(_) | CaptureEvent::Command(_) | CaptureEvent::Readings { .. },
            ) => {}
            Some(CaptureEvent::Lost(error)) => {
                self.stats.losses += 1;
                self.drop_held();
                return Err(CaptureError::PartLost {
                    side: self.side,
                    part: self.part,
                    error: Box::new(error),
                });
            }
            Some(CaptureEvent::Failed(error)) => {
                self.end();
                return Err(error);
            }
            Some(CaptureEvent::End(stats)) => {
                self.stats = stats;
                self.end();
            }
            None => self.end(),
        }
        Ok(())
    }

    /// Sets the side, the part and the time on the common clock of a reading, and holds it until the slowest source shows the same
    /// moment.
    fn hold_back(&mut self, mut reading: Reading, received_at: Instant, start: Option<Instant>) {
        reading.side = reading.side.or(self.side);
        reading.part = self.part.or(reading.part);
        if let Some(start) = start {
            let arrival = received_at.saturating_duration_since(start).as_micros() as i64;
            let time = reading.time.0 as i64;
            let offset = self.clock_offset.update(arrival, time);
            reading.time = Timestamp((time + offset).max(0) as u64);
        }
        reading.time = reading.time + self.hold;
        if self.held.len() == MAX_HELD {
            self.held.pop_front();
            self.dropped += 1;
        }
        self.held.push_back((received_at + self.hold, reading));
    }

    fn due_at(&self) -> Option<Instant> {
        self.held.front().map(|(due_at, _)| *due_at)
    }

    fn time(&self) -> Option<Timestamp> {
        self.held.front().map(|(_, reading)| reading.time)
    }

    /// Stops the source and adopts its last statistics.
    fn stop(&mut self) {
        self.thread.stop();
        while let Ok(event) = self.events.try_recv() {
            // After the end, a loss has no effect.
            let _ = self.handle(Some(event), None);
        }
        self.drop_held();
    }

    fn drop_held(&mut self) {
        self.dropped += self.held.len() as u64;
        self.held.clear();
    }

    fn end(&mut self) {
        self.has_ended = true;
        self.events = never();
    }
}

impl MergedSource {
    /// Starts all sources.
    pub fn start(sources: ArrayVec<PartialSource, MAX_SOURCES>) -> Result<Self, CaptureError> {
        let names: Vec<_> = sources.iter().map(|it| it.source.name()).collect();
        let name = names.join(" and ");
        let is_live = sources.iter().any(|it| it.source.is_live());
        let headsets = sources.iter().find_map(|it| it.source.headsets());
        let delays = sources.iter().map(|it| it.delay);
        let longest_delay = delays.max().unwrap_or_default();
        let inputs = sources.into_iter();
        let inputs = inputs.map(|source| MergedInput::start(source, longest_delay, is_live));
        Ok(Self {
            name,
            is_live,
            start: Instant::now(),
            inputs: inputs.collect::<Result<_, _>>()?,
            headsets,
            time: Timestamp::default(),
            cancel: None,
            report_at: None,
        })
    }

    /// Returns the reading that has been due for the longest time, or waits for the next event or due time.
    fn next_live(&mut self) -> Result<Option<Reading>, CaptureError> {
        let inputs = self.inputs.iter_mut();
        let next = inputs
            .filter_map(|input| Some((input.due_at()?, input)))
            .min_by_key(|(due_at, _)| *due_at);
        let now = Instant::now();
        let timeout = match next {
            Some((due_at, input)) if due_at <= now => {
                return Ok(input.held.pop_front().map(|(_, reading)| reading));
            }
            Some((due_at, _)) => due_at - now,
            None if self.cancel.is_some() => self.time_to_report(now),
            None => MAX_BLOCK,
        };
        self.wait(timeout)?;
        Ok(None)
    }

    /// Returns the time until the next report is due.
    fn time_to_report(&mut self, now: Instant) -> Duration {
        self.report_at = self.report_at.filter(|&at| at > now);
        self.report_at.map_or(NO_DEADLINE, |at| at - now)
    }

    /// Waits for an event of any source, at most for `timeout`, and handles it.
    fn wait(&mut self, timeout: Duration) -> Result<(), CaptureError> {
        let events = |index: usize| {
            let input = self.inputs.get(index);
            input.map_or_else(never, |input| input.events.clone())
        };
        let [first, second, third, fourth] = std::array::from_fn(events);
        let cancelled = self.cancel.as_ref();
        let cancelled = cancelled.map_or_else(never, |cancel| cancel.channel().clone());
        let (index, event) = select! {
            recv(first) -> event => (0, event.ok()),
            recv(second) -> event => (1, event.ok()),
            recv(third) -> event => (2, event.ok()),
            recv(fourth) -> event => (3, event.ok()),
            recv(cancelled) -> _ => return Ok(()),
            default(timeout) => return Ok(()),
        };
        if let Some(CaptureEvent::Noise(_)) = event {
            self.report_at = Some(Instant::now() + NOISE_INTERVAL);
        }
        self.inputs[index].handle(event, Some(self.start))
    }

    /// Returns the earliest reading of all sources, once each has one or has ended.
    fn next_in_time(&mut self) -> Result<Option<Reading>, CaptureError> {
        for input in &mut self.inputs {
            if !input.held.is_empty() || input.has_ended {
                continue;
            }
            let event = match input.events.recv_timeout(MAX_BLOCK) {
                Err(RecvTimeoutError::Timeout) => return Ok(None),
                event => event.ok(),
            };
            input.handle(event, None)?;
            if input.held.is_empty() && !input.has_ended {
                return Ok(None);
            }
        }
        let inputs = self.inputs.iter_mut();
        let earliest = inputs
            .filter(|input| !input.held.is_empty())
            .min_by_key(|input| input.time());
        let reading = earliest.and_then(|input| input.held.pop_front());
        Ok(reading.map(|(_, reading)| reading))
    }
}

impl Source for MergedSource {
    fn next(&mut self) -> Result<SourceEvent, CaptureError> {
        let reading = if self.is_live {
            self.next_live()?
        } else {
            self.next_in_time()?
        };
        if let Some(mut reading) = reading {
            // Readings of the parts of a hand must have different times, and so must live readings of a hand whose clock the other
            // hand's has overtaken.
            let is_later = self.is_live || reading.part.is_some();
            let earliest = self.time.0 + u64::from(is_later);
            reading.time = reading.time.max(Timestamp(earliest));
            self.time = reading.time;
            return Ok(SourceEvent::Reading(reading));
        }
        let has_ended = |input: &MergedInput| input.has_ended && input.held.is_empty();
        if self.inputs.iter().all(has_ended) {
            Ok(SourceEvent::End)
        } else {
            Ok(SourceEvent::Idle)
        }
    }

    fn set_cancel_token(&mut self, cancel: &CancelToken) {
        self.cancel = Some(cancel.clone());
    }

    fn take_feedback_device(&mut self, side: Side) -> Option<FeedbackDevice> {
        let mut inputs = self.inputs.iter_mut();
        let input = inputs.find(|input| input.side == Some(side) && input.feedback.is_some());
        input?.feedback.take()
    }

    fn headsets(&self) -> Option<HeadsetList> {
        self.headsets.clone()
    }

    fn name(&self) -> &str {
        &self.name
    }

    /// Stops all sources. Their readings that were not returned are dropped.
    fn stop(&mut self) {
        for input in &mut self.inputs {
            input.stop();
        }
    }

    /// Returns the period of the slowest source.
    fn packet_period(&self) -> Option<Duration> {
        let periods = self.inputs.iter().map(|input| input.packet_period);
        periods.flatten().max()
    }

    fn is_live(&self) -> bool {
        self.is_live
    }

    fn stats(&self) -> SourceStats {
        let stats = self.inputs.iter().map(|input| SourceStats {
            dropped: input.stats.dropped + input.dropped,
            ..input.stats
        });
        stats.fold(SourceStats::default(), |sum, stats| SourceStats {
            bytes: sum.bytes + stats.bytes,
            skipped_bytes: sum.skipped_bytes + stats.skipped_bytes,
            resyncs: sum.resyncs + stats.resyncs,
            invalid: sum.invalid + stats.invalid,
            readings: sum.readings + stats.readings,
            dropped: sum.dropped + stats.dropped,
            losses: sum.losses + stats.losses,
            left_out: sum.left_out + stats.left_out,
            sender_changes: sum.sender_changes + stats.sender_changes,
            cut_at: sum.cut_at.or(stats.cut_at),
        })
    }
}
