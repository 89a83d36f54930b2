//! What a run is asked between two frames.

use std::thread;
use std::time::{Duration, Instant};

use ademan::capture::{CaptureError, Hc11Format, Source, SourceEvent, SourceStats};
use ademan::output;
use ademan::session::{Answer, Call, Calls, CommandError, Commands, Order, calls, run_pipeline};
use ademan::setup::Setup;
use ademan::sim::SimulatedTypist;
use ademan::snapshot::{PipelineState, Snapshot};
use crossbeam_channel::{Receiver, bounded, never};

/// A glove that says nothing any more after so many readings.
struct FallsSilent {
    hand: SimulatedTypist,
    readings: u64,
    most: u64,
}

impl Source for FallsSilent {
    fn next(&mut self) -> Result<SourceEvent, CaptureError> {
        if self.readings == self.most {
            thread::sleep(Duration::from_millis(5));
            return Ok(SourceEvent::Idle);
        }
        self.readings += 1;
        self.hand.next()
    }

    fn name(&self) -> &str {
        "falls silent"
    }

    fn is_live(&self) -> bool {
        true
    }

    fn stats(&self) -> SourceStats {
        SourceStats {
            readings: self.readings,
            ..SourceStats::default()
        }
    }
}

/// Runs until `observe` says that it is over, with somebody at the other end of the calls.
fn run(asker: impl FnOnce(Calls) + Send + 'static, mut observe: impl FnMut(&Snapshot) -> bool) {
    let assembly = Setup::default().load_files().expect("the default setup");
    let hand = assembly.typist("asked", &Hc11Format::default(), 0.0, 0);
    let source = FallsSilent {
        hand: hand.expect("it can be typed"),
        readings: 0,
        most: 10,
    };
    let mut nowhere = output::open("none", &assembly.required_capabilities()).expect("nowhere");
    let (end, stop) = bounded(1);
    let (sender, called) = calls();
    let commands = Commands {
        stop,
        replace: never(),
        calls: called,
    };
    thread::spawn(move || asker(sender));
    let mut pipeline = assembly.pipeline();
    run_pipeline(
        source,
        &mut pipeline,
        &mut *nowhere,
        commands,
        &mut |frame| {
            if observe(frame) {
                let _ = end.try_send(());
            }
        },
    )
    .expect("a run");
}

fn ask(calls: &Calls, order: Order) -> Receiver<Result<Answer, CommandError>> {
    let (answer, answered) = bounded(1);
    // The run may be over.
    let _ = calls.send(Call { order, answer });
    answered
}

#[test]
fn somebody_who_never_ceases_to_ask_does_not_put_off_a_stall() {
    let begun = Instant::now();
    let never_ceases = |calls: Calls| {
        let send = || {
            let (order, answer) = (Order::Resume, bounded(1).0);
            calls.send(Call { order, answer })
        };
        thread::scope(|scope| {
            for _ in 0..4 {
                scope.spawn(|| while send().is_ok() {});
            }
        });
    };
    let mut has_stalled = false;
    run(never_ceases, |frame| {
        // The run is slower than they are, so that there is always somebody who waits.
        thread::sleep(Duration::from_millis(1));
        has_stalled |= frame.state == PipelineState::Stalled;
        has_stalled || begun.elapsed() > Duration::from_secs(10)
    });
    assert!(has_stalled);
}

#[test]
fn orders_are_answered_and_obeyed_in_order_also_when_nobody_waits_for_the_answer() {
    let (told, answers) = bounded(8);
    let asker = move |calls: Calls| {
        drop(ask(&calls, Order::Pause));
        let far = Order::Nudge([9.0, 0.0, 0.0]);
        for order in [Order::State, far, Order::Resume, Order::State] {
            told.send(ask(&calls, order).recv())
                .expect("somebody reads");
        }
    };
    let mut resumed = false;
    let mut was_paused = false;
    run(asker, |frame| {
        was_paused |= frame.is_paused;
        resumed |= was_paused && !frame.is_paused;
        resumed
    });
    let state = answers.recv().expect("an answer").expect("the run goes on");
    assert!(
        matches!(state, Ok(Answer::State(run)) if run.is_paused && run.state == PipelineState::Paused),
        "{state:?}"
    );
    let nudged = answers.recv().expect("an answer").expect("the run goes on");
    assert_eq!(nudged, Err(CommandError::TooFar(1)));
    let resumed = answers.recv().expect("an answer").expect("the run goes on");
    assert_eq!(resumed, Ok(Answer::Done));
}
