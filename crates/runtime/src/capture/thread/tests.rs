//! Tests of the events that a consumer receives, in order.

use std::sync::atomic::{AtomicBool, Ordering};
use std::time::Instant;

use super::*;
use crate::capture::event::NOISE_INTERVAL;
use crate::capture::event_queue::QUEUE_CAPACITY;
#[cfg(target_os = "linux")]
use crate::capture::suspend::SuspendDetector;
use crate::capture::{Reading, Sample, SourceEvent, SourceStats};
use crate::output::tests::wait_until;
use ademan_core::command::Command;
use ademan_core::time::Timestamp;

const TIMEOUT: Duration = Duration::from_secs(60);

fn reading(number: u64) -> SourceEvent {
    let angles = Default::default();
    let reading = Reading::new(Timestamp(number), None, Sample::Angles { angles });
    SourceEvent::Reading(reading)
}

fn lost() -> CaptureError {
    CaptureError::Lost {
        source_name: "script".to_owned(),
        reason: "cable out".to_owned(),
    }
}

type Step = fn(u64) -> Result<SourceEvent, CaptureError>;

/// Source that returns `step(0)`, `step(1)`, …; after `steps` it sends to `done` and is idle.
struct ScriptedSource {
    step: Step,
    steps: u64,
    next_step: u64,
    is_live: bool,
    done: Sender<()>,
}

fn scripted(steps: u64, is_live: bool, step: Step) -> (ScriptedSource, Receiver<()>) {
    let (done, is_done) = bounded(1);
    let source = ScriptedSource {
        step,
        steps,
        next_step: 0,
        is_live,
        done,
    };
    (source, is_done)
}

impl Source for ScriptedSource {
    fn next(&mut self) -> Result<SourceEvent, CaptureError> {
        if self.next_step == self.steps {
            let _ = self.done.try_send(());
            std::thread::sleep(Duration::from_millis(5));
            return Ok(SourceEvent::Idle);
        }
        self.next_step += 1;
        (self.step)(self.next_step - 1)
    }

    fn name(&self) -> &str {
        "script"
    }

    fn is_live(&self) -> bool {
        self.is_live
    }

    fn stats(&self) -> SourceStats {
        SourceStats {
            readings: self.next_step,
            ..SourceStats::default()
        }
    }
}

/// Formats an event; a reading is its number and the readings dropped before it.
fn brief(event: CaptureEvent) -> String {
    match event {
        CaptureEvent::Reading { reading, stats, .. } => {
            format!("{}({})", reading.time.0, stats.dropped)
        }
        CaptureEvent::Readings { readings, .. } => {
            let numbers = readings.iter().map(|reading| reading.time.0.to_string());
            numbers.collect::<Vec<_>>().join(" ")
        }
        CaptureEvent::Command(command) => command.to_string(),
        CaptureEvent::Elapsed(_) => "elapsed".to_owned(),
        CaptureEvent::Noise(_) => "noise".to_owned(),
        CaptureEvent::Lost(_) => "lost".to_owned(),
        CaptureEvent::Failed(error) => format!("failed: {error}"),
        CaptureEvent::End(_) => "end".to_owned(),
    }
}

fn queued(capture: &CaptureThread) -> Vec<String> {
    capture.events().try_iter().map(brief).collect()
}

#[test]
fn a_live_source_drops_its_oldest_readings_and_counts_them() {
    let (source, done) = scripted(100, true, |step| Ok(reading(step)));
    let capture = spawn(source).unwrap();
    done.recv_timeout(TIMEOUT).unwrap();
    let events = queued(&capture);
    assert_eq!(events.len(), QUEUE_CAPACITY);
    assert_eq!(events[0], "84(69)");
    assert_eq!(events[15], "99(84)");
}

