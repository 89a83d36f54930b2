//! Hands that a camera or a headset follows, from lines to keys: hands that are lost, exchanged, or of the other side.

use ademan::capture::protocol::{hand_landmarks, joint_sets};
use ademan::capture::{Reading, SourceUri};
use ademan::command::{Command, CommandOrigin};
use ademan::device::{EventKind, Events};
use ademan::hand::{Finger, Joint, JointPositions, Side};
use ademan::pipeline::PipelineState;
use ademan::setup::{LoadedSetup, OtherHand, Setup};
use ademan::time::Timestamp;
use glam::DVec3;

use crate::support::checked::CheckedPipeline;
use crate::support::wearer::load_layout;

/// A layout with F below the left index finger and J below the right one, in front of a camera at the head.
const TWO_KEYS: &str = r#"Layout(name: "Two keys", boards: [
    (hand: "left", pose: (anchor: world, right_mm: -150, forward_mm: 470, height_mm: -270), size_mm: Box(40, 40), travel_mm: 10, keys: [(code: "F", at_mm: (0, 0))]),
    (hand: "right", pose: (anchor: world, right_mm: 150, forward_mm: 470, height_mm: -270), size_mm: Box(40, 40), travel_mm: 10, keys: [(code: "J", at_mm: (0, 0))]),
])"#;

/// A pointer around the right index fingertip, for the first hand that is seen.
const POINTER: &str = r#"Layout(name: "Point", pointer: Pointer(mode: Direct(
    pose: (anchor: world, right_mm: 150, forward_mm: 470, height_mm: -210), size_mm: (200, 200, 200),
)))"#;

const RATE_HZ: f64 = 30.0;

/// Heights of the index fingertip above its key and on it, in metres.
const ABOVE: f64 = -0.21;
const ON_KEY: f64 = -0.275;

/// Returns a hand with stretched fingers whose index fingertip has this height above the key of its side.
fn hand(side: Side, height: f64) -> (Side, JointPositions) {
    let sign = match side {
        Side::Left => -1.0,
        Side::Right => 1.0,
    };
    let mut positions = JointPositions::default();
    let wrist = DVec3::new(sign * 0.15, height, -0.30);
    positions.set(Joint::Wrist, wrist);
    for (column, finger) in Finger::ALL.iter().enumerate() {
        // The index finger is straight ahead, the thumb towards the other hand. The others are higher.
        let across = sign * 0.02 * (column as f64 - 1.0);
        let raise = if *finger == Finger::Index { 0.0 } else { 0.04 };
        for (bone, &joint) in finger.joints().iter().rev().enumerate() {
            let ahead = -0.17 + 0.03 * bone as f64;
            positions.set(joint, wrist + DVec3::new(across, raise, ahead));
        }
    }
    (side, positions)
}

/// A setup with two hands whose readings are lines of a protocol.
struct Tracker {
    pipeline: CheckedPipeline,
    decoder: Box<dyn ademan::capture::protocol::Decoder>,
    encode: fn(&[(Side, JointPositions)]) -> String,
    keys: Vec<String>,
}

fn setup(source: &str, layout: &str, other_hand: Option<OtherHand>) -> LoadedSetup {
    let setup = Setup {
        source: Some(source.parse().expect("a source")),
        other_hand,
        ..Setup::default()
    };
    load_layout(layout, setup)
}

impl Tracker {
    /// Creates a tracker that sees both hands above their keys, with armed output.
    fn new(source: &str, encode: fn(&[(Side, JointPositions)]) -> String) -> Self {
        let mut tracker = Self::of(setup(source, TWO_KEYS, Some(OtherHand::default())), encode);
        tracker.see(&[hand(Side::Left, ABOVE), hand(Side::Right, ABOVE)], 15);
        assert_eq!(tracker.pipeline.state(), PipelineState::Running);
        tracker
    }

    /// Creates a tracker that has seen nothing.
    fn of(setup: LoadedSetup, encode: fn(&[(Side, JointPositions)]) -> String) -> Self {
        let Some(SourceUri::Stream(stream)) = &setup.setup.source else {
            panic!("a stream");
        };
        let decoder = stream.format.decoder();
        Self {
            pipeline: CheckedPipeline::new(&setup),
            decoder,
            encode,
            keys: Vec::new(),
        }
    }

    /// Steps a number of equal lines. Returns the presses, releases and motions.
    fn see(&mut self, hands: &[(Side, JointPositions)], lines: usize) -> Vec<String> {
        let line = (self.encode)(hands);
        for _ in 0..lines {
            self.line(&line);
        }
        std::mem::take(&mut self.keys)
    }

