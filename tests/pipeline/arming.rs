//! Arming, stalls, pauses and layout changes of the pipeline: events are emitted only while it is running, and
//! everything is released in time.

use crate::support::checked::CheckedPipeline;
use ademan::capture::{Channels, Hc11Format, Reading, Sample, Source, SourceEvent};
use ademan::command::CommandOrigin;
use ademan::contact::Phase;
use ademan::device::{EventKind, Events, KeyCode};
use ademan::estimate::Rejection;
use ademan::files::Load;
use ademan::layout::Layout;
use ademan::pipeline::{LayoutInstance, PipelineState};
use ademan::setup::Setup;
use ademan::time::Timestamp;
use parry3d::math::Vec3;

/// A hand above the H key that presses it on request, with 100 readings per second.
struct Wearer {
    pipeline: CheckedPipeline,
    time_ms: u64,
    hover: Channels,
    pressed: Channels,
    transcript: Vec<String>,
}

/// Returns the counts of the glove above the H key, and with the key fully pressed.
fn postures(setup: &Setup) -> (Channels, Channels) {
    let loaded = setup.clone().load_files().expect("the default setup");
    let hand = loaded.typist("h", &Hc11Format::default(), 0.0, 0);
    let mut hand = hand.expect("h can be typed");
    let mut pipeline = loaded.pipeline();
    let (mut hover, mut pressed) = (None, None);
    let mut events = Events::new();
    while let Ok(SourceEvent::Reading(reading)) = hand.next() {
        let Sample::Channels(channels) = reading.sample.clone() else {
            panic!("a glove has channels");
        };
        hover.get_or_insert(channels.clone());
        let step = pipeline.step(&reading, &mut events);
        let is_deepest = step
            .expect("a plausible reading")
            .touches
            .iter()
            .any(|touch| touch.phase == Phase::Moved && touch.depth == 1.0);
        if is_deepest && pressed.is_none() {
            pressed = Some(channels);
        }
    }
    (
        hover.expect("a first reading"),
        pressed.expect("a pressed key"),
    )
}

impl Wearer {
    fn new(setup: &Setup) -> Self {
        let (hover, pressed) = postures(setup);
        let loaded = setup.clone().load_files().expect("the default setup");
        Self {
            pipeline: CheckedPipeline::new(&loaded),
            time_ms: 0,
            hover,
            pressed,
            transcript: Vec::new(),
        }
    }

    fn armed() -> Self {
        let mut wearer = Self::new(&Setup::default());
        wearer.hover_for(400);
        assert_eq!(wearer.pipeline.state(), PipelineState::Running);
        wearer
    }

    fn send(&mut self, channels: &Channels) -> Option<Rejection> {
        let reading = Reading::new(
            Timestamp(self.time_ms * 1_000),
            None,
            Sample::Channels(channels.clone()),
        );
        let mut events = Events::new();
        let rejection = self.pipeline.step(&reading, &mut events).err();
        self.write(&events);
        rejection
    }

    fn write(&mut self, events: &Events) {
        for event in events {
            let line = match event.kind {
                EventKind::KeyDown(key) => format!("down {key}"),
                EventKind::KeyUp(key) => format!("up {key} at {}", event.time.0 / 1_000),
                _ => continue,
            };
            self.transcript.push(line);
        }
    }

    fn hold(&mut self, channels: &Channels, milliseconds: u64) {
        for _ in 0..milliseconds / 10 {
            self.time_ms += 10;
            self.send(channels);
        }
    }

    fn hover_for(&mut self, milliseconds: u64) {
        self.hold(&self.hover.clone(), milliseconds);
    }

    fn press_for(&mut self, milliseconds: u64) {
        self.hold(&self.pressed.clone(), milliseconds);
    }

    fn skip(&mut self, milliseconds: u64) {
        self.time_ms += milliseconds;
    }

    /// Replaces the active layout: the H key becomes D.
    fn replace_with_dvorak(&mut self) {
        let layout = Layout::load("dvorak-flat").expect("the shipped layout");
        let mut events = Events::new();
        self.pipeline.replace_profile(
            0,
            &mut LayoutInstance::from_layout(&layout),
            &layout,
            &mut events,
        );
        self.write(&events);
    }

    fn take_transcript(&mut self) -> String {
        std::mem::take(&mut self.transcript).join(", ")
    }
}

#[test]
fn output_is_armed_after_the_hand_has_been_clear_of_every_key_for_300_ms() {
    let mut wearer = Wearer::new(&Setup::default());
    assert_eq!(wearer.pipeline.state(), PipelineState::Starting);
    wearer.hover_for(300);
    assert_eq!(wearer.pipeline.state(), PipelineState::Paused);
    wearer.hover_for(10);
    assert_eq!(wearer.pipeline.state(), PipelineState::Running);
    wearer.press_for(300);
    wearer.hover_for(300);
    assert!(wearer.take_transcript().starts_with("down H, up H"));
}

