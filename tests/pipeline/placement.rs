//! Poses of boards, and commands that move them, through the whole pipeline.

use ademan::capture::{Channels, Reading, Sample};
use ademan::command::CommandOrigin;
use ademan::contact::board_pose::BoardPose;
use ademan::contact::surface::Scene;
use ademan::device::{EventKind, Events};
use ademan::layout::Layout;
use ademan::pipeline::PipelineState;
use ademan::pipeline::{CommandError, Pipeline};
use ademan::setup::{LoadedSetup, ProfileSetup, Setup};
use ademan::sim::TypingHand;
use ademan::time::Timestamp;
use parry3d::math::Vec3;

use crate::key_reach::KeyReach;
use crate::support::wearer::load_layout;
use crate::wearer::channels;

/// Distance between adjacent keys, in metres.
const PITCH: f32 = 0.019;

/// A wearer of a glove that sends a reading every 10 ms.
struct Wearer {
    loaded: LoadedSetup,
    pipeline: Pipeline,
    time_ms: u64,
    shown: Channels,
    transcript: Vec<String>,
}

/// Returns a layout with one board with these fields and keys.
fn text(board: &str, keys: &str) -> String {
    format!(
        "Layout(name: \"a\", boards: [(pose: (anchor: elbow, bearing_deg: 35, forward_mm: 300, \
         height_mm: -45), {board} rows: [(at_mm: (-38, 0), keys: \"{keys}\")])])"
    )
}

fn parsed(text: &str) -> Layout {
    Layout::parse(text, "a.ron").unwrap_or_else(|error| panic!("{error}"))
}

impl Wearer {
    /// Returns a wearer whose hand is clear of all keys, with the output armed.
    fn with_layout(text: &str) -> Self {
        Self::new(load_layout(text, Setup::default()))
    }

    fn new(loaded: LoadedSetup) -> Self {
        let mut wearer = Self {
            pipeline: loaded.pipeline(),
            shown: Channels {
                full_scale: 255,
                counts: Default::default(),
                unsent: Default::default(),
            },
            loaded,
            time_ms: 0,
            transcript: Vec::new(),
        };
        let first = wearer.loaded.layout.keys[0].face.name.clone();
        wearer.hover(&first);
        wearer.hold_still(400);
        assert_eq!(wearer.pipeline.state(), PipelineState::Running);
        wearer
    }

    /// Moves the index fingertip to a position in the world, in metres.
    fn go(&mut self, tip: Vec3) {
        let map = &self.loaded.glove.as_ref().expect("a glove").map;
        let hand = TypingHand::new(&self.loaded.arm, map);
        let mut values = hand.rest_values();
        let miss = hand.reach(tip, &mut values, &[]);
        assert!(miss < 1e-3, "{tip} is {miss} m out of reach");
        let angles = hand.angles(&values);
        self.shown = channels(map, |dof| angles.get(dof));
    }

    /// Returns the positions of the fingertip above a key and at the bottom of its travel.
    fn tap_positions(&self, layout: &Layout, scene: &Scene, key: &str) -> [Vec3; 2] {
        let target = layout.key(key).expect("a key").face.target;
        let hand = TypingHand::new(
            &self.loaded.arm,
            &self.loaded.glove.as_ref().expect("a glove").map,
        );
        let reach = KeyReach::new(&hand, scene, target).expect("a place");
        [reach.hover(), reach.bottom()]
    }

    /// Moves the fingertip above a key, at its position in the file.
    fn hover(&mut self, key: &str) {
        let layout = self.loaded.layout.clone();
        let [hover, _] = self.tap_positions(&layout, &layout.scene, key);
        self.go(hover);
    }

    /// Moves the fingertip to the bottom of a key, at its position in the file.
    fn push(&mut self, key: &str) {
        let layout = self.loaded.layout.clone();
        let [_, bottom] = self.tap_positions(&layout, &layout.scene, key);
        self.go(bottom);
    }

    fn hold_still(&mut self, milliseconds: u64) {
        for _ in 0..milliseconds / 10 {
            self.time_ms += 10;
            let reading = Reading::new(
                Timestamp(self.time_ms * 1_000),
                None,
                Sample::Channels(self.shown.clone()),
            );
            let mut events = Events::new();
            if let Ok(step) = self.pipeline.step(&reading, &mut events) {
                let commands = step.commands.iter();
                let commands = commands.map(|issued| issued.command.to_string());
                self.transcript.extend(commands);
            }
            self.write(&events);
        }
    }

