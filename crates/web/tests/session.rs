//! The session of the page, without a page.

use std::time::Duration;

use ademan_core::contact::TargetId;
use ademan_core::document::Document;
use ademan_core::hand::Side;
use ademan_web::{HandState, PageSession, PlanEdit, Pointed};
use glam::Vec3;
use serde_json::Value;

const FRAME: Duration = Duration::from_micros(16_667);

fn shipped(name: &str) -> String {
    Document::shipped(name).expect("a shipped file").text
}

fn session(name: &str) -> PageSession {
    PageSession::new(&shipped(name)).expect("a valid layout")
}

fn objects(lines: &str) -> Vec<Value> {
    let object = |line| serde_json::from_str(line).expect("an object");
    lines.lines().map(object).collect()
}

/// Runs until the hands rest, and returns all objects.
fn run(session: &mut PageSession) -> Vec<Value> {
    let mut all = Vec::new();
    for _ in 0..20_000 {
        all.extend(objects(&session.advance(FRAME)));
        if session.hand_state() == HandState::Resting {
            return all;
        }
    }
    panic!("the hands do not rest");
}

fn events(objects: &[Value]) -> Vec<String> {
    let of_kind = objects.iter().filter(|it| it["kind"] == "events");
    let words = |it: &Value| format!("{} {}", it["event"], it["key"]).replace('"', "");
    of_kind.map(words).collect()
}

#[test]
fn a_simulated_person_types_a_text() {
    let mut session = session("qwerty-flat");
    assert_eq!(session.type_text("Hi a"), []);
    let objects = run(&mut session);
    assert_eq!(session.text(), "Hi a");
    let events = events(&objects).join(", ");
    assert!(events.contains("key-down H, key-up H"), "{events}");
    for kind in ["scene", "pose", "touches", "events", "session"] {
        assert!(objects.iter().any(|it| it["kind"] == kind), "{kind}");
    }
}

#[test]
fn two_hands_type_on_boards_for_both() {
    let mut session = session("qwerty-two-flat");
    assert_eq!(session.type_text("hello"), []);
    run(&mut session);
    assert_eq!(session.text(), "hello");
}

#[test]
fn one_hand_presses_keys_on_a_board_that_the_other_one_carries() {
    let mut session = session("wrist-remote");
    assert_eq!(session.play("tap F5; tap Escape"), []);
    let found = events(&run(&mut session)).join(", ");
    assert_eq!(
        found,
        "key-down F5, key-up F5, key-down Escape, key-up Escape"
    );
}

#[test]
fn every_shipped_layout_opens_and_is_toured() {
    for name in ademan_core::document::shipped_layouts() {
        let mut session = session(name);
        let lines = objects(&session.layout_lines());
        assert_eq!(lines[0]["faults"], serde_json::json!([]), "{name}");
        assert_eq!(lines[1]["kind"], "layout", "{name}");
        let plan = lines[0]["plan"].as_array().expect("boards");
        assert_eq!(plan.len(), session.layout().boards.len(), "{name}");
    }
}

#[test]
fn a_hand_at_rest_is_shown_and_places_the_boards() {
    let mut session = session("qwerty-two-flat");
    let seen = objects(&session.advance(FRAME));
    let scene = seen
        .iter()
        .find(|it| it["kind"] == "scene")
        .expect("a scene");
    assert!(
        scene["boards"]
            .as_array()
            .is_some_and(|it| it.len() == 2 && it.iter().all(Value::is_array)),
        "{scene}"
    );
    assert_eq!(seen.iter().filter(|it| it["kind"] == "pose").count(), 2);
    assert_eq!(session.text(), "");
    let mut rehearsal = session.rehearsal();
    assert!(rehearsal.run() > 100);
    assert_eq!(session.text(), "", "a rehearsal is not shown");
}

#[test]
fn a_script_with_a_fault_names_its_line() {
    let mut session = session("qwerty-flat");
    let faults = session.play("tap Q\ntapp W");
    assert_eq!(faults[0].line, Some(2));
    assert_eq!(session.hand_state(), HandState::Resting);
    assert_eq!(session.play("tap Q\ntap W"), []);
    run(&mut session);
    assert_eq!(session.text(), "qw");
}

