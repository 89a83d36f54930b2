//! When the engine lets events out, and that it lets go of everything in time.

use crate::support::checked::Judged;
use ademan::capture::{Channels, Reading, Sample, Source, SourceEvent, StreamOptions};
use ademan::contact::Phase;
use ademan::device::{EventKind, Events, KeyCode};
use ademan::estimate::Rejection;
use ademan::layout::Layout;
use ademan::setup::{Setup, controls};
use ademan::snapshot::PipelineState;
use ademan::time::Timestamp;
use parry3d::math::Vec3;

/// A wearer whose hand is over the H key or pushes it in, 100 readings a second.
struct Wearer {
    pipeline: Judged,
    time_ms: u64,
    over: Channels,
    down: Channels,
    transcript: Vec<String>,
}

/// The counts of the glove over the H key, and with the key pushed in.
fn postures(setup: &Setup) -> (Channels, Channels) {
    let assembly = setup.clone().load_files().expect("the default setup");
    let hand = assembly.typist("h", &StreamOptions::default(), 0.0, 0);
    let mut hand = hand.expect("h can be typed");
    let mut pipeline = assembly.pipeline();
    let (mut over, mut down) = (None, None);
    let mut events = Events::new();
    while let Ok(SourceEvent::Reading(reading)) = hand.next() {
        let Sample::Channels(channels) = reading.sample.clone() else {
            panic!("a glove has channels");
        };
        over.get_or_insert(channels.clone());
        let frame = pipeline.step(&reading, &mut events).expect("an able hand");
        let deepest = frame
            .touches
            .iter()
            .any(|touch| touch.phase == Phase::Moved && touch.depth == 1.0);
        if deepest && down.is_none() {
            down = Some(channels);
        }
    }
    (
        over.expect("a first posture"),
        down.expect("the key goes down"),
    )
}

impl Wearer {
    fn new(setup: &Setup) -> Self {
        let (over, down) = postures(setup);
        let assembly = setup.clone().load_files().expect("the default setup");
        Self {
            pipeline: Judged::of(&assembly),
            time_ms: 0,
            over,
            down,
            transcript: Vec::new(),
        }
    }

    fn armed() -> Self {
        let mut wearer = Self::new(&Setup::default());
        wearer.stay_over(400);
        assert_eq!(wearer.pipeline.state(), PipelineState::Running);
        wearer
    }

