//! Layouts that are placed where an open hand is held still, and hands that reach nothing.

use std::ops::Range;

use ademan::capture::{Reading, Sample};
use ademan::command::CommandOrigin;
use ademan::device::{EventKind, Events};
use ademan::hand::{Finger, Joint, JointPositions, Side};
use ademan::pipeline::PipelineState;
use ademan::setup::{OtherHand, Setup};
use ademan::time::Timestamp;
use glam::DVec3;

use crate::support::checked::CheckedPipeline;

/// The time between two images, in microseconds.
const PERIOD_US: u64 = 33_333;

const PLACE: DVec3 = DVec3::new(0.05, 0.02, 0.45);

/// A key 50 mm below the place, and one at a fixed position of the world.
const BOARDS: &str = r#"Layout(name: "a", boards: [
    (pose: (anchor: start, height_mm: -50), keys: [(code: "A", at_mm: (0, 0), size_mm: Box(18, 18), travel_mm: 10)]),
    (pose: (anchor: world, right_mm: 200, forward_mm: -450, height_mm: -50), keys: [
        (code: "B", at_mm: (0, 0), size_mm: Box(18, 18), travel_mm: 10),
        (name: "Again", action: Command("recenter"), at_mm: (60, 0), size_mm: Box(18, 18), travel_mm: 10),
    ]),
])"#;

/// A person whose right hand a camera sees, palm down and fingers forward.
struct Person {
    pipeline: CheckedPipeline,
    time_us: u64,
    tip: DVec3,
    bend: f64,
    /// The finger whose tip the thumb touches.
    pinched: Option<Finger>,
    side: Side,
    events: Vec<EventKind>,
}

impl Person {
    fn with_layout(layout: &str) -> Self {
        let folder = tempfile::tempdir().expect("a folder");
        let path = folder.path().join("a.ron");
        std::fs::write(&path, layout).expect("a file");
        Self::with(&path.display().to_string())
    }

    fn with(layout: &str) -> Self {
        Self::with_hands(layout, None)
    }

    fn with_hands(layout: &str, other_hand: Option<OtherHand>) -> Self {
        let source = "stdin:?protocol=hand-landmarks".parse();
        let setup = Setup {
            layout: layout.into(),
            source: Some(source.expect("a source")),
            other_hand,
            ..Setup::default()
        };
        let loaded = setup.load_files().unwrap_or_else(|error| panic!("{error}"));
        Self {
            pipeline: CheckedPipeline::new(&loaded),
            time_us: 1_000_000,
            tip: PLACE,
            bend: 0.0,
            pinched: None,
            side: Side::Right,
            events: Vec::new(),
        }
    }

    fn show(&mut self, positions: JointPositions) {
        self.time_us += PERIOD_US;
        let time = Timestamp(self.time_us);
        let sample = Sample::Joints { positions };
        let mut events = Events::new();
        let reading = Reading::new(time, Some(self.side), sample);
        let stepped = self.pipeline.step(&reading, &mut events);
        stepped.expect("an accepted reading");
        self.events.extend(events.iter().map(|event| event.kind));
    }

    fn hold(&mut self, seconds: f64) {
        self.go(seconds, self.tip);
    }

