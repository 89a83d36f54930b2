//! Errors in keys, chords, radio groups, touch surfaces and triggers, with their positions.

use ademan::layout::Layout;

use super::{check_refusals, refusal_of};

/// Returns `LINE:COLUMN: message` of the error in a layout with these fields on its board (from line 2) and
/// beside it (from the line after `],`).
fn refusal(board: &str, fields: &str) -> String {
    refusal_of(&format!(
        "Layout(name: \"t\", boards: [(pose: (anchor: world),\n{board}\n)],\n{fields}\n)"
    ))
}

#[test]
fn a_text_has_at_most_32_characters() {
    let long = "é".repeat(33);
    let key = format!("keys: [(action: Text(\"{long}\"), name: \"T\", at_mm: (0, 0))]");
    assert_eq!(
        refusal(&key, ""),
        "2:23: a key types at most 32 characters, not 33"
    );
    assert_eq!(
        refusal(
            "keys: [(action: Text(\"\"), name: \"T\", at_mm: (0, 0))]",
            ""
        ),
        "2:23: the text is empty"
    );
}

#[test]
fn a_dwell_key_has_no_other_activation() {
    check_refusals(
        &[
            (
                r#"code: "A", dwell_ms: 300, activate_on: Release"#,
                "2:16: the key `A` cannot have both `activate_on` and `dwell_ms`: only a resting fingertip activates it",
            ),
            (
                r#"code: "A", dwell_ms: 300, hold: (code: "B")"#,
                "2:16: the key `A` cannot have both `hold` and `dwell_ms`: only a resting fingertip activates it",
            ),
            (
                r#"code: "ShiftLeft", dwell_ms: 300"#,
                "2:16: `ShiftLeft` cannot activate by dwelling: it is active while it is pressed",
            ),
            (
                r#"code: "A", dwell_ms: 49"#,
                "2:30: 49 is out of range: a dwell time is 50 to 5000 ms",
            ),
            (
                r#"code: "A", dwell_ms: NaN"#,
                "2:30: NaN is out of range: a dwell time is 50 to 5000 ms",
            ),
        ],
        |key| refusal(&format!("keys: [({key}, at_mm: (0, 0))]"), ""),
    );
}

#[test]
fn chords_consist_of_known_keys_that_can_be_pressed_together() {
    let keys = r#"rows: [(at_mm: (0, 0), keys: "A B")], keys: [(code: "C", dwell_ms: 300, at_mm: (60, 0))]"#;
    check_refusals(
        &[
            (
                r#"(keys: "A Bee", action: Key("X"))"#,
                "4:20: this layout has no such key: unknown key `Bee`",
            ),
            (
                r#"(keys: "A", action: Key("X"))"#,
                "4:18: a chord has 2 to 10 keys, this one has 1",
            ),
            (
                r#"(keys: "A B A", action: Key("X"))"#,
                "4:22: duplicate key `A` in the chord",
            ),
            (
                r#"(keys: "A C", action: Key("X"))"#,
                "4:20: the key `C` activates by dwelling and cannot take part in chords",
            ),
            (
                r#"(keys: "A B", action: Key("X")), (keys: "B A", action: Key("Y"))"#,
                "4:51: duplicate chord",
            ),
            (
                r#"(keys: "A B", action: Key("Ex"))"#,
                "4:37: unknown key `Ex`, did you mean `E`?",
            ),
            (
                r#"(keys: "A B", action: Key("X"), latch: Lock)"#,
                "4:37: `X` cannot have a latch, only modifiers and layers can",
            ),
            (
                r#"(keys: "A B", action: NoOp)"#,
                "1:15: only a key that takes part in a chord can have the action `NoOp`",
            ),
        ],
        |chords| refusal(keys, &format!("chords: [{chords}]")),
    );
    assert_eq!(
        refusal(keys, "chord_timeout_ms: 5"),
        "4:19: 5 is out of range: a chord timeout is 10 to 500 ms"
    );
}