#[test]
fn a_layout_with_a_fault_leaves_the_board_in_use() {
    let mut session = session("qwerty-flat");
    let text = shipped("qwerty-flat");
    let broken = text.replacen("keys:", "kyes:", 1);
    let line = 1 + broken[..broken.find("kyes").expect("it is there")]
        .matches('\n')
        .count();
    let lines = objects(&session.set_layout(&broken));
    assert_eq!(lines.len(), 1);
    assert_eq!(lines[0]["faults"][0]["line"], line);
    session.type_text("hi");
    run(&mut session);
    assert_eq!(session.text(), "hi");
}

#[test]
fn a_person_who_types_goes_on_with_the_rest_on_another_layout() {
    let mut session = session("qwerty-flat");
    session.type_text("hello world");
    let mut objects_so_far = Vec::new();
    while session.text().len() < 4 {
        objects_so_far.extend(objects(&session.advance(FRAME)));
    }
    let lines = session.set_layout(&shipped("dvorak-flat"));
    objects_so_far.extend(objects(&lines));
    objects_so_far.extend(run(&mut session));
    assert_eq!(session.text(), "hello world");
    let events = events(&objects_so_far);
    let count = |kind: &str| events.iter().filter(|it| it.starts_with(kind)).count();
    assert_eq!(count("key-down"), count("key-up"), "{events:?}");
}

#[test]
fn a_switch_is_released_by_its_own_name_when_another_layout_follows() {
    let layout = "Layout(name: \"a\", boards: [(pose: (anchor: elbow, bearing_deg: 35, forward_mm: 300, height_mm: -45), toggles: [(name: \"lamp\", at_mm: (0, 0), hold: Key(\"ShiftLeft\"))])])";
    let mut session = PageSession::new(layout).expect("a valid layout");
    assert_eq!(session.play("tap lamp"), []);
    run(&mut session);
    let released = objects(&session.set_layout(&shipped("qwerty-flat")));
    let found = events(&released);
    assert!(found.iter().any(|it| it == "key-up ShiftLeft"), "{found:?}");
    let values = released.iter().filter(|it| it["event"] == "value");
    let names: Vec<&Value> = values.map(|it| &it["target"]).collect();
    assert_eq!(names, ["lamp"]);
}

#[test]
fn a_person_whose_text_was_cleared_goes_on_with_the_rest_on_another_layout() {
    let mut session = session("qwerty-flat");
    session.type_text("hello world");
    while session.text().len() < 4 {
        session.advance(FRAME);
    }
    session.clear_text();
    session.set_layout(&shipped("dvorak-flat"));
    run(&mut session);
    assert_eq!(session.text(), "o world");
}

#[test]
fn a_text_that_is_cleared_while_shift_is_down_goes_on_in_capitals() {
    let layout = "Layout(name: \"a\", boards: [(pose: (anchor: elbow, bearing_deg: 35, forward_mm: 300, height_mm: -45), pitch_mm: 24, size_mm: Box(22, 20), rows: [(at_mm: (-70, 14), keys: \"Q W E R T Y U\")], keys: [(code: \"ShiftLeft\", name: \"lock\", latch: Lock, at_mm: (-36, -24))])])";
    let mut session = PageSession::new(layout).expect("a valid layout");
    assert_eq!(session.play("tap lock; tap Q; tap W"), []);
    let is_typed = |_| {
        session.advance(FRAME);
        session.text() == "Q"
    };
    assert!((0..20_000).any(is_typed), "the first key is typed");
    session.clear_text();
    run(&mut session);
    assert_eq!(session.text(), "W");
}

/// Points at a key of the first board with the right hand.
fn point(session: &mut PageSession, name: &str, scene: &Value, is_down: bool) {
    let layout = session.layout();
    let face = &layout.key(name).expect("a key").face;
    let (_, target) = layout.scene.target(face.target).expect("a target");
    let pose = &scene["boards"][0];
    let number = |index: usize| pose[index].as_f64().expect("a number") as f32;
    let position = Vec3::new(number(0), number(1), number(2));
    let rotation = glam::Quat::from_xyzw(number(3), number(4), number(5), number(6));
    let surface_from_target = target.surface_from_target;
    let pointed = Pointed {
        point: position + rotation * surface_from_target.translation,
        normal: rotation * (surface_from_target.rotation * Vec3::Z),
        travel: target.travel,
        is_down,
    };
    session.point(Side::Right, pointed);
}