#[test]
fn a_press_before_arming_is_never_typed() {
    let mut wearer = Wearer::new(&Setup::default());
    wearer.hover_for(200);
    wearer.press_for(500);
    assert_eq!(wearer.pipeline.state(), PipelineState::Paused);
    wearer.hover_for(250);
    wearer.press_for(500);
    wearer.hover_for(100);
    assert_eq!(wearer.take_transcript(), "");
}

#[test]
fn a_hand_on_a_key_at_the_start_presses_nothing() {
    let mut wearer = Wearer::new(&Setup::default());
    wearer.press_for(2_000);
    assert_eq!(wearer.pipeline.state(), PipelineState::Paused);
    assert_eq!(wearer.take_transcript(), "");
}

#[test]
fn with_start_armed_the_first_press_is_typed() {
    let setup = Setup {
        arm_immediately: true,
        ..Setup::default()
    };
    let mut wearer = Wearer::new(&setup);
    wearer.hover_for(20);
    wearer.press_for(300);
    assert_eq!(wearer.take_transcript(), "down H");
}

#[test]
fn with_start_armed_a_finger_on_a_key_must_leave_it_first() {
    let setup = Setup {
        arm_immediately: true,
        ..Setup::default()
    };
    let mut wearer = Wearer::new(&setup);
    wearer.press_for(500);
    assert_eq!(wearer.take_transcript(), "");
    wearer.hover_for(300);
    wearer.press_for(300);
    assert_eq!(wearer.take_transcript(), "down H");
}

#[test]
fn a_gap_longer_than_the_stall_timeout_releases_everything() {
    let mut wearer = Wearer::armed();
    wearer.press_for(300);
    wearer.skip(190);
    wearer.press_for(10);
    assert_eq!(wearer.take_transcript(), "down H", "a gap of 200 ms");
    let last = wearer.time_ms;
    wearer.skip(191);
    wearer.press_for(10);
    assert_eq!(wearer.take_transcript(), format!("up H at {}", last + 200));
    assert_eq!(wearer.pipeline.state(), PipelineState::Stalled);
    assert_eq!(wearer.pipeline.stalls(), 1);
}

#[test]
fn after_a_stall_the_hand_must_be_clear_of_every_key() {
    let mut wearer = Wearer::armed();
    wearer.press_for(300);
    wearer.skip(1_000);
    wearer.press_for(1_000);
    wearer.take_transcript();
    assert_eq!(wearer.pipeline.state(), PipelineState::Stalled);
    wearer.hover_for(200);
    wearer.press_for(300);
    assert_eq!(wearer.take_transcript(), "", "clear for 200 ms only");
    wearer.hover_for(500);
    wearer.press_for(300);
    assert_eq!(wearer.take_transcript(), "down H");
}

#[test]
fn a_gap_does_not_count_towards_arming() {
    let mut wearer = Wearer::new(&Setup::default());
    wearer.hover_for(200);
    wearer.skip(1_000);
    wearer.hover_for(20);
    assert_eq!(wearer.pipeline.state(), PipelineState::Stalled);
}

#[test]
fn a_stall_ends_every_contact() {
    let mut wearer = Wearer::armed();
    wearer.press_for(300);
    wearer.skip(1_000);
    let reading = Reading::new(
        Timestamp(wearer.time_ms * 1_000),
        None,
        Sample::Channels(wearer.hover.clone()),
    );
    let step = wearer.pipeline.step(&reading, &mut Events::new());
    let touches = &step.expect("a plausible reading").touches;
    assert!(touches.is_empty(), "{touches:?}");
}

#[test]
fn a_stall_by_clock_and_by_time_stamps_gives_the_same_events() {
    let mut by_clock = Wearer::armed();
    by_clock.press_for(300);
    let mut events = Events::new();
    by_clock.pipeline.stall(&mut events);
    by_clock.write(&events);
    let mut by_time_stamps = Wearer::armed();
    by_time_stamps.press_for(300);
    by_time_stamps.skip(5_000);
    by_time_stamps.hover_for(10);
    assert_eq!(by_clock.take_transcript(), by_time_stamps.take_transcript());
}

#[test]
fn a_second_stall_without_a_reading_is_not_counted() {
    let mut wearer = Wearer::armed();
    let mut events = Events::new();
    wearer.pipeline.stall(&mut events);
    wearer.pipeline.stall(&mut events);
    assert_eq!(wearer.pipeline.stalls(), 1);
}

