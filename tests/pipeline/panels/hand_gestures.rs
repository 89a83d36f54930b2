//! Triggers that are held for a time, have a cool-down, and measure a shape or a motion of the hand.

use ademan::hand::{Dof, Finger};
use ademan::layout::Layout;

use super::{assert_layout_events, simulate_layout};

const BOARD: &str = r#"keys: [(code: "A", at_mm: (0, 0))]"#;
const CLAW: &str = r#"triggers: [(name: "Claw", action: Key("X"), TIMES
    when: Angle(dof: "index-mcp-flexion", on_deg: 60, off_deg: 50))]"#;
const FIST: &str = r#"triggers: [(name: "Fist", action: Key("X"), hold_ms: 50, cool_down_ms: 0, when: HandShape(name: "fist"))]"#;
const SWIPES: &str = r#"triggers: [
    (name: "Left", action: Key("L"), when: Swipe(direction: "left")),
    (name: "Right", action: Key("R"), when: Swipe(direction: "right")),
    (name: "Up", action: Key("U"), when: Swipe(direction: "up")),
]"#;
const SHAKE: &str = r#"triggers: [(name: "Shake", action: Key("S"), when: Shake())]"#;

const CIRCLES: &str = r#"triggers: [
    (name: "Right", action: Key("R"), when: Circle(direction: "clockwise")),
    (name: "Left", action: Key("L"), when: Circle(direction: "counter-clockwise")),
    (name: "Two", action: Key("T"), when: Circle(on: 1.8)),
]"#;
const STEPS: &str = r#"triggers: [
    (name: "Fist", hold_ms: 50, cool_down_ms: 0, when: HandShape(name: "fist")),
    (name: "Open", hold_ms: 50, cool_down_ms: 0, when: HandShape(name: "open-hand")),
    (name: "Twice", action: Key("T"), when: Sequence(steps: ["Fist", "Fist"])),
    (name: "Burst", action: Key("B"), when: Sequence(steps: ["Fist", "Open"])),
]"#;

fn claw(times: &str, script: &str) -> String {
    simulate_layout(BOARD, &CLAW.replace("TIMES", times), script)
}

fn bend(degrees: u32) -> String {
    format!("set index-mcp-flexion {degrees}")
}

/// Returns an order that bends all joints of fingers by this angle.
fn bend_all(fingers: &[Finger], degrees: u32) -> String {
    let joints = fingers.iter().flat_map(|it| Finger::FLEXIONS[it.index()]);
    let orders: Vec<String> = joints
        .map(|dof: Dof| format!("set {dof} {degrees}"))
        .collect();
    orders.join(" & ")
}

/// Returns a script that moves the palm from one place to another, in millimetres along X and Y, in a time in milliseconds.
fn palm(from: [i32; 2], to: [i32; 2], milliseconds: i32) -> String {
    let steps = milliseconds / 10;
    let at = |axis: usize, step: i32| from[axis] + (to[axis] - from[axis]) * step / steps;
    let places = (0..=steps).map(|step| format!("knuckle {} {} 0", at(0, step), at(1, step)));
    places.collect::<Vec<_>>().join("; ")
}

/// Returns a script that moves the palm around a circle, in millimetres, by an angle in degrees within a second; clockwise as the
/// wearer sees it for a positive one.
fn circle(radius: f64, degrees: f64) -> String {
    let places = (0..=100).map(|step| {
        let angle = (degrees * f64::from(step) / 100.0).to_radians();
        let (right, up) = (radius * angle.sin(), radius * angle.cos());
        format!("knuckle {right:.1} {up:.1} 0")
    });
    places.collect::<Vec<_>>().join("; ")
}

fn swipes(script: &str) -> String {
    keys(SWIPES, script)
}

fn keys(triggers: &str, script: &str) -> String {
    let events = simulate_layout(BOARD, triggers, script);
    let keys = events
        .split(' ')
        .filter(|event| !event.starts_with("value"));
    keys.collect::<Vec<_>>().join(" ")
}

