//! Multitap keys in layout files: their limits, their errors, and what an output needs for them.

use ademan::device::Capability;
use ademan::layout::Layout;

/// Returns a layout with a key that has these letters.
fn layout(letters: &str) -> String {
    let key = format!("action: Multitap(\n\"{letters}\"), name: \"k\", at_mm: (0, 0)");
    format!("Layout(name: \"t\", boards: [(pose: (anchor: elbow), keys: [({key})])])")
}

fn parse(letters: &str) -> Layout {
    let text = layout(letters);
    Layout::parse(&text, "t.ron").unwrap_or_else(|error| panic!("{error}\n{text}"))
}

#[test]
fn an_error_in_the_letters_has_its_position() {
    let cases = [
        (
            "A",
            "2:2: a multitap key has 2 to 12 letters, this one has 1",
        ),
        (
            "A B C D E F G H I J K L M",
            "2:2: a multitap key has 2 to 12 letters, this one has 13",
        ),
        ("A B a", "2:6: duplicate letter `a` of a multitap key"),
        ("A Bb", "2:4: unknown key `Bb`"),
        (
            "A Enter",
            "2:4: `Enter` types no character, which a further tap could replace",
        ),
        (
            "A ShiftLeft",
            "2:4: `ShiftLeft` types no character, which a further tap could replace",
        ),
    ];
    for (letters, expected) in cases {
        let text = layout(letters);
        let error = Layout::parse(&text, "t.ron").expect_err(&text).to_string();
        assert!(
            error.starts_with(&format!("t.ron:{expected}")),
            "{error}\n{text}"
        );
    }
    let text = layout("A B").replace("boards:", "multitap_timeout_ms: 100, boards:");
    let error = Layout::parse(&text, "t.ron").expect_err(&text).to_string();
    let expected = "100 is out of range: a multitap timeout is 200 to 5000 ms";
    assert!(error.contains(expected), "{error}");
}

#[test]
fn a_layout_needs_the_letters_and_a_backspace() {
    let needed = parse("A Semicolon 2").required_capabilities();
    for name in ["A", "Semicolon", "2", "Backspace"] {
        let key = name.parse().expect("a key");
        assert!(needed.contains(Capability::Key(key)), "{name}");
    }
    assert!(!needed.text);
    assert!(parse("A ñ").required_capabilities().text);
}

#[test]
fn a_drawing_shows_all_letters_and_no_character_acts_on_the_terminal() {
    let drawing = parse("A . \u{202e} 2").to_text();
    assert!(drawing.contains("one of A.\\u{202e}2"), "{drawing}");
}

/// Returns a layout with two keys and a layer with these fields.
fn layered(fields: &str) -> String {
    let board = "(pose: (anchor: elbow), rows: [(at_mm: (0, 0), keys: \"Q W\")])";
    format!("Layout(name: \"t\", boards: [{board}], layers: [(name: \"x\",\n{fields})])")
}

#[test]
fn a_key_has_letters_or_any_other_action_in_a_layer() {
    let text = layered("actions: {\"KeyQ\": Multitap(\"Period ñ 2\"), \"W\": Text(\"\u{202e}\")}");
    let layout = Layout::parse(&text, "t.ron").unwrap_or_else(|error| panic!("{error}\n{text}"));
    let needed = layout.required_capabilities();
    for name in ["Q", "Period", "2", "Backspace"] {
        let key = name.parse().expect("a key");
        assert!(needed.contains(Capability::Key(key)), "{name}");
    }
    assert!(needed.text);
    assert_eq!(layout.label_in_layer(&layout.keys[0], 1), Some(".ñ2"));
    let drawing = layout.to_text();
    assert!(
        drawing.contains("Layer x\n  Q one of .ñ2 · W \\u{202e}"),
        "{drawing}"
    );
}

#[test]
fn an_error_in_the_actions_of_a_layer_has_its_position() {
    let cases = [
        (
            "actions: {\"Q\": Multitap(\"A Enter\")}",
            "2:28: `Enter` types no character, which a further tap could replace",
        ),
        (
            "actions: {\"E\": Text(\"e\")}",
            "2:12: this layout has no such key: unknown key `E`",
        ),
        (
            "keys: {\"Q\": \"1\"}, actions: {\"Q\": Text(\"e\")}",
            "2:30: duplicate key `Q` in the layer `x`",
        ),
        (
            "actions: {\"Q\": NoOp}",
            "1:15: only a key that takes part in a chord can have the action `NoOp`",
        ),
        ("actions: {\"Q\": Layer(\"y\")}", "2:23: unknown layer `y`"),
    ];
    for (fields, expected) in cases {
        let text = layered(fields);
        let error = Layout::parse(&text, "t.ron").expect_err(&text).to_string();
        assert!(
            error.starts_with(&format!("t.ron:{expected}")),
            "{error}\n{text}"
        );
    }
}

#[test]
fn a_layout_has_at_most_65_536_multitap_keys_in_all_layers() {
    let key = |index: usize| {
        let [x, y] = [index % 50, index / 50].map(|it| it * 20);
        format!("(code: \"A\", name: \"{index}\", at_mm: ({x}, {y})),")
    };
    let entry = |index: usize| format!("\"{index}\": Multitap(\"A B\"),");
    let keys: String = (0..2_200).map(key).collect();
    let entries: String = (0..2_200).map(entry).collect();
    let layer = |index: usize| format!("(name: \"{index}\", actions: {{{entries}}}),");
    let layers: String = (0..30).map(layer).collect();
    let text = format!(
        "Layout(name: \"t\", boards: [(pose: (anchor: elbow), keys: [{keys}])], layers: [{layers}])"
    );
    let error = Layout::parse(&text, "t.ron")
        .expect_err("too many")
        .to_string();
    let expected = "a layout has at most 65536 multitap keys in all layers";
    assert!(error.contains(expected), "{error:.2000}");
}