    fn line(&mut self, line: &str) {
        let (pipeline, keys) = (&mut self.pipeline, &mut self.keys);
        self.decoder.push(line.as_bytes(), &mut |packet| {
            let time = packet.time.expect("a nominal time");
            let mut events = Events::new();
            let reading = Reading::new(time, packet.side, packet.sample);
            let _ = pipeline.step(&reading, &mut events);
            for event in &events {
                match event.kind {
                    EventKind::KeyDown(key) => keys.push(format!("down {key}")),
                    EventKind::KeyUp(key) => keys.push(format!("up {key}")),
                    EventKind::MoveTo(..) => keys.push("move".to_owned()),
                    _ => {}
                }
            }
        });
    }

    /// Moves the right hand, in lines of 13 mm each, while the left one rests.
    fn move_right(&mut self, from: f64, to: f64) -> Vec<String> {
        let mut keys = Vec::new();
        for step in 0..=8 {
            let height = from + (to - from) * (f64::from(step) / 5.0).min(1.0);
            keys.extend(self.see(&[hand(Side::Left, ABOVE), hand(Side::Right, height)], 1));
        }
        keys
    }
}

fn trackers() -> [Tracker; 3] {
    [
        Tracker::new("stdin:?protocol=hand-landmarks&camera=head", |hands| {
            hand_landmarks::encode(None, hands)
        }),
        Tracker::new("stdin:?protocol=openxr", |hands| {
            joint_sets::encode(&joint_sets::OPENXR, None, hands)
        }),
        Tracker::new("stdin:?protocol=webxr", |hands| {
            joint_sets::encode(&joint_sets::WEBXR, None, hands)
        }),
    ]
}

#[test]
fn a_hand_that_is_not_seen_releases_its_key_after_the_hold_time_and_the_other_hand_goes_on() {
    for mut tracker in trackers() {
        assert_eq!(tracker.move_right(ABOVE, ON_KEY), ["down J"]);
        let left = hand(Side::Left, ABOVE);
        assert!(tracker.see(&[left], 3).is_empty(), "held");
        assert_eq!(tracker.see(&[left], 1), ["up J"], "lost");
        tracker.see(&[hand(Side::Left, -0.24)], 1);
        let pressed = tracker.see(&[hand(Side::Left, ON_KEY)], 3);
        assert_eq!(pressed, ["down F"]);
        assert_eq!(tracker.see(&[left], 4), ["up F"]);

        let both = [left, hand(Side::Right, ON_KEY)];
        assert!(tracker.see(&both, 20).is_empty(), "back on its key");
        assert!(tracker.move_right(ON_KEY, ABOVE).is_empty());
        assert_eq!(tracker.move_right(ABOVE, ON_KEY), ["down J"]);
    }
}

