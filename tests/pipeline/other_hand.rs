//! Boards that follow the wrist of the other hand.

use ademan::capture::Sample;
use ademan::device::Events;
use ademan::hand::{JointPositions, Side};
use ademan::layout::Layout;
use ademan::pipeline::PipelineState;
use ademan::setup::{LoadedSetup, OtherHand, Setup};
use glam::DVec3;

use crate::camera::{Camera, hand, images};
use crate::support::wearer::load_layout;

/// A key 40 mm above the left wrist.
const BOARD: &str = r#"Layout(name: "watch", boards: [(
    hand: "right",
    pose: (anchor: other, height_mm: 40),
    keys: [(code: "A", at_mm: (0, 0), size_mm: Box(30, 30), travel_mm: 10)],
)])"#;

/// The left index fingertip at first.
const LEFT: DVec3 = DVec3::new(-0.1, 0.0, 0.4);

/// From the left index fingertip to a fingertip above the key.
const ABOVE: DVec3 = DVec3::new(0.02, 0.09, 0.18);

/// Returns the setup of the board for a camera or for gloves.
fn setup(has_camera: bool, other_hand: Option<OtherHand>) -> LoadedSetup {
    let camera = || "stdin:?protocol=hand-landmarks".parse().expect("a source");
    let setup = Setup {
        source: has_camera.then(camera),
        other_hand,
        ..Setup::default()
    };
    load_layout(BOARD, setup)
}

/// A person whose hands a camera sees.
struct Person {
    camera: Camera,
    right: DVec3,
    /// `None` while the left hand is out of the picture.
    left: Option<DVec3>,
    /// The camera sends readings of the left hand.
    sends_left: bool,
}

impl Person {
    fn new() -> Self {
        Self {
            camera: Camera::new(&setup(true, Some(OtherHand::default()))),
            right: LEFT + ABOVE,
            left: Some(LEFT),
            sends_left: true,
        }
    }

    fn show(&mut self) {
        self.camera.advance();
        if self.sends_left {
            let left = self.left.map(|tip| hand(tip, 0.0));
            self.send(Side::Left, left.unwrap_or_default());
        }
        self.send(Side::Right, hand(self.right, 0.0));
    }

    fn send(&mut self, side: Side, positions: JointPositions) {
        // A hand that was never seen is rejected.
        _ = self.camera.send(side, Sample::Joints { positions });
    }

    fn hold(&mut self, seconds: f64) {
        self.go(seconds, self.left, self.right);
    }

    /// Moves the fingertips in straight lines.
    fn go(&mut self, seconds: f64, left: Option<DVec3>, right: DVec3) {
        let (from_left, from_right) = (self.left, self.right);
        for t in images(seconds) {
            self.left = from_left
                .zip(left)
                .map(|(from, to)| from.lerp(to, t))
                .or(left);
            self.right = from_right.lerp(right, t);
            self.show();
        }
    }

    /// Presses the key whose fingertip is `above` it, and holds it.
    fn press(&mut self, above: DVec3) {
        self.go(0.5, self.left, above);
        self.go(0.3, self.left, above - DVec3::Y * 0.058);
        self.hold(0.3);
    }

    fn tap(&mut self, above: DVec3) {
        self.press(above);
        self.go(0.3, self.left, above);
    }
}

#[test]
fn a_board_goes_with_the_other_hand() {
    let mut person = Person::new();
    person.hold(1.0);
    assert_eq!(person.camera.pipeline.state(), PipelineState::Running);
    person.tap(LEFT + ABOVE);
    assert_eq!(person.camera.keys(), "A -A");
    let far = LEFT + DVec3::new(0.1, 0.05, -0.1);
    person.go(1.0, Some(far), LEFT + ABOVE + DVec3::Y * 0.1);
    person.tap(LEFT + ABOVE);
    assert_eq!(person.camera.keys(), "");
    person.go(0.5, Some(far), far + ABOVE + DVec3::Y * 0.1);
    person.tap(far + ABOVE);
    assert_eq!(person.camera.keys(), "A -A");
}

#[test]
fn a_hand_can_bring_the_board_to_a_finger_that_rests() {
    let mut person = Person::new();
    person.hold(1.0);
    let right = person.right;
    person.go(0.5, Some(LEFT + DVec3::Y * 0.058), right);
    person.go(0.5, Some(LEFT), right);
    assert_eq!(person.camera.keys(), "A -A");
}

#[test]
fn without_the_other_hand_nothing_is_touched_and_the_run_goes_on() {
    let mut person = Person::new();
    person.left = None;
    person.hold(1.0);
    assert_eq!(person.camera.pipeline.state(), PipelineState::Running);
    person.tap(LEFT + ABOVE);
    assert_eq!(person.camera.keys(), "");
    // It appears around a finger that is inside its key, which has to leave first.
    person.press(LEFT + ABOVE);
    person.left = Some(LEFT);
    person.hold(1.0);
    assert_eq!(person.camera.keys(), "");
    person.go(0.3, Some(LEFT), LEFT + ABOVE);
    person.tap(LEFT + ABOVE);
    assert_eq!(person.camera.keys(), "A -A");
}