#[test]
fn a_pointer_presses_the_key_that_it_points_at() {
    let mut session = session("qwerty-flat");
    // The boards are placed by a hand.
    session.type_text("a");
    let scene = run(&mut session)
        .into_iter()
        .rfind(|it| it["kind"] == "scene")
        .expect("a scene");
    session.clear_text();
    let mut seen = Vec::new();
    for name in ["Q", "P", "Space", "M"] {
        for is_down in [false, true, false] {
            point(&mut session, name, &scene, is_down);
            for _ in 0..40 {
                seen.extend(objects(&session.advance(FRAME)));
            }
        }
    }
    assert_eq!(session.text(), "qp m", "{:?}", events(&seen));
    // A click is shorter than the way of the finger.
    for is_down in [true, false] {
        point(&mut session, "X", &scene, is_down);
    }
    for _ in 0..40 {
        session.advance(FRAME);
    }
    assert_eq!(session.text(), "qp mx");
    // A press may follow while the finger is still in the key before it.
    for name in ["A", "L"] {
        point(&mut session, name, &scene, true);
        let is_typed = |_| {
            session.advance(FRAME);
            session.text().ends_with(&name.to_lowercase())
        };
        assert!((0..100).any(is_typed), "{name} is typed");
        point(&mut session, name, &scene, false);
    }
    assert_eq!(session.text(), "qp mxal");
    session.release();
    assert_eq!(session.hand_state(), HandState::Resting);
}

#[test]
fn a_release_in_the_middle_of_a_press_brings_the_key_up() {
    let mut session = session("qwerty-flat");
    session.type_text("qqq");
    let mut all = Vec::new();
    while !events(&all).iter().any(|it| it == "key-down Q") {
        all.extend(objects(&session.advance(FRAME)));
    }
    session.release();
    all.extend(objects(&session.advance(FRAME)));
    assert_eq!(events(&all), ["key-down Q", "key-up Q"]);
    let scene = all
        .iter()
        .rfind(|it| it["kind"] == "scene")
        .expect("a scene");
    assert_eq!(scene["keys"], serde_json::json!([]));
}

#[test]
fn lines_of_a_headset_type() {
    let mut session = session("qwerty-flat");
    assert!(
        session.push("hc11", b"x").is_err(),
        "a browser reads no glove"
    );
    let line = |time: u64| {
        let joints = vec!["[0.1,1.0,-0.4]"; 25].join(",");
        format!(
            "{{\"time_us\":{time},\"hands\":[{{\"label\":\"right\",\"joints\":[{joints}]}}]}}\n"
        )
    };
    let text: String = (0..5).map(|index| line(16_667 * index)).collect();
    assert_eq!(session.push("webxr", text.as_bytes()), Ok(5));
    assert_eq!(session.hand_state(), HandState::Followed);
    for _ in 0..10 {
        session.advance(FRAME);
    }
}

#[test]
fn a_dragged_key_changes_its_numbers_only() {
    let text = "// mine\nLayout(name: \"a\", boards: [(pose: (anchor: elbow, bearing_deg: 35, forward_mm: 300, height_mm: -45), rows: [(at_mm: (0, 0), keys: \"A B C\")], keys: [(code: \"D\", at_mm: (0, -19))])])\n";
    let session = PageSession::new(text).expect("a valid layout");
    let id = |name: &str| session.layout().key(name).expect("a key").face.target;
    let moved = PlanEdit::Move { by_mm: [2.0, 1.0] };
    assert_eq!(
        session.edit(&[id("D")], moved),
        Ok(text.replace("(0, -19)", "(2, -18)"))
    );
    let taken_out = session.edit(&[id("B")], moved).expect("it is moved");
    assert!(
        taken_out.starts_with("// mine\n") && taken_out.contains("code: \"B\""),
        "{taken_out}"
    );
    let mut edited = PageSession::new(text).expect("a valid layout");
    assert_eq!(
        objects(&edited.set_layout(&taken_out))[0]["faults"],
        serde_json::json!([])
    );
    let missing = edited.edit(&[TargetId(99)], PlanEdit::Delete);
    assert_eq!(missing, Ok(taken_out), "there is nothing to delete");
}

#[test]
fn a_person_with_errors_makes_some() {
    let mut session = session("qwerty-flat");
    assert_eq!(session.set_person("Person(nam: 1)")[0].line, Some(1));
    assert_eq!(session.set_person(&shipped("adult")), []);
    session.type_text("the quick brown fox jumps");
    run(&mut session);
    assert!(!session.text().is_empty());
}
