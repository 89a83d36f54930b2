//! Filters of presses in the whole pipeline: a simulated hand types through them.

use std::sync::mpsc;

use ademan::capture::{Hc11Format, Source, SourceEvent};
use ademan::command::CommandOrigin;
use ademan::device::{EventKind, Events, KeyCode, OutputEvent};
use ademan::hand::Side;
use ademan::pipeline::press_filter::FilterInput;
use ademan::pipeline::{LayoutInstance, PipelineState, PressFilter};
use ademan::setup::Setup;
use ademan::sim::UsTextField;

use crate::support::wearer::shipped_setup;

fn key(name: &str) -> KeyCode {
    name.parse().expect("the name of a key")
}

/// Types `x` for each press by the index finger that has a key within 10 mm beside it.
struct Replace;

impl PressFilter for Replace {
    fn filter(&mut self, input: &FilterInput, events: &mut Events) {
        let is_close = |press: &ademan::contact::Press| {
            let nearest = press.neighbors.first();
            nearest.is_some_and(|neighbor| neighbor.distance < 0.01)
        };
        if !input.presses.iter().any(is_close) {
            return;
        }
        for event in events {
            if matches!(event.kind, EventKind::KeyDown(_)) {
                event.kind = EventKind::KeyDown(key("X"));
            }
        }
    }

    fn reset(&mut self) {}
}

/// Holds each press until it is reset.
#[derive(Default)]
struct Hold {
    held: Vec<OutputEvent>,
    is_reset: bool,
}

impl PressFilter for Hold {
    fn filter(&mut self, _: &FilterInput, events: &mut Events) {
        let is_press = |event: &OutputEvent| matches!(event.kind, EventKind::KeyDown(_));
        self.held.extend(events.iter().copied().filter(is_press));
        events.retain(|event| !is_press(event));
        if self.is_reset {
            // A filter that disobeys: it emits what it held before the reset.
            events.extend(self.held.drain(..));
        }
    }

    fn reset(&mut self) {
        self.is_reset = true;
    }
}

/// Holds each press until the next step, and reports it.
struct Delay {
    held: Option<OutputEvent>,
    holds: mpsc::Sender<()>,
}

impl PressFilter for Delay {
    fn filter(&mut self, _: &FilterInput, events: &mut Events) {
        let is_press = |event: &OutputEvent| matches!(event.kind, EventKind::KeyDown(_));
        let held = self.held.take();
        if let Some(index) = events.iter().position(is_press) {
            self.held = Some(events.remove(index));
            self.holds.send(()).expect("a receiver");
        }
        events.extend(held);
    }

    fn reset(&mut self) {
        self.held = None;
    }
}

/// Fills each list of events.
struct Fill;

impl PressFilter for Fill {
    fn filter(&mut self, input: &FilterInput, events: &mut Events) {
        let movement = OutputEvent {
            time: input.time,
            kind: EventKind::MoveBy(1, 0),
        };
        while events.try_push(movement).is_ok() {}
    }

    fn reset(&mut self) {}
}

/// Reports the candidates that are chosen, and swipes all the time or never.
struct Chosen {
    numbers: mpsc::Sender<u8>,
    is_swiping: bool,
}

impl PressFilter for Chosen {
    fn filter(&mut self, _: &FilterInput, _: &mut Events) {}

    fn reset(&mut self) {}

    fn choose(&mut self, number: u8) {
        self.numbers.send(number).expect("a receiver");
    }

    fn ignores_presses(&self, side: Side) -> bool {
        self.is_swiping && side == Side::Right
    }
}

