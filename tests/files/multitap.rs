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
