//! Errors in layout files: message and position of each.

use std::fs;
use std::path::Path;

use ademan::document::DocumentError;
use ademan::files::Load;
use ademan::layout::Layout;

const POSE: &str = "pose: (anchor: elbow)";

/// Returns a layout whose board has these fields.
fn board(fields: &str) -> String {
    format!("Layout(name: \"t\", boards: [(\n{POSE},\n{fields}\n)])")
}

fn error_of(text: &str) -> DocumentError {
    Layout::parse(text, "t.ron").expect_err("the layout is wrong")
}

/// Checks cases of a board and the expected `LINE:COLUMN: message`.
fn check_boards(cases: &[(String, &str)]) {
    for (fields, expected) in cases {
        check(&board(fields), expected);
    }
}

/// Returns a board with a key that has these fields.
fn key(fields: &str) -> String {
    format!("keys: [(code: \"A\", at_mm: (0, 0), {fields})]")
}

#[test]
fn an_unknown_name_on_a_board_has_its_position() {
    check_boards(&[
        (
            "kyes: []".into(),
            "3:1: unknown field `kyes`, did you mean `keys`?",
        ),
        (
            "xylophone: []".into(),
            super::layouts::with_board_fields("3:1: unknown field `xylophone`, expected one of: "),
        ),
        (
            key("lable: \"x\""),
            "3:35: unknown field `lable`, did you mean `label`?",
        ),
        (
            "rows: [(at_mm: (0, 0), keys: \"Q Entre\")]".into(),
            "3:33: unknown key `Entre`, did you mean `Enter`?",
        ),
        (
            "keys: [(code: \"Spcebar\", at_mm: (0, 0))]".into(),
            "3:16: unknown key `Spcebar`, did you mean `Spacebar`?",
        ),
        (
            key("size_mm: Bux(1, 2)"),
            "3:44: unknown value `Bux`, did you mean `Box`?",
        ),
        (
            key("latch: Oneshot"),
            "3:42: unknown value `Oneshot`, did you mean `OneShot`?",
        ),
        (
            "shape: Arc(radius: 3)".into(),
            "3:12: unknown field `radius`, did you mean `radius_mm`?",
        ),
        (
            "keys: [(layer: \"symbls\", at_mm: (0, 0))]".into(),
            "3:17: unknown layer `symbls`",
        ),
        (
            "keys: [(action: Command(\"allow-keys\"), name: \"k\", at_mm: (0, 0))]".into(),
            "3:26: a layout cannot issue `allow-keys`, only `ademan ctl allow-keys` does",
        ),
    ]);
}

#[test]
fn a_wrong_number_on_a_board_has_its_position() {
    check_boards(&[
        (
            key("size_mm: Box(0, 17)"),
            "3:48: 0 is out of range: a size is 1 to 500 mm",
        ),
        (
            key("size_mm: Box(17, -17)"),
            "3:52: -17 is out of range: a size is 1 to 500 mm",
        ),
        (
            key("size_mm: Disc(NaN)"),
            "3:49: NaN is out of range: a size is 1 to 500 mm",
        ),
        (
            key("size_mm: Disc(1e308)"),
            "3:49: 1e308 is out of range: a size is 1 to 500 mm",
        ),
        (
            key("size_mm: Disc(-1e-300)"),
            "3:49: -1e-300 is out of range: a size is 1 to 500 mm",
        ),
        (
            key("travel_mm: 0"),
            "3:46: 0 is out of range: a travel is 0.2 to 50 mm",
        ),
        (
            key("travel_mm: -inf"),
            "3:46: -inf is out of range: a travel is 0.2 to 50 mm",
        ),
        (
            "keys: [(code: \"A\", at_mm: (0, inf))]".into(),
            "3:31: inf is out of range: an offset is -2000 to 2000 mm",
        ),
        (
            "pitch_mm: 0".into(),
            "3:11: 0 is out of range: a pitch is 1 to 500 mm",
        ),
        (
            "shape: Arc(radius_mm: 0)".into(),
            "3:23: 0 is out of range: a radius is 20 to 2000 mm",
        ),
        (
            "press_at: 1.5".into(),
            "3:11: 1.5 is out of range: a press point is 0.05 to 1",
        ),
        (
            key("press_at: 0.2"),
            "3:16: press_at 0.2 of the key `A` must be greater than release_at 0.25",
        ),
    ]);
}