    /// Presses a key at its position in the file, and stays on it.
    fn press(&mut self, key: &str, milliseconds: u64) {
        self.hover(key);
        self.hold_still(200);
        self.push(key);
        self.hold_still(milliseconds);
    }

    /// Taps a key at its position in the file.
    fn tap(&mut self, key: &str) {
        self.press(key, 200);
        self.hover(key);
        self.hold_still(200);
    }

    fn nudge(&mut self, by: Vec3) -> Result<(), CommandError> {
        let mut events = Events::new();
        let nudged = self.pipeline.nudge(by, &mut events);
        self.write(&events);
        nudged
    }

    fn board_pose(&self) -> BoardPose {
        self.pipeline.board_poses().next().expect("a board")
    }

    fn write(&mut self, events: &Events) {
        for event in events {
            self.transcript.push(match event.kind {
                EventKind::KeyDown(key) => format!("+{key}"),
                EventKind::KeyUp(key) => format!("-{key}"),
                other => panic!("{other:?} comes of no key"),
            });
        }
    }

    fn transcript(&mut self) -> String {
        std::mem::take(&mut self.transcript).join(" ")
    }
}

/// Returns a displacement to the right along the rows of the boards of these tests.
fn along_rows(distance: f32) -> Vec3 {
    let bearing = 35.0_f32.to_radians();
    Vec3::new(bearing.cos(), 0.0, bearing.sin()) * distance
}

#[test]
fn a_nudge_by_one_pitch_moves_the_next_key_under_the_finger() {
    let mut wearer = Wearer::with_layout(&text("", "A B C D E"));
    wearer.tap("B");
    assert_eq!(wearer.nudge(along_rows(-PITCH)), Ok(()));
    assert!((wearer.board_pose().right + PITCH).abs() < 1e-6);
    wearer.tap("B");
    assert_eq!(wearer.nudge(along_rows(2.0 * PITCH)), Ok(()));
    wearer.tap("B");
    assert_eq!(wearer.transcript(), "+B -B +C -C +A -A");
}

#[test]
fn a_held_key_is_released_before_its_board_moves() {
    let mut wearer = Wearer::with_layout(&text("", "A B C D E"));
    wearer.press("B", 300);
    assert_eq!(wearer.transcript(), "+B");
    assert_eq!(wearer.nudge(along_rows(-PITCH)), Ok(()));
    assert_eq!(wearer.transcript(), "-B");
    wearer.hold_still(1_000);
    assert_eq!(wearer.transcript(), "", "the finger is in C now");
    assert_eq!(wearer.pipeline.state(), PipelineState::Running);
    wearer.tap("B");
    assert_eq!(wearer.transcript(), "+C -C");
}

#[test]
fn a_pose_out_of_range_is_rejected_and_nothing_is_released() {
    let mut wearer = Wearer::with_layout(&text("", "A B C D E"));
    wearer.press("B", 300);
    let place = wearer.board_pose();
    for far in [3.0, -3.0, f32::NAN, f32::INFINITY] {
        assert_eq!(
            wearer.nudge(Vec3::new(0.0, 0.0, -far)),
            Err(CommandError::TooFar(1))
        );
    }
    let mut events = Events::new();
    assert!(wearer.pipeline.tilt(f32::NAN, &mut events).is_err());
    for steep in [1.7, -1.7] {
        let tilted = wearer.pipeline.tilt(steep, &mut events);
        assert_eq!(tilted, Err(CommandError::TooSteep(1)));
    }
    assert!(events.is_empty());
    assert_eq!(wearer.transcript(), "+B");
    assert_eq!(wearer.board_pose(), place);
}

#[test]
fn a_tilt_command_equals_the_tilt_of_a_file() {
    let flat = text("", "A B C D E").replace("(-38, 0)", "(-38, 30)");
    let mut wearer = Wearer::with_layout(&flat);
    let sloping = parsed(&flat.replace("height_mm", "tilt_deg: 20, height_mm"));
    let (layout, scene) = (sloping.clone(), &sloping.scene);
    let [hover, bottom] = wearer.tap_positions(&layout, scene, "D");
    let mut events = Events::new();
    assert_eq!(wearer.pipeline.tilt(0.2, &mut events), Ok(()));
    let rest = 20.0_f32.to_radians() - 0.2;
    assert_eq!(wearer.pipeline.tilt(rest, &mut events), Ok(()));
    assert!((wearer.board_pose().tilt - 20.0_f32.to_radians()).abs() < 1e-6);
    for tip in [hover, bottom, hover] {
        wearer.go(tip);
        wearer.hold_still(200);
    }
    assert_eq!(wearer.transcript(), "+D -D");
}