    fn feed(&mut self, channels: &Channels) -> Option<Rejection> {
        let reading = Reading {
            time: Timestamp(self.time_ms * 1_000),
            side: None,
            sample: Sample::Channels(channels.clone()),
        };
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

    fn stay(&mut self, channels: &Channels, milliseconds: u64) {
        for _ in 0..milliseconds / 10 {
            self.time_ms += 10;
            self.feed(channels);
        }
    }

    fn stay_over(&mut self, milliseconds: u64) {
        self.stay(&self.over.clone(), milliseconds);
    }

    fn push_down(&mut self, milliseconds: u64) {
        self.stay(&self.down.clone(), milliseconds);
    }

    fn wait(&mut self, milliseconds: u64) {
        self.time_ms += milliseconds;
    }

    /// Puts another layout in force: where it was H it is D.
    fn switch_to_dvorak(&mut self) {
        let layout = Layout::load("dvorak-flat").expect("the shipped layout");
        let mut events = Events::new();
        self.pipeline
            .replace(0, &mut controls(&layout), &layout, &mut events);
        self.write(&events);
    }

    fn said(&mut self) -> String {
        std::mem::take(&mut self.transcript).join(", ")
    }
}

#[test]
fn it_starts_paused_and_arms_when_the_hand_was_off_all_keys_for_300_ms() {
    let mut wearer = Wearer::new(&Setup::default());
    assert_eq!(wearer.pipeline.state(), PipelineState::Starting);
    wearer.stay_over(300);
    assert_eq!(wearer.pipeline.state(), PipelineState::Paused);
    wearer.stay_over(10);
    assert_eq!(wearer.pipeline.state(), PipelineState::Running);
    wearer.push_down(300);
    wearer.stay_over(300);
    assert!(wearer.said().starts_with("down H, up H"));
}

#[test]
fn a_press_before_it_is_armed_is_never_typed() {
    let mut wearer = Wearer::new(&Setup::default());
    wearer.stay_over(200);
    wearer.push_down(500);
    assert_eq!(wearer.pipeline.state(), PipelineState::Paused);
    wearer.stay_over(250);
    wearer.push_down(500);
    wearer.stay_over(100);
    assert_eq!(wearer.said(), "");
}

#[test]
fn a_hand_that_lies_on_a_key_at_the_start_presses_nothing() {
    let mut wearer = Wearer::new(&Setup::default());
    wearer.push_down(2_000);
    assert_eq!(wearer.pipeline.state(), PipelineState::Paused);
    assert_eq!(wearer.said(), "");
}

#[test]
fn armed_by_flag_it_types_from_the_first_reading_on() {
    let setup = Setup {
        start_armed: true,
        ..Setup::default()
    };
    let mut wearer = Wearer::new(&setup);
    wearer.stay_over(20);
    wearer.push_down(300);
    assert_eq!(wearer.said(), "down H");
}

#[test]
fn even_then_a_finger_that_was_on_the_key_has_to_leave_first() {
    let setup = Setup {
        start_armed: true,
        ..Setup::default()
    };
    let mut wearer = Wearer::new(&setup);
    wearer.push_down(500);
    assert_eq!(wearer.said(), "");
    wearer.stay_over(300);
    wearer.push_down(300);
    assert_eq!(wearer.said(), "down H");
}

#[test]
fn readings_that_stay_away_release_everything_at_the_limit() {
    let mut wearer = Wearer::armed();
    wearer.push_down(300);
    wearer.wait(190);
    wearer.push_down(10);
    assert_eq!(wearer.said(), "down H", "200 ms are not too long");
    let last = wearer.time_ms;
    wearer.wait(191);
    wearer.push_down(10);
    assert_eq!(wearer.said(), format!("up H at {}", last + 200));
    assert_eq!(wearer.pipeline.state(), PipelineState::Stalled);
    assert_eq!(wearer.pipeline.stalls(), 1);
}

#[test]
fn after_a_stall_the_hand_has_to_be_seen_off_all_keys() {
    let mut wearer = Wearer::armed();
    wearer.push_down(300);
    wearer.wait(1_000);
    wearer.push_down(1_000);
    wearer.said();
    assert_eq!(wearer.pipeline.state(), PipelineState::Stalled);
    wearer.stay_over(200);
    wearer.push_down(300);
    assert_eq!(wearer.said(), "", "200 ms are too short");
    wearer.stay_over(500);
    wearer.push_down(300);
    assert_eq!(wearer.said(), "down H");
}

#[test]
fn time_in_which_nothing_was_seen_does_not_arm() {
    let mut wearer = Wearer::new(&Setup::default());
    wearer.stay_over(200);
    wearer.wait(1_000);
    wearer.stay_over(20);
    assert_eq!(wearer.pipeline.state(), PipelineState::Stalled);
}

#[test]
fn a_stall_ends_every_contact() {
    let mut wearer = Wearer::armed();
    wearer.push_down(300);
    wearer.wait(1_000);
    let reading = Reading {
        time: Timestamp(wearer.time_ms * 1_000),
        side: None,
        sample: Sample::Channels(wearer.over.clone()),
    };
    let frame = wearer.pipeline.step(&reading, &mut Events::new());
    let touches = &frame.expect("an able hand").touches;
    assert!(touches.is_empty(), "{touches:?}");
}

#[test]
fn the_watchdog_and_the_times_of_the_readings_tell_the_same_stall() {
    let mut by_watchdog = Wearer::armed();
    by_watchdog.push_down(300);
    let mut events = Events::new();
    by_watchdog.pipeline.stall(&mut events);
    by_watchdog.write(&events);
    let mut by_times = Wearer::armed();
    by_times.push_down(300);
    by_times.wait(5_000);
    by_times.stay_over(10);
    assert_eq!(by_watchdog.said(), by_times.said());
}

#[test]
fn a_second_stall_without_a_reading_in_between_is_no_stall() {
    let mut wearer = Wearer::armed();
    let mut events = Events::new();
    wearer.pipeline.stall(&mut events);
    wearer.pipeline.stall(&mut events);
    assert_eq!(wearer.pipeline.stalls(), 1);
}

#[test]
fn readings_that_cannot_be_used_are_no_readings() {
    let mut wearer = Wearer::armed();
    wearer.push_down(300);
    let mut broken = wearer.down.clone();
    // An elbow at 1 count is bent 17 degrees the wrong way.
    broken.counts[17] = 1;
    wearer.stay(&broken, 250);
    assert!(wearer.said().contains("up H"));
    assert_eq!(wearer.pipeline.state(), PipelineState::Stalled);
    assert_eq!(
        wearer.pipeline.rejected()[Rejection::OutsideLimits.index()],
        25
    );
}

#[test]
fn a_hand_that_is_suddenly_elsewhere_lets_go() {
    let mut wearer = Wearer::armed();
    wearer.push_down(300);
    let mut elsewhere = wearer.down.clone();
    elsewhere.counts[17] += 100;
    wearer.stay(&elsewhere, 30);
    assert!(wearer.said().contains("down H, up H"));
}

#[test]
fn the_end_lets_go_of_everything() {
    let mut wearer = Wearer::armed();
    wearer.push_down(300);
    let mut events = Events::new();
    wearer.pipeline.stop(&mut events);
    assert_eq!(wearer.pipeline.state(), PipelineState::Stopped);
    let up = EventKind::KeyUp("H".parse::<KeyCode>().expect("a key"));
    assert_eq!(
        events.iter().map(|event| event.kind).collect::<Vec<_>>(),
        [up]
    );
    wearer.stay_over(1_000);
    wearer.push_down(300);
    assert_eq!(wearer.pipeline.state(), PipelineState::Stopped);
    assert_eq!(wearer.said(), "down H");
}

#[test]
fn readings_that_stay_away_after_the_end_begin_nothing_anew() {
    let mut wearer = Wearer::armed();
    wearer.pipeline.stop(&mut Events::new());
    wearer.wait(1_000);
    wearer.stay_over(1_000);
    wearer.push_down(300);
    wearer.pipeline.stall(&mut Events::new());
    assert_eq!(wearer.pipeline.state(), PipelineState::Stopped);
    assert_eq!(wearer.said(), "");
}

#[test]
fn a_new_layout_lets_go_first_and_a_finger_in_a_key_of_it_has_to_leave() {
    let mut wearer = Wearer::armed();
    wearer.push_down(300);
    let last = wearer.time_ms;
    wearer.switch_to_dvorak();
    assert_eq!(wearer.said(), format!("down H, up H at {last}"));
    assert_eq!(wearer.pipeline.state(), PipelineState::Running);
    wearer.push_down(1_000);
    assert_eq!(wearer.said(), "", "the finger has not left the key");
    wearer.stay_over(300);
    wearer.push_down(300);
    assert_eq!(wearer.said(), "down D");
}

#[test]
fn a_new_layout_while_no_key_is_down_is_typed_on_at_once() {
    let mut wearer = Wearer::armed();
    wearer.switch_to_dvorak();
    assert_eq!(wearer.said(), "");
    wearer.stay_over(10);
    wearer.push_down(300);
    assert_eq!(wearer.said(), "down D");
}

#[test]
fn a_paused_hand_has_to_be_seen_off_all_keys_of_a_new_layout() {
    let mut wearer = Wearer::new(&Setup::default());
    wearer.stay_over(250);
    wearer.switch_to_dvorak();
    wearer.stay_over(300);
    assert_eq!(wearer.pipeline.state(), PipelineState::Paused);
    wearer.stay_over(10);
    assert_eq!(wearer.pipeline.state(), PipelineState::Running);
}

#[test]
fn a_hundred_new_layouts_while_a_key_is_held_let_go_of_it_once() {
    let mut wearer = Wearer::armed();
    wearer.push_down(300);
    for _ in 0..100 {
        wearer.push_down(10);
        wearer.switch_to_dvorak();
    }
    assert_eq!(wearer.said().matches(", up H").count(), 1);
}

#[test]
fn every_reading_is_accounted_for() {
    let mut wearer = Wearer::armed();
    let mut rejected = 0;
    for number in 0..500_u64 {
        wearer.time_ms += 10;
        let mut channels = wearer.over.clone();
        channels.counts[17] = (number * 37 % 256) as u16;
        rejected += u64::from(wearer.feed(&channels).is_some());
    }
    let accepted = wearer.pipeline.accepted();
    assert_eq!(
        accepted + wearer.pipeline.rejected().iter().sum::<u64>(),
        540
    );
    assert_eq!(wearer.pipeline.rejected().iter().sum::<u64>(), rejected);
    assert!(rejected > 100);
}

impl Wearer {
    fn pause(&mut self) {
        let mut events = Events::new();
        self.pipeline.pause(&mut events);
        self.write(&events);
    }