#[test]
fn a_wrong_missing_or_duplicate_field_has_its_position() {
    check_boards(&[
        (
            key("travel_mm: \"4\""),
            "3:46: expected a number, without quotes",
        ),
        (key("reports_depth: 1"), "3:50: expected `true` or `false`"),
        ("keys: 5".into(), "3:7: expected a list: `[…]`"),
        (
            "keys: [5]".into(),
            "3:8: expected fields in parentheses: `(…)`",
        ),
        (
            "keys: [(code: \"A\")]".into(),
            "3:18: the field `at_mm` is missing",
        ),
        (key("at_mm: (0, 0)"), "3:35: duplicate field `at_mm`"),
        (
            "keys: [(at_mm: (0, 0))]".into(),
            "3:22: the key has none of `code`, `layer` and `action`",
        ),
        (
            key("layer: \"x\""),
            "3:45: the key has both a `code` and a `layer`",
        ),
        (
            key("latch: Momentary"),
            "3:16: `A` cannot have a latch, only modifiers and layers can",
        ),
    ]);
}

#[test]
fn a_contradiction_in_the_activation_of_a_key_has_its_position() {
    check_boards(&[
        (
            key("activate_on: Relese"),
            "3:48: unknown value `Relese`, did you mean `Release`?",
        ),
        (
            "keys: [(code: \"ShiftLeft\", at_mm: (0, 0), activate_on: Release)]".into(),
            "3:16: `ShiftLeft` cannot activate on release: it is active while it is pressed",
        ),
        (
            "keys: [(layer: \"base\", at_mm: (0, 0), hold: (code: \"A\"))]".into(),
            "3:17: `base` cannot be the tap of a key with a `hold`: it is active while it is pressed",
        ),
        (
            key("activate_on: Release, hold: (code: \"B\")"),
            "3:16: the key `A` cannot have both `activate_on` and `hold`: a tap activates on release",
        ),
        (
            key("hold_after_ms: 300"),
            "3:16: the key `A` has a `hold_after_ms` but no `hold`, add the action of a held key",
        ),
        (
            key("hold: (code: \"B\"), hold_after_ms: 20"),
            "3:69: 20 is out of range: a hold time is 50 to 2000 ms",
        ),
        (
            key("hold: (code: \"Shft\")"),
            "3:49: unknown key `Shft`, did you mean `Shift`?",
        ),
        (
            key("hold: (layer: \"symbols\")"),
            "3:50: unknown layer `symbols`",
        ),
        (
            key("hold: (cod: \"B\")"),
            "3:42: unknown field `cod`, did you mean `code`?",
        ),
        (
            key("hold: ()"),
            "3:42: the hold has neither a `code` nor a `layer`",
        ),
        (
            key("hold: (code: \"B\", layer: \"base\")"),
            "3:66: the hold has both a `code` and a `layer`",
        ),
        (
            key("debounce_ms: 2001"),
            "3:48: 2001 is out of range: a debounce time is 0 to 2000 ms",
        ),
        (
            "debounce_ms: -1".into(),
            "3:14: -1 is out of range: a debounce time is 0 to 2000 ms",
        ),
        (
            key("label: \"\""),
            "3:43: a label has 1 to 16 characters, this one has 0",
        ),
        (
            key("label: \"\\u{1b}\""),
            "3:49: the label contains a control character",
        ),
        (
            "rows: [(at_mm: (0, 0), keys: \"\\u{41}\")]".into(),
            "3:37: this text must be written without `\\`",
        ),
        (
            "rows: [(at_mm: (0, 0), keys: \" \")]".into(),
            "3:32: the text is empty",
        ),
    ]);
}

#[test]
fn a_duplicate_label_has_its_position() {
    let boards = "boards: [(pose: (anchor: elbow), rows: [(at_mm: (0, 0), keys: \"Q W\")])]";
    let text = format!(
        "Layout(name: \"x\", {boards},\nlabels: {{\"Q\": \"1\", \"W\": \"2\", \"Q\": \"3\"}})"
    );
    check(&text, "2:31: duplicate label of `Q`");
}

