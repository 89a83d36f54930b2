//! Errors in keys, chords, radio groups, touch surfaces and triggers, with their positions.

use ademan::layout::Layout;

/// Returns `LINE:COLUMN: message` of the error in a layout with these fields on its board (from line 2) and
/// beside it (from the line after `],`).
fn refusal(board: &str, fields: &str) -> String {
    let text =
        format!("Layout(name: \"t\", boards: [(place: (anchor: world),\n{board}\n)],\n{fields}\n)");
    let error = Layout::parse(&text, "t.ron").expect_err(&text).to_string();
    let line = error.lines().next().expect("a line").to_owned();
    line.strip_prefix("t.ron:").expect("the file").to_owned()
}

fn check(cases: &[(&str, &str)], refusal: impl Fn(&str) -> String) {
    for (fields, expected) in cases {
        assert_eq!(refusal(fields), *expected, "{fields}");
    }
}

#[test]
fn a_text_has_at_most_32_characters() {
    let long = "é".repeat(33);
    let key = format!("keys: [(does: Write(\"{long}\"), name: \"T\", at_mm: (0, 0))]");
    assert_eq!(
        refusal(&key, ""),
        "2:22: a key writes at most 32 characters, not 33"
    );
    assert_eq!(
        refusal(
            "keys: [(does: Write(\"\"), name: \"T\", at_mm: (0, 0))]",
            ""
        ),
        "2:22: the text is empty"
    );
}