#[test]
fn a_trigger_that_is_held_switches_on_after_its_time() {
    let hold = "hold_ms: 100,";
    let held = |milliseconds| {
        claw(
            hold,
            &format!("{}; {}; wait {milliseconds}", bend(0), bend(70)),
        )
    };
    assert_eq!(held(90), "");
    assert_eq!(held(100), "dn:X value:Claw=1.000");
    let twice = format!(
        "{}; {}; wait 80; {}; {}; wait 80",
        bend(0),
        bend(70),
        bend(40),
        bend(70)
    );
    assert_eq!(
        claw(hold, &twice),
        "",
        "the times of two bends do not add up"
    );
}

#[test]
fn a_trigger_near_its_threshold_is_held_and_switches_on_beyond_it() {
    let script = format!("{}; {}; {}; wait 200", bend(0), bend(61), bend(55));
    assert_eq!(claw("hold_ms: 100,", &script), "");
    let script = format!("{script}; {}", bend(61));
    assert_eq!(claw("hold_ms: 100,", &script), "dn:X value:Claw=1.000");
}

#[test]
fn a_trigger_does_not_switch_on_during_its_cool_down() {
    let once = "dn:X value:Claw=1.000 up:X value:Claw=0.000";
    let again = |pause: u32| {
        let (on, off) = (bend(70), bend(40));
        claw(
            "cool_down_ms: 300,",
            &format!("{off}; {on}; {off}; wait {pause}; {on}; wait 500"),
        )
    };
    assert_eq!(
        again(200),
        once,
        "it has to be seen off after the cool-down"
    );
    assert_eq!(again(300), format!("{once} dn:X value:Claw=1.000"));
    let lost = format!(
        "{0}; {1}; doubt index; trust index; {0}; wait 100; {1}",
        bend(40),
        bend(70)
    );
    assert_eq!(
        claw("cool_down_ms: 300,", &lost),
        once,
        "a lost finger has a cool-down, too"
    );
}

#[test]
fn a_fist_is_held_until_the_hand_opens() {
    let script = format!(
        "{}; wait 50; {}; wait 70; {}; wait 20",
        bend_all(Finger::ALL, 20),
        bend_all(Finger::ALL, 80),
        bend_all(&[Finger::Ring], 20),
    );
    assert_layout_events(
        BOARD,
        FIST,
        &script,
        "dn:X value:Fist=1.000 up:X value:Fist=0.000",
    );
}

#[test]
fn a_finger_that_is_not_measured_or_not_trusted_makes_no_fist() {
    let fingers = &Finger::ALL[1..];
    let script = format!(
        "{}; {}; wait 500",
        bend_all(fingers, 20),
        bend_all(fingers, 80)
    );
    // The thumb is unknown.
    assert_layout_events(BOARD, FIST, &script, "");
    let doubted = format!(
        "{}; wait 50; {}; wait 100; doubt little; trust little; wait 500",
        bend_all(Finger::ALL, 20),
        bend_all(Finger::ALL, 80),
    );
    assert_layout_events(
        BOARD,
        FIST,
        &doubted,
        "dn:X value:Fist=1.000 up:X value:Fist=0.000",
    );
}

#[test]
fn an_outlier_of_one_reading_does_not_end_a_shape() {
    let script = format!(
        "{}; wait 50; {}; wait 100; {}; {}; wait 100",
        bend_all(Finger::ALL, 20),
        bend_all(Finger::ALL, 80),
        bend_all(&[Finger::Ring], 10),
        bend_all(&[Finger::Ring], 80),
    );
    assert_layout_events(BOARD, FIST, &script, "dn:X value:Fist=1.000");
}

