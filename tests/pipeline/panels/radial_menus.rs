//! Radial menus, which open around the fingertip that presses their hub.

use super::{assert_events, simulate};
use ademan::layout::Layout;

/// A menu with a radius of 30 mm, a dead zone of 12 mm, and four sectors: C away from the wearer, Control and V to the right, Control,
/// Shift and Z towards the wearer, and to the left a nested menu with X away and Y towards.
const MENU: &str = r#"radial_menus: [(name: "M", at_mm: (0, 0), diameter_mm: 60, sectors: [
    (name: "Copy", tap: Key("C")),
    (name: "Paste", tap: Key("V"), with: "Control"),
    (name: "Redo", tap: Key("Z"), with: "Control Shift"),
    (name: "More", menu: [(name: "Cut", tap: Key("X")), (name: "Why", tap: Key("Y"))]),
])]"#;

/// Returns the events of a fingertip that presses the hub in the middle and moves through these positions.
fn moved(positions: &[&str], end: &str) -> String {
    simulate(MENU, &script(positions, end))
}

fn script(positions: &[&str], end: &str) -> String {
    let mut script = "index M 0 0 up; index M 0 0 down".to_owned();
    for position in positions {
        script += &format!("; index M {position} down");
    }
    script + "; " + end
}

/// Returns the end of a script that lifts the fingertip at a position.
fn lift(position: &str) -> String {
    format!("index M {position} up")
}

#[test]
fn a_release_over_a_sector_taps_its_action() {
    for (position, expected) in [
        ("0 20", "value:M=0.143 dn:C up:C value:M=0.000"),
        (
            "20 0",
            "value:M=0.286 dn:ControlLeft dn:V up:V up:ControlLeft value:M=0.000",
        ),
        (
            "0 -20",
            "value:M=0.429 dn:ControlLeft dn:ShiftLeft dn:Z up:Z up:ShiftLeft up:ControlLeft value:M=0.000",
        ),
        ("-20 0", "value:M=0.571 value:M=0.000"),
        ("0 10", ""),
    ] {
        assert_eq!(moved(&[position], &lift(position)), expected, "{position}");
    }
}

#[test]
fn the_way_back_to_the_press_cancels() {
    assert_eq!(
        moved(&["0 20", "0 5"], &lift("0 5")),
        "value:M=0.143 value:M=0.000"
    );
    assert_eq!(moved(&[], &lift("0 0")), "", "a mere tap");
}

#[test]
fn the_menu_is_around_the_fingertip() {
    let script = "index M 11 0 up; index M 11 0 down; index M 19 10 down; index M 19 10 up";
    // Away from the press, and to the right of the middle.
    assert_events(MENU, script, "value:M=0.143 dn:C up:C value:M=0.000");
    let dragged = "index M 11 0 up; index M 11 0 down; index M -4 0 down; index M -4 0 up";
    // Beyond the dead zone around the press.
    assert_events(MENU, dragged, "value:M=0.571 value:M=0.000");
}

#[test]
fn a_press_beside_the_hub_opens_nothing() {
    let script = "index M 0 20 up; index M 0 20 down; index M 0 -20 down; index M 0 -20 up";
    assert_events(MENU, script, "");
}

#[test]
fn a_nested_menu_opens_at_the_radius_around_the_fingertip() {
    assert_eq!(
        moved(&["-20 0", "-31 0", "-31 18"], &lift("-31 18")),
        "value:M=0.571 value:M=0.714 value:M=0.857 dn:X up:X value:M=0.000"
    );
    assert_eq!(
        moved(&["-31 0", "-31 -18"], &lift("-31 -18")),
        "value:M=0.714 value:M=1.000 dn:Y up:Y value:M=0.000",
        "in one step"
    );
    assert_eq!(
        moved(&["-31 0", "-36 0"], &lift("-36 0")),
        "value:M=0.714 value:M=0.000",
        "in its dead zone"
    );
}

#[test]
fn a_nested_menu_closes_at_the_press() {
    assert_eq!(
        moved(&["-31 0", "-5 0", "0 20"], &lift("0 20")),
        "value:M=0.714 value:M=0.000 value:M=0.143 dn:C up:C value:M=0.000"
    );
}

#[test]
fn a_trembling_finger_at_a_border_changes_nothing() {
    // The border of the first two sectors is at 45°, and a highlighted one keeps 9° more.
    let at = |degrees: f32| {
        let (sin, cos) = degrees.to_radians().sin_cos();
        format!("{} {}", 20.0 * sin, 20.0 * cos)
    };
    let positions = [44.0, 46.0, 52.0, 44.0, 56.0, 44.0, 38.0, 34.0].map(at);
    let positions: Vec<&str> = positions.iter().map(String::as_str).collect();
    assert_eq!(
        moved(&positions, "wait 0"),
        "value:M=0.143 value:M=0.286 value:M=0.143"
    );
    // The dead zone has a radius of 12 mm, and of 9.6 mm for a fingertip that was outside.
    assert_eq!(
        moved(
            &["0 11.8", "0 12.2", "0 11.8", "0 10", "0 9", "0 11.8"],
            "wait 0"
        ),
        "value:M=0.143 value:M=0.000"
    );
}

