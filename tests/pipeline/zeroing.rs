//! Zeroing of a slipped glove through the whole pipeline.

use ademan::capture::{Reading, Sample};
use ademan::device::Events;
use ademan::estimate::{ZeroError, Zeroed};
use ademan::files::Load;
use ademan::hand::{Dof, Joint, JointAngles, JointPositions, Side};
use ademan::pipeline::{CommandError, PipelineState};
use ademan::setup::{LoadedSetup, OtherHand, Setup};
use ademan::time::Timestamp;
use glam::DVec3;

use crate::key_words::push_key_words;
use crate::support::checked::CheckedPipeline;
use crate::support::press::{Posture, Press, reading};
use crate::support::wearer::load_layout;
use crate::wearer::{Wearer, boards_of_both_hands};

/// A glove whose channels are shifted by a number of counts, as it has slipped.
struct Slipped {
    loaded: LoadedSetup,
    pipeline: CheckedPipeline,
    time: Timestamp,
    press: Press,
    shift: Posture,
    keys: Vec<String>,
}

impl Slipped {
    /// Returns an armed hand at rest above the key H. Its glove knows the rest pose, and has not slipped yet.
    fn new(layout: &str) -> Self {
        let mut loaded = load_layout(layout, Setup::default());
        let mut hand = Self {
            pipeline: CheckedPipeline::new(&loaded),
            loaded: loaded.clone(),
            time: Timestamp(0),
            press: Press::for_text("h"),
            shift: [0; size_of::<Posture>()],
            keys: Vec::new(),
        };
        let posture = hand.press.clear();
        hand.hold(&posture, 200);
        let rest_pose = hand.angles();
        loaded.glove.as_mut().expect("a glove").rest_pose = rest_pose;
        hand.pipeline = CheckedPipeline::new(&loaded);
        hand.loaded = loaded;
        hand.time = Timestamp(0);
        hand.rest();
        assert_eq!(hand.pipeline.state(), PipelineState::Running);
        hand
    }

    /// Shifts the channel of an angle by some counts.
    fn slip(&mut self, dof: Dof, counts: u8) {
        let rows = self.loaded.glove.as_ref().expect("a glove").map.rows();
        let row = rows.iter().find(|row| row.dof == dof).expect("a sensor");
        self.shift[row.channel] = counts;
    }

    /// Holds a posture for a number of readings.
    fn hold(&mut self, posture: &Posture, readings: usize) {
        for _ in 0..readings {
            let reading = self.reading(posture);
            let mut events = Events::new();
            let _ = self.pipeline.step(&reading, &mut events);
            push_key_words(&events, &mut self.keys);
        }
    }

    /// Returns the next reading of a posture.
    fn reading(&mut self, posture: &Posture) -> Reading {
        self.time.0 += 5_729;
        let mut shifted = *posture;
        for (count, shift) in shifted.iter_mut().zip(self.shift) {
            *count = count.saturating_add(shift).min(254);
        }
        reading(self.time, &shifted)
    }

    /// Rests for a second.
    fn rest(&mut self) {
        let posture = self.press.clear();
        self.hold(&posture, 180);
    }

    /// Returns the angles of the hand at rest.
    fn angles(&mut self) -> JointAngles {
        let posture = self.press.clear();
        let reading = self.reading(&posture);
        let step = self.pipeline.step(&reading, &mut Events::new());
        step.expect("an accepted reading").estimate.angles
    }

    fn zero(&mut self) -> Result<(), CommandError> {
        let mut events = Events::new();
        let outcome = self.pipeline.zero(&mut events);
        push_key_words(&events, &mut self.keys);
        outcome
    }

    fn zeroed(&self) -> Option<Zeroed> {
        let mut hands = self.pipeline.zeroed();
        hands.next().map(|(_, zeroed)| zeroed)
    }

    fn undo_zero(&mut self) -> Result<(), CommandError> {
        let mut events = Events::new();
        let outcome = self.pipeline.undo_zero(&mut events);
        push_key_words(&events, &mut self.keys);
        outcome
    }
}

fn layout() -> String {
    ademan::layout::Layout::load("qwerty-flat")
        .expect("a shipped layout")
        .text
}

/// Returns the layout with a key in the place of H that zeroes the hand.
fn with_zero_key() -> String {
    let layout = layout();
    let row = r#"(at_mm: (-90.25, 0), keys: "A S D F G H J K L Semicolon Quote Backslash")"#;
    assert!(layout.contains(row), "{layout}");
    let rows = r#"(at_mm: (-90.25, 0), keys: "A S D F G"), (at_mm: (23.75, 0), keys: "J K L Semicolon Quote Backslash")"#;
    let key = r#"keys: [(action: Command("zero"), name: "H", at_mm: (4.75, 0)),"#;
    layout.replace(row, rows).replace("keys: [", key)
}

