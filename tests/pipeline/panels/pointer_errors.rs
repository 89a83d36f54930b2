//! Errors in pointers and targets in space, with their positions.

use ademan::layout::Layout;

use super::{check_refusals, refusal_of};

/// Returns `LINE:COLUMN: message` of the error in a layout with these fields, from line 2.
fn refusal(fields: &str) -> String {
    refusal_of(&format!("Layout(name: \"t\",\n{fields}\n)"))
}

const MODE: &str = "mode: Direct(pose: (anchor: world), size_mm: (200, 100, 100))";

fn of_pointer(fields: &str) -> String {
    refusal(&format!("pointer: Pointer({MODE},\n{fields})"))
}

fn of_targets(targets: &str) -> String {
    refusal(&format!(
        "spaces: [(pose: (anchor: world), targets: [\n{targets}\n])]"
    ))
}

#[test]
fn numbers_out_of_range_are_refused_with_their_position() {
    check_refusals(
        &[
            (
                "max_step_px: 1e308",
                "3:14: 1e308 is out of range: a maximum step is 10 to 20000 px",
            ),
            (
                "max_step_px: NaN",
                "3:14: NaN is out of range: a maximum step is 10 to 20000 px",
            ),
            (
                "screen_px: (0, 5)",
                "3:13: 0 is out of range: a screen size is 2 to 20000 px",
            ),
            (
                "clicks: [(gesture: Push(-3), action: Command(\"toggle-pause\"))]",
                "3:25: -3 is out of range: a push is 5 to 200 mm",
            ),
            (
                "precision_factor: inf",
                "3:19: inf is out of range: a precision factor is 0.01 to 1",
            ),
        ],
        of_pointer,
    );
}

#[test]
fn unknown_names_are_refused_with_the_nearest_known_one() {
    check_refusals(
        &[
            (
                "clutch: Pinch(\"indxe\")",
                "3:16: unknown finger `indxe`, did you mean `index`?",
            ),
            (
                "clutch: Flexion(\"wrist-flexoin\", 30)",
                "3:18: unknown degree of freedom `wrist-flexoin`, did you mean `wrist-flexion`?",
            ),
            (
                "clicks: [(gesture: Pnch(\"index\"), action: Command(\"toggle-pause\"))]",
                "3:20: unknown value `Pnch`, did you mean `Pinch`?",
            ),
            (
                "clicks: [(gesture: Pinch(\"index\"), action: Key(\"MouseLeff\"))]",
                "3:49: unknown key `MouseLeff`, did you mean `MouseLeft`?",
            ),
            (
                "z_output: Axis(\"MoveQ\")",
                "3:17: unknown axis `MoveQ`, did you mean `MoveZ`?",
            ),
        ],
        of_pointer,
    );
}

#[test]
fn inconsistent_settings_of_a_pointer_are_refused() {
    check_refusals(
        &[
            (
                "clicks: [(gesture: Pinch(\"index\"), action: Command(\"toggle-pause\"))], clutch: Pinch(\"index\")",
                "2:1: two gestures are a pinch of the index finger: both would be on together",
            ),
            (
                "precision: Flexion(\"wrist-flexion\", 30), clutch: Flexion(\"wrist-flexion\", 50)",
                "2:1: two gestures bend `wrist-flexion` in the same direction: both would be on together",
            ),
            (
                "clutch: Pinch(\"thumb\")",
                "2:1: the thumb pinches with another finger, name that finger",
            ),
            (
                "clutch: Flexion(\"wrist-flexion\", -4)",
                "2:1: the angle of `Flexion` of `wrist-flexion` must be at least 5° or at most -5°, so that it can turn off",
            ),
            (
                "acceleration: [(100, 2)]",
                "2:1: `acceleration` is for a pointer with `output: Relative`",
            ),
            (
                "output: Relative, acceleration: [(100, 2), (100, 3)]",
                "2:1: the speeds of `acceleration` must increase from knot to knot",
            ),
            (
                "pinch_mm: (on: 30, off: 25, near: 40)",
                "2:1: in `pinch_mm`, `on` must be less than `off`, and `off` less than `near`",
            ),
            (
                "scroll: (gesture: Pinch(\"ring\"), px_per_detent: 0)",
                "2:1: `px_per_detent` must be at least 1 or at most -1",
            ),
        ],
        of_pointer,
    );
    assert_eq!(
        refusal(
            "// pointer: this is no field\npointer: Pointer(mode: Joint(\n\
             x: (dof: \"wrist-flexion\", from_deg: 5, to_deg: 5.5), y: (dof: \"wrist-flexion\", from_deg: 5, to_deg: 9)))"
        ),
        "3:1: the range of `wrist-flexion` must be at least 1°: from_deg is 5, to_deg is 5.5"
    );
}

#[test]
fn targets_in_space_have_unique_names_and_a_size() {
    let ball = "(name: \"A\", at_mm: (0, 0, 0), shape: Ball(9)),";
    check_refusals(
        &[
            (
                &format!("{ball}\n{ball}"),
                "4:9: duplicate name `A`: there is a target with this name in line 3, set another `name`",
            ),
            (
                "(name: \"A\", at_mm: (0, 0, 0), shape: Ball(0))",
                "3:43: 0 is out of range: an extent is 1 to 2000 mm",
            ),
            (
                "(name: \"A\", at_mm: (0, 0, 0), shape: Ball(9), action: Layer(\"x\"))",
                "3:62: unknown layer `x`",
            ),
        ],
        of_targets,
    );
    assert_eq!(
        refusal(&format!(
            "pointer: Pointer({MODE}), spaces: [(pose: (anchor: world), targets: [\n{}])]",
            ball.replace('A', "pointer")
        )),
        "3:9: duplicate name `pointer`: there is a target with this name in line 2, set another `name`"
    );
}

#[test]
fn an_empty_layout_or_space_is_refused() {
    assert_eq!(
        Layout::parse("Layout(name: \"t\")", "t.ron")
            .unwrap_err()
            .to_string()
            .lines()
            .next(),
        Some("t.ron:1:15: the layout has no keys and no other controls, add `boards`")
    );
    assert_eq!(
        refusal("spaces: [(pose: (anchor: world), targets: [])]"),
        "1:15: space 1 has no targets"
    );
}
