//! A run accounts for every reading: received = accepted + rejected + superseded.

use ademan::capture::{Capture, CaptureError, Counts, LineSettings, Reading, Source};
use ademan::lab::Typist;
use ademan::monitor::Tally;
use ademan::output;
use ademan::runtime::{Summary, drive};
use ademan::settings::{Assembly, Setup};
use crossbeam_channel::{bounded, never};

/// A typist whose every tenth reading is of a glove with a wrist that no wrist can have.
struct Trembling {
    hand: Typist,
    number: u64,
    is_live: bool,
}

impl Source for Trembling {
    fn next(&mut self) -> Result<Capture, CaptureError> {
        let mut capture = self.hand.next()?;
        if let Capture::Reading(Reading { sample, .. }) = &mut capture {
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

    fn counts(&self) -> Counts {
        Counts {
            readings: self.number,
            ..Counts::default()
        }
    }
}

fn trembling(assembly: &Assembly, is_live: bool) -> Trembling {
    let hand = assembly.typist("accounts", &LineSettings::default(), 0.0, 0);
    Trembling {
        hand: hand.expect("it can be typed"),
        number: 0,
        is_live,
    }
}

fn balance(tally: &Tally) -> (u64, u64) {
    let rejected: u64 = tally.rejected.iter().sum();
    let taken = tally.accepted + rejected + tally.source.superseded;
    (tally.source.readings, taken)
}

fn run(is_live: bool, stop_at: Option<u64>) -> Summary {
    let assembly = Setup::default().assemble().expect("the default setup");
    let mut nowhere = output::open("none", &assembly.needs()).expect("nowhere");
    let (sender, stop) = bounded(1);
    let stop = if stop_at.is_some() { stop } else { never() };
    let source = trembling(&assembly, is_live);
    let mut frames = 0;
    let observe = &mut |_: &_| {
        frames += 1;
        if stop_at == Some(frames) {
            sender.send(()).expect("somebody listens");
        }
    };
    drive(
        source,
        &mut assembly.pipeline(),
        &mut *nowhere,
        &stop,
        observe,
    )
    .expect("a run")
}

#[test]
fn a_source_that_waits_has_every_reading_accepted_or_rejected() {
    let tally = run(false, None).tally;
    let (received, taken) = balance(&tally);
    assert_eq!(received, taken);
    assert_eq!(tally.source.superseded, 0);
    assert!(received > 400 && tally.rejected.iter().sum::<u64>() >= received / 10);
}

#[test]
fn a_live_source_that_is_too_fast_has_its_oldest_readings_superseded() {
    let tally = run(true, None).tally;
    let (received, taken) = balance(&tally);
    assert_eq!(received, taken);
}

#[test]
fn what_still_waits_when_a_run_is_ended_is_accounted_for_too() {
    for _ in 0..20 {
        let tally = run(false, Some(100)).tally;
        let (received, taken) = balance(&tally);
        assert_eq!(received, taken);
        assert!(tally.accepted < 200, "it was ended early");
    }
}
