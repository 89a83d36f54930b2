//! Layouts that are placed where an open hand is held still, and hands that reach nothing.

use std::ops::Range;

use ademan::capture::Sample;
use ademan::command::CommandOrigin;
use ademan::device::{EventKind, Events};
use ademan::hand::{Finger, Joint, JointPositions, Side};
use ademan::pipeline::PipelineState;
use ademan::setup::{LoadedSetup, OtherHand, Setup};
use glam::DVec3;

use crate::camera::{Camera, hand, images};
use crate::support::wearer::load_layout;

const PLACE: DVec3 = DVec3::new(0.05, 0.02, 0.45);

/// A key 50 mm below the place, and one at a fixed position of the world.
const BOARDS: &str = r#"Layout(name: "a", boards: [
    (pose: (anchor: start, height_mm: -50), keys: [(code: "A", at_mm: (0, 0), size_mm: Box(18, 18), travel_mm: 10)]),
    (pose: (anchor: world, right_mm: 200, forward_mm: -450, height_mm: -50), keys: [
        (code: "B", at_mm: (0, 0), size_mm: Box(18, 18), travel_mm: 10),
        (name: "Again", action: Command("recenter"), at_mm: (60, 0), size_mm: Box(18, 18), travel_mm: 10),
    ]),
])"#;

/// Returns a setup with a camera.
fn setup() -> Setup {
    let source = "stdin:?protocol=hand-landmarks".parse();
    Setup {
        source: Some(source.expect("a source")),
        ..Setup::default()
    }
}

/// A person whose right hand a camera sees, palm down and fingers forward.
struct Person {
    camera: Camera,
    tip: DVec3,
    bend: f64,
    /// The finger whose tip the thumb touches.
    pinched: Option<Finger>,
    /// The finger that the camera does not see.
    hidden: Option<Finger>,
    side: Side,
}

impl Person {
    /// Returns a person in front of a layout with this text.
    fn with_layout(layout: &str) -> Self {
        Self::new(&load_layout(layout, setup()))
    }

    /// Returns a person in front of a layout that comes with the program.
    fn with(layout: &str) -> Self {
        let layout = layout.into();
        let setup = Setup { layout, ..setup() };
        let loaded = setup.load_files().unwrap_or_else(|error| panic!("{error}"));
        Self::new(&loaded)
    }

    fn new(setup: &LoadedSetup) -> Self {
        Self {
            camera: Camera::new(setup),
            tip: PLACE,
            bend: 0.0,
            pinched: None,
            hidden: None,
            side: Side::Right,
        }
    }

    fn show(&mut self, positions: JointPositions) {
        self.camera.advance();
        let is_accepted = self.camera.send(self.side, Sample::Joints { positions });
        assert!(is_accepted, "a rejected reading");
    }

    fn hold(&mut self, seconds: f64) {
        self.go(seconds, self.tip);
    }

    /// Moves the index fingertip in a straight line.
    fn go(&mut self, seconds: f64, tip: DVec3) {
        let from = self.tip;
        for t in images(seconds) {
            self.tip = from.lerp(tip, t);
            self.show(self.hand());
        }
    }

    /// Returns the joints of the hand, the mirror image for the left one.
    fn hand(&self) -> JointPositions {
        let mut positions = hand(self.tip, self.bend);
        let tip_of = |finger: Finger| *finger.joints().last().expect("a tip");
        if let Some(tip) = self.pinched.and_then(|it| positions.get(tip_of(it))) {
            positions.set(tip_of(Finger::Thumb), tip - DVec3::Y * 0.012);
        }
        if let Some(finger) = self.hidden {
            let mut seen = JointPositions::default();
            let is_seen = |joint: &Joint| !finger.joints().contains(joint);
            for (joint, position) in positions.known().filter(|(joint, _)| is_seen(joint)) {
                seen.set(joint, position);
            }
            positions = seen;
        }
        if self.side == Side::Left {
            for &joint in Joint::ALL {
                if let Some(position) = positions.get(joint) {
                    let x = 2.0 * self.tip.x - position.x;
                    positions.set(joint, DVec3::new(x, position.y, position.z));
                }
            }
        }
        positions
    }