#[test]
fn an_open_hand_counts_after_a_closed_one_only() {
    let open = FIST.replace("fist", "open-hand");
    let [rest, fist, flat] = [30, 80, 5].map(|degrees| bend_all(Finger::ALL, degrees));
    let play = |script: &str| simulate_layout(BOARD, &open, script);
    assert_eq!(play(&format!("{rest}; wait 50; {flat}; wait 500")), "");
    assert_eq!(
        play(&format!(
            "{fist}; wait 300; {rest}; wait 1100; {flat}; wait 500"
        )),
        ""
    );
    assert_eq!(
        play(&format!(
            "{fist}; wait 300; {rest}; wait 500; {flat}; wait 500; {rest}; wait 50; {flat}; wait 500"
        )),
        "dn:X value:Fist=1.000 up:X value:Fist=0.000"
    );
}

#[test]
fn a_swipe_is_fast_and_the_way_back_is_none() {
    let rest = "knuckle 0 0 0; wait 500";
    let to_left = palm([0, 0], [-300, 0], 150);
    let back = palm([-300, 0], [0, 0], 150);
    let slow = palm([0, 0], [-300, 0], 400);
    assert_eq!(swipes(&format!("{rest}; {to_left}; wait 500")), "dn:L up:L");
    assert_eq!(swipes(&format!("{rest}; {slow}; wait 500")), "");
    assert_eq!(
        swipes(&format!("{rest}; {to_left}; wait 300; {back}; wait 900")),
        "dn:L up:L"
    );
    assert_eq!(
        swipes(&format!("{rest}; {to_left}; wait 1000; {back}; wait 500")),
        "dn:L up:L dn:R up:R"
    );
    let slanted = palm([0, 0], [-300, 300], 150);
    assert_eq!(swipes(&format!("{rest}; {slanted}; wait 500")), "");
}

#[test]
fn a_palm_that_jumps_does_not_swipe() {
    let jump = "knuckle 0 0 0; wait 500; reacquire & knuckle -300 0 0; wait 500";
    assert_eq!(swipes(jump), "");
}

#[test]
fn a_shake_goes_back_and_forth() {
    let shake = |times: usize| {
        let there = palm([0, 0], [0, 120], 100);
        let back = palm([0, 120], [0, 0], 100);
        let script = format!(
            "knuckle 0 0 0; {}; wait 1500",
            vec![format!("{there}; {back}"); times].join("; ")
        );
        simulate_layout(BOARD, SHAKE, &script)
    };
    assert_eq!(shake(1), "");
    assert_eq!(shake(4), "dn:S value:Shake=1.000 up:S value:Shake=0.000");
}

#[test]
fn a_circle_has_a_direction_and_ends_when_the_hand_stops() {
    let draw = |script: &str| {
        keys(
            CIRCLES,
            &format!("knuckle 0 80 0; wait 500; {script}; wait 500"),
        )
    };
    assert_eq!(draw(&circle(80.0, 360.0)), "dn:R up:R");
    assert_eq!(draw(&circle(80.0, -360.0)), "dn:L up:L");
    assert_eq!(draw(&circle(80.0, 270.0)), "");
    assert_eq!(draw(&circle(20.0, 360.0)), "");
    assert_eq!(draw(&circle(80.0, 720.0)), "dn:R dn:T up:R up:T");
}

#[test]
fn a_palm_that_jumps_draws_no_circle() {
    let [first, second] = [circle(80.0, 200.0), circle(80.0, 160.0)];
    let script = format!("knuckle 0 80 0; wait 500; {first}; reacquire & {second}; wait 500");
    assert_eq!(keys(CIRCLES, &script), "");
}

#[test]
fn steps_in_their_order_are_a_sequence() {
    let [rest, fist, flat] = [30, 80, 5].map(|degrees| bend_all(Finger::ALL, degrees));
    let play = |script: &str| keys(STEPS, &format!("{rest}; wait 50; {script}"));
    let opened = format!("{fist}; wait 200; {flat}; wait 200");
    assert_eq!(play(&opened), "dn:B");
    assert_eq!(play(&format!("{opened}; {rest}; wait 50")), "dn:B up:B");
    let twice = format!("{fist}; wait 200; {rest}; wait 200; {fist}; wait 200; {rest}; wait 50");
    assert_eq!(play(&twice), "dn:T up:T");
    let slow = format!("{fist}; wait 200; {rest}; wait 1200; {fist}; wait 200; {rest}; wait 50");
    assert_eq!(play(&slow), "");
    let lost = format!("{fist}; wait 200; doubt little; trust little; {flat}; wait 200");
    assert_eq!(play(&lost), "", "a finger of a step was lost");
    let held = format!("{opened}; doubt little; wait 50");
    assert_eq!(play(&held), "dn:B up:B");
}