#[test]
fn rejected_readings_do_not_prevent_a_stall() {
    let mut wearer = Wearer::armed();
    wearer.press_for(300);
    let mut broken = wearer.pressed.clone();
    broken.counts.truncate(17);
    wearer.hold(&broken, 250);
    assert!(wearer.take_transcript().contains("up H"));
    assert_eq!(wearer.pipeline.state(), PipelineState::Stalled);
    assert_eq!(
        wearer.pipeline.rejected()[Rejection::WrongShape.index()],
        25
    );
}

#[test]
fn a_jump_of_the_hand_releases_everything() {
    let mut wearer = Wearer::armed();
    wearer.press_for(300);
    let mut jumped = wearer.pressed.clone();
    jumped.counts[17] += 100;
    wearer.hold(&jumped, 30);
    let transcript = wearer.take_transcript();
    assert!(transcript.starts_with("down H, up H"), "{transcript}");
    assert_eq!(transcript.matches("down").count(), 1, "{transcript}");
}

#[test]
fn stop_releases_everything() {
    let mut wearer = Wearer::armed();
    wearer.press_for(300);
    let mut events = Events::new();
    wearer.pipeline.stop(&mut events);
    assert_eq!(wearer.pipeline.state(), PipelineState::Stopped);
    let up = EventKind::KeyUp("H".parse::<KeyCode>().expect("a key"));
    assert_eq!(
        events.iter().map(|event| event.kind).collect::<Vec<_>>(),
        [up]
    );
    wearer.hover_for(1_000);
    wearer.press_for(300);
    assert_eq!(wearer.pipeline.state(), PipelineState::Stopped);
    assert_eq!(wearer.take_transcript(), "down H");
}

#[test]
fn a_gap_after_stop_does_not_restart_the_pipeline() {
    let mut wearer = Wearer::armed();
    wearer.pipeline.stop(&mut Events::new());
    wearer.skip(1_000);
    wearer.hover_for(1_000);
    wearer.press_for(300);
    wearer.pipeline.stall(&mut Events::new());
    assert_eq!(wearer.pipeline.state(), PipelineState::Stopped);
    assert_eq!(wearer.take_transcript(), "");
}

#[test]
fn a_lost_source_after_stop_does_not_restart_the_pipeline() {
    let mut wearer = Wearer::armed();
    wearer.pipeline.stop(&mut Events::new());
    wearer.pipeline.lose(None, None, &mut Events::new());
    wearer.hover_for(1_000);
    wearer.press_for(300);
    assert_eq!(wearer.pipeline.state(), PipelineState::Stopped);
    assert_eq!(wearer.take_transcript(), "");
}

#[test]
fn a_new_layout_releases_everything_and_a_finger_in_a_key_must_leave_it() {
    let mut wearer = Wearer::armed();
    wearer.press_for(300);
    let last = wearer.time_ms;
    wearer.replace_with_dvorak();
    assert_eq!(wearer.take_transcript(), format!("down H, up H at {last}"));
    assert_eq!(wearer.pipeline.state(), PipelineState::Running);
    wearer.press_for(1_000);
    assert_eq!(
        wearer.take_transcript(),
        "",
        "the finger is still in the key"
    );
    wearer.hover_for(300);
    wearer.press_for(300);
    assert_eq!(wearer.take_transcript(), "down D");
}

#[test]
fn a_new_layout_is_usable_at_once_if_no_key_is_pressed() {
    let mut wearer = Wearer::armed();
    wearer.replace_with_dvorak();
    assert_eq!(wearer.take_transcript(), "");
    wearer.hover_for(10);
    wearer.press_for(300);
    assert_eq!(wearer.take_transcript(), "down D");
}

#[test]
fn arming_restarts_with_a_new_layout() {
    let mut wearer = Wearer::new(&Setup::default());
    wearer.hover_for(250);
    wearer.replace_with_dvorak();
    wearer.hover_for(300);
    assert_eq!(wearer.pipeline.state(), PipelineState::Paused);
    wearer.hover_for(10);
    assert_eq!(wearer.pipeline.state(), PipelineState::Running);
}

#[test]
fn a_hundred_new_layouts_release_a_pressed_key_once() {
    let mut wearer = Wearer::armed();
    wearer.press_for(300);
    for _ in 0..100 {
        wearer.press_for(10);
        wearer.replace_with_dvorak();
    }
    assert_eq!(wearer.take_transcript().matches(", up H").count(), 1);
}

#[test]
fn every_reading_is_accepted_or_rejected() {
    let mut wearer = Wearer::armed();
    let mut rejected = 0;
    for number in 0..500_u64 {
        wearer.time_ms += 10;
        let mut channels = wearer.hover.clone();
        channels.counts[17] = (number * 37 % 256) as u16;
        rejected += u64::from(wearer.send(&channels).is_some());
    }
    let accepted = wearer.pipeline.accepted();
    assert_eq!(
        accepted + wearer.pipeline.rejected().iter().sum::<u64>(),
        540
    );
    assert_eq!(wearer.pipeline.rejected().iter().sum::<u64>(), rejected);
    assert!(rejected >= 10, "{rejected}");
}