#[test]
fn a_duplicate_or_overlapping_key_has_its_position() {
    let row = "rows: [(at_mm: (0, 0), keys: \"Q W\")]";
    check_boards(&[
        (
            "rows: [(at_mm: (0, 0), keys: \"Q W Q\")]".into(),
            "3:35: duplicate name `Q`: there is a key with this name in line 3, list it in `keys` with another `name`",
        ),
        (
            format!("{row},\nkeys: [(code: \"KeyW\", at_mm: (0, 50))]"),
            "4:16: duplicate name `W`: there is a key with this name in line 3, set another `name`",
        ),
        (
            format!("{row},\nkeys: [(code: \"E\", at_mm: (35, 1))]"),
            "4:16: the key `E` overlaps the key `W` of line 3 by 1 mm",
        ),
        (
            "rows: [(at_mm: (0, 0), keys: \"Q W\", pitch_mm: 16.9)]".into(),
            "3:33: the key `W` overlaps the key `Q` of line 3 by 0.1 mm",
        ),
        (
            "shape: Arc(radius_mm: 100), keys: [(code: \"A\", at_mm: (0, -95))]".into(),
            "3:44: the key `A` is beyond the ends of its arc",
        ),
        (
            "shape: Arc(radius_mm: 100), keys: [(code: \"A\", at_mm: (400, 0))]".into(),
            "3:44: the key `A` is beyond the ends of its arc",
        ),
        (
            "rows: [(at_mm: (1999, 0), keys: \"Q W\")]".into(),
            "3:36: the key `W` is more than 2000 mm from the center of its board",
        ),
        ("keys: []".into(), "1:15: board 1 has no keys"),
    ]);
    check(
        "Layout(name: \"t\", boards: [])",
        "1:15: the layout has no keys and no other controls, add `boards`",
    );
}

/// Checks the first line of the error without the file, the excerpt and the caret.
fn check(text: &str, expected: &str) {
    let error = error_of(text);
    let text_of_error = error.to_string();
    let mut lines = text_of_error.lines();
    assert_eq!(
        lines.next(),
        Some(format!("t.ron:{expected}").as_str()),
        "\n{text}"
    );
    let source = text
        .lines()
        .nth(error.line().unwrap() - 1)
        .unwrap_or_default();
    // A long line is cut, so that it fits into a terminal.
    let number = error.line().unwrap().to_string();
    let excerpt = lines.next().unwrap();
    assert!(excerpt.chars().count() <= 80, "{excerpt}");
    let shown = excerpt.strip_prefix(&format!(" {number} | ")).unwrap();
    let part = shown.trim_start_matches('…').trim_end_matches('…');
    let skipped = source.split(part).next().unwrap().chars().count();
    let is_whole = source.chars().count() <= 70;
    assert_eq!(source == part, is_whole, "{text_of_error}");
    let cut = usize::from(shown.starts_with('…'));
    let caret = lines.next().unwrap().chars().position(|c| c == '^');
    assert_eq!(
        caret,
        Some(error.column().unwrap() - skipped + cut + number.len() + 3),
        "{text_of_error}"
    );
    assert_eq!(lines.next(), None);
}

#[test]
fn an_error_in_a_layer_has_its_position() {
    let layers = |layers: &str| {
        format!(
            "Layout(name: \"t\", boards: [({POSE}, rows: [(at_mm: (0, 0), keys: \"Q Comma\")])], layers: [\n{layers}\n])"
        )
    };
    let many: Vec<String> = (1..=32)
        .map(|n| format!("(name: \"l{n}\", keys: {{}})"))
        .collect();
    for (text, expected) in [
        (
            "(name: \"base\", keys: {})",
            "2:9: `base` is the layer without a name, choose another name",
        ),
        (
            "(name: \"x\", keys: {}),\n(name: \"x\", keys: {})",
            "3:9: duplicate layer `x`",
        ),
        (
            "(name: \"x\", keys: {\"Coma\": \"1\"})",
            "2:21: this layout has no such key: unknown key `Coma`, did you mean `Comma`?",
        ),
        (
            "(name: \"x\", keys: {\"Q\": \"Entr\"})",
            "2:26: unknown key `Entr`, did you mean `Enter`?",
        ),
        (
            "(name: \"x\", keys: {\"Q\": \"1\", \"KeyQ\": \"2\"})",
            "2:31: duplicate key `KeyQ` in the layer `x`",
        ),
        (&many.join(",\n"), "33:9: a layout has at most 31 layers"),
    ] {
        check(&layers(text), expected);
    }
    for (key, expected) in [
        (
            "(code: \"Q\", activate_on: Release, at_mm: (0, 0))",
            "2:26: `AltLeft` cannot activate on release: it is active while it is pressed",
        ),
        (
            "(code: \"Q\", hold: (code: \"W\"), at_mm: (0, 0))",
            "2:26: `AltLeft` cannot be the tap of a key with a `hold`: it is active while it is pressed",
        ),
        (
            "(layer: \"x\", latch: Lock, name: \"Q\", at_mm: (0, 0))",
            "2:26: the key `Q` locks the layer `x` and must unlock it too, so it cannot have another action there",
        ),
    ] {
        let layer = "layers: [\n(name: \"x\", keys: {\"Q\": \"AltLeft\"})]";
        let text = format!("Layout(name: \"t\", boards: [({POSE}, keys: [{key}])], {layer})");
        check(&text, expected);
    }
    let text = board("keys: [(layer: \"symbls\", at_mm: (0, 0))]");
    let text = text.replace(")])", ")], layers: [(name: \"symbols\", keys: {})])");
    check(
        &text,
        "3:17: unknown layer `symbls`, did you mean `symbols`?",
    );
}

