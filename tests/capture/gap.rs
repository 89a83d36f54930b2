//! A replay in real time with a long gap: everything is released in the gap, not at its end.

use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};
use std::thread;
use std::time::{Duration, Instant};

use ademan::capture::{CaptureError, Reading, Source, SourceEvent};
use ademan::device::{EventKind, OutputEvent};
use ademan::output::{OutputError, Sink};
use ademan::session::{CommandReceiver, run_pipeline};
use ademan::setup::Setup;
use ademan::time::Timestamp;

use crate::support::press::{Press, readings};

/// The gap in the recording.
const GAP: Duration = Duration::from_secs(2);

/// The stall timeout, which is shorter than the gap.
const STALL_TIMEOUT_MS: u32 = 200;

/// Longest wait for the release in the gap.
const TIMEOUT: Duration = Duration::from_secs(60);

/// A replay that holds a key when the gap begins. The gap does not end before the key is released.
struct GappedReplay {
    /// Readings before and after the gap.
    parts: [std::vec::IntoIter<Reading>; 2],
    /// Time of the last reading before the gap.
    last: Timestamp,
    /// Time that the clock has passed since then; `None` without a clock.
    waited: Option<Duration>,
    is_released: Arc<AtomicBool>,
    started_at: Instant,
}

impl GappedReplay {
    fn new(is_paced: bool, is_released: &Arc<AtomicBool>) -> Self {
        let press = Press::for_text("h");
        let mut before = readings(&[&press.approach[..], &press.lift].concat());
        let mut after = before.split_off(press.approach.len());
        for reading in &mut after {
            reading.time = reading.time + GAP;
        }
        Self {
            last: before.last().expect("a reading").time,
            parts: [before.into_iter(), after.into_iter()],
            waited: is_paced.then_some(Duration::ZERO),
            is_released: is_released.clone(),
            started_at: Instant::now(),
        }
    }
}

/// A replay whose disk stops to respond while a key is held, until the key is released.
struct HangingReplay(GappedReplay);

impl Source for HangingReplay {
    fn next(&mut self) -> Result<SourceEvent, CaptureError> {
        let replay = &self.0;
        if replay.parts[0].len() == 0 && replay.parts[1].len() > 0 {
            while !replay.is_released.load(Ordering::Relaxed) {
                assert!(replay.started_at.elapsed() < TIMEOUT, "the key is held");
                thread::sleep(Duration::from_millis(1));
            }
        }
        self.0.next()
    }

    fn name(&self) -> &str {
        "a recording on a disk that hangs"
    }

    fn is_live(&self) -> bool {
        false
    }
}

impl Source for GappedReplay {
    fn next(&mut self) -> Result<SourceEvent, CaptureError> {
        let [before, after] = &mut self.parts;
        if let Some(reading) = before.next() {
            return Ok(SourceEvent::Reading(reading));
        }
        if let Some(waited) = &mut self.waited
            && !self.is_released.load(Ordering::Relaxed)
        {
            assert!(
                self.started_at.elapsed() < TIMEOUT,
                "the key is held in the gap"
            );
            thread::sleep(Duration::from_millis(1));
            *waited = (*waited + Duration::from_millis(10)).min(GAP);
            return Ok(SourceEvent::Idle);
        }
        Ok(after.next().map_or(SourceEvent::End, SourceEvent::Reading))
    }

    fn name(&self) -> &str {
        "a recording with a gap"
    }

    fn is_live(&self) -> bool {
        false
    }

    fn clock(&self) -> Option<Timestamp> {
        self.waited.map(|waited| self.last + waited)
    }
}

/// A sink that notes all events and the release of a key.
struct NotingSink {
    events: Arc<std::sync::Mutex<Vec<OutputEvent>>>,
    is_released: Arc<AtomicBool>,
}

impl Sink for NotingSink {
    fn send(&mut self, events: &[OutputEvent]) -> Result<(), OutputError> {
        let is_release = |event: &OutputEvent| matches!(event.kind, EventKind::KeyUp(_));
        if events.iter().any(is_release) {
            self.is_released.store(true, Ordering::Relaxed);
        }
        self.events.lock().expect("no panic").extend(events);
        Ok(())
    }

    fn close(&mut self) -> Result<(), OutputError> {
        Ok(())
    }
}

/// Plays the recording. Returns its events and the number of stalls.
fn play(is_paced: bool) -> (Vec<OutputEvent>, u64) {
    play_source(STALL_TIMEOUT_MS, |is_released| {
        GappedReplay::new(is_paced, is_released)
    })
}

/// Plays a source that is told of the release. Returns its events and the number of stalls.
pub fn play_source<S: Source + 'static>(
    stall_timeout_ms: u32,
    source: impl FnOnce(&Arc<AtomicBool>) -> S,
) -> (Vec<OutputEvent>, u64) {
    let setup = Setup {
        arm_immediately: true,
        stall_timeout_ms,
        ..Setup::default()
    };
    let setup = setup.load_files().expect("the default setup");
    let is_released = Arc::default();
    let events = Arc::default();
    let mut sink = NotingSink {
        events: Arc::clone(&events),
        is_released: Arc::clone(&is_released),
    };
    let ended = run_pipeline(
        source(&is_released),
        &mut setup.pipeline(),
        &mut sink,
        &CommandReceiver::disconnected(),
        &mut |_| {},
    );
    let stalls = ended.expect("the recording ends").stats.stalls;
    let events = events.lock().expect("no panic").clone();
    (events, stalls)
}

#[test]
fn a_key_is_released_in_the_gap_of_a_paced_replay_with_the_time_of_the_stall() {
    let (paced, stalls) = play(true);
    let (unpaced, unpaced_stalls) = play(false);
    assert_eq!(paced, unpaced, "the events do not depend on the pace");
    assert_eq!((stalls, unpaced_stalls), (1, 1));
    let [down, up] = paced[..] else {
        panic!("{paced:?}");
    };
    assert!(matches!(down.kind, EventKind::KeyDown(_)), "{paced:?}");
    assert!(matches!(up.kind, EventKind::KeyUp(_)), "{paced:?}");
    assert!(up.time.since(down.time) < GAP, "{paced:?}");
}

#[test]
fn a_key_is_released_while_the_disk_of_a_recording_hangs() {
    let (events, stalls) = play_source(STALL_TIMEOUT_MS, |is_released| {
        HangingReplay(GappedReplay::new(false, is_released))
    });
    assert_eq!(stalls, 1);
    let [down, up] = events[..] else {
        panic!("{events:?}");
    };
    assert!(matches!(down.kind, EventKind::KeyDown(_)), "{events:?}");
    assert!(matches!(up.kind, EventKind::KeyUp(_)), "{events:?}");
}
