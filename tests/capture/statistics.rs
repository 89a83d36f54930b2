//! Statistics of a session: received = accepted + rejected + dropped readings.

use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};
use std::thread;
use std::time::{Duration, Instant};

use ademan::capture::{
    CaptureError, Hc11Format, PacedSource, Reading, Source, SourceEvent, SourceStats,
};
use ademan::command::Command;
use ademan::device::{EventKind, OutputEvent};
use ademan::output;
use ademan::session::{CommandReceiver, Summary, command_channel, run_pipeline};
use ademan::setup::{LoadedSetup, Setup};
use ademan::sim::SimulatedTypist;
use ademan::snapshot::{Stats, StepView};
use ademan::time::Timestamp;

use crate::support::press::{Posture, Press, glove_format, reading};

/// A typist whose every tenth reading has an impossible wrist angle.
struct FaultyTypist {
    hand: SimulatedTypist,
    readings: u64,
    is_live: bool,
    is_over: Arc<AtomicBool>,
}

impl Source for FaultyTypist {
    fn next(&mut self) -> Result<SourceEvent, CaptureError> {
        let mut event = self.hand.next()?;
        if event == SourceEvent::End {
            self.is_over.store(true, Ordering::Relaxed);
        }
        if let SourceEvent::Reading(Reading { sample, .. }) = &mut event {
            self.readings += 1;
            let ademan::capture::Sample::Channels(channels) = sample else {
                panic!("a glove has channels");
            };
            if self.readings.is_multiple_of(10) {
                channels.counts[4] = 254;
            }
        }
        Ok(event)
    }

    fn name(&self) -> &str {
        "faulty typist"
    }

    fn is_live(&self) -> bool {
        self.is_live
    }

    fn stats(&self) -> SourceStats {
        SourceStats {
            readings: self.readings,
            ..SourceStats::default()
        }
    }
}

fn faulty_typist(setup: &LoadedSetup, is_live: bool) -> FaultyTypist {
    let hand = setup.typist("statistics", &Hc11Format::default(), 0.0, 0);
    FaultyTypist {
        hand: hand.expect("the text can be typed"),
        readings: 0,
        is_live,
        is_over: Arc::default(),
    }
}

/// Returns the received readings, and the sum of those accepted, rejected and dropped.
fn received_and_sum(stats: &Stats) -> (u64, u64) {
    let rejected: u64 = stats.rejected.iter().sum();
    let sum = stats.accepted + rejected + stats.source.dropped;
    (stats.source.readings, sum)
}

/// Runs a session. A live source has ended before the session takes its second step.
fn run(is_live: bool, stop_at: Option<u64>) -> Summary {
    let setup = Setup::default().load_files().expect("the default setup");
    let mut sink = output::open("none", &setup.required_capabilities()).expect("an output");
    let (sender, commands) = command_channel();
    let source = faulty_typist(&setup, is_live);
    let is_over = source.is_over.clone();
    let mut steps = 0;
    let observe = &mut |_: &StepView| {
        steps += 1;
        while is_live && !is_over.load(Ordering::Relaxed) {
            thread::sleep(Duration::from_millis(1));
        }
        if stop_at == Some(steps) {
            sender.send(Command::Stop).expect("the session runs");
        }
    };
    run_pipeline(
        source,
        &mut setup.pipeline(),
        &mut *sink,
        &commands,
        observe,
    )
    .expect("a session")
}

#[test]
fn every_reading_of_a_waiting_source_is_accepted_or_rejected() {
    let stats = run(false, None).stats;
    let (received, sum) = received_and_sum(&stats);
    assert_eq!(received, sum);
    assert_eq!(stats.source.dropped, 0);
    assert!(received > 400 && stats.rejected.iter().sum::<u64>() >= received / 10);
}

#[test]
fn dropped_readings_of_a_fast_live_source_are_counted() {
    let stats = run(true, None).stats;
    let (received, sum) = received_and_sum(&stats);
    assert_eq!(received, sum);
    assert!(stats.source.dropped > 0, "{stats:?}");
}

/// The observer blocks while a key is pressed, as if the program were stopped.
#[test]
fn readings_from_before_a_stop_of_the_program_press_nothing_and_are_counted() {
    let setup = Setup::default().load_files().expect("the default setup");
    let mut sink = output::open("none", &setup.required_capabilities()).expect("an output");
    let typist = setup.typist("statistics", &Hc11Format::default(), 0.0, 0);
    let source = PacedSource::new(typist.expect("the text can be typed"), 1.0);
    let mut has_blocked = false;
    let mut events_after = Vec::new();
    let observe = &mut |step: &StepView| {
        let is_down = |event: &OutputEvent| matches!(event.kind, EventKind::KeyDown(_));
        if has_blocked {
            events_after.extend(step.events.iter().map(|event| event.kind));
        } else if step.events.iter().any(is_down) {
            has_blocked = true;
            thread::sleep(Duration::from_millis(600));
        }
    };
    let source = LiveSource(source);
    let summary = run_pipeline(
        source,
        &mut setup.pipeline(),
        &mut *sink,
        &CommandReceiver::disconnected(),
        observe,
    );
    let stats = summary.expect("a session").stats;
    let (received, sum) = received_and_sum(&stats);
    assert_eq!(received, sum);
    assert!(stats.source.dropped > 0 && stats.stalls > 0, "{stats:?}");
    let first = events_after.first();
    assert!(
        matches!(first, Some(EventKind::KeyUp(_))),
        "{events_after:?}"
    );
}