#[test]
fn a_key_without_an_action_must_be_in_a_chord() {
    let idle = r#"keys: [(name: "N", action: NoOp, at_mm: (0, 0))]"#;
    assert_eq!(
        refusal(idle, ""),
        "2:16: the key `N` has no action and takes part in no chord, remove it"
    );
    let slow = r#"keys: [(name: "N", action: NoOp, activate_on: Release, at_mm: (0, 0))]"#;
    assert_eq!(
        refusal(slow, ""),
        "2:16: the key `N` has no action of its own, remove `activate_on`, `hold` and `dwell_ms`"
    );
}

#[test]
fn at_most_64_keys_take_part_in_chords() {
    let keys: Vec<String> = (0..66)
        .map(|number| {
            format!(
                "(name: \"k{number}\", action: NoOp, at_mm: ({}, 0))",
                number * 20
            )
        })
        .collect();
    let board = format!("keys: [{}]", keys.join(", "));
    let chord = |number: i32| {
        format!(
            "(keys: \"k{} k{}\", action: Key(\"A\"))",
            number,
            number + 1
        )
    };
    let chords = |count: i32| {
        let chords: Vec<String> = (0..count).step_by(2).map(chord).collect();
        format!("chords: [{}]", chords.join(",\n"))
    };
    assert_eq!(
        refusal(&board, &chords(66)),
        "36:9: at most 64 keys of a layout can take part in chords"
    );
    let idle = refusal(&board, &chords(64));
    assert!(
        idle.ends_with("the key `k64` has no action and takes part in no chord, remove it"),
        "{idle}"
    );
}

#[test]
fn a_radio_group_has_at_least_two_distinct_options() {
    check_refusals(
        &[
            (
                r#"(name: "R", options: [(name: "A", at_mm: (0, 0))])"#,
                "2:18: the radio group `R` needs at least two options",
            ),
            (
                r#"(name: "R", options: [(name: "A", at_mm: (0, 0)), (name: "A", at_mm: (30, 0))])"#,
                "2:68: duplicate name `A`: there is a radio option with this name in line 2, set another `name`",
            ),
            (
                r#"(name: "R", initial: "Be", options: [(name: "A", at_mm: (0, 0)), (name: "Bee", at_mm: (30, 0))])"#,
                "2:32: unknown option `Be`, did you mean `Bee`?",
            ),
            (
                r#"(name: "R", initial: "A", options: [(name: "A", at_mm: (0, 0), hold: Key("X")), (name: "B", at_mm: (30, 0))])"#,
                "2:32: the radio option `A` has a `hold` and cannot be on at the start: only a finger can press",
            ),
            (
                r#"(name: "R", options: [(name: "A", at_mm: (0, 0), hold: Key("X"), tap: Key("X")), (name: "B", at_mm: (30, 0))])"#,
                "2:40: the radio option `A` has both `hold` and `tap`, remove one of them",
            ),
            (
                r#"(name: "R", options: [(name: "A", at_mm: (0, 0)), (name: "B", at_mm: (3, 0))])"#,
                "2:68: the radio option `B` overlaps the radio option `A` of line 2 by 14 mm",
            ),
        ],
        |radio| refusal(&format!("radios: [{radio}]"), ""),
    );
}

#[test]
fn a_touch_surface_is_a_box_with_a_known_mode() {
    check_refusals(
        &[
            (
                "size_mm: Disc(90), mode: Touchpad",
                "2:26: the touch surface `T` must be a Box",
            ),
            (
                "size_mm: Box(90, 90), mode: Touchscreen, natural_scrolling: true",
                "2:26: the touch surface `T` is a Touchscreen, remove `natural_scrolling`, which is for a Touchpad",
            ),
            (
                "size_mm: Box(90, 90), mode: Touchscren",
                "2:73: unknown value `Touchscren`, did you mean `Touchscreen`?",
            ),
            (
                "size_mm: Box(90, 90), mode: Touchpad, px_per_mm: 1e308",
                "2:94: 1e308 is out of range: a pointer speed is 0.1 to 100 px/mm",
            ),
            (
                "size_mm: Box(90, 90), mode: Touchpad, acceleration: -1",
                "2:97: -1 is out of range: an acceleration is 0 to 10",
            ),
            (
                "size_mm: Box(90, 90), mode: Touchpad, mm_per_detent: 0",
                "2:98: 0 is out of range: a scroll distance is 1 to 100 mm",
            ),
        ],
        |fields| {
            let surface = format!("(name: \"T\", at_mm: (0, 0), {fields})");
            refusal(&format!("touch_surfaces: [{surface}]"), "")
        },
    );
}

