//! Layout files: shipped layouts, positions of keys, drawings, and the guide.

use std::collections::BTreeSet;
use std::fs;
use std::path::Path;
use std::time::Duration;

use ademan::contact::surface::Shape;
use ademan::device::KeyCode;
use ademan::device::keyboard::{Activation, TapHold};
use ademan::device::{KeyAction, Latch};
use ademan::document::Document;
use ademan::files::{Load, OpenDocument};
use ademan::hand::{Joint, Side};
use ademan::kinematics::HandPose;
use ademan::layout::{KeySize, Layout, field_tables};
use ademan::time::Timestamp;
use parry3d::math::{Pose, Vec2, Vec3};

const POSE: &str = "pose: (anchor: elbow)";

/// Returns a layout whose board has these fields.
fn board(fields: &str) -> String {
    format!("Layout(name: \"t\", boards: [(\n{POSE},\n{fields}\n)])")
}

/// Returns a message with the names of all fields of a board at its end.
pub fn with_board_fields(message: &str) -> &'static str {
    let tables = field_tables();
    let board = tables.iter().find(|table| table.name == "Board");
    let rows = board.expect("boards have fields").rows.iter();
    let names: Vec<&str> = rows.map(|row| row.name.as_str()).collect();
    assert!(names.contains(&"rows") && names.contains(&"knobs"));
    format!("{message}{}", names.join(", ")).leak()
}

fn code(name: &str) -> KeyCode {
    name.parse().unwrap()
}

#[test]
fn every_shipped_layout_loads_by_name_and_from_its_file() {
    let shipped = Layout::shipped().unwrap();
    let names: Vec<&str> = shipped.iter().map(|(name, _)| *name).collect();
    assert_eq!(
        names,
        [
            "arrows",
            "azerty-flat",
            "chords-bend",
            "colemak-flat",
            "dvorak-flat",
            "number-entry",
            "numpad",
            "phone-pad",
            "phone-words",
            "qwerty-arc",
            "qwerty-flat",
            "qwerty-flat-22",
            "qwerty-swipe",
            "qwerty-two-arc",
            "qwerty-two-flat",
            "qwerty-words",
            "qwertz-flat",
            "spanish-flat",
            "webcam-qwerty",
            "wrist-remote",
            "drum-pads",
            "game",
            "media",
            "mixer",
            "piano",
            "radial",
            "scroll-rings",
            "steering-wheel",
            "switches",
            "touch-pad",
            "workshop",
            "xy-pad",
            "arm-6dof",
            "arm-gamepad",
            "claws",
            "direct",
            "drive",
            "gestures",
            "joint",
            "lucidgloves-controller",
            "rate",
            "ray",
            "space",
            "webcam-mouse",
        ]
    );
    let plays = ["drum-pads", "piano"];
    for (name, layout) in &shipped {
        let folder = match layout {
            Layout { boards, .. } if boards.is_empty() => "pointers",
            Layout { controls, .. } if controls.is_empty() && !plays.contains(name) => "keyboards",
            _ => "panels",
        };
        let path = format!("{}/layouts/{folder}/{name}.ron", env!("CARGO_MANIFEST_DIR"));
        let from_file = Layout::load(&path).unwrap();
        assert_eq!(from_file.keys, layout.keys, "{name}");
        assert_eq!(from_file.controls, layout.controls, "{name}");
        assert_eq!(from_file.text, Layout::load(name).unwrap().text, "{name}");
        assert!(!layout.description.is_empty(), "{name}");
        let fronts = layout.boards.iter().flat_map(|board| layout.faces(board));
        assert_eq!(fronts.count(), layout.scene.len(), "{name}");
    }
}

#[test]
fn the_flat_boards_type_every_printable_character_with_and_without_shift() {
    for name in ["qwerty-flat", "qwerty-flat-22"] {
        let layout = Layout::load(name).unwrap();
        let codes = layout.required_capabilities().keys;
        for character in (' '..='~').chain(['\n', '\t']) {
            assert!(types(&codes, character), "{name}: {character:?}");
        }
        assert!(codes.contains(&KeyCode::SHIFT_LEFT) && codes.contains(&KeyCode::BACKSPACE));
    }
}