#[test]
fn a_syntax_error_has_its_position() {
    for (text, expected) in [
        (
            "",
            "1:1: the file is empty, expected `Layout(…)`; `ademan layout new NAME` writes a layout to start from",
        ),
        (
            "Layuot(name: \"x\")",
            "1:1: expected `Layout(…)`, found `Layuot`",
        ),
        (
            "Layout(name: \"x\"\nboards: [])",
            "2:1: expected a comma or the closing bracket",
        ),
        ("Layout(name: \"x", "1:14: the text has no closing quote"),
        (
            "Layout(name: 5)",
            "1:14: expected a text in quotes: `\"…\"`",
        ),
        (
            "Layout(name: \"x\", boards: []) x",
            "1:31: unexpected text after the end",
        ),
        ("  /* Layout(", "1:3: the comment has no `*/`"),
    ] {
        let error = error_of(text);
        let first = error.to_string().lines().next().unwrap().to_owned();
        assert_eq!(first, format!("t.ron:{expected}"), "\n{text}");
    }
}

#[test]
fn nesting_of_200_levels_is_an_error_and_not_a_crash() {
    for bracket in ["(", "[", "{", "Some(", "Layout(name:", "/*"] {
        for before in [
            "",
            "Layout(name: ",
            "Layout(name: \"x\", boards: ",
            "Layout(zzz: ",
        ] {
            let error = error_of(&format!("{before}{}", bracket.repeat(200)));
            assert!(error.line().is_some(), "{error}");
        }
    }
    #[derive(Debug, serde::Deserialize)]
    struct Nested(#[expect(dead_code, reason = "only read")] Vec<Nested>);
    let text = "([".repeat(200);
    let error = ademan::document::parse_ron::<Nested>(&text, "t.ron").unwrap_err();
    assert!(
        error.message().contains("nested more than 128 levels deep"),
        "{error}"
    );
}

#[test]
fn a_layout_has_at_most_10_000_keys() {
    let keys = |count: usize| {
        let key = |n: usize| {
            let (x, y) = (n % 100 * 19, n / 100 * 19);
            format!("(code: \"A\", name: \"{n}\", at_mm: ({x}, {y})),\n")
        };
        board(&format!(
            "keys: [\n{}]",
            (0..count).map(key).collect::<String>()
        ))
    };
    assert_eq!(
        Layout::parse(&keys(10_000), "t.ron").unwrap().scene.len(),
        10_000
    );
    let error = error_of(&keys(10_001));
    assert_eq!(
        error.message(),
        "a layout has at most 10000 keys and other controls"
    );
    assert_eq!(error.line(), Some(10_004));
}

#[test]
fn an_unreadable_file_reports_the_reason() {
    let folder = tempfile::tempdir().unwrap();
    let path = |name: &str| folder.path().join(name).to_str().unwrap().to_owned();
    let message = |file: &str| {
        let error = Layout::load(file).unwrap_err();
        assert!(
            error.to_string().starts_with(&format!("{file}:")),
            "{error}"
        );
        error.message().to_owned()
    };

    assert_eq!(message(&path("")), "this is a directory, name a file in it");
    assert_eq!(
        message(&path("qwerty-acr.ron")),
        "there is no such file, and no shipped one of that name, did you mean `qwerty-arc`?"
    );
    assert_eq!(
        message("zzzzzz"),
        "there is no such file, and no shipped one of that name; `ademan layouts` lists the names"
    );

    fs::write(path("latin1.ron"), b"Layout(\n  name: \"\xe9\")").unwrap();
    let error = Layout::load(&path("latin1.ron")).unwrap_err();
    assert_eq!((error.line(), error.column()), (Some(2), Some(10)));
    assert!(error.message().contains("UTF-8"), "{error}");
}

#[test]
fn a_file_has_at_most_one_mebibyte() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("large.ron");
    let mut text = board("rows: [(at_mm: (0, 0), keys: \"A\")]");
    text.push_str(&"\n".repeat((1 << 20) - text.len()));
    fs::write(&path, &text).unwrap();
    assert_eq!(Layout::load(path.to_str().unwrap()).unwrap().keys.len(), 1);
    text.push('\n');
    fs::write(&path, &text).unwrap();
    let error = Layout::load(path.to_str().unwrap()).unwrap_err();
    assert_eq!(error.message(), "the file is larger than 1 MiB");
}