#[test]
fn a_locked_modifier_ends_when_its_hand_is_not_seen() {
    let lock = r#"code: "ControlLeft", name: "J", latch: Lock"#;
    let layout = TWO_KEYS.replace(r#"code: "J""#, lock);
    let encode: fn(&[_]) -> String = |hands| joint_sets::encode(&joint_sets::WEBXR, None, hands);
    for other_hand in [Some(OtherHand::default()), None] {
        let setup = setup("stdin:?protocol=webxr", &layout, other_hand.clone());
        let mut tracker = Tracker::of(setup, encode);
        let seen = |height| match other_hand {
            Some(_) => vec![hand(Side::Left, ABOVE), hand(Side::Right, height)],
            None => vec![hand(Side::Right, height)],
        };
        tracker.see(&seen(ABOVE), 15);
        assert_eq!(tracker.pipeline.state(), PipelineState::Running);
        tracker.see(&seen(-0.24), 2);
        assert_eq!(tracker.see(&seen(ON_KEY), 4), ["down ControlLeft"]);
        tracker.see(&seen(-0.24), 2);
        assert!(tracker.see(&seen(ABOVE), 15).is_empty(), "locked");
        let rest: Vec<_> = seen(ABOVE)
            .into_iter()
            .filter(|(side, _)| *side == Side::Left)
            .collect();
        assert!(tracker.see(&rest, 3).is_empty(), "held");
        assert_eq!(tracker.see(&rest, 1), ["up ControlLeft"], "lost");
        assert_eq!(tracker.pipeline.state(), PipelineState::Running);
    }
}

#[test]
fn a_hand_below_the_score_counts_as_not_seen() {
    let mut tracker = Tracker::new("stdin:?protocol=hand-landmarks&camera=head", |hands| {
        let line = hand_landmarks::encode(None, hands);
        line.replace(
            "\"label\":\"right\",\"score\":1.0",
            "\"label\":\"right\",\"score\":0.2",
        )
    });
    let (encode, unsure) = (
        (|hands| hand_landmarks::encode(None, hands)) as fn(&[_]) -> String,
        tracker.encode,
    );
    tracker.encode = encode;
    tracker.see(&[hand(Side::Left, ABOVE), hand(Side::Right, ABOVE)], 15);
    assert_eq!(tracker.move_right(ABOVE, ON_KEY), ["down J"]);
    tracker.encode = unsure;
    let both = [hand(Side::Left, ABOVE), hand(Side::Right, ON_KEY)];
    assert_eq!(tracker.see(&both, 4), ["up J"]);
}

#[test]
fn a_tracker_that_exchanges_left_and_right_releases_both_hands_and_presses_nothing_until_they_leave_the_keys()
 {
    for mut tracker in trackers() {
        assert_eq!(tracker.move_right(ABOVE, ON_KEY), ["down J"]);
        let (_, left) = hand(Side::Left, ABOVE);
        let (_, right) = hand(Side::Right, ON_KEY);
        let exchanged = [(Side::Left, right), (Side::Right, left)];
        assert_eq!(tracker.see(&exchanged, 3), ["up J"]);
        assert!(tracker.see(&exchanged, 10).is_empty());
        let correct = [(Side::Left, left), (Side::Right, right)];
        assert!(tracker.see(&correct, 20).is_empty(), "on the key");
        assert!(tracker.move_right(ON_KEY, ABOVE).is_empty());
        assert_eq!(tracker.move_right(ABOVE, ON_KEY), ["down J"]);
    }
}

#[test]
fn a_setup_with_one_hand_has_the_arm_of_the_side_that_its_source_names() {
    for (source, side) in [
        ("stdin:?protocol=hand-landmarks", Side::Right),
        ("stdin:?protocol=hand-landmarks&hand=left", Side::Left),
        ("stdin:?protocol=openxr&hand=left", Side::Left),
        ("stdin:?protocol=markers&hand=left", Side::Left),
        ("stdin:?protocol=body-landmarks&hand=left", Side::Left),
        ("file:walk.bvh?protocol=bvh&hand=left", Side::Left),
    ] {
        let setup = setup(source, TWO_KEYS, None);
        assert!(setup.glove.is_none(), "{source}");
        assert_eq!(setup.arm.side(), side, "{source}");
    }
}

#[test]
fn files_play_at_their_nominal_rate_with_one_or_two_hands_in_a_line() {
    let mut decoder = (hand_landmarks::PROTOCOL.decoder)(&Default::default());
    let both = [hand(Side::Left, ABOVE), hand(Side::Right, ABOVE)];
    let line = hand_landmarks::encode(None, &both);
    let mut times = Vec::new();
    for _ in 0..3 {
        decoder.push(line.as_bytes(), &mut |packet| times.push(packet.time));
    }
    let expected = [1, 1, 2, 2, 3, 3];
    let expected =
        expected.map(|number| Some(Timestamp::from_seconds(f64::from(number) / RATE_HZ)));
    assert_eq!(times, expected);
}

#[test]
fn a_pointer_is_not_taken_by_a_hand_that_has_left_the_view() {
    let encode: fn(&[_]) -> String = |hands| joint_sets::encode(&joint_sets::WEBXR, None, hands);
    let setup = setup("stdin:?protocol=webxr", POINTER, Some(OtherHand::default()));
    let mut tracker = Tracker::of(setup, encode);
    let (left, right) = (hand(Side::Left, ABOVE), hand(Side::Right, ABOVE));
    assert!(!tracker.see(&[left, right], 15).is_empty());
    assert_eq!(tracker.pipeline.state(), PipelineState::Running);
    tracker.see(&[right], 10);
    // It releases everything, after which the next hand points.
    let (release, origin) = (Command::AllowKeys, CommandOrigin::Client);
    let released = tracker
        .pipeline
        .execute(&release, origin, &mut Events::new());
    assert_eq!(released, Ok(()));
    assert_eq!(tracker.pipeline.state(), PipelineState::Running);
    let moved = tracker.see(&[right], 5);
    assert!(moved.contains(&"move".to_owned()), "{moved:?}");
}

#[test]
fn the_boards_are_moved_to_the_hand_that_is_seen() {
    for mut tracker in trackers() {
        for side in [Side::Right, Side::Left] {
            tracker.see(&[hand(Side::Left, ABOVE), hand(Side::Right, ABOVE)], 10);
            tracker.see(&[hand(side, ABOVE)], 10);
            let (recenter, origin) = (Command::Recenter, CommandOrigin::Client);
            let mut events = Events::new();
            let moved = tracker.pipeline.execute(&recenter, origin, &mut events);
            assert_eq!(moved, Ok(()), "{side}");
        }
    }
}