#[test]
fn the_arc_board_types_every_printable_character_with_its_layer() {
    let layout = Layout::load("qwerty-arc").unwrap();
    let codes = layout.required_capabilities().keys;
    for character in ' '..='~' {
        assert!(types(&codes, character), "{character:?}");
    }
    let shift = layout.key("ShiftLeft").unwrap();
    let one_shot = KeyAction::Modifier(KeyCode::SHIFT_LEFT, Latch::OneShot);
    assert_eq!(shift.action(0), Some(one_shot));
    let q = layout.key("Q").unwrap();
    assert_eq!(q.action(1), Some(KeyAction::Key(code("1"))));
    assert_eq!(q.action(7), Some(KeyAction::Key(code("Q"))));
    let symbols = layout.key("symbols").unwrap();
    assert_eq!(symbols.action(0), Some(KeyAction::Layer(1, Latch::OneShot)));
    assert_eq!(layout.layers, ["base", "symbols"]);
}

/// Returns `true` if one of the keys types the character on a US keymap, with or without Shift.
fn types(codes: &BTreeSet<KeyCode>, character: char) -> bool {
    let types = |shifted| move |key: &KeyCode| key.us_character(shifted) == Some(character);
    codes.iter().any(types(false)) || codes.iter().any(types(true))
}

#[test]
fn the_pads_have_their_keys() {
    let arrows = Layout::load("arrows").unwrap();
    assert_eq!(arrows.keys.len(), 4);
    assert!(arrows.key_bindings().iter().all(|key| key.reports_depth));
    assert_eq!(Layout::load("numpad").unwrap().keys.len(), 17);
}