#[test]
fn a_hand_that_leaves_the_picture_releases_what_the_other_presses_on_it() {
    let mut person = Person::new();
    person.hold(1.0);
    person.press(LEFT + ABOVE);
    assert_eq!(person.camera.keys(), "A");
    person.left = None;
    person.hold(1.0);
    assert_eq!(person.camera.keys(), "-A");
    // Found again elsewhere, and moved below the finger: the board was not seen on its way.
    person.left = Some(LEFT + DVec3::Y * 0.2);
    person.hold(0.5);
    person.left = Some(LEFT);
    person.hold(0.5);
    assert_eq!(person.camera.keys(), "");
}

#[test]
fn a_finger_does_not_sink_into_a_board_whose_hand_is_not_seen_for_a_moment() {
    let mut person = Person::new();
    person.hold(1.0);
    // Both hands sink.
    let down = DVec3::NEG_Y * 0.07;
    let (left, right) = (LEFT + down, person.right + down);
    person.sends_left = false;
    person.go(4.0 / 30.0, Some(left), right);
    person.sends_left = true;
    person.hold(0.5);
    assert_eq!(person.camera.keys(), "");
    person.tap(left + ABOVE);
    assert_eq!(person.camera.keys(), "A -A");
}

#[test]
fn a_board_whose_hand_was_repeated_presses_no_finger_where_it_appears() {
    let mut person = Person::new();
    person.hold(1.0);
    // Higher in the next picture, so that the key is around the finger.
    person.left = Some(LEFT + DVec3::Y * 0.058);
    person.hold(0.5);
    assert_eq!(person.camera.keys(), "");
    person.go(0.5, Some(LEFT), person.right);
    person.go(0.5, Some(LEFT + DVec3::Y * 0.058), person.right);
    assert_eq!(person.camera.keys(), "A");
}

#[test]
fn readings_of_a_hand_that_stop_release_what_the_other_presses_on_it() {
    let mut person = Person::new();
    person.hold(1.0);
    person.press(LEFT + ABOVE);
    assert_eq!(person.camera.keys(), "A");
    person.sends_left = false;
    person.hold(1.0);
    assert_eq!(person.camera.keys(), "-A");
}

#[test]
fn a_source_of_a_hand_that_is_lost_releases_what_the_other_presses_on_it_at_once() {
    let mut person = Person::new();
    person.hold(1.0);
    person.press(LEFT + ABOVE);
    assert_eq!(person.camera.keys(), "A");
    let mut events = Events::new();
    person
        .camera
        .pipeline
        .lose(Some(Side::Left), None, &mut events);
    person
        .camera
        .events
        .extend(events.iter().map(|event| event.kind));
    assert_eq!(person.camera.keys(), "-A");
}

#[test]
fn a_setup_that_does_not_measure_the_other_hand_in_one_room_says_so() {
    for (has_camera, other_hand, expected) in [
        (true, Some(OtherHand::default()), None),
        (true, None, Some("the setup has one hand")),
        (false, None, Some("the setup has one hand")),
        (false, Some(OtherHand::default()), Some("a glove does not")),
    ] {
        let setup = setup(has_camera, other_hand);
        let found = setup.missing_other_hand(&setup.layout);
        let has_found = found.zip(expected).map(|(found, it)| found.contains(it));
        assert_eq!(has_found, expected.map(|_| true), "{found:?}");
        assert_eq!(found.is_some(), expected.is_some(), "{found:?}");
    }
}

#[test]
fn a_simulated_person_is_measured_in_one_room_unless_a_protocol_is_of_a_glove() {
    for (source, is_missing) in [
        ("typist:a", false),
        ("script:tap A", false),
        ("typist:a?protocol=openxr", false),
        ("typist:a?protocol=hc11", true),
    ] {
        let setup = Setup {
            source: Some(source.parse().expect("a source")),
            other_hand: Some(OtherHand::default()),
            ..Setup::default()
        };
        let setup = load_layout(BOARD, setup);
        let missing = setup.missing_other_hand(&setup.layout);
        assert_eq!(missing.is_some(), is_missing, "{source}: {missing:?}");
    }
}

#[test]
fn a_board_that_follows_the_other_hand_is_for_one_hand() {
    let text = BOARD.replace("hand: \"right\",", "");
    let error = Layout::parse(&text, "t.ron").unwrap_err().to_string();
    assert!(error.contains("set its `hand`"), "{error}");
}