/// Types a text with a filter, and pauses after this number of readings. Returns the text, the events and the keys that stay down.
fn typed(text: &str, filter: Box<dyn PressFilter>, pause_after: usize) -> (String, usize, usize) {
    let setup = Setup::default().load_files().expect("the shipped layout");
    let format = Hc11Format::default();
    let mut hand = setup.typist(text, &format, 0.0, 0).expect("a text");
    let mut pipeline = setup.pipeline().with_filter(filter);
    let (mut field, mut down, mut presses) = (UsTextField::new(), Vec::new(), 0);
    let mut count = 0;
    while let Ok(SourceEvent::Reading(reading)) = hand.next() {
        let mut events = Events::new();
        pipeline
            .step(&reading, &mut events)
            .expect("a clear reading");
        count += 1;
        if count == pause_after {
            pipeline.pause(CommandOrigin::Client, &mut events);
        }
        for event in &events {
            field.handle(event);
            match event.kind {
                EventKind::KeyDown(key) => {
                    presses += 1;
                    down.push(key);
                }
                EventKind::KeyUp(key) => down.retain(|other| *other != key),
                _ => {}
            }
        }
    }
    (field.text().to_owned(), presses, down.len())
}

#[test]
fn a_filter_replaces_keys_by_the_evidence_of_their_presses() {
    // The hand presses the middle of the space bar, which is far from its neighbors.
    assert_eq!(
        typed("ab c", Box::new(Replace), usize::MAX),
        ("xx x".to_owned(), 4, 0)
    );
}

#[test]
fn presses_that_a_filter_holds_leave_no_key_down() {
    let (text, presses, down) = typed("ab c", Box::new(Hold::default()), usize::MAX);
    assert_eq!((text.as_str(), presses, down), ("", 0, 0));
}

#[test]
fn nothing_is_emitted_after_a_pause_whatever_a_filter_holds() {
    let (text, presses, down) = typed("ab c", Box::new(Hold::default()), 300);
    assert_eq!((text.as_str(), presses, down), ("", 0, 0));
}

#[test]
fn a_pause_for_whose_releases_there_is_no_room_releases_in_the_next_step() {
    let mut pressed = 0;
    // The hand types in the first half of this time.
    for pause_after in (1..400).step_by(7) {
        let (_, presses, down) = typed("ab", Box::new(Fill), pause_after);
        assert_eq!(down, 0, "a pause after {pause_after} readings");
        pressed += presses;
    }
    assert!(pressed > 0);
}

#[test]
fn a_press_that_a_filter_held_at_a_pause_does_not_follow_when_the_run_is_resumed() {
    for is_paused in [false, true] {
        let setup = Setup::default().load_files().expect("the shipped layout");
        let format = Hc11Format::default();
        let mut hand = setup.typist("a", &format, 0.0, 0).expect("a text");
        let (holds, held) = mpsc::channel();
        let filter = Box::new(Delay { held: None, holds });
        let mut pipeline = setup.pipeline().with_filter(filter);
        let mut presses = 0;
        while let Ok(SourceEvent::Reading(reading)) = hand.next() {
            let mut events = Events::new();
            let step = pipeline.step(&reading, &mut events);
            step.expect("a clear reading");
            presses += events.iter().filter(|event| event.kind.is_press()).count();
            if held.try_recv().is_ok() && is_paused {
                pipeline.pause(CommandOrigin::Client, &mut Events::new());
                pipeline.resume(CommandOrigin::Client);
            }
        }
        assert_eq!(pipeline.state(), PipelineState::Running);
        assert_eq!(presses, usize::from(!is_paused));
    }
}

#[test]
fn a_hand_that_swipes_takes_no_candidate() {
    let setup = shipped_setup("qwerty-swipe");
    for (is_swiping, expected) in [(false, vec![2_u8]), (true, Vec::new())] {
        let (numbers, chosen) = mpsc::channel();
        let filter = Chosen {
            numbers,
            is_swiping,
        };
        let layout = LayoutInstance::from_layout(&setup.layout);
        let mut layout = layout.with_filter(Some(Box::new(filter)));
        let mut pipeline = setup.pipeline();
        pipeline.replace_profile(0, &mut layout, &mut Events::new());
        let hand = setup.scripted("tap candidate-2", &Hc11Format::default(), 0.0, 0);
        let mut hand = hand.expect("a script");
        while let Ok(SourceEvent::Reading(reading)) = hand.next() {
            let step = pipeline.step(&reading, &mut Events::new());
            step.expect("a clear reading");
        }
        let chosen: Vec<u8> = chosen.try_iter().collect();
        assert_eq!(chosen, expected);
    }
}
