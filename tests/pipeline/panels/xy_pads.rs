//! XY pads: a handle under the fingertip, with two values.

use super::{assert_events, simulate, simulate_layout};
use ademan::device::{Axis, Capability};
use ademan::layout::Layout;

const PAD: &str = r#"xy_pads: [(name: "P", at_mm: (0, 0), size_mm: Box(100, 80))]"#;
const SPRING: &str = r#"xy_pads: [(name: "P", at_mm: (0, 0), size_mm: Box(100, 80), springs_back: true,
    x: (output: Axis("RightX")), y: (initial: 0, output: Axis("Throttle")))]"#;

/// Returns the events of a fingertip that presses the middle and moves through these positions.
fn moved(controls: &str, positions: &[&str], end: &str) -> String {
    let mut script = "index P up; index P down".to_owned();
    for position in positions {
        script += &format!("; index P {position} down");
    }
    simulate(controls, &(script + "; " + end))
}

#[test]
fn the_handle_jumps_to_the_finger_and_follows_it() {
    let script =
        "index P 25 20 up; index P 25 20 down; wait 100; index P -50 -40 down; index P -50 0 down";
    assert_events(
        PAD,
        script,
        "value:P_x=0.750 value:P_y=0.750 value:P_x=0.000 value:P_y=0.000 value:P_y=0.500",
    );
}

#[test]
fn a_touch_without_a_press_does_not_move_the_handle() {
    assert_events(PAD, "index P up; index P 1; index P 20 20 1", "");
}

#[test]
fn a_lifted_finger_leaves_the_handle_until_the_next_press() {
    let script = "index P 25 0 up; index P 25 0 down; index P 30 30 up; index P -25 20 up; wait 300; index P -25 20 down";
    assert_events(
        PAD,
        script,
        "value:P_x=0.750 value:P_x=0.250 value:P_y=0.750",
    );
}

#[test]
fn a_finger_beyond_a_corner_sends_both_ends() {
    for (x, y) in [(1, 1), (1, -1), (-1, 1), (-1, -1)] {
        let (at, end) = (format!("{} {}", 70 * x, 60 * y), |sign| {
            if sign > 0 { "1.000" } else { "0.000" }
        });
        assert_eq!(
            moved(PAD, &[&at], "wait 0"),
            format!("value:P_x={} value:P_y={}", end(x), end(y)),
            "{at}"
        );
    }
    assert_eq!(
        moved(PAD, &["70 20"], "index P 0 0 down"),
        "value:P_x=1.000 value:P_y=0.750 value:P_x=0.500 value:P_y=0.500",
        "beyond one edge the other value follows"
    );
}

#[test]
fn a_finger_far_beyond_an_edge_loses_its_grip() {
    assert_eq!(moved(PAD, &["0 75"], "index P 20 20 down"), "");
}

#[test]
fn a_second_finger_is_ignored() {
    let script = "index P up & middle P 20 20 up; index P down; middle P 20 20 down; index P 10 0 down; \
                  index P 10 0 up; middle P 30 30 down; middle P 30 30 up; middle P 20 20 up; middle P 20 20 down";
    assert_events(
        PAD,
        script,
        "value:P_x=0.600 value:P_x=0.700 value:P_y=0.750",
    );
}

#[test]
fn a_spring_returns_both_values_and_their_axes() {
    let pulled = "value:P_y=0.500 axis:Throttle=+0.500 value:P_x=0.750 axis:RightX=+0.500 value:P_y=1.000 axis:Throttle=+1.000";
    let back = "axis:RightX=+0.000 value:P_x=0.500 axis:Throttle=+0.000 value:P_y=0.000";
    for end in [
        "index P 25 40 up",
        "hide index; wait 500",
        "reacquire",
        "reset",
        "release",
        "release-devices; index P 0 0 up",
        "index P 0 90 down; index P 0 90 up",
    ] {
        assert_eq!(
            moved(SPRING, &["25 40"], end),
            format!("{pulled} {back}"),
            "{end}"
        );
    }
}

#[test]
fn everything_that_ends_a_grip_leaves_a_handle_without_a_spring() {
    for end in [
        "index P 25 40 up",
        "hide index; wait 500",
        "reacquire",
        "reset",
        "release",
        "release-devices; index P 0 0 up",
    ] {
        assert_eq!(
            moved(PAD, &["25 40"], end),
            "value:P_x=0.750 value:P_y=1.000",
            "{end}"
        );
    }
}