/// A live source: its readings are dropped if the consumer is slow.
struct LiveSource(PacedSource<SimulatedTypist>);

impl Source for LiveSource {
    fn next(&mut self) -> Result<SourceEvent, CaptureError> {
        self.0.next()
    }

    fn name(&self) -> &str {
        "live"
    }

    fn stats(&self) -> SourceStats {
        self.0.stats()
    }
}

#[test]
fn readings_queued_at_the_end_of_a_session_are_counted() {
    for _ in 0..20 {
        let stats = run(false, Some(100)).stats;
        let (received, sum) = received_and_sum(&stats);
        assert_eq!(received, sum);
        assert!(stats.accepted < 200, "the session was stopped early");
    }
}

/// Readings that wait for a session that is blocked. The queue of a live source has room for them.
const WAITING: usize = 10;

/// The progress of a block of a session.
#[derive(Default)]
struct Block {
    has_begun: AtomicBool,
    are_readings_waiting: AtomicBool,
    is_over: AtomicBool,
}

/// A live hand that holds a key until its session is blocked, sends a few more readings, and lifts when the block is over.
struct WaitingHand {
    approach: std::vec::IntoIter<Posture>,
    pressed: Posture,
    waiting: usize,
    lift: std::vec::IntoIter<Posture>,
    block: Arc<Block>,
    start: Instant,
}

impl Source for WaitingHand {
    fn next(&mut self) -> Result<SourceEvent, CaptureError> {
        let is_late = self.start.elapsed() > Duration::from_secs(60);
        assert!(!is_late, "the hand waits for its session");
        let posture = if let Some(posture) = self.approach.next() {
            Some(posture)
        } else if !self.block.has_begun.load(Ordering::Relaxed) {
            Some(self.pressed)
        } else if self.waiting < WAITING {
            self.waiting += 1;
            Some(self.pressed)
        } else if !self.block.is_over.load(Ordering::Relaxed) {
            let are_waiting = &self.block.are_readings_waiting;
            are_waiting.store(true, Ordering::Relaxed);
            thread::sleep(Duration::from_millis(1));
            return Ok(SourceEvent::Idle);
        } else {
            self.lift.next()
        };
        thread::sleep(glove_format().packet_period());
        let time = Timestamp(0) + self.start.elapsed();
        Ok(posture.map_or(SourceEvent::End, |posture| {
            SourceEvent::Reading(reading(time, &posture))
        }))
    }

    fn name(&self) -> &str {
        "a hand that waits"
    }
}

/// No reading is missing and the times have no gap: only the age of the readings shows that they are of the past.
#[test]
fn readings_that_have_waited_for_longer_than_the_stall_timeout_are_dropped() {
    let setup = Setup {
        arm_immediately: true,
        // A busy machine must not cause a stall before the block.
        stall_timeout_ms: 2_000,
        ..Setup::default()
    };
    let setup = setup.load_files().expect("the default setup");
    let mut sink = output::open("none", &setup.required_capabilities()).expect("an output");
    let (press, block) = (Press::for_text("h"), Arc::new(Block::default()));
    let source = WaitingHand {
        pressed: press.pressed(),
        approach: press.approach.into_iter(),
        waiting: 0,
        lift: press.lift.into_iter(),
        block: Arc::clone(&block),
        start: Instant::now(),
    };
    let mut presses = 0;
    let observe = &mut |step: &StepView| {
        let is_down = |event: &&OutputEvent| matches!(event.kind, EventKind::KeyDown(_));
        presses += step.events.iter().filter(is_down).count();
        if presses == 1 && !block.has_begun.load(Ordering::Relaxed) {
            block.has_begun.store(true, Ordering::Relaxed);
            let start = Instant::now();
            while !block.are_readings_waiting.load(Ordering::Relaxed) {
                let is_in_time = start.elapsed() < Duration::from_secs(60);
                assert!(is_in_time, "no reading waits");
                thread::sleep(Duration::from_millis(1));
            }
            thread::sleep(Duration::from_millis(2_100));
            block.is_over.store(true, Ordering::Relaxed);
        }
    };
    let summary = run_pipeline(
        source,
        &mut setup.pipeline(),
        &mut *sink,
        &CommandReceiver::disconnected(),
        observe,
    );
    let stats = summary.expect("a session").stats;
    assert!(stats.source.dropped >= WAITING as u64, "{stats:?}");
    assert!(stats.stalls > 0, "{stats:?}");
    assert_eq!(presses, 1);
}
