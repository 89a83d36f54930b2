//! What a consumer of a capture thread gets, in order.

use super::*;
use crate::capture::{Channels, Sample};
use crate::time::Timestamp;
use std::sync::atomic::{AtomicBool, Ordering};

const LIMIT: Duration = Duration::from_secs(10);

fn reading(number: u64) -> SourceEvent {
    SourceEvent::Reading(Reading {
        time: Timestamp(number),
        side: None,
        sample: Sample::Channels(Channels {
            full_scale: 255,
            counts: Default::default(),
        }),
    })
}

fn lost() -> CaptureError {
    CaptureError::Lost {
        source_name: "script".to_owned(),
        reason: "cable out".to_owned(),
    }
}

type Step = fn(u64) -> Result<SourceEvent, CaptureError>;

/// Runs `step` with 0, 1, 2, …; after `steps` it is quiet, and says so through `done`.
struct Script {
    step: Step,
    steps: u64,
    at: u64,
    is_live: bool,
    done: Sender<()>,
}

fn script(steps: u64, is_live: bool, step: Step) -> (Script, Receiver<()>) {
    let (done, is_done) = bounded(1);
    let script = Script {
        step,
        steps,
        at: 0,
        is_live,
        done,
    };
    (script, is_done)
}

impl Source for Script {
    fn next(&mut self) -> Result<SourceEvent, CaptureError> {
        if self.at == self.steps {
            let _ = self.done.try_send(());
            std::thread::sleep(Duration::from_millis(5));
            return Ok(SourceEvent::Idle);
        }
        self.at += 1;
        (self.step)(self.at - 1)
    }

    fn name(&self) -> &str {
        "script"
    }

    fn is_live(&self) -> bool {
        self.is_live
    }

    fn stats(&self) -> SourceStats {
        SourceStats {
            readings: self.at,
            ..SourceStats::default()
        }
    }
}

fn brief(arrival: CaptureEvent) -> String {
    match arrival {
        CaptureEvent::Reading {
            reading,
            stats: counts,
            ..
        } => {
            format!("{}({})", reading.time.0, counts.dropped)
        }
        CaptureEvent::Noise(_) => "noise".to_owned(),
        CaptureEvent::Lost(_) => "lost".to_owned(),
        CaptureEvent::Failed(error) => format!("failed: {error}"),
        CaptureEvent::End(_) => "end".to_owned(),
    }
}

fn everything(captured: &CaptureThread) -> Vec<String> {
    captured.events().try_iter().map(brief).collect()
}

#[test]
fn a_live_source_drops_its_oldest_readings_and_counts_them() {
    let (source, done) = script(100, true, |step| Ok(reading(step)));
    let captured = spawn(source).unwrap();
    done.recv_timeout(LIMIT).unwrap();
    let arrived = everything(&captured);
    assert_eq!(arrived.len(), WAITING_ARRIVALS);
    assert_eq!(arrived[0], "84(69)");
    assert_eq!(arrived[15], "99(84)");
}

#[test]
fn a_loss_is_never_superseded_and_keeps_its_place() {
    let (source, done) = script(41, true, |step| match step {
        10 | 20 => Err(lost()),
        step => Ok(reading(step)),
    });
    let captured = spawn(source).unwrap();
    done.recv_timeout(LIMIT).unwrap();
    let arrived = everything(&captured);
    assert_eq!(arrived[0], "lost");
    assert!(!arrived[1..].contains(&"lost".to_owned()));
    let readings = arrived.len() as u64 - 1;
    assert_eq!(arrived.last().unwrap(), &format!("40({})", 39 - readings));
}

#[test]
fn a_recording_waits_until_its_readings_are_taken() {
    let (source, _done) = script(100, false, |step| match step {
        99 => Ok(SourceEvent::End),
        step => Ok(reading(step)),
    });
    let captured = spawn(source).unwrap();
    std::thread::sleep(Duration::from_millis(30));
    let arrived: Vec<String> = captured.events().iter().map(brief).collect();
    let expected: Vec<String> = (0..99).map(|step| format!("{step}(0)")).collect();
    assert_eq!(arrived[..99], expected);
    assert_eq!(arrived[99..], ["end"]);
}

#[test]
fn dropping_stops_a_thread_that_waits_for_room() {
    let (source, _done) = script(100, false, |step| Ok(reading(step)));
    let captured = spawn(source).unwrap();
    while captured.events().len() < WAITING_ARRIVALS {
        std::thread::yield_now();
    }
    let over = captured.over.clone();
    drop(captured);
    assert_eq!(
        over.try_recv(),
        Err(crossbeam_channel::TryRecvError::Disconnected)
    );
}