#[test]
fn the_first_sector_has_hysteresis_at_both_borders() {
    for (positions, expected) in [
        (["-2 20", "-15 14", "-14 15"], "value:M=0.143"),
        (["-20 1", "-14 15", "-15 14"], "value:M=0.571"),
        (["2 20", "15 14", "14 15"], "value:M=0.143"),
    ] {
        assert_eq!(moved(&positions, "wait 0"), expected, "{positions:?}");
    }
}

#[test]
fn everything_that_ends_a_menu_otherwise_fires_nothing() {
    for end in [
        "hide index; wait 500; index M 0 20 up",
        "reacquire",
        "reset",
        "release",
        "release-devices; index M 0 20 up",
        "index M 0 90 down; index M 0 90 up",
    ] {
        assert_eq!(
            moved(&["0 20"], end),
            "value:M=0.143 value:M=0.000",
            "{end}"
        );
    }
}

#[test]
fn a_nested_menu_that_is_lost_fires_nothing() {
    for end in [
        "hide index; wait 500",
        "release",
        "release-devices; index M -31 18 up",
    ] {
        assert_eq!(
            moved(&["-31 0", "-31 18"], end),
            "value:M=0.714 value:M=0.857 value:M=0.000",
            "{end}"
        );
    }
}

#[test]
fn a_second_finger_on_the_hub_is_ignored() {
    let script = "index M 0 0 up & middle M 5 0 up; index M 0 0 down & middle M 5 0 down; \
                  middle M 5 20 down; middle M 5 20 up; index M 20 0 down; index M 20 0 up";
    assert_events(
        MENU,
        script,
        "value:M=0.286 dn:ControlLeft dn:V up:V up:ControlLeft value:M=0.000",
    );
}

#[test]
fn a_layout_requires_the_modifiers_of_its_menus() {
    let text = format!("Layout(name: \"t\", boards: [(pose: (anchor: world), {MENU})])");
    let layout = Layout::parse(&text, "t.ron").expect("a layout");
    let required = format!("{:?}", layout.required_capabilities());
    for key in ["C", "ControlLeft", "ShiftLeft", "X"] {
        let code = key.parse::<ademan::device::KeyCode>().expect("a key");
        let capability = ademan::device::Capability::Key(code);
        assert!(
            layout.required_capabilities().contains(capability),
            "{key} in {required}"
        );
    }
}

#[test]
fn an_error_of_a_menu_has_its_position() {
    let two = r#"(name: "a", tap: Key("A")), (name: "b", tap: Key("B"))"#;
    let one = r#"(name: "a", tap: Key("A"))"#;
    let nine = [one; 9].join(", ");
    let cases = [
        (60, one.to_owned(), "needs 2 to 8 sectors, not 1"),
        (60, nine, "needs 2 to 8 sectors, not 9"),
        (20, two.to_owned(), "needs a `diameter_mm` of at least 30"),
        (
            60,
            format!(r#"{two}, (name: "c")"#),
            "the sector `c` needs either a `tap`, which may have a `with`, or a `menu`",
        ),
        (
            60,
            format!(r#"{two}, (name: "c", tap: Key("C"), menu: [{two}])"#),
            "needs either a `tap`",
        ),
        (
            60,
            format!(r#"{two}, (name: "c", menu: [{one}])"#),
            "the menu of the sector `c` needs 2 to 8 sectors, not 1",
        ),
        (
            60,
            format!(r#"{two}, (name: "c", tap: Key("C"), with: "Control Q")"#),
            "`Q` is not a modifier key",
        ),
        (
            60,
            format!(r#"{two}, (name: "c", tap: Text("C"), with: "Control")"#),
            "only a `tap` of a key can have a `with`",
        ),
    ];
    for (diameter, sectors, expected) in cases {
        let text = format!(
            "Layout(name: \"t\", boards: [(pose: (anchor: world),\n\
             radial_menus: [(name: \"M\", at_mm: (0, 0), diameter_mm: {diameter}, sectors: [{sectors}])])])"
        );
        let error = Layout::parse(&text, "t.ron").expect_err(expected);
        assert_eq!(error.line(), Some(2), "{error}");
        assert!(error.message().contains(expected), "{error}");
    }
}

#[test]
fn a_release_in_a_gap_fires_nothing() {
    // The fingertip may have gone back before it lifted.
    let lifted = |gap: &str| moved(&["0 20"], &format!("{gap} & {}", lift("0 5")));
    assert_eq!(
        lifted("gap 100"),
        "value:M=0.143 dn:C up:C value:M=0.000",
        "short"
    );
    assert_eq!(lifted("gap 160"), "value:M=0.143 value:M=0.000");
}
