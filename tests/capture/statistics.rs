//! A run accounts for every reading: received = accepted + rejected + superseded.

use std::time::Duration;

use ademan::capture::{
    CaptureError, Hc11Format, PacedSource, Reading, Source, SourceEvent, SourceStats,
};
use ademan::command::Command;
use ademan::device::{EventKind, OutputEvent};
use ademan::output;
use ademan::session::{CommandReceiver, Summary, command_channel, run_pipeline};
use ademan::setup::{LoadedSetup, Setup};
use ademan::sim::SimulatedTypist;
use ademan::snapshot::{Snapshot, Stats};

/// A typist whose every tenth reading is of a glove with a wrist that no wrist can have.
struct Trembling {
    hand: SimulatedTypist,
    number: u64,
    is_live: bool,
}

impl Source for Trembling {
    fn next(&mut self) -> Result<SourceEvent, CaptureError> {
        let mut capture = self.hand.next()?;
        if let SourceEvent::Reading(Reading { sample, .. }) = &mut capture {
            self.number += 1;
            let ademan::capture::Sample::Channels(channels) = sample else {
                panic!("a glove has channels");
            };
            if self.number.is_multiple_of(10) {
                channels.counts[4] = 254;
            }
        }
        Ok(capture)
    }

    fn name(&self) -> &str {
        "trembling"
    }

    fn is_live(&self) -> bool {
        self.is_live
    }

    fn stats(&self) -> SourceStats {
        SourceStats {
            readings: self.number,
            ..SourceStats::default()
        }
    }
}

fn trembling(assembly: &LoadedSetup, is_live: bool) -> Trembling {
    let hand = assembly.typist("accounts", &Hc11Format::default(), 0.0, 0);
    Trembling {
        hand: hand.expect("it can be typed"),
        number: 0,
        is_live,
    }
}

fn balance(tally: &Stats) -> (u64, u64) {
    let rejected: u64 = tally.rejected.iter().sum();
    let taken = tally.accepted + rejected + tally.source.dropped;
    (tally.source.readings, taken)
}

fn run(is_live: bool, stop_at: Option<u64>) -> Summary {
    let assembly = Setup::default().load_files().expect("the default setup");
    let mut nowhere = output::open("none", &assembly.required_capabilities()).expect("nowhere");
    let (sender, commands) = command_channel();
    let source = trembling(&assembly, is_live);
    let mut frames = 0;
    let observe = &mut |_: &_| {
        frames += 1;
        if stop_at == Some(frames) {
            sender.send(Command::Stop).expect("the session runs");
        }
    };
    run_pipeline(
        source,
        &mut assembly.pipeline(),
        &mut *nowhere,
        &commands,
        observe,
    )
    .expect("a run")
}

#[test]
fn a_source_that_waits_has_every_reading_accepted_or_rejected() {
    let tally = run(false, None).stats;
    let (received, taken) = balance(&tally);
    assert_eq!(received, taken);
    assert_eq!(tally.source.dropped, 0);
    assert!(received > 400 && tally.rejected.iter().sum::<u64>() >= received / 10);
}

#[test]
fn a_live_source_that_is_too_fast_has_its_oldest_readings_superseded() {
    let tally = run(true, None).stats;
    let (received, taken) = balance(&tally);
    assert_eq!(received, taken);
}

/// An observer that stands still while a key is down, as a program that is stopped does.
#[test]
fn readings_from_before_the_program_stood_still_press_nothing_and_are_accounted_for() {
    let assembly = Setup::default().load_files().expect("the default setup");
    let mut nowhere = output::open("none", &assembly.required_capabilities()).expect("nowhere");
    let typist = assembly.typist("accounts", &Hc11Format::default(), 0.0, 0);
    let source = PacedSource::new(typist.expect("it can be typed"), 1.0);
    let mut has_stood_still = false;
    let mut events_after = Vec::new();
    let observe = &mut |frame: &Snapshot| {
        let is_down = |event: &OutputEvent| matches!(event.kind, EventKind::KeyDown(_));
        if has_stood_still {
            events_after.extend(frame.events.iter().map(|event| event.kind));
        } else if frame.events.iter().any(is_down) {
            has_stood_still = true;
            std::thread::sleep(Duration::from_millis(600));
        }
    };
    let source = Live(source);
    let summary = run_pipeline(
        source,
        &mut assembly.pipeline(),
        &mut *nowhere,
        &CommandReceiver::disconnected(),
        observe,
    );
    let tally = summary.expect("a run").stats;
    let (received, taken) = balance(&tally);
    assert_eq!(received, taken);
    assert!(tally.source.dropped > 0 && tally.stalls > 0, "{tally:?}");
    let first = events_after.first();
    assert!(
        matches!(first, Some(EventKind::KeyUp(_))),
        "{events_after:?}"
    );
}

/// Readings that are lost when nobody takes them.
struct Live(PacedSource<SimulatedTypist>);

impl Source for Live {
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
fn what_still_waits_when_a_run_is_ended_is_accounted_for_too() {
    for _ in 0..20 {
        let tally = run(false, Some(100)).stats;
        let (received, taken) = balance(&tally);
        assert_eq!(received, taken);
        assert!(tally.accepted < 200, "it was ended early");
    }
}