    /// Moves the index fingertip in a straight line.
    fn go(&mut self, seconds: f64, tip: DVec3) {
        let (from, count) = (self.tip, (seconds * 1e6 / PERIOD_US as f64).round());
        for number in 1..=count as u32 {
            self.tip = from.lerp(tip, f64::from(number) / count);
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
        for _ in 0..(seconds * 1e6) as u64 / PERIOD_US {
            self.show(JointPositions::default());
        }
    }

    fn place(&mut self) {
        self.hold(2.0);
        assert!(!self.pipeline.awaits_start());
    }

    /// Holds the open hand still until its board is placed.
    fn place_hand(&mut self) {
        self.hold(2.0);
    }

    /// Returns the keys that went down (`A`) and up (`-A`) since the last call.
    fn keys(&mut self) -> String {
        let events = std::mem::take(&mut self.events);
        let keys = events.iter().filter_map(|event| match event {
            EventKind::KeyDown(key) => Some(key.name().to_owned()),
            EventKind::KeyUp(key) => Some(format!("-{}", key.name())),
            _ => None,
        });
        keys.collect::<Vec<_>>().join(" ")
    }
}

/// Returns a hand whose index fingertip is at `tip` and whose other fingers are bent by `bend` degrees at two joints.
pub(crate) fn hand(tip: DVec3, bend: f64) -> JointPositions {
    let mut positions = JointPositions::default();
    let wrist = tip + DVec3::new(0.02, 0.0, 0.18);
    positions.set(Joint::Wrist, wrist);
    for &finger in Finger::ALL {
        let side = 0.024 * (finger.index() as f64 - 1.0);
        let is_thumb = finger == Finger::Thumb;
        let turns = if is_thumb || finger == Finger::Index {
            [0.0; 3]
        } else {
            [0.0, bend, bend]
        };
        let mut position = tip + DVec3::new(side, 0.0, if is_thumb { 0.12 } else { 0.09 });
        let mut angle = 0.0_f64;
        let (first, last) = finger.joints()[finger.joints().len() - 4..]
            .split_first()
            .expect("four joints");
        positions.set(*first, position);
        for ((joint, bone), turn) in last.iter().zip([0.042, 0.027, 0.021]).zip(turns) {
            angle += turn.to_radians();
            position += DVec3::new(0.0, -angle.sin(), -angle.cos()) * bone;
            positions.set(*joint, position);
        }
    }
    positions
}

#[test]
fn a_board_appears_where_the_open_hand_was_held_still_and_presses_nothing_before() {
    let mut person = Person::with_layout(BOARDS);
    assert!(!person.pipeline.awaits_start());
    // The hand goes through the place of the key, and is never still for a second.
    for _ in 0..4 {
        person.tap(PLACE);
    }
    assert_eq!(person.pipeline.state(), PipelineState::Running);
    assert!(person.pipeline.awaits_start());
    assert_eq!(person.keys(), "");
    person.place();
    person.tap(PLACE);
    assert_eq!(person.keys(), "A -A");
    // Units are metric: 20 mm beside the key there is none.
    person.tap(PLACE + DVec3::X * 0.02);
    assert_eq!(person.keys(), "");
    // A stall and a hand that leaves the picture keep the place.
    person.hide(1.0);
    person.time_us += 3_000_000;
    person.hold(1.0);
    person.tap(PLACE);
    assert_eq!(person.keys(), "A -A");
}

#[test]
fn a_hand_that_is_lost_jumps_or_is_bent_places_nothing() {
    let mut person = Person::with_layout(BOARDS);
    person.bend = 50.0;
    person.hold(3.0);
    assert_eq!(person.pipeline.state(), PipelineState::Running);
    assert!(person.pipeline.awaits_start(), "a bent hand");
    person.bend = 0.0;
    for _ in 0..5 {
        person.hold(0.8);
        person.hide(0.3);
    }
    assert!(person.pipeline.awaits_start(), "a lost hand");
    for number in 0..6 {
        person.tip = PLACE + DVec3::X * 0.1 * f64::from(number % 2);
        person.hold(0.8);
    }
    assert!(person.pipeline.awaits_start(), "a hand that jumps");
    person
        .pipeline
        .pause(CommandOrigin::Client, &mut Events::new());
    person.hold(3.0);
    person.pipeline.resume(CommandOrigin::Client);
    assert_eq!(person.keys(), "");
    person.place();
    // A hand that comes back inside the key has to leave it first.
    let place = person.tip;
    person.hide(0.3);
    person.tip = place - DVec3::Y * 0.055;
    person.hold(0.5);
    person.go(0.3, place);
    assert_eq!(person.keys(), "");
    person.tap(place);
    assert_eq!(person.keys(), "A -A");
}

#[test]
fn nothing_is_placed_while_a_key_is_pressed() {
    let mut person = Person::with_layout(BOARDS);
    let above_b = DVec3::new(0.2, 0.0, 0.45);
    person.tap(above_b);
    assert_eq!(person.keys(), "B -B");
    person.press(above_b);
    person.hold(3.0);
    assert_eq!(person.keys(), "B");
    assert!(person.pipeline.awaits_start());
    person.go(0.3, above_b);
    person.place();
    assert_eq!(person.keys(), "-B");
}

#[test]
fn recenter_releases_what_is_held_and_places_the_board_again() {
    let mut person = Person::with_layout(BOARDS);
    person.place();
    person.press(PLACE);
    assert_eq!(person.keys(), "A");
    let mut events = Events::new();
    person
        .pipeline
        .recenter(&mut events)
        .expect("a layout that starts at the hand");
    let kinds: Vec<_> = events.iter().map(|event| event.kind).collect();
    assert!(
        matches!(kinds[..], [EventKind::KeyUp(key)] if key.name() == "A"),
        "{kinds:?}"
    );
    assert!(person.pipeline.awaits_start());
    person.go(0.3, PLACE);
    person.tap(PLACE);
    assert_eq!(person.keys(), "");
    let other = PLACE + DVec3::new(-0.1, 0.05, 0.05);
    person.go(0.5, other);
    person.place();
    person.tap(other);
    assert_eq!(person.keys(), "A -A");
    // A key with the command does the same.
    person.tap(DVec3::new(0.26, 0.0, 0.45));
    assert!(person.pipeline.awaits_start());
    person.tap(other);
    assert_eq!(person.keys(), "");
}

#[test]
fn a_pointer_moves_after_its_range_is_placed_and_drops_what_it_holds_with_the_hand() {
    let mut person = Person::with("webcam-mouse");
    let moves = |moving: &mut Person| {
        let events = std::mem::take(&mut moving.events);
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
fn the_webcam_mouse_clicks_with_the_left_and_the_right_button_drags_and_scrolls() {
    let mut person = Person::with("webcam-mouse");
    person.place();
    person.events.clear();
    for (finger, button) in [(Finger::Index, "MouseLeft"), (Finger::Ring, "MouseRight")] {
        person.pinch(Some(finger));
        assert_eq!(person.keys(), button);
        person.pinch(None);
        assert_eq!(person.keys(), format!("-{button}"));
    }
    // The left button stays down while the hand moves.
    person.pinch(Some(Finger::Index));
    person.go(0.5, PLACE + DVec3::X * 0.05);
    let moved = person
        .events
        .iter()
        .any(|it| matches!(it, EventKind::MoveBy(x, _) if *x > 0));
    assert!(moved, "{:?}", person.events);
    assert_eq!(person.keys(), "MouseLeft");
    person.pinch(None);
    assert_eq!(person.keys(), "-MouseLeft");
    // With the middle finger, an upward movement turns the wheel up and moves no pointer.
    person.pinch(Some(Finger::Middle));
    person.events.clear();
    let place = person.tip;
    let scrolled = |scrolling: &mut Person| {
        let events = std::mem::take(&mut scrolling.events);
        let moves = events
            .iter()
            .filter(|it| matches!(it, EventKind::MoveBy(..)));
        assert_eq!(moves.count(), 0, "{events:?}");
        let turns = events.iter().map(|event| match event {
            EventKind::Scroll(_, up) => *up,
            _ => 0,
        });
        turns.sum::<i32>()
    };
    person.go(0.6, place + DVec3::Y * 0.08);
    assert!(scrolled(&mut person) > 0);
    person.go(0.6, place);
    assert!(scrolled(&mut person) < 0);
    person.pinch(None);
    person.events.clear();
    person.go(0.3, place + DVec3::X * 0.05);
    assert!(
        person
            .events
            .iter()
            .all(|it| matches!(it, EventKind::MoveBy(..)))
    );
    assert!(!person.events.is_empty());
}

/// A key for each hand, 50 mm below the place where that hand is shown.
const TWO_BOARDS: &str = r#"Layout(name: "two", boards: [
    (hand: "left", pose: (anchor: start, height_mm: -50), keys: [(code: "L", at_mm: (0, 0), size_mm: Box(18, 18), travel_mm: 10)]),
    (hand: "right", pose: (anchor: start, height_mm: -50), keys: [(code: "R", at_mm: (0, 0), size_mm: Box(18, 18), travel_mm: 10)]),
])"#;

#[test]
fn each_of_two_hands_places_its_own_board_and_presses_only_that() {
    let folder = tempfile::tempdir().expect("a folder");
    let path = folder.path().join("two.ron");
    std::fs::write(&path, TWO_BOARDS).expect("a file");
    let path = path.display().to_string();
    let mut person = Person::with_hands(&path, Some(OtherHand::default()));
    let far = PLACE - DVec3::X * 0.3;
    person.place_hand();
    person.tap(PLACE);
    assert_eq!(person.keys(), "R -R");
    // The other hand is not placed yet.
    person.side = Side::Left;
    person.tip = far + DVec3::X * 0.08;
    person.tap(far);
    assert_eq!(person.keys(), "");
    person.place_hand();
    person.tap(far);
    assert_eq!(person.keys(), "L -L");
    // Its board is not where the right hand is, and the other way round.
    person.tap(PLACE);
    person.side = Side::Right;
    person.tap(far);
    assert_eq!(person.keys(), "");
    person.tap(PLACE);
    assert_eq!(person.keys(), "R -R");
}

/// The name of a control and the way to it.
type Nearest = (String, [f32; 3]);

/// Returns the time at which a hand is found to reach nothing, and the name and way of what is nearest.
fn unreached(person: &mut Person, seconds: Range<u32>) -> Option<(u32, Option<Nearest>)> {
    for second in seconds {
        let x = if second % 2 == 0 { 0.08 } else { 0.0 };
        person.go(1.0, PLACE + DVec3::X * x);
        if let Some(found) = person.pipeline.unreached() {
            let names = person.pipeline.target_names();
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
    assert_eq!(person.keys(), "A");
    person.go(1.0, DVec3::new(0.0, 0.35, 0.45));
    assert_eq!(person.pipeline.unreached(), None);
    assert_eq!(unreached(&mut person, 0..10), None);
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
    assert_eq!(resting.pipeline.unreached(), None, "it rests");
    let mut pointing = Person::with("webcam-mouse");
    pointing.place();
    assert_eq!(unreached(&mut pointing, 0..10), None, "it points");
}