#[test]
fn sequences_that_are_never_complete_are_rejected() {
    for (steps, expected) in [
        (r#"["A"]"#, "two or more steps"),
        ("[]", "two or more steps"),
        (r#"["A", "B", "A", "B", "A"]"#, "at most 4 steps"),
        (r#"["A", "Bb"]"#, "did you mean `B`?"),
        (
            r#"["A", "Later"]"#,
            "unknown trigger before the sequence `Later`",
        ),
        (r#"["A", "Both"]"#, "write the steps of `Both`"),
        (
            r#"["A", "Of the left hand"]"#,
            r#"set `hand: "left"` for the sequence"#,
        ),
    ] {
        let text = format!(
            r#"Layout(name: "t", triggers: [
                (name: "A", when: HandShape(name: "fist")),
                (name: "B", when: HandShape(name: "point")),
                (name: "Of the left hand", hand: "left", when: HandShape(name: "point")),
                (name: "Both", when: Sequence(steps: ["A", "B"])),
                (name: "T", when: Sequence(steps: {steps})),
                (name: "Later", when: HandShape(name: "point")),
            ])"#
        );
        let error = Layout::parse(&text, "t.ron").unwrap_err().to_string();
        assert!(error.contains(expected), "{error}");
    }
}

#[test]
fn thresholds_that_a_hand_at_rest_would_pass_are_rejected() {
    for (when, expected) in [
        (
            r#"HandShape(name: "fist", on: 0.3)"#,
            "turns on at 0.3 and off at 0.5, set on to more than off",
        ),
        (
            r#"Swipe(direction: "left", on_mm: 20)"#,
            "turns on at 20 and off at 50, set on_mm to more than off_mm",
        ),
        (
            "Circle(on: 0.2)",
            "turns on at 0.2 and off at 0.4, set on to more than off",
        ),
        (r#"HandShape(name: "fits")"#, "did you mean `fist`?"),
        (r#"HandShape(name: "fist", on: 1.5)"#, "1.5"),
    ] {
        let text = format!("Layout(name: \"t\", triggers: [(name: \"T\", when: {when})])");
        let error = Layout::parse(&text, "t.ron").unwrap_err().to_string();
        assert!(error.contains(expected), "{error}");
    }
}

#[test]
fn a_threshold_that_is_written_alone_does_not_reverse_a_trigger() {
    let parsed = |when: &str| {
        let text = format!("Layout(name: \"t\", triggers: [(name: \"T\", when: {when})])");
        let layout = Layout::parse(&text, "t.ron");
        layout.map(drop).map_err(|error| error.to_string())
    };
    for when in [
        r#"Pinch(finger: "index", on_mm: 35)"#,
        r#"Pinch(finger: "index", off_mm: 20)"#,
        r#"Input(name: "trigger", on: 0.3)"#,
        r#"Input(name: "stick-x", on: -0.5)"#,
        r#"Input(name: "head-yaw", on: -20)"#,
    ] {
        let error = parsed(when).unwrap_err();
        assert!(error.contains("a default in the wrong order"), "{error}");
    }
    for when in [
        r#"Pinch(finger: "index", on_mm: 20)"#,
        r#"Pinch(finger: "index", on_mm: 60, off_mm: 50)"#,
        r#"Input(name: "trigger", off: 0.2)"#,
        r#"Input(name: "stick-x", on: -0.5, off: -0.4)"#,
    ] {
        assert_eq!(parsed(when), Ok(()), "{when}");
    }
}