#[test]
fn recentering_moves_a_board_below_the_index_fingertip() {
    let mut wearer = Wearer::with_layout(&text("", "A B C D E"));
    wearer.hover("A");
    wearer.hold_still(300);
    let mut events = Events::new();
    assert_eq!(wearer.pipeline.recenter(&mut events), Ok(()));
    let place = wearer.board_pose();
    let [middle, height] = [2.0 * PITCH, -0.045];
    // A count of the glove is some millimetres at the fingertip.
    assert!((place.right + middle).abs() < 4e-3, "{place:?}");
    assert!((place.height - height).abs() < 1e-6, "{place:?}");
    assert!((place.bearing - 35.0_f32.to_radians()).abs() < 1e-6);
    wearer.tap("A");
    assert_eq!(wearer.transcript(), "+C -C");
}

#[test]
fn recentering_keeps_the_arrangement_of_several_boards() {
    let two = text("", "A B C D E").replace(
        "boards: [",
        "boards: [(pose: (anchor: elbow, bearing_deg: 35, forward_mm: 300, height_mm: 100), \
         keys: [(code: \"Z\", at_mm: (0, 0))]), ",
    );
    let mut wearer = Wearer::with_layout(&text("", "A B C D E"));
    wearer.loaded.layout = parsed(&two);
    wearer.pipeline = wearer.loaded.pipeline();
    wearer.hover("A");
    wearer.hold_still(600);
    let before: Vec<BoardPose> = wearer.pipeline.board_poses().collect();
    assert_eq!(wearer.pipeline.recenter(&mut Events::new()), Ok(()));
    let after: Vec<BoardPose> = wearer.pipeline.board_poses().collect();
    let moved = |board: usize| after[board].right - before[board].right;
    assert!(moved(0) < -0.03, "{}", moved(0));
    assert!((moved(0) - moved(1)).abs() < 1e-6);
}

#[test]
fn recentering_without_a_tracked_hand_is_rejected() {
    let mut wearer = Wearer::with_layout(&text("", "A B C D E"));
    let mut events = Events::new();
    wearer.pipeline.stall(&mut events);
    let refused = wearer.pipeline.recenter(&mut events);
    assert_eq!(refused, Err(CommandError::NoHand));
    let unseen = &mut wearer.loaded.pipeline();
    assert_eq!(unseen.recenter(&mut events), Err(CommandError::NoHand));
    let left = text("", "A B C D E").replace("boards: [(", "boards: [(hand: \"left\", ");
    wearer.loaded.layout = parsed(&left);
    wearer.pipeline = wearer.loaded.pipeline();
    wearer.hold_still(100);
    let refused_again = wearer.pipeline.recenter(&mut events);
    assert_eq!(
        refused_again,
        Err(CommandError::NoBoard(ademan::hand::Side::Right))
    );
}

#[test]
fn a_key_recenters_its_own_board() {
    let with_key = text("", "A B C D E").replace(
        "rows:",
        "keys: [(action: Command(\"recenter\"), name: \"here\", at_mm: (0, 19))], rows:",
    );
    let mut wearer = Wearer::with_layout(&with_key);
    wearer.press("here", 500);
    assert_eq!(
        wearer.transcript(),
        "recenter",
        "and not C, in which the finger is"
    );
    wearer.tap("here");
    assert_eq!(wearer.transcript(), "+C -C");
}

#[test]
fn each_profile_keeps_its_own_board_poses() {
    let folder = tempfile::tempdir().expect("a folder");
    let file = |name: &str| {
        let path = folder.path().join(name);
        std::fs::write(&path, text("", "A B C D E")).expect("a file");
        path.display().to_string()
    };
    let setup = Setup {
        layout: file("a.ron"),
        profiles: vec![ProfileSetup {
            name: "other".into(),
            text: None,
            layout: file("b.ron"),
        }],
        ..Setup::default()
    };
    let mut wearer = Wearer::new(setup.load_files().expect("a setup"));
    let mut events = Events::new();
    assert_eq!(wearer.nudge(along_rows(-PITCH)), Ok(()));
    wearer.pipeline.switch_profile(1, &mut events);
    wearer.tap("B");
    wearer.pipeline.switch_profile(0, &mut events);
    wearer.tap("B");
    let mut fresh = wearer
        .loaded
        .layout_instance(&wearer.loaded.layout)
        .unwrap();
    wearer.pipeline.replace_profile(0, &mut fresh, &mut events);
    wearer.tap("B");
    assert_eq!(wearer.transcript(), "+B -B +C -C +B -B");
}

