//! Scroll rings, around which a fingertip slides.

use super::{assert_events, simulate};
use ademan::layout::Layout;

/// A ring of 24 detents with an outer radius of 30 mm and a dead center of 12 mm.
fn ring(fields: &str) -> String {
    format!("scroll_rings: [(name: \"R\", at_mm: (0, 0), diameter_mm: 60{fields})]")
}

/// Returns the events of a fingertip that presses the ring at 3 o'clock and moves through these positions.
fn moved(fields: &str, positions: &[&str]) -> String {
    let mut script = "index R 20 0 up; index R 20 0 down".to_owned();
    for position in positions {
        script += &format!("; index R {position} down");
    }
    simulate(&ring(fields), &script)
}

#[test]
fn a_finger_that_moves_clockwise_increases_the_value_and_scrolls_down() {
    assert_eq!(
        moved(", output: ScrollY(-24)", &["0 -20", "20 0"]),
        "value:R=0.250 scroll=+0,-720 value:R=0.000 scroll=+0,+720"
    );
    assert_eq!(moved("", &["0 -20"]), "value:R=0.250", "only its value");
}

#[test]
fn a_reversed_ring_counts_the_other_way() {
    assert_eq!(
        moved(", reversed: true, output: ScrollY(24)", &["0 20"]),
        "value:R=0.250 scroll=+0,+720"
    );
}

#[test]
fn the_value_wraps_around_and_the_wheel_goes_on() {
    let turn = ["0 -20", "-20 0", "0 20", "20 0"];
    assert_eq!(
        moved(", output: ScrollY(24)", &[turn, turn].concat()),
        "value:R=0.250 scroll=+0,+720 value:R=0.500 scroll=+0,+720 \
         value:R=0.750 scroll=+0,+720 value:R=0.000 scroll=+0,+720 \
         value:R=0.250 scroll=+0,+720 value:R=0.500 scroll=+0,+720 \
         value:R=0.750 scroll=+0,+720 value:R=0.000 scroll=+0,+720"
    );
    assert_eq!(
        moved(", output: ScrollY(24)", &["0 20", "-20 0"]),
        "value:R=0.750 scroll=+0,-720 value:R=0.500 scroll=+0,-720",
        "below 0"
    );
}

#[test]
fn a_trembling_finger_between_two_detents_does_not_scroll() {
    // The first detent is at 15°, and the value changes 0.6 detents from the last one.
    let at = |degrees: f32| {
        let (sin, cos) = (-degrees).to_radians().sin_cos();
        format!("{} {}", 20.0 * cos, 20.0 * sin)
    };
    let positions = [8.0, 7.0, 8.0, 9.5, 7.0, 8.0, 5.5].map(at);
    let positions: Vec<&str> = positions.iter().map(String::as_str).collect();
    assert_eq!(moved("", &positions), "value:R=0.042 value:R=0.000");
}

#[test]
fn the_dead_center_turns_nothing() {
    assert_eq!(
        moved("", &["2 0", "0 -3", "-20 0"]),
        "",
        "through the middle"
    );
    assert_eq!(
        moved("", &["2 0", "-20 0", "0 20"]),
        "value:R=0.250",
        "a quarter on the far side"
    );
    assert_eq!(
        moved(", dead_center: 0.8", &["0 -20"]),
        "",
        "a press within a large center"
    );
}

#[test]
fn a_finger_that_leaves_the_ring_releases_it_and_the_next_press_continues() {
    let script = "index R 20 0 up; index R 20 0 down; index R 0 -20 down; index R 0 -60 down; index R -20 0 down; \
                  index R -20 0 up; index R -20 0 down; index R 0 20 down";
    // Nothing between leaving and the next press.
    assert_events(&ring(""), script, "value:R=0.250 value:R=0.500");
}

#[test]
fn a_second_finger_is_ignored() {
    let script = "index R 20 0 up & middle R -20 0 up; index R 20 0 down & middle R -20 0 down; \
                  middle R 0 20 down; index R 0 -20 down";
    assert_events(&ring(""), script, "value:R=0.250");
}

#[test]
fn a_ring_taps_at_each_step() {
    assert_eq!(
        moved(
            ", output: Taps(increase: Key(\"A\"), decrease: Key(\"B\"), steps: 4)",
            &["0 -20", "20 0"]
        ),
        "value:R=0.250 dn:A up:A value:R=0.000 dn:B up:B"
    );
}

#[test]
fn an_error_of_a_ring_has_its_position() {
    for (fields, expected) in [
        (", detent_deg: 1", "the angle of a detent is 2 to 180°"),
        (", dead_center: 1", "a dead center is 0.1 to 0.9"),
        (
            ", output: Axis(\"LeftX\")",
            "cannot output the axis `LeftX`, which has ends; use a knob",
        ),
    ] {
        let board = ring(fields);
        let text = format!("Layout(name: \"t\", boards: [(pose: (anchor: world),\n{board})])");
        let error = Layout::parse(&text, "t.ron").expect_err(fields);
        assert_eq!(error.line(), Some(2), "{error}");
        assert!(error.message().contains(expected), "{error}");
    }
}