impl Wearer {
    fn pause(&mut self) {
        let mut events = Events::new();
        self.pipeline.pause(CommandOrigin::Client, &mut events);
        self.write(&events);
    }

    /// Raises the finger and presses the key again.
    fn tap(&mut self) {
        self.hover_for(400);
        self.press_for(100);
    }
}

#[test]
fn a_pause_releases_everything_until_resume_and_arming() {
    let mut wearer = Wearer::armed();
    wearer.press_for(100);
    wearer.pause();
    assert_eq!(wearer.take_transcript(), "down H, up H at 500");
    wearer.pause();
    wearer.tap();
    assert_eq!(wearer.pipeline.state(), PipelineState::Paused);

    wearer.pipeline.resume(CommandOrigin::Client);
    wearer.press_for(400);
    assert_eq!(wearer.pipeline.state(), PipelineState::Paused);
    wearer.hover_for(290);
    wearer.press_for(100);
    assert_eq!(wearer.take_transcript(), "", "clear for 290 ms only");
    wearer.tap();
    assert_eq!(wearer.take_transcript(), "down H");
}

#[test]
fn pauses_and_stalls_can_overlap() {
    let mut wearer = Wearer::armed();
    wearer.pause();
    wearer.skip(1_000);
    wearer.pipeline.stall(&mut Events::new());
    assert_eq!(wearer.pipeline.state(), PipelineState::Paused);
    assert_eq!(wearer.pipeline.stalls(), 1);
    wearer.tap();
    assert_eq!(wearer.take_transcript(), "");

    wearer.pipeline.stall(&mut Events::new());
    wearer.pipeline.resume(CommandOrigin::Client);
    assert_eq!(wearer.pipeline.state(), PipelineState::Stalled);
    wearer.pause();
    wearer.tap();
    assert_eq!(wearer.pipeline.state(), PipelineState::Paused);
    assert_eq!(wearer.take_transcript(), "");
    wearer.pipeline.resume(CommandOrigin::Client);
    wearer.tap();
    assert_eq!(wearer.take_transcript(), "down H");
}

#[test]
fn a_pause_outlasts_a_new_layout_and_ends_with_stop() {
    let mut wearer = Wearer::armed();
    wearer.pause();
    wearer.replace_with_dvorak();
    wearer.tap();
    assert_eq!(wearer.take_transcript(), "");
    wearer.pipeline.resume(CommandOrigin::Client);
    wearer.tap();
    assert_eq!(wearer.take_transcript(), "down D");

    wearer.pause();
    wearer.pipeline.stop(&mut Events::new());
    assert_eq!(wearer.pipeline.state(), PipelineState::Stopped);
    wearer.pause();
    assert_eq!(wearer.pipeline.state(), PipelineState::Stopped);
}

#[test]
fn a_pause_before_the_first_reading_overrides_start_armed() {
    let setup = Setup {
        arm_immediately: true,
        ..Setup::default()
    };
    let mut wearer = Wearer::new(&setup);
    wearer.pause();
    wearer.tap();
    wearer.pipeline.resume(CommandOrigin::Client);
    wearer.press_for(100);
    assert_eq!(wearer.take_transcript(), "");
    wearer.tap();
    assert_eq!(wearer.take_transcript(), "down H");
}

#[test]
fn resume_without_a_pause_releases_nothing() {
    let mut wearer = Wearer::armed();
    wearer.press_for(100);
    wearer.pipeline.resume(CommandOrigin::Client);
    wearer.press_for(100);
    assert_eq!(wearer.take_transcript(), "down H");
    assert_eq!(wearer.pipeline.state(), PipelineState::Running);
}

#[test]
fn presses_during_a_pause_are_never_released() {
    let actions: [fn(&mut Wearer, &mut Events); 4] = [
        |wearer, events| wearer.pipeline.stall(events),
        |wearer, events| wearer.pipeline.stop(events),
        |wearer, events| {
            let moved = wearer.pipeline.nudge(Vec3::X * 0.01, events);
            moved.expect("a valid position");
        },
        |wearer, _| wearer.replace_with_dvorak(),
    ];
    for action in actions {
        let mut wearer = Wearer::armed();
        wearer.pause();
        wearer.tap();
        let mut events = Events::new();
        action(&mut wearer, &mut events);
        wearer.write(&events);
        assert_eq!(wearer.take_transcript(), "");
    }
}
