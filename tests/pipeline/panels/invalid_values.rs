//! Common mistakes in layout files, one test each: the message and its position.

use ademan::layout::Layout;

use crate::rig::Rig;

/// Returns line, column and message of the error in a board with these fields.
fn refusal(fields: &str) -> (usize, usize, String) {
    let text = format!("Layout(name: \"t\", boards: [(\npose: (anchor: world),\n{fields})])");
    let error = Layout::parse(&text, "t.ron").expect_err("the board is wrong");
    let position = (
        error.line().expect("a line"),
        error.column().expect("a column"),
    );
    let shown = error.to_string();
    let message = shown.lines().next().expect("a line");
    let message = message.splitn(4, ':').nth(3).expect("after the position");
    (position.0, position.1, message.trim().to_owned())
}

#[test]
fn sizes_that_are_not_finite_or_out_of_range_are_refused() {
    for (size, value) in [
        ("NaN", "NaN"),
        ("inf", "inf"),
        ("1e308", "1e308"),
        ("-5", "-5"),
        ("0", "0"),
    ] {
        for (field, what) in [
            (
                format!("keys: [(code: \"A\", at_mm: (0, 0), size_mm: Disc({size}))]"),
                "a size is 1 to 500 mm",
            ),
            (
                format!("sliders: [(name: \"s\", at_mm: (0, 0), length_mm: {size})]"),
                "a size is 1 to 500 mm",
            ),
            (
                format!("knobs: [(name: \"k\", at_mm: (0, 0), diameter_mm: {size})]"),
                "a size is 1 to 500 mm",
            ),
        ] {
            let (line, _, message) = refusal(&field);
            assert_eq!(
                message,
                format!("{value} is out of range: {what}"),
                "{field}"
            );
            assert_eq!(line, 3);
        }
    }
}

#[test]
fn a_travel_of_zero_is_refused() {
    let (line, column, message) = refusal("travel_mm: 0");
    assert_eq!((line, column), (3, 12));
    assert_eq!(message, "0 is out of range: a travel is 0.2 to 50 mm");
}

#[test]
fn an_inverted_range_is_refused() {
    let (line, _, message) =
        refusal("press_at: 0.2, release_at: 0.6, keys: [(code: \"A\", at_mm: (0, 0))]");
    assert_eq!(line, 3);
    assert_eq!(
        message,
        "press_at 0.2 of the key `A` must be greater than release_at 0.6"
    );
}

#[test]
fn an_unknown_name_is_refused_with_the_nearest_known_one() {
    for (fields, expected) in [
        (
            "keys: [(code: \"Spcae\", at_mm: (0, 0))]",
            "unknown key `Spcae`, did you mean `Space`?",
        ),
        (
            "sliders: [(name: \"s\", at_mm: (0, 0), length_mm: 50, output: Axis(\"LefX\"))]",
            "unknown axis `LefX`, did you mean `LeftX`?",
        ),
    ] {
        assert_eq!(refusal(fields).2, expected);
    }
}

#[test]
fn an_unknown_layer_is_refused() {
    let (line, column, message) = refusal("keys: [(layer: \"digits\", at_mm: (0, 0))]");
    assert_eq!((line, column), (3, 17));
    assert_eq!(message, "unknown layer `digits`");
}

#[test]
fn locked_layers_are_unlocked_in_the_reverse_order() {
    let text = r#"Layout(name: "t", boards: [(pose: (anchor: world), keys: [
        (code: "A", at_mm: (0, 0)),
        (layer: "one", latch: Lock, at_mm: (30, 0)),
        (layer: "two", latch: Lock, at_mm: (60, 0)),
    ])], layers: [(name: "one", keys: {"A": "B"}), (name: "two", keys: {"A": "C"})])"#;
    let script = "index A tap; index one tap; index A tap; index two tap; index A tap; index one tap; \
             index A tap; index one tap; index A tap";
    assert_eq!(
        Rig::new(text).run(script).events(),
        "dn:A up:A dn:B up:B dn:C up:C dn:B up:B dn:A up:A"
    );
}