#[test]
fn a_loss_is_never_dropped_and_stays_before_later_readings() {
    let (source, done) = scripted(41, true, |step| match step {
        10 | 20 => Err(lost()),
        step => Ok(reading(step)),
    });
    let capture = spawn(source).unwrap();
    done.recv_timeout(TIMEOUT).unwrap();
    let events = queued(&capture);
    assert_eq!(events[0], "lost");
    assert!(!events[1..].contains(&"lost".to_owned()));
    let readings = events.len() as u64 - 1;
    assert_eq!(events.last().unwrap(), &format!("40({})", 39 - readings));
}

#[test]
fn a_recording_waits_for_a_slow_consumer() {
    let (source, _done) = scripted(100, false, |step| match step {
        99 => Ok(SourceEvent::End),
        step => Ok(reading(step)),
    });
    let capture = spawn(source).unwrap();
    std::thread::sleep(Duration::from_millis(30));
    let events: Vec<String> = capture.events().iter().map(brief).collect();
    let expected: Vec<String> = (0..99).map(|step| format!("{step}(0)")).collect();
    assert_eq!(events[..99], expected);
    assert_eq!(events[99..], ["end"]);
}

/// A source that has everything ready, as a recording.
struct ReadySource(ScriptedSource);

impl Source for ReadySource {
    fn next(&mut self) -> Result<SourceEvent, CaptureError> {
        self.0.next()
    }

    fn name(&self) -> &str {
        self.0.name()
    }

    fn is_live(&self) -> bool {
        false
    }

    fn is_ready(&self) -> bool {
        self.0.next_step < self.0.steps
    }

    fn stats(&self) -> SourceStats {
        self.0.stats()
    }
}

#[test]
fn readings_that_are_ready_come_together_in_their_order() {
    let (source, _done) = scripted(140, false, |step| match step {
        70 => Ok(SourceEvent::Command(Command::Recenter)),
        139 => Ok(SourceEvent::End),
        step => Ok(reading(step)),
    });
    let capture = spawn_batched(ReadySource(source)).unwrap();
    let events: Vec<CaptureEvent> = capture.events().iter().collect();
    let mut readings = 0;
    for event in &events {
        if let CaptureEvent::Readings {
            readings: together,
            stats,
            ..
        } = event
        {
            readings += together.len() as u64;
            let last = together.last().expect("it is not empty").time.0;
            assert_eq!(
                stats.readings,
                last + 1,
                "statistics up to the last reading"
            );
        }
    }
    assert_eq!(readings, 138);
    let numbers = |range: std::ops::Range<u64>| {
        let numbers: Vec<String> = range.map(|number| number.to_string()).collect();
        numbers.join(" ")
    };
    let events: Vec<String> = events.into_iter().map(brief).collect();
    let expected = [
        numbers(0..64),
        numbers(64..70),
        "recenter".to_owned(),
        numbers(71..135),
        numbers(135..139),
        "end".to_owned(),
    ];
    assert_eq!(events, expected);
}

#[test]
fn dropping_stops_a_thread_that_waits_for_room() {
    let (source, _done) = scripted(100, false, |step| Ok(reading(step)));
    let capture = spawn(source).unwrap();
    wait_until("a full queue", || capture.events().len() >= QUEUE_CAPACITY);
    let ended = capture.ended.clone();
    drop(capture);
    assert_eq!(
        ended.recv_timeout(TIMEOUT),
        Err(crossbeam_channel::RecvTimeoutError::Disconnected)
    );
}

#[test]
fn dropping_leaves_a_blocked_thread_behind() {
    static BLOCKS: AtomicBool = AtomicBool::new(false);
    static GOES_ON: AtomicBool = AtomicBool::new(false);
    let (source, _done) = scripted(1, true, |_| {
        BLOCKS.store(true, Ordering::SeqCst);
        std::thread::sleep(Duration::from_secs(60));
        GOES_ON.store(true, Ordering::SeqCst);
        Ok(SourceEvent::Idle)
    });
    let capture = spawn(source).unwrap();
    wait_until("a read", || BLOCKS.load(Ordering::SeqCst));
    drop(capture);
    assert!(!GOES_ON.load(Ordering::SeqCst));
}