#[test]
fn axes_return_to_0_with_everything_and_are_restored_by_the_next_press() {
    let pad = r#"xy_pads: [(name: "P", at_mm: (0, 0), size_mm: Box(100, 80),
        x: (output: Axis("RightX")), y: (output: Axis("RightY")))]"#;
    let script =
        "index P 25 20 up; index P 25 20 down; release; index P 25 20 up; index P 25 20 down";
    let held = "axis:RightX=+0.500 axis:RightY=+0.500";
    assert_events(
        pad,
        script,
        &format!(
            "value:P_x=0.750 axis:RightX=+0.500 value:P_y=0.750 axis:RightY=+0.500 axis:RightX=+0.000 axis:RightY=+0.000 {held}"
        ),
    );
}

#[test]
fn each_value_has_an_output_of_its_own() {
    let pad = r#"xy_pads: [(name: "P", at_mm: (0, 0), size_mm: Box(100, 80),
        x: (output: ScrollX(10)), y: (output: Taps(increase: Key("A"), decrease: Key("B"), steps: 4)))]"#;
    assert_eq!(
        moved(pad, &["50 40", "50 0"], "wait 0"),
        "value:P_x=1.000 scroll=+600,+0 value:P_y=1.000 dn:A up:A dn:A up:A value:P_y=0.500 dn:B up:B dn:B up:B"
    );
    let layout = layout_of(pad);
    let required = layout.required_capabilities();
    assert!(required.contains(Capability::Scroll));
    assert!(required.contains(Capability::Key("B".parse().unwrap())));
    let of_axes = layout_of(SPRING).required_capabilities();
    for axis in [Axis::RightX, Axis::Throttle] {
        assert!(of_axes.contains(Capability::Axis(axis)), "{axis}");
    }
}

#[test]
fn steps_are_those_of_each_value_and_ignore_tremor() {
    let pad = r#"xy_pads: [(name: "P", at_mm: (0, 0), size_mm: Box(100, 80), x: (steps: 4), y: (steps: 2))]"#;
    assert_eq!(
        moved(
            pad,
            &["12 15", "13 15", "16 15", "12 15", "11 25"],
            "wait 0"
        ),
        "value:P_x=0.750 value:P_y=1.000"
    );
}

#[test]
fn values_are_named_after_their_pad_for_signals() {
    let with = |fields: &str| simulate_layout(PAD, fields, "index P 25 0 up; index P 25 0 down");
    let signals = r#"signals: {"P x": (control: 74), "P y": (osc: "/y", range: (-1, 1))}"#;
    assert_eq!(with(signals), "value:P_x=0.750");
    let layout = parse(PAD, signals).unwrap();
    let targets: Vec<u32> = layout.signals.iter().map(|(target, _)| target.0).collect();
    assert_eq!(targets, [1, 2]);
    let names: Vec<_> = layout.target_names().iter().map(str::to_owned).collect();
    assert_eq!(names, ["P", "P x", "P y"]);
}

#[test]
fn an_error_of_a_pad_has_its_position() {
    let cases = [
        (
            PAD,
            r#"signals: {"P": (control: 74)}"#,
            "3:12: the XY pad `P` has several values, set a signal for `P x` or `P y`",
        ),
        (
            PAD,
            r#"signals: {"P x": (note: 60)}"#,
            "3:12: a value plays no note, set a `control` for `P x`",
        ),
        (
            r#"keys: [(code: "A", name: "P y", at_mm: (0, 90))], xy_pads: [(name: "P", at_mm: (0, 0), size_mm: Box(100, 80))]"#,
            "",
            "2:69: its value `P y` has the name of a key in line 2, set another `name`",
        ),
        (
            r#"xy_pads: [(name: "P", at_mm: (0, 0), size_mm: Disc(40))]"#,
            "",
            "2:19: the XY pad `P` must be a Box",
        ),
        (
            r#"xy_pads: [(name: "P", at_mm: (0, 0), size_mm: Box(80, 80), x: (output: Axis("LeftX")), y: (output: Axis("LeftX")))]"#,
            "",
            "sets the axis `LeftX` too, name another axis",
        ),
        (
            r#"xy_pads: [(name: "P", at_mm: (0, 0), size_mm: Box(80, 80), springs_back: true, y: (initial: 0.2, output: Axis("LeftX")))]"#,
            "",
            "2:19: the XY pad `P` springs back to 0.2, where the axis `LeftX` is not at 0, set `initial: 0.5`",
        ),
    ];
    for (controls, fields, expected) in cases {
        let error = parse(controls, fields).expect_err(controls);
        let (line, column) = (error.line().unwrap(), error.column().unwrap());
        let message = format!("{line}:{column}: {}", error.message());
        assert!(message.contains(expected), "{message}");
    }
}

fn layout_of(controls: &str) -> Layout {
    parse(controls, "").unwrap()
}

fn parse(controls: &str, fields: &str) -> Result<Layout, ademan::document::DocumentError> {
    let text =
        format!("Layout(name: \"t\", boards: [(pose: (anchor: world),\n{controls})],\n{fields})");
    Layout::parse(&text, "t.ron")
}
