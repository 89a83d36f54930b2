//! Errors in sliders, knobs, levers, valves and joysticks, with their positions.

use ademan::layout::{KeySize, Layout};

/// Returns `LINE:COLUMN: message` of the error in a board with these fields in line 2.
fn refusal(fields: &str) -> String {
    let text = format!("Layout(name: \"t\", boards: [(pose: (anchor: world),\n{fields})])");
    let error = Layout::parse(&text, "t.ron").expect_err(fields);
    let (line, column) = (error.line().unwrap(), error.column().unwrap());
    format!("{line}:{column}: {}", error.message())
}

/// Checks that each list of controls is refused on the second line, with this part of the message.
fn check(cases: &[(String, &str)]) {
    for (fields, expected) in cases {
        let message = refusal(fields);
        assert!(
            message.starts_with("2:") && message.contains(expected),
            "{fields}\n{message}"
        );
    }
}

#[test]
fn an_error_of_a_slider_has_its_position() {
    let slider =
        |fields: &str| format!("sliders: [(name: \"S\", at_mm: (0, 0), length_mm: 50, {fields})]");
    check(&[
        (
            slider("steps: 0"),
            "out of range: a number of steps is 1 to 1000",
        ),
        (slider("steps: 2.5"), "2.5 is not a whole number"),
        (
            slider("output: Taps(increase: Key(\"A\"), decrease: Key(\"B\"), steps: 3.5)"),
            "3.5 is not a whole number",
        ),
        (slider("initial: 1.5"), "out of range: a fraction is 0 to 1"),
        (slider("initial: NaN"), "out of range: a fraction is 0 to 1"),
        (
            slider("rotation_deg: 181"),
            "out of range: a rotation is -180 to 180°",
        ),
        (
            slider("grab: Absolut"),
            "unknown value `Absolut`, did you mean `Absolute`?",
        ),
        (
            slider("output: Axis(\"LeftZ\")"),
            "unknown axis `LeftZ`, did you mean `LeftX`?",
        ),
        (
            slider("output: ScrolY(1)"),
            "unknown value `ScrolY`, did you mean `ScrollY`?",
        ),
        (
            slider("output: Taps(increase: Key(\"A\"), steps: 3)"),
            "`decrease`",
        ),
        (
            slider("output: Taps(increase: Key(\"A\"), decrease: Key(\"Bee\"), steps: 3)"),
            "unknown key `Bee`",
        ),
        (
            slider("width_mm: 1e308"),
            "out of range: a size is 1 to 500 mm",
        ),
    ]);
}

#[test]
fn an_error_of_a_knob_has_its_position() {
    let knob =
        |fields: &str| format!("knobs: [(name: \"K\", at_mm: (0, 0), diameter_mm: 40, {fields})]");
    check(&[
        (
            knob("range_deg: 0"),
            "out of range: the range of a knob is 10 to 360°",
        ),
        (
            knob("endless: true, range_deg: 90"),
            "the knob `K` is endless and cannot have a `range_deg`",
        ),
        (
            knob("endless: true, initial: 0.5"),
            "the knob `K` is endless and cannot have an `initial` value: it counts turns from 0",
        ),
        (
            knob("endless: true, springs_back: true"),
            "the knob `K` is endless and cannot spring back",
        ),
        (
            knob("springs_back: true, initial: 0.4, steps: 4"),
            "the knob `K` springs back to 0.4, which is at none of its 4 steps",
        ),
        (
            knob("endless: true, output: Axis(\"LeftX\")"),
            "the knob `K` is endless and cannot output an axis, which has ends",
        ),
    ]);
}