#[test]
fn a_press_during_a_pause_has_no_effect_after_it() {
    let mut wearer = Wearer::with_layout(&text("", "A B C D E"));
    wearer.hover("B");
    wearer.hold_still(200);
    let mut events = Events::new();
    wearer.pipeline.pause(CommandOrigin::Client, &mut events);
    wearer.push("B");
    wearer.hold_still(300);
    wearer.pipeline.resume(CommandOrigin::Client);
    wearer.hover("B");
    wearer.hold_still(500);
    assert_eq!(wearer.transcript(), "");
    wearer.tap("B");
    assert_eq!(wearer.transcript(), "+B -B");
}

/// Rests the hand beside and above the center of the board, by these distances in metres.
fn rest(wearer: &mut Wearer, right: f32, up: f32) {
    let layout = wearer.loaded.layout.clone();
    let [_, bottom] = wearer.tap_positions(&layout, &layout.scene, "C");
    wearer.go(bottom + along_rows(right) + Vec3::Y * up);
}

/// Returns the distance of the board from its pose in the file, in metres.
fn board_offset(wearer: &Wearer) -> f32 {
    let place = wearer.board_pose();
    (place.right.powi(2) + (place.forward - 0.3).powi(2)).sqrt()
}

#[test]
fn auto_recentering_moves_a_board_under_a_resting_hand() {
    let drift = "auto_recenter: (speed_mm_per_s: 5, delay_ms: 2000),";
    let mut wearer = Wearer::with_layout(&text(drift, "A B C D E"));
    rest(&mut wearer, 0.012, 0.03);
    wearer.hold_still(1_900);
    assert!(board_offset(&wearer) < 1e-6, "not yet");
    let mut last = 0.0;
    for _ in 0..60 {
        wearer.hold_still(100);
        let now = board_offset(&wearer);
        assert!(
            now - last < 0.00051,
            "{last} to {now} is faster than 5 mm/s"
        );
        last = now;
    }
    let right = wearer.board_pose().right;
    assert!((right - 0.012).abs() < 4e-3, "{right}");
    wearer.hold_still(1_000);
    assert!(
        (wearer.board_pose().right - right).abs() < 1e-4,
        "it has arrived"
    );
    assert!((wearer.board_pose().height + 0.045).abs() < 1e-6);
    assert_eq!(wearer.transcript(), "");
}

#[test]
fn auto_recentering_stays_within_its_maximum_offset() {
    let drift = "auto_recenter: (speed_mm_per_s: 50, delay_ms: 100, max_offset_mm: 6),";
    let mut wearer = Wearer::with_layout(&text(drift, "A B C D E"));
    for right in [0.03, -0.03, 0.02] {
        rest(&mut wearer, right, 0.03);
        for _ in 0..200 {
            wearer.hold_still(10);
            assert!(
                board_offset(&wearer) <= 0.006 + 1e-6,
                "{}",
                board_offset(&wearer)
            );
        }
        assert!(board_offset(&wearer) > 0.0059, "{}", board_offset(&wearer));
        assert_eq!(wearer.board_pose().right > 0.0, right > 0.0);
    }
}

#[test]
fn auto_recentering_stops_near_keys() {
    let drift = "auto_recenter: (speed_mm_per_s: 50, delay_ms: 100),";
    let mut wearer = Wearer::with_layout(&text(drift, "A B C D E"));
    wearer.push("A");
    wearer.hold_still(3_000);
    assert_eq!(wearer.transcript(), "+A");
    assert!(board_offset(&wearer) < 1e-6);
    rest(&mut wearer, 0.019, 0.008);
    wearer.hold_still(3_000);
    assert!(board_offset(&wearer) < 1e-6);
    let still = text("", "A B C D E");
    wearer.loaded.layout = parsed(&still);
    wearer.pipeline = wearer.loaded.pipeline();
    rest(&mut wearer, 0.012, 0.03);
    wearer.hold_still(5_000);
    assert!(board_offset(&wearer) < 1e-6, "off unless said");
}