#[test]
fn a_dwell_key_has_no_other_activation() {
    check(
        &[
            (
                r#"code: "A", dwell_ms: 300, fires: Release"#,
                "2:16: the key `A` cannot have both `fires` and `dwell_ms`: it fires when a fingertip rests on it and at nothing else",
            ),
            (
                r#"code: "A", dwell_ms: 300, hold: (code: "B")"#,
                "2:16: the key `A` cannot have both `hold` and `dwell_ms`: it fires when a fingertip rests on it and at nothing else",
            ),
            (
                r#"code: "ShiftLeft", dwell_ms: 300"#,
                "2:16: `ShiftLeft` cannot fire by dwelling: it is in force as long as it is pressed only",
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
    check(
        &[
            (
                r#"(keys: "A Bee", does: Key("X"))"#,
                "4:20: this layout has no such key: unknown key `Bee`",
            ),
            (
                r#"(keys: "A", does: Key("X"))"#,
                "4:18: a chord has 2 to 10 keys, this one has 1",
            ),
            (
                r#"(keys: "A B A", does: Key("X"))"#,
                "4:22: the key `A` is in the chord for the second time",
            ),
            (
                r#"(keys: "A C", does: Key("X"))"#,
                "4:20: the key `C` fires by dwelling, so it cannot take part in chords",
            ),
            (
                r#"(keys: "A B", does: Key("X")), (keys: "B A", does: Key("Y"))"#,
                "4:49: these keys are a chord already",
            ),
            (
                r#"(keys: "A B", does: Key("Ex"))"#,
                "4:35: unknown key `Ex`, did you mean `X`?",
            ),
            (
                r#"(keys: "A B", does: Key("X"), latch: Lock)"#,
                "4:35: `X` cannot have a latch, only modifiers and layers can",
            ),
            (
                r#"(keys: "A B", does: Nothing)"#,
                "1:15: only keys that take part in chords can do nothing on their own",
            ),
        ],
        |chords| refusal(keys, &format!("chords: [{chords}]")),
    );
    assert_eq!(
        refusal(keys, "chord_ms: 5"),
        "4:11: 5 is out of range: a chord time is 10 to 500 ms"
    );
}

#[test]
fn a_key_without_an_action_must_be_in_a_chord() {
    let idle = r#"keys: [(name: "N", does: Nothing, at_mm: (0, 0))]"#;
    assert_eq!(
        refusal(idle, ""),
        "2:16: the key `N` does nothing and takes part in no chord, leave it out"
    );
    let slow = r#"keys: [(name: "N", does: Nothing, fires: Release, at_mm: (0, 0))]"#;
    assert_eq!(
        refusal(slow, ""),
        "2:16: the key `N` does nothing on its own, so it has no way to fire"
    );
}

#[test]
fn at_most_64_keys_take_part_in_chords() {
    let keys: Vec<String> = (0..66)
        .map(|number| {
            format!(
                "(name: \"k{number}\", does: Nothing, at_mm: ({}, 0))",
                number * 20
            )
        })
        .collect();
    let board = format!("keys: [{}]", keys.join(", "));
    let chord = |number: i32| format!("(keys: \"k{} k{}\", does: Key(\"A\"))", number, number + 1);
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
        idle.ends_with("the key `k64` does nothing and takes part in no chord, leave it out"),
        "{idle}"
    );
}

#[test]
fn a_radio_group_has_at_least_two_distinct_options() {
    check(
        &[
            (
                r#"(name: "R", options: [(name: "A", at_mm: (0, 0))])"#,
                "2:18: the radio group `R` needs at least two options to switch between",
            ),
            (
                r#"(name: "R", options: [(name: "A", at_mm: (0, 0)), (name: "A", at_mm: (30, 0))])"#,
                "2:68: there is a radio option `A` already in line 2, give this one a `name` of its own",
            ),
            (
                r#"(name: "R", starts: "Be", options: [(name: "A", at_mm: (0, 0)), (name: "Bee", at_mm: (30, 0))])"#,
                "2:31: unknown option `Be`, did you mean `Bee`?",
            ),
            (
                r#"(name: "R", starts: "A", options: [(name: "A", at_mm: (0, 0), holds: Key("X")), (name: "B", at_mm: (30, 0))])"#,
                "2:31: the radio option `A` cannot be on at the start: what it holds is pressed by a finger only",
            ),
            (
                r#"(name: "R", options: [(name: "A", at_mm: (0, 0), holds: Key("X"), taps: Key("X")), (name: "B", at_mm: (30, 0))])"#,
                "2:40: the radio option `A` has both `holds` and `taps`, leave one of them out",
            ),
            (
                r#"(name: "R", options: [(name: "A", at_mm: (0, 0)), (name: "B", at_mm: (3, 0))])"#,
                "2:68: the radio option `B` overlaps the radio option `A` of line 2",
            ),
        ],
        |radio| refusal(&format!("radios: [{radio}]"), ""),
    );
}

#[test]
fn a_touch_surface_is_a_box_with_a_known_mode() {
    check(
        &[
            (
                "size_mm: Disc(90), mode: Pad",
                "2:26: the touch surface `T` must be a Box",
            ),
            (
                "size_mm: Box(90, 90), mode: Screen, natural: true",
                "2:26: the touch surface `T` is a Screen, `natural` is for a Pad, leave it out",
            ),
            (
                "size_mm: Box(90, 90), mode: Scren",
                "2:73: unknown value `Scren`, did you mean `Screen`?",
            ),
            (
                "size_mm: Box(90, 90), mode: Pad, px_per_mm: 1e308",
                "2:89: 1e308 is out of range: a speed is 0.1 to 100 px/mm",
            ),
            (
                "size_mm: Box(90, 90), mode: Pad, acceleration: -1",
                "2:92: -1 is out of range: an acceleration is 0 to 10",
            ),
            (
                "size_mm: Box(90, 90), mode: Pad, scroll_mm: 0",
                "2:89: 0 is out of range: a way for a click is 1 to 100 mm",
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
    check(
        &[
            (
                r#"(name: "T", when: Angle(of: "index-flexion", on_deg: 60, off_deg: 50))"#,
                "4:41: unknown degree of freedom `index-flexion`, did you mean `index-dip-flexion`?",
            ),
            (
                r#"(name: "T", when: Angle(of: "wrist-flexion", on_deg: 60, off_deg: 60))"#,
                "4:20: the trigger `T` goes on and off at 60, set on_deg and off_deg apart",
            ),
            (
                r#"(name: "T", when: Angle(of: "wrist-flexion", on_deg: 60, off_deg: 50, from_deg: 20))"#,
                "4:20: the trigger `T` has one of from_deg and full_deg, give it both or none",
            ),
            (
                r#"(name: "T", when: Angle(of: "wrist-flexion", on_deg: 60, off_deg: 50, from_deg: 20, full_deg: 20))"#,
                "4:20: the value of the trigger `T` is 0 and 1 at 20, set from_deg and full_deg apart",
            ),
            (
                r#"(name: "T", when: Angle(of: "wrist-flexion", on_deg: NaN, off_deg: 50))"#,
                "4:65: NaN is out of range: an angle is -180 to 180°",
            ),
            (
                r#"(name: "T", when: Pinch(of: "thumb"))"#,
                "4:41: the thumb pinches with another finger, name that one",
            ),
            (
                r#"(name: "T", when: Pinch(of: "pinky"))"#,
                "4:41: unknown finger `pinky`, did you mean `ring`?",
            ),
            (
                r#"(name: "T", when: Pinch(of: "index", on_mm: 30))"#,
                "4:20: the trigger `T` goes on and off at 30, set on_mm and off_mm apart",
            ),
            (
                r#"(name: "T", hand: "lefd", when: Pinch(of: "index"))"#,
                "4:31: unknown side `lefd`, did you mean `left`?",
            ),
            (
                r#"(name: "A", when: Pinch(of: "index"))"#,
                "4:20: there is a key `A` already in line 2, give this one a `name` of its own",
            ),
            (
                r#"(name: "T", when: Pinch(of: "index"), drives: Axis("LeftZ"))"#,
                "4:64: unknown axis `LeftZ`, did you mean `LeftY`?",
            ),
        ],
        |trigger| refusal(keys, &format!("triggers: [{trigger}]")),
    );
}

#[test]
fn a_layout_has_at_most_64_triggers() {
    let keys = r#"rows: [(at_mm: (0, 0), keys: "A B")]"#;
    let triggers = |count: i32| {
        let trigger = |number| format!("(name: \"t{number}\", when: Pinch(of: \"index\"))");
        let triggers: Vec<String> = (0..count).map(trigger).collect();
        format!("triggers: [\n{}\n]", triggers.join(",\n"))
    };
    assert_eq!(
        refusal(keys, &triggers(65)),
        "69:9: a layout has at most 64 triggers"
    );
    let text = format!(
        "Layout(name: \"t\", boards: [(place: (anchor: world), {keys})], {})",
        triggers(64)
    );
    let layout = Layout::parse(&text, "t.ron").expect("64 triggers");
    assert_eq!(layout.triggers.len(), 64);
    let names = layout.target_names();
    let last = layout.triggers[63].1.target;
    assert_eq!(names.get(last).to_string(), "t63");
    assert_eq!(last.0 as usize, layout.scene.len() + 63);
}