#[test]
fn an_error_of_a_lever_or_valve_has_its_position() {
    let lever =
        |fields: &str| format!("levers: [(name: \"L\", at_mm: (0, 0), length_mm: 50, {fields})]");
    let valve =
        |fields: &str| format!("valves: [(name: \"V\", at_mm: (0, 0), diameter_mm: 40, {fields})]");
    check(&[
        (
            lever("throw_deg: 180"),
            "out of range: a throw is 5 to 170°",
        ),
        (
            lever("springs_back: true, rest: 0, output: Axis(\"MoveX\")"),
            "the lever `L` springs back to 0, where the axis `MoveX` is not at 0, set `rest: 0.5`",
        ),
        (
            lever("springs_back: true, output: Axis(\"LeftTrigger\")"),
            "the lever `L` springs back to 0.5, where the axis `LeftTrigger` is not at 0, set `rest: 0`",
        ),
        (
            lever("springs_back: true, detents: 3"),
            "the lever `L` springs back to 0.5, which is at none of its 3 detents",
        ),
        (
            valve("turns: -1"),
            "out of range: a number of turns is 0.25 to 50",
        ),
        (
            valve("twist_gain: 0"),
            "out of range: a twist gain is 0.1 to 20",
        ),
        (
            valve("springs_back: true, output: Axis(\"Wheel\")"),
            "the valve `V` springs back to 0, where the axis `Wheel` is not at 0, set `initial: 0.5`",
        ),
        (
            valve("springs_back: true, initial: 0.5, output: Axis(\"Throttle\")"),
            "the valve `V` springs back to 0.5, where the axis `Throttle` is not at 0, set `initial: 0`",
        ),
    ]);
}

#[test]
fn an_error_of_a_joystick_has_its_position() {
    let stick = |fields: &str| {
        format!("joysticks: [(name: \"J\", at_mm: (0, 0), diameter_mm: 40, {fields})]")
    };
    check(&[
        (
            stick(""),
            "the joystick `J` has no output, add `axes`, `direction_keys`, `push_action` or `pointer_px_per_s`",
        ),
        (
            stick("axes: (\"LeftX\", \"LeftX\")"),
            "the joystick `J` has the same axis in both directions, name two axes",
        ),
        (
            stick("axes: (\"LeftX\", \"RightTrigger\")"),
            "the joystick `J` has values on both sides of 0, a trigger does not",
        ),
        (stick("exponent: 5"), "out of range: an exponent is 1 to 4"),
        (
            stick("dead_zone: 1"),
            "out of range: a dead zone is 0 to 0.9",
        ),
        (
            stick("pointer_px_per_s: inf"),
            "out of range: a cursor speed",
        ),
        (
            stick("push_action: Key(\"A\")"),
            "the joystick `J` has a `push_action` and needs a `travel_mm` of at least 10, not 4: otherwise every touch is a push",
        ),
        (stick("direction_keys: (up: Key(\"W\"))"), "`down`"),
    ]);
}

#[test]
fn controls_that_overlap_or_share_a_name_are_refused() {
    assert_eq!(
        refusal(
            "sliders: [(name: \"S\", at_mm: (0, 0), length_mm: 50)],\nknobs: [(name: \"K\", at_mm: (30, 0), diameter_mm: 40)]"
        ),
        "3:17: the knob `K` overlaps the slider `S` of line 2 by 15 mm"
    );
    assert_eq!(
        refusal(
            "levers: [(name: \"S\", at_mm: (0, 0), length_mm: 50)],\nvalves: [(name: \"S\", at_mm: (90, 0), diameter_mm: 40)]"
        ),
        "3:18: duplicate name `S`: there is a lever with this name in line 2, set another `name`"
    );
}

#[test]
fn an_axis_is_set_by_one_control() {
    assert_eq!(
        refusal(
            "sliders: [(name: \"S\", at_mm: (0, 0), length_mm: 50, output: Axis(\"LeftX\"))],\njoysticks: [(name: \"J\", at_mm: (90, 0), diameter_mm: 40, axes: (\"LeftX\", \"LeftY\"))]"
        ),
        "3:66: the control in line 2 sets the axis `LeftX` too, name another axis"
    );
}

#[test]
fn the_overlap_of_a_slider_depends_on_its_rotation() {
    let board = |turn: u32| {
        format!(
            "Layout(name: \"t\", boards: [(pose: (anchor: world), keys: [(code: \"A\", at_mm: (25, 0))],
             sliders: [(name: \"S\", at_mm: (0, 0), length_mm: 80, rotation_deg: {turn})])])"
        )
    };
    let error = Layout::parse(&board(0), "t.ron").expect_err("an overlap");
    assert_eq!(
        error.message(),
        "the slider `S` overlaps the key `A` of line 1 by 17 mm"
    );
    let layout = Layout::parse(&board(90), "t.ron").unwrap();
    let widths: Vec<usize> = layout.grids(KeySize::Labelled)[0]
        .cells
        .iter()
        .map(|cell| cell.width)
        .collect();
    assert_eq!(widths[0], widths[1], "and is drawn upright");
}
