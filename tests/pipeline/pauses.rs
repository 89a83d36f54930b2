//! Pauses of the layout and pauses from outside: which side ends which.

use ademan::capture::{Hc11Format, Reading, Source, SourceEvent};
use ademan::command::{Command, CommandOrigin};
use ademan::device::{EventKind, Events};
use ademan::pipeline::PipelineState;
use ademan::setup::{LoadedSetup, Setup};

use crate::support::checked::CheckedPipeline;

/// The origins of pauses that a layout cannot request.
fn outside() -> impl Iterator<Item = CommandOrigin> {
    let origins = CommandOrigin::ALL.iter().copied();
    origins.filter(|&origin| origin != CommandOrigin::Layout)
}

/// A simulated hand at the layout `switches`, whose key `pause` toggles the pause.
struct Hand {
    setup: LoadedSetup,
    pipeline: CheckedPipeline,
    /// Time of the next script, in microseconds.
    start: u64,
    presses: usize,
}

impl Hand {
    fn new(setup: Setup) -> Self {
        let setup = Setup {
            layout: "switches".into(),
            ..setup
        };
        let setup = setup.load_files().expect("a shipped layout");
        Self {
            pipeline: CheckedPipeline::new(&setup),
            setup,
            start: 0,
            presses: 0,
        }
    }

    /// Plays a script, which has to begin and end at the same target as all others.
    fn play(&mut self, script: &str) {
        let hand = self.setup.scripted(script, &Hc11Format::default(), 0.0, 0);
        let mut hand = hand.expect("the hand can do it");
        let mut last = self.start;
        while let Ok(SourceEvent::Reading(reading)) = hand.next() {
            last = self.start + reading.time.0;
            let reading = Reading {
                time: ademan::time::Timestamp(last),
                ..reading
            };
            let mut events = Events::new();
            self.pipeline
                .step(&reading, &mut events)
                .expect("an accepted reading");
            let is_press = |kind| matches!(kind, EventKind::KeyDown(_));
            self.presses += events.iter().filter(|event| is_press(event.kind)).count();
        }
        self.start = last + 10_000;
    }

    /// Presses the key that toggles the pause.
    fn tap_pause(&mut self) {
        self.play("tap pause");
    }

    fn pause(&mut self, origin: CommandOrigin) {
        self.pipeline.pause(origin, &mut Events::new());
    }
}

#[test]
fn a_pause_key_ends_the_pause_of_the_layout_and_no_pause_from_outside() {
    let mut hand = Hand::new(Setup::default());
    hand.tap_pause();
    assert_eq!(hand.pipeline.paused_by(), Some(CommandOrigin::Layout));
    hand.tap_pause();
    assert_eq!(hand.pipeline.paused_by(), None);
    assert_eq!(hand.pipeline.state(), PipelineState::Running);
    for origin in outside() {
        hand.pause(origin);
        for _ in 0..3 {
            hand.tap_pause();
            assert_eq!(hand.pipeline.paused_by(), Some(origin));
            assert_eq!(hand.pipeline.state(), PipelineState::Paused);
        }
        hand.pipeline.resume(CommandOrigin::Client);
        hand.play("press pause; lift");
        assert_eq!(hand.pipeline.paused_by(), Some(CommandOrigin::Layout));
        hand.pipeline.resume(CommandOrigin::Client);
        hand.play("push pause 0.1; wait 400; lift");
        assert_eq!(hand.pipeline.state(), PipelineState::Running, "{origin}");
    }
}

#[test]
fn a_source_that_may_only_point_ends_no_pause_from_outside() {
    let mut hand = Hand::new(Setup {
        source: Some("tcp:10.0.0.7:4001".parse().expect("a source")),
        ..Setup::default()
    });
    hand.play("push pause 0.1; wait 400; lift");
    assert_eq!(hand.pipeline.state(), PipelineState::Running);
    hand.pause(CommandOrigin::Client);
    hand.tap_pause();
    hand.tap_pause();
    assert_eq!(hand.pipeline.paused_by(), Some(CommandOrigin::Client));
    assert_eq!(hand.presses, 0);
}

#[test]
fn a_pause_from_outside_replaces_that_of_the_layout() {
    let mut hand = Hand::new(Setup::default());
    hand.tap_pause();
    hand.pause(CommandOrigin::PanicKeys);
    assert_eq!(hand.pipeline.paused_by(), Some(CommandOrigin::PanicKeys));
    hand.pause(CommandOrigin::Signal);
    hand.tap_pause();
    assert_eq!(
        hand.pipeline.paused_by(),
        Some(CommandOrigin::PanicKeys),
        "the first of equal origins"
    );
}

#[test]
fn presses_beyond_the_rate_limit_pause_until_a_command_from_outside() {
    let setup = Setup {
        max_presses_per_second: Some(1),
        ..Setup::default()
    };
    let mut hand = Hand::new(setup);
    hand.play("tap Z; tap Z; tap Z; tap Z");
    assert_eq!(hand.pipeline.paused_by(), Some(CommandOrigin::RateLimit));
    let taps = hand.presses;
    hand.play("tap Z; tap pause; tap Z; tap pause; tap Z");
    assert_eq!(hand.pipeline.paused_by(), Some(CommandOrigin::RateLimit));
    assert_eq!(hand.presses, taps);
    hand.pipeline.resume(CommandOrigin::Client);
    hand.play("push Z 0.1; wait 400; tap Z");
    assert_eq!(hand.presses, taps + 1);
}

#[test]
fn a_suspend_ends_its_own_pause_and_no_other_from_outside() {
    let mut hand = Hand::new(Setup::default());
    hand.tap_pause();
    hand.pipeline.resume(CommandOrigin::Suspend);
    assert_eq!(hand.pipeline.paused_by(), None);
    hand.pause(CommandOrigin::Suspend);
    hand.pause(CommandOrigin::Client);
    hand.pipeline.resume(CommandOrigin::Suspend);
    assert_eq!(hand.pipeline.paused_by(), Some(CommandOrigin::Client));
}

#[test]
fn a_toggle_from_outside_ends_every_pause() {
    let setup = Setup::default().load_files().expect("the default setup");
    for &origin in CommandOrigin::ALL {
        let mut pipeline = setup.pipeline();
        let mut events = Events::new();
        pipeline.pause(origin, &mut events);
        let toggle = Command::TogglePause;
        let toggled = pipeline.execute(&toggle, CommandOrigin::Client, &mut events);
        assert_eq!((toggled, pipeline.paused_by()), (Ok(()), None), "{origin}");
    }
}