fn degrees(angles: &JointAngles, dof: Dof) -> f64 {
    angles.get(dof).to_degrees()
}

#[test]
fn zeroing_turns_the_resting_hand_into_the_rest_pose_and_undoing_it_turns_it_back() {
    let mut hand = Slipped::new(&layout());
    let dof = Dof::IndexMcpFlexion;
    let at_rest = degrees(&hand.angles(), dof);
    hand.slip(dof, 8);
    hand.rest();
    let slipped = degrees(&hand.angles(), dof);
    assert!((slipped - at_rest).abs() > 4.0, "{slipped}");

    assert_eq!(hand.zero(), Ok(()));
    let zeroed = hand.zeroed().expect("it was zeroed");
    assert_eq!(zeroed.largest, dof);
    let found = degrees(&hand.angles(), dof);
    assert!((found - at_rest).abs() < 0.2, "{found}, not {at_rest}");

    assert_eq!(hand.undo_zero(), Ok(()));
    assert_eq!(hand.zeroed(), None);
    let found_again = degrees(&hand.angles(), dof);
    assert!(
        (found_again - slipped).abs() < 0.2,
        "{found_again}, not {slipped}"
    );
    let refused = hand.undo_zero().unwrap_err();
    assert_eq!(refused, CommandError::Zero(ZeroError::NothingToUndo));
}

#[test]
fn zeroing_presses_no_key_and_arms_again_after_the_hand_was_clear() {
    let mut hand = Slipped::new(&layout());
    hand.slip(Dof::IndexMcpFlexion, 6);
    hand.rest();
    hand.keys.clear();
    assert_eq!(hand.zero(), Ok(()));
    assert_eq!(hand.pipeline.state(), PipelineState::Paused);
    let pressed = hand.press.pressed();
    hand.hold(&pressed, 100);
    assert_eq!(hand.pipeline.state(), PipelineState::Paused, "not clear");
    assert!(hand.keys.is_empty(), "{:?}", hand.keys);
    hand.rest();
    assert_eq!(hand.pipeline.state(), PipelineState::Running);
    hand.hold(&pressed, 100);
    hand.rest();
    assert_eq!(hand.keys.join(" "), "+H -H", "the glove fits again");
}

#[test]
fn zeroing_is_refused_with_the_reason() {
    let mut hand = Slipped::new(&layout());
    let (pressed, clear) = (hand.press.pressed(), hand.press.clear());
    hand.hold(&pressed, 200);
    assert_eq!(hand.zero(), Err(CommandError::KeyDown));
    hand.hold(&clear, 40);
    let moving = Err(CommandError::Zero(ZeroError::Moving));
    assert_eq!(hand.zero(), moving, "0.2 s of rest");
    hand.rest();
    hand.slip(Dof::IndexMcpFlexion, 40);
    hand.rest();
    let refused = hand.zero().unwrap_err();
    let CommandError::Zero(ZeroError::TooFar { dof, degrees }) = refused else {
        panic!("{refused}");
    };
    assert_eq!(dof, Dof::IndexMcpFlexion);
    assert!(degrees > 20, "{refused}");
    assert_eq!(hand.zeroed(), None);
    assert_eq!(hand.pipeline.state(), PipelineState::Running, "no effect");
    hand.pipeline.stall(&mut Events::new());
    assert_eq!(hand.zero(), Err(CommandError::NoHand));
}

#[test]
fn sources_of_positions_and_of_other_joints_are_not_zeroed() {
    let loaded = Setup::default().load_files().expect("a setup");
    let mut positions = JointPositions::default();
    for (number, &joint) in Joint::ALL.iter().enumerate() {
        let step = number as f64 * 0.01;
        positions.set(joint, DVec3::new(step, step * step, -step));
    }
    let mut elbow = JointAngles::default();
    elbow.set(Dof::ElbowFlexion, 0.5);
    for (sample, reason) in [
        (Sample::Joints { positions }, ZeroError::NoAngles),
        (Sample::Angles { angles: elbow }, ZeroError::NoRestPose),
    ] {
        let mut pipeline = CheckedPipeline::new(&loaded);
        let mut events = Events::new();
        let reading = Reading::new(Timestamp(1_000), None, sample);
        pipeline.step(&reading, &mut events).expect("accepted");
        assert_eq!(pipeline.zero(&mut events), Err(CommandError::Zero(reason)));
    }
}