#[test]
fn an_endless_file_is_not_read() {
    if !Path::new("/dev/zero").exists() {
        println!("SKIPPED: there is no /dev/zero here");
        return;
    }
    let error = Layout::load("/dev/zero").unwrap_err();
    let expected = "this is not a regular file but a device, name a file";
    assert_eq!(error.message(), expected);
}

#[test]
fn a_damaged_file_is_read_or_rejected_at_a_position_within_it() {
    let mut generator = fastrand::Rng::with_seed(1);
    let mut random = move |below: usize| generator.usize(..below);
    let signs = b"()[]{}\",:./*0-9e\\ \n\xc3";
    let mut refused = 0;
    for (_, layout) in Layout::shipped().unwrap() {
        for _ in 0..400 {
            let mut bytes = layout.text.clone().into_bytes();
            for _ in 0..=random(3) {
                let place = random(bytes.len());
                match random(3) {
                    0 => bytes[place] = signs[random(signs.len())],
                    1 => bytes.insert(place, signs[random(signs.len())]),
                    _ => drop(bytes.drain(place..(place + random(40)).min(bytes.len()))),
                }
            }
            let text = String::from_utf8_lossy(&bytes);
            let Err(error) = Layout::parse(&text, "t.ron") else {
                continue;
            };
            refused += 1;
            let lines = text.lines().count() + 1;
            assert!((1..=lines).contains(&error.line().unwrap()), "{error}");
        }
    }
    assert!(refused > 500, "{refused}");
}

#[test]
fn an_error_in_a_signal_is_at_its_control_or_its_address() {
    let layout = |signals: &str| {
        let controls = "keys: [(action: NoOp, name: \"C4\", at_mm: (0, 0)), (code: \"A\", at_mm: (30, 0))], \
                        sliders: [(name: \"Volume\", at_mm: (80, 0), length_mm: 30)]";
        format!(
            "Layout(name: \"t\", boards: [(\n{POSE},\n{controls}\n)], signals: {{\"C4\": (note: 1),\n{signals}}})"
        )
    };
    let address = "an OSC address is a path such as `/mixer/1`";
    for (signals, expected) in [
        ("\"A\": ()", "sends nothing, set `osc`, `note` or `control`"),
        (
            "\"A\": (note: 1, control: 2)",
            "has both a `note` and a `control`",
        ),
        (
            "\"Volume\": (note: 1)",
            "a slider plays no note, set a `control` for `Volume`",
        ),
        ("\"Volumen\": (note: 1)", "no such control"),
        ("\"Volumen\": (control: 1)", "did you mean `Volume`?"),
        ("\"C4\": (control: 1)", "duplicate signal of `C4`"),
        ("\"A\": (note: 1.5)", "1.5 is not a whole number"),
        (
            "\"A\": (note: 128)",
            "128 is out of range: a note is 0 to 127",
        ),
        (
            "\"A\": (note: 1, channel: 0)",
            "0 is out of range: a channel is 1 to 16",
        ),
        ("\"A\": (osc: \"mixer\")", address),
        ("\"A\": (osc: \"/\")", address),
        ("\"A\": (osc: \"/a//b\")", address),
        ("\"A\": (osc: \"/a b\")", address),
        ("\"A\": (osc: \"/ñ\")", address),
        ("\"A\": (osc: \"/*\")", address),
    ] {
        let error = error_of(&layout(signals));
        assert!(error.message().contains(expected), "{signals}: {error}");
        assert_eq!(error.line(), Some(5), "{signals}: {error}");
    }
    let valid = layout("\"KeyA\": (control: 1), \"Volume\": (osc: \"/mixer/1\", range: (-60, 6))");
    let parsed = Layout::parse(&valid, "t.ron").expect("a valid layout");
    assert_eq!(parsed.signals.iter().len(), 3);
    let reports = parsed
        .keys
        .iter()
        .map(|key| (key.reports_velocity, key.reports_depth));
    assert_eq!(reports.collect::<Vec<_>>(), [(true, false), (false, true)]);
}