#[test]
fn dropping_leaves_a_thread_behind_that_blocks() {
    static BLOCKS: AtomicBool = AtomicBool::new(false);
    let (source, _done) = script(1, true, |_| {
        BLOCKS.store(true, Ordering::SeqCst);
        std::thread::sleep(Duration::from_secs(5));
        Ok(SourceEvent::Idle)
    });
    let captured = spawn(source).unwrap();
    while !BLOCKS.load(Ordering::SeqCst) {
        std::thread::yield_now();
    }
    let start = Instant::now();
    drop(captured);
    assert!(start.elapsed() < Duration::from_secs(4));
}

#[cfg(target_os = "linux")]
#[test]
fn a_machine_that_slept_loses_its_live_sources_before_the_next_reading() {
    use std::sync::atomic::AtomicU64;
    static ASLEEP: AtomicU64 = AtomicU64::new(0);
    for is_live in [true, false] {
        let (source, _done) = script(4, is_live, |step| {
            if step == 2 {
                ASLEEP.fetch_add(3600, Ordering::SeqCst);
            }
            match step {
                3 => Ok(SourceEvent::End),
                step => Ok(reading(step)),
            }
        });
        let mut awake =
            SuspendDetector::with_clock(|| Duration::from_secs(ASLEEP.load(Ordering::SeqCst)));
        let (sender, waiting) = bounded(WAITING_ARRIVALS);
        let (_bell, interrupt) = cancel_token().unwrap();
        let mut outlet = Outlet {
            sender,
            waiting: waiting.clone(),
            is_live,
            interrupt,
            superseded: 0,
            waiter: Waiter(std::thread::current()),
        };
        run(source, &mut awake, &mut outlet);
        let arrivals: Vec<CaptureEvent> = waiting.try_iter().collect();
        let counted = |arrival: &CaptureEvent| matches!(arrival, CaptureEvent::End(counts) if counts.losses == u64::from(is_live));
        assert!(arrivals.iter().any(counted), "{arrivals:?}");
        let arrived: Vec<String> = arrivals.into_iter().map(brief).collect();
        let expected: &[&str] = match is_live {
            true => &["0(0)", "1(0)", "lost", "2(0)", "end"],
            false => &["0(0)", "1(0)", "2(0)", "end"],
        };
        assert_eq!(arrived, expected);
    }
}

#[test]
fn a_panic_of_the_source_arrives_as_a_failure() {
    let (source, _done) = script(2, true, |step| match step {
        0 => Ok(reading(0)),
        _ => panic!("bad count"),
    });
    let captured = spawn(source).unwrap();
    let arrived: Vec<String> = captured.events().iter().map(brief).collect();
    assert_eq!(arrived[0], "0(0)");
    assert_eq!(
        arrived[1..],
        ["failed: cannot use script: it panicked: bad count; please report this"]
    );
}

#[test]
fn a_source_that_gives_up_ends_the_channel() {
    let (source, _done) = script(1, true, |_| {
        Err(CaptureError::Malformed {
            source_name: "script".to_owned(),
            reason: "half a file".to_owned(),
        })
    });
    let captured = spawn(source).unwrap();
    let arrived: Vec<String> = captured.events().iter().map(brief).collect();
    assert_eq!(arrived, ["failed: cannot use script: half a file"]);
}

/// A line on which nothing but noise comes.
struct Hiss(u64);

impl Source for Hiss {
    fn next(&mut self) -> Result<SourceEvent, CaptureError> {
        std::thread::sleep(Duration::from_millis(1));
        self.0 += u64::from(self.0 < 700);
        Ok(SourceEvent::Idle)
    }

    fn name(&self) -> &str {
        "hiss"
    }

    fn is_live(&self) -> bool {
        true
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
fn bytes_that_are_no_readings_are_told_of_now_and_then_and_silence_is_not() {
    let start = Instant::now();
    let captured = spawn(Hiss(0)).unwrap();
    let next = || captured.events().recv_timeout(LIMIT).unwrap();
    let mut told = Vec::new();
    while told.last() != Some(&700) {
        let CaptureEvent::Noise(counts) = next() else {
            panic!("there are no readings");
        };
        assert_eq!(counts.skipped_bytes, counts.bytes);
        told.push(counts.bytes);
    }
    let times = start.elapsed().as_millis() / NOISE.as_millis();
    assert!(told.len() as u128 <= times, "{told:?}");
    let more = captured.events().recv_timeout(2 * NOISE);
    assert!(more.is_err(), "{more:?}");
}