    /// Touches a finger with the thumb, or leaves it.
    fn pinch(&mut self, finger: Option<Finger>) {
        self.pinched = finger;
        self.hold(0.3);
    }

    fn tap(&mut self, above: DVec3) {
        self.go(0.5, above);
        self.press(above);
        self.go(0.3, above);
    }

    fn press(&mut self, above: DVec3) {
        self.go(0.3, above - DVec3::Y * 0.058);
        self.hold(0.3);
    }

    fn hide(&mut self, seconds: f64) {
        for _ in images(seconds) {
            self.show(JointPositions::default());
        }
    }

    fn place(&mut self) {
        self.hold(2.0);
        assert!(!self.camera.pipeline.awaits_start());
    }
}

#[test]
fn a_board_appears_where_the_open_hand_was_held_still_and_presses_nothing_before() {
    let mut person = Person::with_layout(BOARDS);
    assert!(!person.camera.pipeline.awaits_start());
    // The hand goes through the place of the key, and is never still for a second.
    for _ in 0..4 {
        person.tap(PLACE);
    }
    assert_eq!(person.camera.pipeline.state(), PipelineState::Running);
    assert!(person.camera.pipeline.awaits_start());
    assert_eq!(person.camera.keys(), "");
    person.place();
    person.tap(PLACE);
    assert_eq!(person.camera.keys(), "A -A");
    // Units are metric: 20 mm beside the key there is none.
    person.tap(PLACE + DVec3::X * 0.02);
    assert_eq!(person.camera.keys(), "");
    // A stall and a hand that leaves the picture keep the place.
    person.hide(1.0);
    person.camera.time_us += 3_000_000;
    person.hold(1.0);
    person.tap(PLACE);
    assert_eq!(person.camera.keys(), "A -A");
}

#[test]
fn a_hand_that_is_lost_jumps_or_is_bent_places_nothing() {
    let mut person = Person::with_layout(BOARDS);
    person.bend = 50.0;
    person.hold(3.0);
    assert_eq!(person.camera.pipeline.state(), PipelineState::Running);
    assert!(person.camera.pipeline.awaits_start(), "a bent hand");
    person.bend = 0.0;
    for _ in 0..5 {
        person.hold(0.8);
        person.hide(0.3);
    }
    assert!(person.camera.pipeline.awaits_start(), "a lost hand");
    for number in 0..6 {
        person.tip = PLACE + DVec3::X * 0.1 * f64::from(number % 2);
        person.hold(0.8);
    }
    assert!(person.camera.pipeline.awaits_start(), "a hand that jumps");
    let mut events = Events::new();
    person
        .camera
        .pipeline
        .pause(CommandOrigin::Client, &mut events);
    person.hold(2.0);
    person.camera.pipeline.resume(CommandOrigin::Client);
    assert_eq!(person.camera.keys(), "");
    person.place();
    // A hand that comes back inside the key has to leave it first.
    let place = person.tip;
    person.hide(0.3);
    person.tip = place - DVec3::Y * 0.055;
    person.hold(0.5);
    person.go(0.3, place);
    assert_eq!(person.camera.keys(), "");
    person.tap(place);
    assert_eq!(person.camera.keys(), "A -A");
}

#[test]
fn nothing_is_placed_while_a_key_is_pressed() {
    let mut person = Person::with_layout(BOARDS);
    let above_b = DVec3::new(0.2, 0.0, 0.45);
    person.tap(above_b);
    assert_eq!(person.camera.keys(), "B -B");
    person.press(above_b);
    person.hold(3.0);
    assert_eq!(person.camera.keys(), "B");
    assert!(person.camera.pipeline.awaits_start());
    person.go(0.3, above_b);
    person.place();
    assert_eq!(person.camera.keys(), "-B");
}