    /// Lifts the finger and pushes the key down again.
    fn type_once(&mut self) {
        self.stay_over(400);
        self.push_down(100);
    }
}

#[test]
fn a_pause_lets_go_and_nothing_goes_out_until_it_is_ended_and_the_hand_was_off() {
    let mut wearer = Wearer::armed();
    wearer.push_down(100);
    wearer.pause();
    assert_eq!(wearer.said(), "down H, up H at 500");
    wearer.pause();
    wearer.type_once();
    assert_eq!(wearer.pipeline.state(), PipelineState::Paused);

    wearer.pipeline.resume();
    wearer.push_down(400);
    assert_eq!(wearer.pipeline.state(), PipelineState::Paused);
    wearer.stay_over(290);
    wearer.push_down(100);
    assert_eq!(wearer.said(), "", "not off all keys for long enough");
    wearer.type_once();
    assert_eq!(wearer.said(), "down H");
}

#[test]
fn a_stall_while_paused_stays_paused_and_a_pause_while_stalled_is_one_too() {
    let mut wearer = Wearer::armed();
    wearer.pause();
    wearer.wait(1_000);
    wearer.pipeline.stall(&mut Events::new());
    assert_eq!(wearer.pipeline.state(), PipelineState::Paused);
    assert_eq!(wearer.pipeline.stalls(), 1);
    wearer.type_once();
    assert_eq!(wearer.said(), "");

    wearer.pipeline.stall(&mut Events::new());
    wearer.pipeline.resume();
    assert_eq!(wearer.pipeline.state(), PipelineState::Stalled);
    wearer.pause();
    wearer.type_once();
    assert_eq!(wearer.pipeline.state(), PipelineState::Paused);
    assert_eq!(wearer.said(), "");
    wearer.pipeline.resume();
    wearer.type_once();
    assert_eq!(wearer.said(), "down H");
}

#[test]
fn a_pause_outlasts_a_new_layout_and_ends_with_the_run() {
    let mut wearer = Wearer::armed();
    wearer.pause();
    wearer.switch_to_dvorak();
    wearer.type_once();
    assert_eq!(wearer.said(), "");
    wearer.pipeline.resume();
    wearer.type_once();
    assert_eq!(wearer.said(), "down D");

    wearer.pause();
    wearer.pipeline.stop(&mut Events::new());
    assert_eq!(wearer.pipeline.state(), PipelineState::Stopped);
    wearer.pause();
    assert_eq!(wearer.pipeline.state(), PipelineState::Stopped);
}

#[test]
fn a_pause_before_the_first_reading_holds_though_that_would_arm() {
    let setup = Setup {
        start_armed: true,
        ..Setup::default()
    };
    let mut wearer = Wearer::new(&setup);
    wearer.pause();
    wearer.type_once();
    wearer.pipeline.resume();
    wearer.push_down(100);
    assert_eq!(wearer.said(), "");
    wearer.type_once();
    assert_eq!(wearer.said(), "down H");
}

#[test]
fn ending_no_pause_does_not_let_go() {
    let mut wearer = Wearer::armed();
    wearer.push_down(100);
    wearer.pipeline.resume();
    wearer.push_down(100);
    assert_eq!(wearer.said(), "down H");
    assert_eq!(wearer.pipeline.state(), PipelineState::Running);
}

#[test]
fn what_is_played_for_nothing_in_a_pause_never_comes_up() {
    let ends: [fn(&mut Wearer, &mut Events); 4] = [
        |wearer, events| wearer.pipeline.stall(events),
        |wearer, events| wearer.pipeline.stop(events),
        |wearer, events| {
            let moved = wearer.pipeline.nudge(Vec3::X * 0.01, events);
            moved.expect("a board can go so far");
        },
        |wearer, _| wearer.switch_to_dvorak(),
    ];
    for end in ends {
        let mut wearer = Wearer::armed();
        wearer.pause();
        wearer.type_once();
        let mut events = Events::new();
        end(&mut wearer, &mut events);
        wearer.write(&events);
        assert_eq!(wearer.said(), "");
    }
}