#[test]
fn keys_of_a_cylinder_face_its_axis() {
    for (bends, axis) in [("Rows", Vec3::Y), ("Columns", Vec3::X)] {
        let form = format!("shape: Cylinder(radius_mm: 120, curved: {bends}),");
        let keys = text(&form, "A B C D E").replace(
            "rows: [",
            "rows: [(at_mm: (-38, 38), keys: \"Q W E R T\"), ",
        );
        let layout = parsed(&keys.replace("C D E\"", "C D F\""));
        let surface = &layout.scene.surfaces()[0];
        let board = &layout.boards[0];
        for key in &layout.keys {
            let pose = surface.target(key.face.target).unwrap().surface_from_target;
            let on_axis = Vec3::Z * 0.12 + axis * pose.translation.dot(axis);
            let facing = on_axis - pose.translation;
            assert!((facing.length() - 0.12).abs() < 1e-6);
            assert!((facing.normalize() - pose.rotation * Vec3::Z).length() < 1e-5);
            let over = board.shape.unbend(pose.transform_point(Vec3::Z * 0.01));
            assert!(
                (over - key.face.row_position.extend(0.01)).length() < 1e-6,
                "{over}"
            );
        }
        let text = layout.text.clone();
        let mut wearer = Wearer::with_layout(&text);
        for key in ["B", "D", "W"] {
            wearer.tap(key);
        }
        assert_eq!(wearer.transcript(), "+B -B +D -D +W -W", "{bends}");
    }
}

#[test]
fn a_key_has_a_lift_and_a_rotation() {
    let own = "keys: [(code: \"Z\", at_mm: (0, 60), lift_mm: 12, rotation_deg: (30, 0, 90)), \
               (code: \"Y\", at_mm: (0, 60))], rows:";
    let layout = parsed(&text("", "A B C D E").replace("rows:", own));
    let target = layout.key("Z").unwrap().face.target;
    let pose = layout.scene.target(target).unwrap().1.surface_from_target;
    assert!((pose.translation - Vec3::new(0.0, 0.06, 0.012)).length() < 1e-6);
    // About x first: the normal leans to −Y; then about z: to +X.
    let normal = pose.rotation * Vec3::Z;
    let expected = Vec3::new(0.5, 0.0, 0.75_f32.sqrt());
    assert!((normal - expected).length() < 1e-6, "{normal}");
    let mut wearer = Wearer::with_layout(&layout.text.replace("60)", "30)"));
    wearer.tap("Z");
    assert_eq!(wearer.transcript(), "+Z -Z");
}

#[test]
fn a_scale_applies_to_positions_and_sizes_but_not_to_the_pose() {
    let once = parsed(&text("shape: Arc(radius_mm: 300),", "A B C D E"));
    let larger = once
        .text
        .replace("anchor: elbow,", "anchor: elbow, scale: 1.5,");
    let larger = parsed(&larger);
    let origin = |layout: &Layout| layout.scene.surfaces()[0].anchor_from_surface();
    assert_eq!(origin(&once), origin(&larger));
    for (key, scaled) in once.keys.iter().zip(&larger.keys) {
        assert!((key.face.row_position * 1.5 - scaled.face.row_position).length() < 1e-6);
        let (half, large) = (&key.face.outline, &scaled.face.outline);
        assert!((half.half_extents() * 1.5 - large.half_extents()).length() < 1e-6);
        let (_, target) = larger.scene.target(scaled.face.target).unwrap();
        assert_eq!(target.travel, 0.004);
    }
}

#[test]
fn keys_issue_nudge_and_tilt_commands() {
    let keys = r#"keys: [(action: Command("nudge 0 -5 0"), name: "down", at_mm: (0, -30)),
        (action: Command("tilt -2"), name: "tilt", at_mm: (30, -30))],"#;
    let mut wearer = Wearer::with_layout(&text(keys, "A B"));
    let before = wearer.board_pose();
    wearer.tap("tilt");
    assert!((wearer.board_pose().tilt - (before.tilt - 2_f32.to_radians())).abs() < 1e-6);
    wearer.tap("down");
    assert!((wearer.board_pose().height - (before.height - 0.005)).abs() < 1e-6);
    assert_eq!(wearer.transcript(), "tilt -2 nudge 0 -5 0");
}