#[test]
fn recenter_releases_what_is_held_and_places_the_board_again() {
    let mut person = Person::with_layout(BOARDS);
    person.place();
    person.press(PLACE);
    assert_eq!(person.camera.keys(), "A");
    let mut events = Events::new();
    let recentered = person.camera.pipeline.recenter(&mut events);
    recentered.expect("a layout that starts at the hand");
    let kinds: Vec<_> = events.iter().map(|event| event.kind).collect();
    assert!(
        matches!(kinds[..], [EventKind::KeyUp(key)] if key.name() == "A"),
        "{kinds:?}"
    );
    assert!(person.camera.pipeline.awaits_start());
    person.go(0.3, PLACE);
    person.tap(PLACE);
    assert_eq!(person.camera.keys(), "");
    let other = PLACE + DVec3::new(-0.1, 0.05, 0.05);
    person.go(0.5, other);
    person.place();
    person.tap(other);
    assert_eq!(person.camera.keys(), "A -A");
    // A key with the command does the same.
    person.tap(DVec3::new(0.26, 0.0, 0.45));
    assert!(person.camera.pipeline.awaits_start());
    person.tap(other);
    assert_eq!(person.camera.keys(), "");
}

#[test]
fn a_pointer_moves_after_its_range_is_placed_and_drops_what_it_holds_with_the_hand() {
    let mut person = Person::with("webcam-mouse");
    let moves = |moving: &mut Person| {
        let events = std::mem::take(&mut moving.camera.events);
        let moved = events.iter().filter_map(|event| match event {
            EventKind::MoveBy(x, _) => Some(*x),
            _ => None,
        });
        moved.sum::<i32>()
    };
    for _ in 0..3 {
        person.go(0.5, PLACE + DVec3::X * 0.1);
        person.go(0.5, PLACE);
    }
    assert_eq!(moves(&mut person), 0);
    person.place();
    person.go(0.5, PLACE + DVec3::X * 0.1);
    person.hold(0.3);
    assert!(moves(&mut person) > 100);
    // A closed hand takes the way back without the pointer.
    person.bend = 75.0;
    person.hold(0.3);
    person.go(0.5, PLACE);
    person.hold(0.3);
    person.bend = 0.0;
    person.hold(0.3);
    assert_eq!(moves(&mut person), 0);
}

#[test]
fn the_range_of_a_pointer_is_placed_at_the_point_that_the_pointer_follows() {
    // Seen from the right, so that the way from the fingertip back to the knuckle is a way to the right.
    for point in ["Index", "Knuckle", "Wrist"] {
        let layout = format!(
            "Layout(name: \"a\", pointer: Pointer(smoothing: Off, mode: Direct(point: {point}, \
             pose: (anchor: start, bearing_deg: 90), size_mm: (200, 200, 200))))"
        );
        let mut person = Person::with_layout(&layout);
        person.place();
        let placed = person.camera.events.iter().find_map(|event| match event {
            EventKind::MoveTo(right, _) => Some(*right),
            _ => None,
        });
        let placed = placed.expect("the pointer moves");
        assert!((placed - 0.5).abs() < 0.05, "{point}: {placed}");
    }
}

