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

/// A layout whose controls issue commands that pause and resume.
const COMMANDS: &str = r#"Layout(name: "Commands", boards: [(
    pose: (anchor: elbow, bearing_deg: 35, forward_mm: 300, height_mm: -45),
    pitch_mm: 24, size_mm: Box(22, 20),
    keys: [(code: "A", at_mm: (-24, 0))],
    toggles: [(name: "toggle", at_mm: (0, 30), tap: Command("toggle-pause"))],
    radios: [(name: "group", initial: "one", options: [
        (name: "one", at_mm: (24, 30)),
        (name: "two", at_mm: (48, 30), tap: Command("resume")),
    ])],
)])"#;

/// A simulated hand at a layout: by default `switches`, whose key `pause` toggles the pause.
struct Hand {
    setup: LoadedSetup,
    pipeline: CheckedPipeline,
    /// Time of the next script, in microseconds.
    start: u64,
    presses: usize,
    /// The values of controls since they were last looked at.
    values: Vec<String>,
}

impl Hand {
    fn new(setup: Setup) -> Self {
        Self::with_layout("switches", setup)
    }

    fn with_layout(layout: &str, setup: Setup) -> Self {
        let setup = Setup {
            layout: layout.into(),
            ..setup
        };
        let setup = setup.load_files().expect("a layout");
        Self {
            pipeline: CheckedPipeline::new(&setup),
            setup,
            start: 0,
            presses: 0,
            values: Vec::new(),
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
            for event in &events {
                if let EventKind::Value(target, value) = event.kind {
                    let name = self.pipeline.target_names().get(target);
                    self.values.push(format!("{name} {value:.2}"));
                }
            }
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

    /// Ends a pause of a client, and moves near this key until the output is armed.
    fn resume_at(&mut self, key: &str) {
        self.pipeline.resume(CommandOrigin::Client);
        self.play(&format!("push {key} 0.1; wait 400; lift"));
        assert_eq!(self.pipeline.state(), PipelineState::Running);
    }

    fn take_values(&mut self) -> Vec<String> {
        std::mem::take(&mut self.values)
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

#[test]
fn switches_and_options_that_are_poked_during_a_pause_stay_as_they_were() {
    let mut hand = Hand::new(Setup::default());
    hand.play("push pause 0.1; tap Mute; tap Eraser; push pause 0.1; lift");
    assert_eq!(
        hand.take_values(),
        ["Mute 1.00", "Brush 0.00", "Eraser 1.00"]
    );
    hand.pause(CommandOrigin::Client);
    hand.play("push pause 0.1; tap Mute; tap Hand; tap Brush; push pause 0.1; lift");
    hand.resume_at("pause");
    assert!(hand.take_values().is_empty());
    let before = hand.presses;
    hand.play("push pause 0.1; tap Mute; tap Brush; push pause 0.1; lift");
    assert_eq!(
        hand.take_values(),
        ["Mute 0.00", "Eraser 0.00", "Brush 1.00"]
    );
    assert_eq!(hand.presses, before + 2);
}

#[test]
fn a_knob_that_is_turned_during_a_pause_stays_where_it_was() {
    let mut hand = Hand::with_layout("media", Setup::default());
    let turn = "push MediaStop 0.1; press Volume 15 0; arc -80; lift; push MediaStop 0.1; lift";
    hand.pause(CommandOrigin::Client);
    hand.play(turn);
    hand.resume_at("MediaStop");
    assert!(hand.take_values().is_empty());
    hand.play(turn);
    let values = hand.take_values();
    assert_eq!(values.first().map(String::as_str), Some("Volume 0.55"));
}

#[test]
fn switches_and_options_with_commands_end_every_pause_of_the_layout() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("commands.ron");
    std::fs::write(&path, COMMANDS).unwrap();
    let path = path.to_str().expect("a path in UTF-8");
    let mut hand = Hand::with_layout(path, Setup::default());
    for round in 0..2 {
        hand.play("push A 0.1; tap toggle; push A 0.1; lift");
        let paused_by = hand.pipeline.paused_by();
        assert_eq!(paused_by, Some(CommandOrigin::Layout), "round {round}");
        hand.play("push A 0.1; tap two; push A 0.1; lift");
        assert_eq!(hand.pipeline.paused_by(), None, "round {round}");
    }
    hand.play("push A 0.1; tap toggle; tap toggle; push A 0.1; lift");
    assert_eq!(hand.pipeline.paused_by(), None);
}
