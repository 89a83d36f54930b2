use std::sync::Arc;
use std::sync::atomic::{AtomicU64, Ordering};

use super::*;
use crate::capture::{InvalidPacket, Sample};

/// Longest wait on a busy machine.
const TIMEOUT: Duration = Duration::from_secs(60);

/// Source with a name and readings at these times, in microseconds. One named `live` is live.
struct TimedSource(&'static str, Vec<u64>);

impl Source for TimedSource {
    fn next(&mut self) -> Result<SourceEvent, CaptureError> {
        if self.1.is_empty() {
            return Ok(SourceEvent::End);
        }
        Ok(empty_reading(self.1.remove(0)))
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

fn start(left: impl Source + 'static, right: impl Source + 'static) -> MergedSource {
    let sources: [(Side, Box<dyn Source>); 2] =
        [(Side::Left, Box::new(left)), (Side::Right, Box::new(right))];
    let sources = sources.map(|(side, source)| PartialSource {
        source,
        side: Some(side),
        part: None,
        delay: Duration::ZERO,
    });
    MergedSource::start(sources.into_iter().collect()).unwrap()
}

fn merge(left: TimedSource, right: TimedSource) -> (Vec<(Side, u64)>, MergedSource) {
    let mut merged = start(left, right);
    let mut readings = Vec::new();
    let start = Instant::now();
    loop {
        assert!(start.elapsed() < TIMEOUT, "no end: {readings:?}");
        match merged.next().unwrap() {
            SourceEvent::Reading(reading) => {
                readings.push((reading.side.unwrap(), reading.time.0));
            }
            SourceEvent::Idle | SourceEvent::Command(_) => {}
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
fn recordings_whose_threads_have_ended_without_a_message_end() {
    let many = || (0..10_000).collect();
    let mut merged = start(TimedSource("a", many()), TimedSource("b", many()));
    merged.stop();
    assert!(matches!(merged.next(), Ok(SourceEvent::End)));
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

#[test]
fn a_recording_beside_a_live_source_keeps_its_pace() {
    let live = TimedSource("live", vec![0]);
    let recording = TimedSource("recording", vec![0, 1_000_000]);
    let (readings, _) = merge(live, recording);
    let of_recording = readings.iter().filter(|(side, _)| *side == Side::Right);
    let times: Vec<u64> = of_recording.map(|(_, time)| *time).collect();
    let [first, second] = times[..] else {
        panic!("{readings:?}")
    };
    assert!(second - first > 500_000, "{times:?}");
}

#[test]
fn no_two_live_readings_of_a_hand_have_the_same_time_although_the_other_hand_overtakes_it() {
    // Their own clocks are slower than the arrival, so that each hand is behind whenever the other one has a reading.
    let times = || (0..300).collect();
    let (readings, _) = merge(TimedSource("live", times()), TimedSource("live", times()));
    for side in [Side::Left, Side::Right] {
        let of_side = readings.iter().filter(|(other, _)| *other == side);
        let of_side: Vec<_> = of_side.map(|(_, time)| *time).collect();
        assert!(of_side.len() > 10, "{of_side:?}");
        assert!(
            of_side.windows(2).all(|pair| pair[0] < pair[1]),
            "{of_side:?}"
        );
    }
}

/// Live source that gives events at once and then waits.
struct PartSource(Vec<Result<u64, CaptureError>>);

impl Source for PartSource {
    fn next(&mut self) -> Result<SourceEvent, CaptureError> {
        if self.0.is_empty() {
            std::thread::sleep(Duration::from_millis(1));
            return Ok(SourceEvent::Idle);
        }
        Ok(empty_reading(self.0.remove(0)?))
    }

    fn name(&self) -> &str {
        "part"
    }
}

/// Merges a fast source of fingers and a source of the arm that is late by `delay`.
fn merge_parts(
    fingers: Vec<Result<u64, CaptureError>>,
    arm: Vec<Result<u64, CaptureError>>,
    delay: Duration,
) -> MergedSource {
    let parts = [
        (HandPart::Fingers, fingers, Duration::ZERO),
        (HandPart::Arm, arm, delay),
    ];
    let parts = parts.map(|(part, events, part_delay)| PartialSource {
        source: Box::new(PartSource(events)),
        side: Some(Side::Right),
        part: Some(part),
        delay: part_delay,
    });
    MergedSource::start(parts.into_iter().collect()).unwrap()
}

#[test]
fn a_fast_source_waits_for_the_moment_that_a_late_source_shows() {
    // A busy machine may start the thread of one source late.
    let delay = Duration::from_secs(3);
    let mut merged = merge_parts(vec![Ok(7), Ok(8)], vec![Ok(100)], delay);
    let mut readings = Vec::new();
    let start = Instant::now();
    while readings.len() < 3 {
        assert!(start.elapsed() < TIMEOUT, "{readings:?}");
        if let SourceEvent::Reading(reading) = merged.next().unwrap() {
            readings.push(reading);
        }
    }
    let parts: Vec<_> = readings
        .iter()
        .map(|reading| reading.part.unwrap())
        .collect();
    assert_eq!(parts, [HandPart::Arm, HandPart::Fingers, HandPart::Fingers]);
    // All arrived at the start, so that the fingers show a moment that is later by the delay.
    let between = readings[1].time.since(readings[0].time);
    assert!(between > Duration::from_secs(1), "{between:?}");
    assert!(readings[2].time > readings[1].time);
    assert!(
        readings
            .iter()
            .all(|reading| reading.side == Some(Side::Right))
    );
}

#[test]
fn the_loss_of_a_source_names_its_part_and_the_other_continues() {
    let lost = CaptureError::Lost {
        source_name: "tcp:camera:4001".into(),
        reason: "connection closed".into(),
    };
    let mut merged = merge_parts(vec![Ok(7)], vec![Err(lost), Ok(8)], Duration::ZERO);
    let (mut readings, mut losses) = (Vec::new(), Vec::new());
    let start = Instant::now();
    while readings.len() < 2 || losses.is_empty() {
        assert!(start.elapsed() < TIMEOUT, "{readings:?}, {losses:?}");
        match merged.next() {
            Ok(SourceEvent::Reading(reading)) => readings.push(reading.part),
            Ok(_) => {}
            Err(error) => losses.push(error),
        }
    }
    readings.sort_by_key(|part| part.map(HandPart::index));
    assert_eq!(readings, [Some(HandPart::Arm), Some(HandPart::Fingers)]);
    let [error] = losses.as_slice() else {
        panic!("{losses:?}");
    };
    assert!(error.is_recoverable());
    assert_eq!(error.source_name(), "tcp:camera:4001");
    assert_eq!(
        error.to_string(),
        "lost tcp:camera:4001: connection closed; reconnecting"
    );
    let CaptureError::PartLost { side, part, .. } = error else {
        panic!("{error:?}");
    };
    assert_eq!((*side, *part), (Some(Side::Right), Some(HandPart::Arm)));
}

/// Readings of a hand without pauses, until the other hand has ended.
struct Flood(u64, Arc<AtomicU64>);

/// Readings of a hand whose consumer has received all but four of them.
struct Steady {
    sent: u64,
    received: Arc<AtomicU64>,
    started_at: Instant,
}

const STEADY_READINGS: u64 = 100;

fn empty_reading(time: u64) -> SourceEvent {
    let angles = Default::default();
    SourceEvent::Reading(Reading::new(
        Timestamp(time),
        None,
        Sample::Angles { angles },
    ))
}

impl Source for Flood {
    fn next(&mut self) -> Result<SourceEvent, CaptureError> {
        self.0 += 1;
        match self.1.load(Ordering::Relaxed) {
            STEADY_READINGS.. => Ok(SourceEvent::End),
            _ => Ok(empty_reading(self.0)),
        }
    }

    fn name(&self) -> &str {
        "flood"
    }
}

impl Source for Steady {
    fn next(&mut self) -> Result<SourceEvent, CaptureError> {
        let received = self.received.load(Ordering::Relaxed);
        if self.sent == STEADY_READINGS || self.started_at.elapsed() > Duration::from_secs(60) {
            self.received.store(STEADY_READINGS, Ordering::Relaxed);
            return Ok(SourceEvent::End);
        }
        if self.sent >= received + 4 {
            std::thread::sleep(Duration::from_millis(1));
            return Ok(SourceEvent::Idle);
        }
        self.sent += 1;
        Ok(empty_reading(self.sent))
    }

    fn name(&self) -> &str {
        "steady"
    }
}

#[test]
fn a_slow_consumer_receives_every_reading_of_a_hand_beside_one_that_floods() {
    let received = Arc::new(AtomicU64::new(0));
    let steady = Steady {
        sent: 0,
        received: received.clone(),
        started_at: Instant::now(),
    };
    let merged = start(Flood(0, received.clone()), steady);
    let capture = spawn(merged).unwrap();
    let (mut calm, mut flooded, mut dropped) = (0, 0, 0);
    for event in capture.events() {
        match event {
            CaptureEvent::Reading { reading, .. } if reading.side == Some(Side::Right) => {
                calm += 1;
                received.fetch_max(calm, Ordering::Relaxed);
            }
            CaptureEvent::Reading { .. } => flooded += 1,
            CaptureEvent::End(stats) => dropped = stats.dropped,
            _ => continue,
        }
        std::thread::sleep(Duration::from_millis(1));
    }
    assert_eq!(calm, STEADY_READINGS, "beside {flooded} readings");
    assert!(dropped > STEADY_READINGS, "{dropped}");
}

/// A source without readings that has refused this number of packets.
struct Refused(Arc<AtomicU64>);

impl Source for Refused {
    fn next(&mut self) -> Result<SourceEvent, CaptureError> {
        std::thread::sleep(Duration::from_millis(1));
        Ok(SourceEvent::Idle)
    }

    fn name(&self) -> &str {
        "refused"
    }

    fn stats(&self) -> SourceStats {
        let mut stats = SourceStats::default();
        for _ in 0..self.0.load(Ordering::Relaxed) {
            stats.invalid.count(InvalidPacket::Truncated);
        }
        stats
    }
}

/// Merges the fingers and the arm, which have refused these numbers of packets.
fn merged_refusals(refused: [&Arc<AtomicU64>; 2]) -> MergedSource {
    let sources = HandPart::ALL.iter().zip(refused);
    let sources = sources.map(|(&part, count)| PartialSource {
        source: Box::new(Refused(Arc::clone(count))) as Box<dyn Source>,
        side: Some(Side::Right),
        part: Some(part),
        delay: Duration::ZERO,
    });
    MergedSource::start(sources.collect()).unwrap()
}

fn refused_packets(event: &CaptureEvent) -> u64 {
    match event {
        CaptureEvent::Noise(stats) => stats.invalid.get(InvalidPacket::Truncated),
        other => panic!("{other:?}"),
    }
}

#[test]
fn packets_that_parts_refused_before_a_stop_are_in_the_last_statistics() {
    let (fingers, arm) = (Arc::default(), Arc::default());
    let mut capture = spawn(merged_refusals([&fingers, &arm])).unwrap();
    fingers.store(3, Ordering::Relaxed);
    arm.store(4, Ordering::Relaxed);
    capture.stop();
    let last = capture.events().iter().last().expect("an event");
    assert_eq!(refused_packets(&last), 7);
}

#[test]
fn packets_that_a_part_refused_are_reported_without_another_event() {
    let (fingers, arm) = (Arc::new(AtomicU64::new(1)), Arc::default());
    let merged = merged_refusals([&fingers, &arm]);
    // The part reports when the next report of the merged source is not due yet.
    std::thread::sleep(Duration::from_millis(200));
    let capture = spawn(merged).unwrap();
    let event = capture.events().recv_timeout(Duration::from_secs(60));
    assert_eq!(refused_packets(&event.expect("a report")), 1);
}