#[test]
fn the_webcam_mouse_clicks_with_the_left_and_the_right_button_drags_and_scrolls() {
    let mut person = Person::with("webcam-mouse");
    person.place();
    person.camera.events.clear();
    for (finger, button) in [(Finger::Index, "MouseLeft"), (Finger::Ring, "MouseRight")] {
        person.pinch(Some(finger));
        assert_eq!(person.camera.keys(), button);
        person.pinch(None);
        assert_eq!(person.camera.keys(), format!("-{button}"));
    }
    // The left button stays down while the hand moves.
    person.pinch(Some(Finger::Index));
    person.go(0.5, PLACE + DVec3::X * 0.05);
    let dragged = &person.camera.events;
    let is_right = |it: &EventKind| matches!(it, EventKind::MoveBy(x, _) if *x > 0);
    assert!(dragged.iter().any(is_right), "{dragged:?}");
    assert_eq!(person.camera.keys(), "MouseLeft");
    person.pinch(None);
    assert_eq!(person.camera.keys(), "-MouseLeft");
    // With the middle finger, an upward movement turns the wheel up and moves no pointer.
    person.pinch(Some(Finger::Middle));
    person.camera.events.clear();
    let place = person.tip;
    let scrolled = |scrolling: &mut Person| {
        let events = std::mem::take(&mut scrolling.camera.events);
        let moves = events
            .iter()
            .filter(|it| matches!(it, EventKind::MoveBy(..)));
        assert_eq!(moves.count(), 0, "{events:?}");
        let turns = events.iter().filter_map(|event| match event {
            EventKind::Scroll(_, up) => Some(*up),
            _ => None,
        });
        turns.sum::<i32>()
    };
    person.go(0.6, place + DVec3::Y * 0.08);
    assert!(scrolled(&mut person) > 0);
    person.go(0.6, place);
    assert!(scrolled(&mut person) < 0);
    person.pinch(None);
    person.camera.events.clear();
    person.go(0.3, place + DVec3::X * 0.05);
    let moved = &person.camera.events;
    let is_move = |it: &EventKind| matches!(it, EventKind::MoveBy(..));
    assert!(moved.iter().all(is_move) && !moved.is_empty());
}

/// A key for each hand, 50 mm below the place where that hand is shown.
const TWO_BOARDS: &str = r#"Layout(name: "two", boards: [
    (hand: "left", pose: (anchor: start, height_mm: -50), keys: [(code: "L", at_mm: (0, 0), size_mm: Box(18, 18), travel_mm: 10)]),
    (hand: "right", pose: (anchor: start, height_mm: -50), keys: [(code: "R", at_mm: (0, 0), size_mm: Box(18, 18), travel_mm: 10)]),
])"#;

#[test]
fn each_of_two_hands_places_its_own_board_and_presses_only_that() {
    let both = Setup {
        other_hand: Some(OtherHand::default()),
        ..setup()
    };
    let mut person = Person::new(&load_layout(TWO_BOARDS, both));
    let far = PLACE - DVec3::X * 0.3;
    // Its board is placed where it is held still.
    person.hold(2.0);
    person.tap(PLACE);
    assert_eq!(person.camera.keys(), "R -R");
    // The other hand is not placed yet.
    person.side = Side::Left;
    person.tip = far + DVec3::X * 0.08;
    person.tap(far);
    assert_eq!(person.camera.keys(), "");
    person.hold(2.0);
    person.tap(far);
    assert_eq!(person.camera.keys(), "L -L");
    // Its board is not where the right hand is, and the other way round.
    person.tap(PLACE);
    person.side = Side::Right;
    person.tap(far);
    assert_eq!(person.camera.keys(), "");
    person.tap(PLACE);
    assert_eq!(person.camera.keys(), "R -R");
}

/// The name of a control and the way to it.
type Nearest = (String, [f32; 3]);

/// Returns the time at which a hand is found to reach nothing, and the name and way of what is nearest.
fn unreached(person: &mut Person, seconds: Range<u32>) -> Option<(u32, Option<Nearest>)> {
    for second in seconds {
        let x = if second % 2 == 0 { 0.08 } else { 0.0 };
        person.go(1.0, PLACE + DVec3::X * x);
        if let Some(found) = person.camera.pipeline.unreached() {
            let names = person.camera.pipeline.target_names();
            let named = found.nearest.map(|nearest| {
                let name = nearest
                    .target
                    .map_or(String::new(), |id| names.get(id).to_string());
                (name, nearest.way.to_array())
            });
            return Some((second, named));
        }
    }
    None
}