#[cfg(target_os = "linux")]
#[test]
fn a_suspend_is_a_loss_of_a_live_source_before_the_next_reading() {
    use std::sync::atomic::AtomicU64;

    use crate::capture::suspend::monotonic;

    static SUSPENDED_S: AtomicU64 = AtomicU64::new(0);
    for is_live in [true, false] {
        let (source, _done) = scripted(4, is_live, |step| {
            if step == 2 {
                SUSPENDED_S.fetch_add(3600, Ordering::SeqCst);
            }
            match step {
                3 => Ok(SourceEvent::End),
                step => Ok(reading(step)),
            }
        });
        let suspend = SuspendDetector::with_clock(|| {
            monotonic() + Duration::from_secs(SUSPENDED_S.load(Ordering::SeqCst))
        });
        let mut source = EventSource::new(source).with_suspend_detector(suspend);
        let mut events = Vec::new();
        while source.next(&mut |event| events.push(event)) {}
        let is_end = |event: &CaptureEvent| matches!(event, CaptureEvent::End(stats) if stats.losses == u64::from(is_live));
        assert!(events.iter().any(is_end), "{events:?}");
        let events: Vec<String> = events.into_iter().map(brief).collect();
        let expected: &[&str] = if is_live {
            &["0(0)", "1(0)", "lost", "2(0)", "end"]
        } else {
            &["0(0)", "1(0)", "2(0)", "end"]
        };
        assert_eq!(events, expected);
    }
}

#[test]
fn a_panic_of_the_source_is_a_failure() {
    let (source, _done) = scripted(2, true, |step| match step {
        0 => Ok(reading(0)),
        _ => panic!("bad count"),
    });
    let capture = spawn(source).unwrap();
    let events: Vec<String> = capture.events().iter().map(brief).collect();
    assert_eq!(events[0], "0(0)");
    assert_eq!(
        events[1..],
        ["failed: cannot use script: it panicked: bad count; please report this"]
    );
}

#[test]
fn a_failed_source_ends_the_channel() {
    let (source, _done) = scripted(1, true, |_| {
        Err(CaptureError::Malformed {
            source_name: "script".to_owned(),
            reason: "half a file".to_owned(),
        })
    });
    let capture = spawn(source).unwrap();
    let events: Vec<String> = capture.events().iter().map(brief).collect();
    assert_eq!(events, ["failed: cannot use script: half a file"]);
}

/// Source that receives 700 bytes of noise.
struct NoiseSource(u64);

impl Source for NoiseSource {
    fn next(&mut self) -> Result<SourceEvent, CaptureError> {
        std::thread::sleep(Duration::from_millis(1));
        self.0 += u64::from(self.0 < 700);
        Ok(SourceEvent::Idle)
    }

    fn name(&self) -> &str {
        "noise"
    }

    fn stats(&self) -> SourceStats {
        SourceStats {
            bytes: self.0,
            skipped_bytes: self.0,
            ..SourceStats::default()
        }
    }
}

#[test]
fn noise_is_reported_at_most_twice_a_second_and_silence_is_not() {
    let start = Instant::now();
    let capture = spawn(NoiseSource(0)).unwrap();
    let mut reports = Vec::new();
    while reports.last() != Some(&700) {
        let event = capture.events().recv_timeout(TIMEOUT).unwrap();
        let CaptureEvent::Noise(stats) = event else {
            panic!("not noise: {event:?}");
        };
        assert_eq!(stats.skipped_bytes, stats.bytes);
        reports.push(stats.bytes);
    }
    let intervals = start.elapsed().as_millis() / NOISE_INTERVAL.as_millis();
    assert!(reports.len() as u128 <= intervals, "{reports:?}");
    let more = capture.events().recv_timeout(2 * NOISE_INTERVAL);
    assert!(more.is_err(), "{more:?}");
}