#[test]
fn a_key_of_the_layout_zeroes_the_hand_once_it_rests() {
    let mut hand = Slipped::new(&with_zero_key());
    let dof = Dof::IndexMcpFlexion;
    let at_rest = degrees(&hand.angles(), dof);
    hand.slip(dof, 2);
    hand.rest();
    let pressed = hand.press.pressed();
    hand.hold(&pressed, 180);
    assert_eq!(hand.zeroed(), None, "the finger is on the key");
    hand.rest();
    assert!(hand.zeroed().is_some());
    let found = degrees(&hand.angles(), dof);
    assert!((found - at_rest).abs() < 0.2, "{found}, not {at_rest}");
    assert!(hand.keys.is_empty(), "{:?}", hand.keys);
}

#[test]
fn a_hand_that_does_not_come_to_rest_in_time_is_not_zeroed() {
    let mut hand = Slipped::new(&with_zero_key());
    let pressed = hand.press.pressed();
    hand.hold(&pressed, 1000);
    hand.rest();
    assert_eq!(hand.zeroed(), None, "5 s have passed");
}

/// A wearer of two gloves, both slipped by 3°, who rests over the key `w` of each board. Each board has a key that zeroes the hand, too.
fn wearer_of_slipped_gloves() -> Wearer {
    let boards = boards_of_both_hands(
        r#"keys: [
                (code: "W", name: "SIDE-w", at_mm: (0, 0)),
                (action: Command("zero"), name: "SIDE-zero", at_mm: (24, 0)),
                (code: "A", name: "SIDE-a", at_mm: (-48, 0)),
                (code: "D", name: "SIDE-d", at_mm: (48, 0)),
            ]"#,
    );
    let setup = Setup {
        source: Some("serial:/dev/right".parse().expect("a source")),
        other_hand: Some(OtherHand {
            source: Some("serial:/dev/left".parse().expect("a source")),
            ..OtherHand::default()
        }),
        ..Setup::default()
    };
    let layout = format!(r#"Layout(name: "two", boards: [{boards}])"#);
    let mut wearer = Wearer::with_layout(&layout, setup);
    rest_both(&mut wearer);
    for side in [Side::Left, Side::Right] {
        let channels = wearer.shown[side.index()].clone().expect("it is shown");
        let reading = Reading::new(Timestamp(0), Some(side), Sample::Channels(channels));
        let mut rest_pose = wearer.pipeline.output_for(&reading).estimate.angles;
        let bent = rest_pose.get(Dof::IndexMcpFlexion) + 3_f64.to_radians();
        rest_pose.set(Dof::IndexMcpFlexion, bent);
        let loaded = &mut wearer.loaded;
        let other = loaded.other_hand.as_mut().expect("another hand");
        let gloves = [&mut loaded.glove, &mut other.glove];
        let mut gloves = gloves.into_iter().flatten();
        let glove = gloves.find(|glove| glove.side == side);
        glove.expect("a glove").rest_pose = rest_pose;
    }
    wearer.pipeline = CheckedPipeline::new(&wearer.loaded);
    wearer.time_ms = 0;
    rest_both(&mut wearer);
    assert_eq!(wearer.pipeline.state(), PipelineState::Running);
    wearer
}

fn rest_both(wearer: &mut Wearer) {
    for side in [Side::Left, Side::Right] {
        wearer.go(side, &format!("{side}-w"), false);
    }
    wearer.hold_still(2000);
}

fn zeroed_hands(wearer: &Wearer) -> Vec<Side> {
    wearer.pipeline.zeroed().map(|(side, _)| side).collect()
}

#[test]
fn a_key_zeroes_the_hand_that_presses_it_although_the_other_one_rests() {
    for side in [Side::Left, Side::Right] {
        let mut wearer = wearer_of_slipped_gloves();
        wearer.tap(side, &format!("{side}-zero"));
        rest_both(&mut wearer);
        assert_eq!(zeroed_hands(&wearer), [side]);
    }
}

#[test]
fn a_command_from_outside_zeroes_each_hand_that_rests() {
    let mut wearer = wearer_of_slipped_gloves();
    assert_eq!(wearer.pipeline.zero(&mut Events::new()), Ok(()));
    let mut zeroed = zeroed_hands(&wearer);
    zeroed.sort_unstable();
    assert_eq!(zeroed, [Side::Left, Side::Right]);

    let mut wearer_with_one_at_rest = wearer_of_slipped_gloves();
    for key in ["left-a", "left-d"] {
        wearer_with_one_at_rest.go(Side::Left, key, false);
        wearer_with_one_at_rest.hold_still(200);
    }
    let pipeline = &mut wearer_with_one_at_rest.pipeline;
    assert_eq!(pipeline.zero(&mut Events::new()), Ok(()));
    assert_eq!(zeroed_hands(&wearer_with_one_at_rest), [Side::Right]);
}