#[test]
fn a_hand_that_moves_for_5_s_and_reaches_nothing_is_told_the_way_to_the_nearest_control_once() {
    let far = r#"Layout(name: "a", boards: [(pose: (anchor: world, height_mm: 300, forward_mm: -450), keys: [
        (code: "A", at_mm: (0, 0)), (code: "B", at_mm: (-400, 0))])])"#;
    let mut person = Person::with_layout(far);
    let (second, nearest) = unreached(&mut person, 0..10).expect("a hint");
    assert!((5..=6).contains(&second), "{second}");
    let (name, way) = nearest.expect("a control with a place");
    assert_eq!(name, "A");
    let expected = [f64::from(0.3_f32) - PLACE.y, 0.0 - person.tip.x];
    assert!((f64::from(way[1]) - expected[0]).abs() < 0.01, "{way:?}");
    assert!((f64::from(way[0]) - expected[1]).abs() < 0.09, "{way:?}");
    // It reaches the key, and later moves elsewhere.
    person.go(1.0, DVec3::new(0.0, 0.35, 0.45));
    person.go(1.0, DVec3::new(0.0, 0.30, 0.45));
    assert_eq!(person.camera.keys(), "A");
    person.go(1.0, DVec3::new(0.0, 0.35, 0.45));
    assert_eq!(person.camera.pipeline.unreached(), None);
    assert_eq!(unreached(&mut person, 0..10), None);
}

#[test]
fn the_way_to_the_range_of_a_pointer_begins_at_the_point_that_the_pointer_follows() {
    for (point, back) in [("Index", 0.0), ("Knuckle", -0.04)] {
        let layout = format!(
            "Layout(name: \"a\", pointer: Pointer(mode: Direct(point: {point}, \
             pose: (anchor: world, height_mm: 300, forward_mm: -450), size_mm: (20, 100, 100))))"
        );
        let mut person = Person::with_layout(&layout);
        // The cursor goes to the border of the range at first.
        person.go(1.0, PLACE);
        let (_, nearest) =
            unreached(&mut person, 0..10).unwrap_or_else(|| panic!("a hint for {point}"));
        let (_, way) = nearest.expect("a range with a place");
        assert!((way[1] - 0.23).abs() < 0.01, "{point}: {way:?}");
        assert!((way[2] - back).abs() < 0.01, "{point}: {way:?}");
    }
}

#[test]
fn a_hand_whose_index_finger_is_not_seen_is_not_told_what_needs_it() {
    let far = r#"Layout(name: "a", boards: [(pose: (anchor: world, height_mm: 300, forward_mm: -450), keys: [
        (code: "A", at_mm: (0, 0))])])"#;
    let mut person = Person::with_layout(far);
    person.hidden = Some(Finger::Index);
    assert_eq!(unreached(&mut person, 0..10), None);
    person.hidden = None;
    assert!(unreached(&mut person, 10..20).is_some(), "it is seen again");
}

#[test]
fn a_layout_of_joint_angles_that_the_camera_does_not_show_has_no_control_that_is_nearest() {
    for (layout, has_place) in [("joint", false), ("ray", true), ("touch-pad", true)] {
        let mut person = Person::with(layout);
        let (second, nearest) = unreached(&mut person, 0..10).expect("a hint");
        assert!((5..=6).contains(&second), "{layout}: {second}");
        assert_eq!(nearest.is_some(), has_place, "{layout}: {nearest:?}");
    }
}

#[test]
fn a_hand_that_waits_rests_or_points_is_not_told_that_it_reaches_nothing() {
    let mut person = Person::with_layout(BOARDS);
    assert_eq!(
        unreached(&mut person, 0..10),
        None,
        "it waits for its place"
    );
    let mut resting = Person::with_layout(&BOARDS.replace("start", "world"));
    resting.hold(8.0);
    assert_eq!(resting.camera.pipeline.unreached(), None, "it rests");
    let mut pointing = Person::with("webcam-mouse");
    pointing.place();
    assert_eq!(unreached(&mut pointing, 0..10), None, "it points");
}