#[test]
fn a_trigger_has_a_known_measurement_and_distinct_thresholds() {
    let keys = r#"rows: [(at_mm: (0, 0), keys: "A B")]"#;
    check_refusals(
        &[
            (
                r#"(name: "T", when: Angle(dof: "index-flexion", on_deg: 60, off_deg: 50))"#,
                "4:42: unknown degree of freedom `index-flexion`, did you mean `index-mcp-flexion`?",
            ),
            (
                r#"(name: "T", when: Angle(dof: "wrist-flexion", on_deg: 60, off_deg: 60))"#,
                "4:20: the trigger `T` turns on and off at 60, set different values for on_deg and off_deg",
            ),
            (
                r#"(name: "T", when: Angle(dof: "wrist-flexion", on_deg: 60, off_deg: 50, zero_deg: 20))"#,
                "4:20: the trigger `T` has only one of zero_deg and full_deg, set both or none",
            ),
            (
                r#"(name: "T", when: Angle(dof: "wrist-flexion", on_deg: 60, off_deg: 50, zero_deg: 20, full_deg: 20))"#,
                "4:20: the value of the trigger `T` is 0 and 1 at 20, set different values for zero_deg and full_deg",
            ),
            (
                r#"(name: "T", when: Angle(dof: "wrist-flexion", on_deg: NaN, off_deg: 50))"#,
                "4:66: NaN is out of range: an angle is -180 to 180°",
            ),
            (
                r#"(name: "T", when: Pinch(finger: "thumb"))"#,
                "4:45: the thumb pinches with another finger, name that finger",
            ),
            (
                r#"(name: "T", when: Pinch(finger: "pinky"))"#,
                "4:45: unknown finger `pinky`, did you mean `little`?",
            ),
            (
                r#"(name: "T", when: Pinch(finger: "index", on_mm: 30))"#,
                "4:20: the trigger `T` turns on and off at 30, set different values for on_mm and off_mm",
            ),
            (
                r#"(name: "T", hand: "lefd", when: Pinch(finger: "index"))"#,
                "4:31: unknown side `lefd`, did you mean `left`?",
            ),
            (
                r#"(name: "A", when: Pinch(finger: "index"))"#,
                "4:20: duplicate name `A`: there is a key with this name in line 2, set another `name`",
            ),
            (
                r#"(name: "T", when: Pinch(finger: "index"), output: Axis("LeftZ"))"#,
                "4:68: unknown axis `LeftZ`, did you mean `LeftX`?",
            ),
        ],
        |trigger| refusal(keys, &format!("triggers: [{trigger}]")),
    );
}

#[test]
fn a_layout_has_at_most_64_triggers() {
    let keys = r#"rows: [(at_mm: (0, 0), keys: "A B")]"#;
    let triggers = |count: i32| {
        let trigger = |number| format!("(name: \"t{number}\", when: Pinch(finger: \"index\"))");
        let triggers: Vec<String> = (0..count).map(trigger).collect();
        format!("triggers: [\n{}\n]", triggers.join(",\n"))
    };
    assert_eq!(
        refusal(keys, &triggers(65)),
        "69:9: a layout has at most 64 triggers"
    );
    let text = format!(
        "Layout(name: \"t\", boards: [(pose: (anchor: world), {keys})], {})",
        triggers(64)
    );
    let layout = Layout::parse(&text, "t.ron").expect("64 triggers");
    assert_eq!(layout.triggers.len(), 64);
    let names = layout.target_names();
    let last = layout.triggers[63].1.target;
    assert_eq!(names.get(last).to_string(), "t63");
    assert_eq!(last.0 as usize, layout.scene.len() + 63);
}
