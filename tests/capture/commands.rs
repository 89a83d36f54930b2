//! Commands to a session, executed between two readings.

use std::thread;
use std::time::{Duration, Instant};

use ademan::capture::{CaptureError, Hc11Format, Source, SourceEvent, SourceStats};
use ademan::command::{Command, CommandOrigin};
use ademan::output;
use ademan::pipeline::PipelineState;
use ademan::session::{
    CommandError, CommandSender, Reply, RequestError, command_channel, run_pipeline,
};
use ademan::setup::Setup;
use ademan::sim::SimulatedTypist;
use ademan::snapshot::StepView;
use crossbeam_channel::unbounded;

/// Longest wait on a busy machine.
const TIMEOUT: Duration = Duration::from_secs(60);

/// A glove that falls silent after a number of readings.
struct SilentGlove {
    hand: SimulatedTypist,
    readings: u64,
    max_readings: u64,
}

impl Source for SilentGlove {
    fn next(&mut self) -> Result<SourceEvent, CaptureError> {
        if self.readings == self.max_readings {
            thread::sleep(Duration::from_millis(5));
            return Ok(SourceEvent::Idle);
        }
        self.readings += 1;
        self.hand.next()
    }

    fn name(&self) -> &str {
        "silent glove"
    }

    fn stats(&self) -> SourceStats {
        SourceStats {
            readings: self.readings,
            ..SourceStats::default()
        }
    }
}

/// Runs a session with a client until `is_over` returns `true`.
fn run(
    client: impl FnOnce(CommandSender) + Send + 'static,
    mut is_over: impl FnMut(&StepView) -> bool,
) {
    let setup = Setup::default().load_files().expect("the default setup");
    let hand = setup.typist("commands", &Hc11Format::default(), 0.0, 0);
    let source = SilentGlove {
        hand: hand.expect("the layout can type it"),
        readings: 0,
        max_readings: 10,
    };
    let mut sink = output::open("none", &setup.required_capabilities()).expect("the output `none`");
    let (sender, commands) = command_channel();
    let stop = sender.clone();
    thread::spawn(move || client(sender));
    let mut observe = |step: &StepView| {
        if is_over(step) {
            stop.send(Command::Stop).expect("the session runs");
        }
    };
    let mut pipeline = setup.pipeline();
    run_pipeline(source, &mut pipeline, &mut *sink, &commands, &mut observe).expect("a session");
}

#[test]
fn commands_without_pause_do_not_delay_a_stall() {
    let start = Instant::now();
    let busy_client =
        |commands: CommandSender| {
            thread::scope(|scope| {
                for _ in 0..4 {
                    scope.spawn(|| {
                        while commands.send(Command::Resume) != Err(RequestError::Ended) {}
                    });
                }
            });
        };
    let mut has_stalled = false;
    run(busy_client, |snapshot| {
        // The session is slower than its clients, so that commands are always waiting.
        thread::sleep(Duration::from_millis(1));
        has_stalled |= snapshot.state == PipelineState::Stalled;
        has_stalled || start.elapsed() > TIMEOUT
    });
    assert!(has_stalled);
}

#[test]
fn commands_are_executed_in_order_and_answered() {
    let (results, received) = unbounded();
    let client = move |commands: CommandSender| {
        // Without a reply, but before the others.
        commands.send(Command::Pause).expect("the session runs");
        let nudge = Command::Nudge {
            x_mm: 1000.0,
            y_mm: 0.0,
            z_mm: 0.0,
        };
        for command in [Command::State, nudge, nudge, nudge, Command::Resume] {
            let result = commands.request_with_timeout(command, TIMEOUT);
            results.send(result).expect("the test waits");
        }
    };
    let (mut was_paused, mut is_resumed) = (false, false);
    let start = Instant::now();
    run(client, |snapshot| {
        was_paused |= snapshot.paused_by.is_some();
        is_resumed |= was_paused && snapshot.paused_by.is_none();
        is_resumed || start.elapsed() > TIMEOUT
    });
    assert!(is_resumed);
    let next = || received.recv().expect("a result");
    let state = next();
    assert!(
        matches!(&state, Ok(Reply::State(status)) if status.paused_by == Some(CommandOrigin::Client) && status.state == PipelineState::Paused),
        "{state:?}"
    );
    assert_eq!(next(), Ok(Reply::Done));
    let too_far = Err(RequestError::Pipeline(CommandError::TooFar(1)));
    assert!([next(), next()].contains(&too_far));
    assert_eq!(next(), Ok(Reply::Done));
}