/// Compares the numbers of a file with the positions of the targets in the world.
#[test]
fn keys_of_a_flat_board_have_the_positions_of_the_file() {
    for (bearing, tilt) in [(0.0, 0.0), (35.0, 0.0), (-120.0, 20.0), (90.0, -45.0)] {
        let text = format!(
            "Layout(name: \"t\", boards: [(
                pose: (anchor: elbow, bearing_deg: {bearing}, forward_mm: 300, height_mm: -40, tilt_deg: {tilt}),
                rows: [(at_mm: (-30, 20), keys: \"Q W E\", pitch_mm: 25)],
                keys: [(code: \"Space\", at_mm: (5, -18), size_mm: Disc(12), travel_mm: 6)],
            )])"
        );
        let layout = Layout::parse(&text, "t.ron").unwrap();
        let positions = [(-30.0, 20.0), (-5.0, 20.0), (20.0, 20.0), (5.0, -18.0)];
        for (key, (x, y)) in layout.keys.iter().zip(positions) {
            let (sin, cos) = f32::to_radians(bearing).sin_cos();
            let (up, along) = f32::to_radians(tilt).sin_cos();
            let (right, forward) = (x * 1e-3, 0.3 + y * 1e-3 * along);
            let expected = Vec3::new(
                right * cos + forward * sin,
                -0.04 + y * 1e-3 * up,
                right * sin - forward * cos,
            );
            let (front, normal) = in_the_world(&layout, &key.face.name, Vec3::new(1.0, 2.0, 3.0));
            let error = (front - Vec3::new(1.0, 2.0, 3.0) - expected).length();
            assert!(error < 1e-6, "{}: {front} for {expected}", key.face.name);
            let upright = Vec3::new(-up * sin, along, up * cos);
            assert!((normal - upright).length() < 1e-6, "{}", key.face.name);
        }
        let (_, space) = layout.scene.target(layout.keys[3].face.target).unwrap();
        assert_eq!((space.shape, space.travel), (Shape::Disc(0.006), 0.006));
    }
}

#[test]
fn rows_of_an_arc_board_are_arcs_around_the_elbow() {
    let layout = Layout::load("qwerty-arc").unwrap();
    let board = &layout.boards[0];
    let elbow = Vec3::new(0.0, 0.0, -0.2);
    let bearing = 35_f32.to_radians();
    for key in &layout.keys {
        let (front, normal) = in_the_world(&layout, &key.face.name, elbow);
        let from_elbow = front - elbow;
        let radius = from_elbow.x.hypot(from_elbow.z);
        assert!(
            (radius - (0.32 + key.face.row_position.y)).abs() < 1e-6,
            "{}",
            key.face.name
        );
        let angle = from_elbow.x.atan2(-from_elbow.z) - bearing;
        assert!(
            (angle * radius - key.face.row_position.x).abs() < 1e-6,
            "{}",
            key.face.name
        );
        assert!((from_elbow.y + 0.045).abs() < 1e-6);
        assert!((normal - Vec3::Y).length() < 1e-6);
        assert!(
            (key.face.outline.rotation + angle).abs() < 1e-6,
            "{}",
            key.face.name
        );
        assert!(
            (board.shape.row_position(key.face.outline.center) - key.face.row_position).length()
                < 1e-6
        );
        assert!(angle.abs() < 25_f32.to_radians(), "{}", key.face.name);
    }
}

/// Returns the center and the normal of the face of a key, in the world.
fn in_the_world(layout: &Layout, name: &str, elbow: Vec3) -> (Vec3, Vec3) {
    let mut pose = HandPose::new(Timestamp(0), Side::Right, 0.005);
    pose.set(Joint::Elbow, Pose::from_translation(elbow));
    let target = layout.key(name).unwrap().face.target;
    let (surface, target) = layout.scene.target(target).unwrap();
    let world_from_target = surface.world_from_surface(&pose).unwrap() * target.surface_from_target;
    (
        world_from_target.translation,
        world_from_target.rotation * Vec3::Z,
    )
}

#[test]
fn a_board_moves_with_its_anchor() {
    for (word, joint) in [
        ("world", None),
        ("elbow", Some(Joint::Elbow)),
        ("wrist", Some(Joint::Wrist)),
    ] {
        let text = board("rows: [(at_mm: (0, 0), keys: \"A\")]").replace("elbow", word);
        let layout = Layout::parse(&text, "t.ron").unwrap();
        let surface = &layout.scene.surfaces()[0];
        let mut pose = HandPose::new(Timestamp(0), Side::Right, 0.005);
        assert_eq!(
            surface.world_from_surface(&pose).is_some(),
            joint.is_none(),
            "{word}"
        );
        let place = joint.map_or(Vec3::ZERO, |joint| {
            pose.set(joint, Pose::from_translation(Vec3::X));
            Vec3::X
        });
        let found = surface
            .world_from_surface(&pose)
            .map(|pose| pose.translation);
        assert_eq!(found, Some(place), "{word}");
    }
}

#[test]
fn boards_share_one_list_of_keys() {
    let one = "(pose: (anchor: world), rows: [(at_mm: (0, 0), keys: \"A B\")])";
    let two =
        "(pose: (anchor: wrist), keys: [(code: \"C\", at_mm: (1, 2), name: \"c\", label: \"x\")])";
    let text = format!("Layout(name: \"t\", boards: [{one}, {two}])");
    let layout = Layout::parse(&text, "t.ron").unwrap();
    let key = layout.key("c").unwrap();
    assert_eq!((key.face.target.0, key.face.label.as_str()), (2, "x"));
    assert_eq!(key.face.row_position, Vec2::new(0.001, 0.002));
    assert_eq!(layout.boards[0].keys, 0..2);
    assert_eq!(layout.boards[1].keys, 2..3);
    assert_eq!(layout.scene.surfaces().len(), 2);
}

#[test]
fn touching_keys_do_not_overlap() {
    let text = board(
        "pitch_mm: 17, rows: [(at_mm: (0.1, 0), keys: \"Q W E\"), (at_mm: (0.1, 17), keys: \"A S D\")]",
    );
    assert_eq!(Layout::parse(&text, "t.ron").unwrap().keys.len(), 6);
}

#[test]
fn a_layer_does_not_change_keys_that_it_does_not_name() {
    let text = format!(
        "Layout(name: \"t\", boards: [({POSE}, rows: [(at_mm: (0, 0), keys: \"Q W\")])], layers: [
            (name: \"one\", keys: {{\"W\": \"1\"}}), (name: \"two\", keys: {{\"Q\": \"2\", \"W\": \"ShiftLeft\"}})])"
    );
    let layout = Layout::parse(&text, "t.ron").unwrap();
    let bindings = layout.key_bindings();
    let key = |name| Some(KeyAction::Key(code(name)));
    assert_eq!(bindings[0].actions, [key("Q"), None, key("2")]);
    let shift = Some(KeyAction::Modifier(KeyCode::SHIFT_LEFT, Latch::Momentary));
    assert_eq!(bindings[1].actions, [key("W"), key("1"), shift]);
    let expected: BTreeSet<KeyCode> = ["Q", "W", "1", "2", "ShiftLeft"].map(code).into();
    assert_eq!(layout.required_capabilities().keys, expected);
    assert_eq!(layout.label_in_layer(&layout.keys[0], 1), None);
    assert_eq!(layout.label_in_layer(&layout.keys[1], 2), Some("⇧"));
}

#[test]
fn activation_and_debounce_are_read_from_the_file() {
    let text = format!(
        "Layout(name: \"t\", boards: [({POSE}, debounce_ms: 40.5,
            rows: [(at_mm: (0, 0), keys: \"Q\")],
            keys: [
                (code: \"W\", activate_on: Release, debounce_ms: 0, at_mm: (19, 0)),
                (code: \"E\", activate_on: Press, at_mm: (38, 0)),
                (code: \"Space\", hold: (layer: \"x\"), hold_after_ms: 300, at_mm: (57, 0)),
                (code: \"F\", hold: (code: \"ShiftLeft\"), at_mm: (76, 0)),
                (code: \"AltLeft\", latch: Lock, at_mm: (95, 0)),
                (layer: \"x\", latch: Lock, at_mm: (114, 0)),
            ])], layers: [(name: \"x\", keys: {{\"Space\": \"1\"}})])"
    );
    let layout = Layout::parse(&text, "t.ron").unwrap();
    let bindings = layout.key_bindings();
    let hold = |action, after| {
        Activation::TapHold(TapHold {
            hold_action: action,
            hold_after: Duration::from_millis(after),
        })
    };
    let shift = KeyAction::Modifier(KeyCode::SHIFT_LEFT, Latch::Momentary);
    let fires: Vec<Activation> = bindings.iter().map(|binding| binding.activation).collect();
    assert_eq!(
        fires[..5],
        [
            Activation::OnPress,
            Activation::OnRelease,
            Activation::OnPress,
            hold(KeyAction::Layer(1, Latch::Momentary), 300),
            hold(shift, 250),
        ]
    );
    let alt = KeyAction::Modifier(code("AltLeft"), Latch::Lock);
    assert_eq!(bindings[5].actions, [Some(alt)]);
    assert_eq!(
        bindings[6].actions,
        [Some(KeyAction::Layer(1, Latch::Lock))]
    );
    let debounce_times: Vec<u128> = bindings[..3]
        .iter()
        .map(|binding| binding.debounce.as_micros())
        .collect();
    assert_eq!(debounce_times, [40_500, 0, 40_500]);
    assert!(
        layout
            .required_capabilities()
            .keys
            .contains(&KeyCode::SHIFT_LEFT)
    );
}

#[test]
fn a_path_takes_precedence_over_a_shipped_layout_and_a_name_never_means_a_file_in_the_folder() {
    let folder = tempfile::tempdir().unwrap();
    let text = board("rows: [(at_mm: (0, 0), keys: \"A\")]");
    fs::create_dir(folder.path().join("keyboards")).unwrap();
    for name in ["arrows", "keyboards/arrows.ron"] {
        fs::write(folder.path().join(name), &text).unwrap();
    }
    let keys = |base: &Path, name| {
        let document = Document::open_relative_to(base, name).unwrap();
        Layout::from_document(document).unwrap().keys.len()
    };
    assert_eq!(keys(folder.path(), "arrows"), 4);
    assert_eq!(keys(folder.path(), "./arrows"), 1);
    assert_eq!(keys(folder.path(), "arrows.ron"), 4);
    fs::write(folder.path().join("arrows.ron"), &text).unwrap();
    assert_eq!(keys(folder.path(), "arrows.ron"), 1);
    assert_eq!(keys(folder.path(), "arrows"), 4);
    assert_eq!(keys(folder.path(), "keyboards/arrows"), 4);
    assert_eq!(keys(folder.path(), "keyboards/arrows.ron"), 1);
    // A folder with that name is ignored.
    fs::create_dir(folder.path().join("numpad")).unwrap();
    assert_eq!(keys(folder.path(), "numpad"), 17);
}

#[test]
fn a_drawing_shows_every_key_at_its_position() {
    let text = board(
        "rows: [(at_mm: (0, 0), keys: \"Q W\")], keys: [(code: \"Space\", label: \"⎵ <&>\", at_mm: (9.5, -19), size_mm: Box(36, 17)), (code: \"1\", at_mm: (57, -19), size_mm: Disc(17))]",
    );
    let layout = Layout::parse(&text, "t.ron").unwrap();
    let expected = "\
┌───┐┌───┐
│ Q ││ W │
└───┘└───┘
┌────────┐     ╭───╮
│ ⎵ <&>  │     │ 1 │
└────────┘     ╰───╯
";
    assert_eq!(layout.to_text(), expected);
    let grid = &layout.grids(KeySize::Labelled)[0];
    assert_eq!(grid.cell_at(Vec2::new(0.019, 0.0)), Some((7, 1)));
    for (x, y) in [(0.5, 0.0), (-0.01, 0.0), (0.0, 0.01), (0.0, -0.1)] {
        assert_eq!(grid.cell_at(Vec2::new(x, y)), None);
    }
}

#[test]
fn drawings_of_shipped_layouts_have_whole_labels_and_fit_into_80_columns() {
    for (name, layout) in Layout::shipped().unwrap() {
        let text = layout.to_text();
        for line in text.lines() {
            assert!(line.chars().count() <= 80, "{name}: {line}");
        }
        let faces = layout.boards.iter().flat_map(|board| layout.faces(board));
        let labels = faces.map(|face| face.label.as_str());
        let triggers = layout.triggers.iter().map(|(trigger, _)| trigger.as_str());
        let targets = layout.spaces.iter().flat_map(|space| &space.names);
        for part in labels.chain(triggers).chain(targets.map(String::as_str)) {
            assert!(text.contains(part), "{name}: {part} is missing in\n{text}");
        }
    }
}

#[test]
fn controls_gestures_and_chords_are_listed_below_the_boards() {
    let cases = [
        ("workshop", "Water  valve, 3 turns"),
        (
            "scroll-rings",
            "Page    scroll ring, 24 detents a turn, wheel -24 up",
        ),
        (
            "steering-wheel",
            "valve, 2.5 turns, springs back, axis Wheel",
        ),
        (
            "xy-pad",
            "Bend    XY pad, springs back; Bend x to the right; Bend y up",
        ),
        (
            "radial",
            "Edit  radial menu, clockwise: Copy Ctrl+C, Paste Ctrl+V,",
        ),
        (
            "media",
            "Volume  knob, 270°, 20 steps, 20 taps of Vol+ or Vol-",
        ),
        ("game", "Gas    ring-mcp-flexion 20°, axis RightTrigger"),
        ("chords-bend", "T I: I · I M: N"),
        ("chords-bend", "T 1 · I 2 · M 3 · R 4 · L 5 · T I: 6"),
        ("chords-bend", "thumb bent beyond 50 %, until 40 %"),
        ("qwerty-arc", "Q 1 · W 2"),
        ("phone-pad", "one of ABC2"),
        ("phone-pad", "one of .,-/="),
        ("direct", "index fingertip in a box of 200 × 120 × 160 mm,"),
        (
            "webcam-mouse",
            "index knuckle in a box of 640 × 360 × 600 mm,",
        ),
        ("ray", "middle pinch          right mouse button"),
        ("space", "Door   box 60 × 40 × 30 mm at (160, 50, -320) mm"),
        ("switches", "F                      held for 250 ms: Ctrl"),
        ("switches", "copy-line  taps Home, taps ShiftLeft+End"),
    ];
    for (name, line) in cases {
        let text = Layout::load(name).unwrap().to_text();
        assert!(text.contains(line), "{name}: {line} is missing in\n{text}");
    }
}

#[test]
fn the_drawing_of_the_largest_board_is_limited_in_size() {
    let text = board(
        "pitch_mm: 1, size_mm: Disc(1), keys: [(code: \"A\", at_mm: (-2000, -2000)), (code: \"B\", at_mm: (2000, 2000))]",
    );
    let layout = Layout::parse(&text, "t.ron").unwrap();
    let grid = &layout.grids(KeySize::Labelled)[0];
    assert!(grid.columns <= 201 && grid.rows <= 81);
    assert_eq!(layout.to_text().lines().count(), grid.rows);
}

/// Every fenced RON block of the guide is a complete layout.
#[test]
fn the_examples_of_the_guide_are_valid() {
    let path = format!("{}/layouts/README.md", env!("CARGO_MANIFEST_DIR"));
    let guide = fs::read_to_string(path).unwrap();
    let blocks: Vec<&str> = guide
        .split("```ron\n")
        .skip(1)
        .map(|rest| rest.split("```").next().unwrap())
        .collect();
    assert!(blocks.len() >= 4, "{}", blocks.len());
    for block in blocks {
        let document = Document::new("README.md", block);
        Layout::parse(&document.text, &document.file).unwrap_or_else(|error| panic!("{error}"));
    }
}

#[test]
fn the_errors_in_the_guide_are_those_of_the_program() {
    let path = format!("{}/layouts/README.md", env!("CARGO_MANIFEST_DIR"));
    let guide = fs::read_to_string(path).unwrap();
    let first = guide.split("```ron\n").nth(1).unwrap();
    let first = first.split("```").next().unwrap();
    let misspelt = first.replace("Enter", "Entre");
    let space = "        keys: [(code: \"Space\", at_mm: (10, 10))],\n    )],";
    let overlapping = first.replace("    )],", space);
    for text in [misspelt, overlapping] {
        let error = Layout::parse(&text, "yes-no.ron").unwrap_err().to_string();
        assert!(guide.contains(&format!("```text\n{error}\n```")), "{error}");
    }
}

#[test]
fn labels_of_a_national_board_are_assigned_by_key_code() {
    let board = Layout::load("azerty-flat").expect("a shipped layout");
    let label = |name: &str| board.key(name).expect("a key").face.label.clone();
    assert_eq!(
        [label("Q"), label("A"), label("3"), label("E")],
        ["A", "Q", "\"", "E"]
    );
}

#[test]
fn a_label_for_an_unknown_key_is_rejected_at_its_position() {
    let text = "Layout(name: \"t\", boards: [(pose: (anchor: elbow), rows: [(at_mm: (0, 0), keys: \"Q\")])],\n\
                labels: {\"W\": \"Z\"})";
    let error = Layout::parse(text, "t.ron")
        .expect_err("no key W")
        .to_string();
    assert!(
        error.starts_with("t.ron:2:11: this layout has no such key"),
        "{error}"
    );
}
