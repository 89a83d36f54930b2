//! Candidates that controls other than keys take, and layouts whose controls make the text decoder part of a run.

use ademan::capture::Hc11Format;
use ademan::command::TextMode;
use ademan::layout::Layout;
use ademan::setup::{LoadedSetup, Setup};
use ademan::text::{TextModeSchema, TextSetup};

use super::text::play;

/// Letters, and each kind of control that taps actions.
const LAYOUT: &str = r#"Layout(
    name: "Controls for candidates",
    boards: [(
        pose: (anchor: elbow, bearing_deg: 35, forward_mm: 300, height_mm: -45),
        pitch_mm: 19,
        size_mm: Box(17, 17),
        rows: [
            (at_mm: (-90.25, -19), keys: "Q W E R T Y U I O P"),
            (at_mm: (-80.75, -38), keys: "A S D F G H J K L"),
        ],
        keys: [
            (action: Command("candidate 1"), name: "first", at_mm: (-60, -57)),
            (action: Command("candidate 2"), name: "second", at_mm: (-20, -57)),
        ],
        knobs: [(
            name: "Choose",
            at_mm: (-70, 20),
            diameter_mm: 40,
            range_deg: 120,
            initial: 0.5,
            springs_back: true,
            output: Taps(increase: Command("candidate 1"), decrease: Command("candidate 2"), steps: 2),
        )],
        scroll_rings: [(
            name: "Ring",
            at_mm: (-10, 22),
            diameter_mm: 50,
            output: Taps(increase: Command("candidate 1"), decrease: Command("candidate 2"), steps: 6),
        )],
        radial_menus: [(
            name: "Menu",
            at_mm: (60, 22),
            diameter_mm: 50,
            sectors: [
                (name: "one", tap: Command("candidate 1")),
                (name: "two", tap: Command("candidate 2")),
                (name: "three", tap: Command("candidate 3")),
            ],
        )],
    )],
)"#;

fn load(text: Option<TextSetup>) -> LoadedSetup {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("controls.ron");
    std::fs::write(&path, LAYOUT).unwrap();
    let setup = Setup {
        layout: path.display().to_string(),
        text,
        ..Setup::default()
    };
    setup.load_files().expect("a layout")
}

/// Types the letters of `he` in the mode `suggest`, then performs a script. Returns the text.
fn performs(script: &str) -> String {
    let suggest = TextSetup {
        mode: Some(TextModeSchema::Suggest),
        ..TextSetup::default()
    };
    let setup = load(Some(suggest));
    let whole = format!("tap H; tap E; {script}; wait 400");
    let hand = setup.scripted(&whole, &Hc11Format::default(), 0.0, 0);
    play(&setup, hand.expect("a script"), |_, _, _| {}).text
}

#[test]
fn a_knob_a_ring_and_a_menu_take_candidates() {
    let [first, second] = ["tap first", "tap second"].map(performs);
    assert!(
        first.ends_with(' ') && second.ends_with(' '),
        "{first}{second}"
    );
    assert_ne!(first, second);
    for (script, expected) in [
        ("press Choose 14 0; arc -60; lift", &first),
        ("press Choose 14 0; arc 60; lift", &second),
        ("press Ring 18 0; arc -75; lift", &first),
        ("press Ring 18 0; arc 75; lift", &second),
        ("press Menu; slide 0 18; lift", &first),
    ] {
        assert_eq!(performs(script), *expected, "{script}");
    }
}

#[test]
fn a_knob_without_a_word_changes_nothing() {
    let right = "press Choose 14 0; arc -60; lift";
    let once = performs(right);
    assert_eq!(performs(&format!("{right}; {right}")), once);
}

#[test]
fn a_layout_with_a_control_for_candidates_has_a_decoder_that_changes_nothing() {
    let mode = load(None).pipeline().text_state().map(|state| state.mode);
    assert_eq!(mode, Some(TextMode::Literal));
    let has_commands = |control: &str| {
        let text = format!("Layout(name: \"a\", boards: [(pose: (anchor: elbow), {control})])");
        let layout = Layout::parse(&text, "a.ron");
        layout.expect("a layout").has_text_commands
    };
    let knob = |action: &str| {
        format!(
            "knobs: [(name: \"k\", at_mm: (0, 0), diameter_mm: 40, output: Taps(increase: {action}, decrease: Key(\"A\"), steps: 2))]"
        )
    };
    let key = |action: &str| format!("keys: [(action: {action}, name: \"k\", at_mm: (0, 0))]");
    assert!(has_commands(&knob("Command(\"candidate 1\")")));
    assert!(has_commands(&key("Command(\"text suggest\")")));
    assert!(!has_commands(&knob("Key(\"B\")")));
    assert!(!has_commands(&key("Command(\"toggle-pause\")")));
    let fist = "Layout(name: \"a\", triggers: [(name: \"Fist\", action: Command(\"text literal\"), when: HandShape(name: \"fist\"))])";
    let gesture = Layout::parse(fist, "a.ron").expect("a layout");
    assert!(gesture.has_text_commands);
}
