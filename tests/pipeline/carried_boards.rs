//! The shipped board that one hand of the simulated person carries and the other one uses, and what happens to its keys.

use ademan::capture::{Hc11Format, Reading, Sample, Source, SourceEvent};
use ademan::device::{EventKind, Events};
use ademan::hand::{FingerSet, Joint, JointPositions, Side};
use ademan::setup::{LoadedSetup, OtherHand, Setup};
use ademan::sim::SimulatedTypist;
use glam::DVec3;

use crate::support::checked::CheckedPipeline;

const SCRIPT: &str = "tap F5; wait 700; tap PageDown; wait 900; tap Escape";

/// The events of the script.
const KEYS: &str = "F5 -F5 PageDown -PageDown Escape -Escape";

/// A person who plays a script, and the pipeline that receives the readings.
struct Carrying {
    pipeline: CheckedPipeline,
    hand: SimulatedTypist,
    /// The keys that went down (`F5`) and up (`-F5`).
    keys: Vec<String>,
    /// The wrist of the carrying hand at each key.
    wrists: Vec<DVec3>,
    wrist: DVec3,
}

impl Carrying {
    fn new(script: &str) -> Self {
        let setup = setup();
        let hand = setup.scripted(script, &Hc11Format::default(), 0.0, 0);
        Self {
            pipeline: CheckedPipeline::new(&setup),
            hand: hand.unwrap_or_else(|error| panic!("{error}")),
            keys: Vec::new(),
            wrists: Vec::new(),
            wrist: DVec3::ZERO,
        }
    }

    /// Returns the next reading; `None` at the end.
    fn next(&mut self) -> Option<Reading> {
        match self.hand.next() {
            Ok(SourceEvent::Reading(reading)) => Some(reading),
            _ => None,
        }
    }

    fn step(&mut self, reading: &Reading) {
        let mut events = Events::new();
        let step = self.pipeline.step(reading, &mut events);
        step.map(drop).expect("an accepted reading");
        self.keep(&events);
        if reading.side == Some(Side::Left)
            && let Sample::Joints { positions } = &reading.sample
        {
            self.wrist = positions.get(Joint::Wrist).unwrap_or(self.wrist);
        }
    }

    fn keep(&mut self, events: &Events) {
        for event in events {
            match event.kind {
                EventKind::KeyDown(key) => self.keys.push(key.name().to_owned()),
                EventKind::KeyUp(key) => self.keys.push(format!("-{}", key.name())),
                _ => continue,
            }
            self.wrists.push(self.wrist);
        }
    }

    /// Plays until a key is down.
    fn press(&mut self) {
        while self.keys.is_empty() {
            let reading = self.next().expect("a key goes down before the end");
            self.step(&reading);
        }
    }

    fn keys(&self) -> String {
        self.keys.join(" ")
    }
}

fn setup() -> LoadedSetup {
    let setup = Setup {
        layout: "wrist-remote".into(),
        other_hand: Some(OtherHand::default()),
        ..Setup::default()
    };
    setup.load_files().expect("a shipped layout")
}

/// Returns a reading of a hand that is not seen.
fn unseen(reading: &Reading) -> Reading {
    let positions = JointPositions::default();
    Reading::new(reading.time, reading.side, Sample::Joints { positions })
}

#[test]
fn keys_are_pressed_while_the_hand_that_carries_them_moves() {
    let mut person = Carrying::new(SCRIPT);
    while let Some(reading) = person.next() {
        person.step(&reading);
    }
    assert_eq!(person.keys(), KEYS);
    let moved = |pair: &[DVec3]| pair[0].distance(pair[1]) > 0.001;
    assert!(person.wrists.windows(2).all(moved), "{:?}", person.wrists);
    let presses = [0, 2, 4].map(|index| person.wrists[index]);
    let moved_far = |pair: &[DVec3]| pair[0].distance(pair[1]) > 0.008;
    assert!(presses.windows(2).all(moved_far), "{presses:?}");
}

#[test]
fn a_finger_misses_the_keys_of_a_hand_that_is_carried_away_from_it() {
    let mut person = Carrying::new(SCRIPT);
    while let Some(mut reading) = person.next() {
        if reading.side == Some(Side::Left)
            && let Sample::Joints { positions } = &mut reading.sample
        {
            for (joint, position) in positions.clone().known() {
                positions.set(joint, position - DVec3::Y * 0.05);
            }
        }
        person.step(&reading);
    }
    assert_eq!(person.keys(), "");
}

#[test]
fn a_carrying_hand_that_is_no_longer_seen_releases_the_key_in_the_step_that_loses_it() {
    let mut person = Carrying::new("press PageDown; wait 2000; lift");
    person.press();
    let mut is_lost = false;
    while !is_lost {
        assert_eq!(person.keys(), "PageDown");
        let mut reading = person.next().expect("the finger stays down");
        if reading.side == Some(Side::Left) {
            reading = unseen(&reading);
        }
        person.step(&reading);
        let estimate = &person.pipeline.output_for(&reading).estimate;
        is_lost = reading.side == Some(Side::Left) && estimate.untrusted == FingerSet::ALL;
    }
    assert_eq!(person.keys(), "PageDown -PageDown");
}

#[test]
fn a_carrying_hand_whose_source_is_lost_releases_the_key_at_once_and_presses_nothing_when_it_returns()
 {
    let mut person = Carrying::new("press PageDown; wait 2000; lift");
    person.press();
    let mut events = Events::new();
    person.pipeline.lose(Some(Side::Left), None, &mut events);
    person.keep(&events);
    assert_eq!(person.keys(), "PageDown -PageDown");
    // The finger is inside the key and has to leave it first.
    while let Some(reading) = person.next() {
        person.step(&reading);
    }
    assert_eq!(person.keys(), "PageDown -PageDown");
}
