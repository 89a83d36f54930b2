//! Mistakes that people make in a layout, and the message for each.
//!
//! `cargo test --test files layout_mistakes -- --nocapture` prints the table.

use ademan::layout::Layout;

/// A kind of mistake, the text of a layout with it, and the first line of the message without the file.
type Mistake = (&'static str, String, &'static str);

/// A layout with these fields of its only board.
fn board(fields: &str) -> String {
    format!("Layout(name: \"t\", boards: [(\npose: (anchor: elbow),\n{fields}\n)])")
}

/// A layout with these fields of its only key.
fn key(fields: &str) -> String {
    board(&format!("keys: [(\n{fields}\n)]"))
}

/// A layout with a row, and these fields beside its boards.
fn layout(fields: &str) -> String {
    let row = "rows: [(at_mm: (0, 0), keys: \"Q W\")]";
    format!("Layout(name: \"t\", boards: [(pose: (anchor: elbow), {row})],\n{fields}\n)")
}

fn mistakes() -> Vec<Mistake> {
    [
        syntax(),
        brackets_and_quotes(),
        numbers(),
        names(),
        structure(),
        meaning(),
    ]
    .concat()
}

fn syntax() -> Vec<Mistake> {
    let row = "rows: [(at_mm: (0, 0), keys: \"Q W\")]";
    vec![
        (
            "an empty file",
            String::new(),
            "1:1: the file is empty, expected `Layout(…)`; `ademan layout new NAME` writes a layout to start from",
        ),
        (
            "only comments",
            "// my layout\n".into(),
            "1:1: the file is empty, expected `Layout(…)`; `ademan layout new NAME` writes a layout to start from",
        ),
        (
            "a comment with `#`",
            format!("# mine\n{}", board(row)),
            "1:1: a comment begins with `//`, not with `#`",
        ),
        (
            "a comment with `#` after a field",
            board(&format!("pitch_mm: 19, # mm\n{row}")),
            "3:15: a comment begins with `//`, not with `#`",
        ),
        (
            "a comma too many",
            board("rows: [(at_mm: (0, 0),, keys: \"Q W\")]"),
            "3:23: there is no value before this comma; write it, or remove the comma",
        ),
        (
            "JSON",
            "{\"name\": \"t\", \"boards\": []}".into(),
            "1:1: expected fields in parentheses: `(…)`, not `{…}`",
        ),
        (
            "braces for parentheses",
            "Layout{name: \"t\"}".into(),
            "1:7: expected fields in parentheses: `(…)`, not `{…}`",
        ),
        (
            "a glove in place of a layout",
            "Glove(name: \"t\")".into(),
            "1:1: expected `Layout(…)`, found `Glove`",
        ),
        (
            "`=` for `:`",
            board("rows: [(at_mm = (0, 0), keys: \"Q W\")]"),
            "3:15: write `:` in place of `=`",
        ),
        (
            "`;` for `,`",
            board("rows: [(at_mm: (0, 0); keys: \"Q W\")]"),
            "3:22: write `,` in place of `;`",
        ),
    ]
}

fn brackets_and_quotes() -> Vec<Mistake> {
    let row = "rows: [(at_mm: (0, 0), keys: \"Q W\")]";
    vec![
        (
            "a missing comma",
            board(&format!("pitch_mm: 19\n{row}")),
            "4:1: expected a comma or the closing bracket",
        ),
        (
            "a bracket that is not closed",
            board(row).replace(")])", ")"),
            "1:27: the `[` is not closed",
        ),
        (
            "a bracket too many, which closes nothing that follows",
            board("rows: [(at_mm: ((0, 0), keys: \"Q W\"), (at_mm: (0, 19), keys: \"A S\")]"),
            "3:17: expected a number",
        ),
        (
            "a bracket of another kind",
            board("rows: [(at_mm: (0, 0), keys: \"Q W\"]]"),
            "3:35: expected `)` before `]`: the `(` of line 3 is open",
        ),
        (
            "a text without closing quote",
            board("rows: [(at_mm: (0, 0), keys: \"Q W)]"),
            "3:30: the text has no closing quote",
        ),
        (
            "a text without closing quote before other texts",
            board("rows: [(at_mm: (0, 0), keys: \"Q W)],\nkeys: [(code: \"A\", at_mm: (0, 50))]"),
            "3:30: the text has no closing quote",
        ),
        (
            "a label without closing quote",
            layout("labels: {\n\"Q\": \"q,\n\"W\": \"w\"}"),
            "3:7: the label has a line break: is its closing quote missing?",
        ),
        (
            "single quotes",
            board("rows: [(at_mm: (0, 0), keys: 'Q W')]"),
            "3:30: a text has straight double quotes: `\"…\"`",
        ),
        (
            "typographic quotes",
            "Layout(name: “t”)".into(),
            "1:14: a text has straight double quotes: `\"…\"`",
        ),
        (
            "a text without quotes",
            board("rows: [(at_mm: (0, 0), keys: Enter)]"),
            "3:30: expected a text in quotes: `\"Enter\"`",
        ),
        (
            "a list for a text",
            board("rows: [(at_mm: (0, 0), keys: [\"Q\", \"W\"])]"),
            "3:30: expected one text in quotes, not a list: `\"…\"`",
        ),
        (
            "a value in quotes",
            layout("").replace("elbow", "\"elbow\""),
            "1:44: write `elbow` without quotes",
        ),
    ]
}

fn numbers() -> Vec<Mistake> {
    let row = "rows: [(at_mm: (0, 0), keys: \"Q W\")]";
    vec![
        (
            "a decimal comma",
            board(&format!("pitch_mm: 19,5,\n{row}")),
            "3:14: a decimal point is `.`, not `,`: `19.5`",
        ),
        (
            "a decimal comma in a position",
            board("rows: [(at_mm: (0,5, 3), keys: \"Q\")]"),
            "3:22: expected `)`: there are more values than this field has; a decimal point is `.`, as in `3.5`",
        ),
        (
            "a unit",
            board(&format!("pitch_mm: 19mm,\n{row}")),
            "3:13: a number is written without its unit, which is in the name of the field",
        ),
        (
            "a sign of degrees",
            board(&format!("pitch_mm: 19°,\n{row}")),
            "3:13: a number is written without its unit, which is in the name of the field",
        ),
        (
            "a calculation",
            board(&format!("pitch_mm: 38/2,\n{row}")),
            "3:13: write the result of the calculation",
        ),
        (
            "a number in quotes",
            board(&format!("pitch_mm: \"19\",\n{row}")),
            "3:11: expected a number, without quotes",
        ),
        (
            "a number out of range",
            board(&format!("pitch_mm: 0.019,\n{row}")),
            "3:11: 0.019 is out of range: a pitch is 1 to 500 mm",
        ),
        (
            "a position with one number",
            key("code: \"A\", at_mm: (5)"),
            "4:21: expected 2 values in parentheses, found 1",
        ),
        (
            "a position without parentheses",
            key("code: \"A\", at_mm: 5"),
            "4:19: expected fields in parentheses: `(…)`",
        ),
        (
            "a position in brackets",
            key("code: \"A\", at_mm: [5, 5]"),
            "4:19: expected fields in parentheses: `(…)`, not `[…]`",
        ),
        (
            "a size without a name",
            key("code: \"A\", at_mm: (0, 0), size_mm: (17, 17)"),
            "4:36: expected a name before the parentheses, one of: Box, Disc; such as `Box(17, 17)`",
        ),
        (
            "a size of one number",
            key("code: \"A\", at_mm: (0, 0), size_mm: 17"),
            "4:36: expected one of: Box, Disc",
        ),
        (
            "a box of one number",
            key("code: \"A\", at_mm: (0, 0), size_mm: Box(17)"),
            "4:42: expected 2 values in parentheses, found 1",
        ),
        (
            "a radius without its name",
            board(&format!("shape: Arc(300),\n{row}")),
            "3:12: expected a field with its name: `radius_mm: 300`",
        ),
        (
            "`True`",
            board(&format!("reports_depth: True,\n{row}")),
            "3:16: expected `true` or `false`",
        ),
    ]
}

fn names() -> Vec<Mistake> {
    let row = "rows: [(at_mm: (0, 0), keys: \"Q W\")]";
    vec![
        (
            "a misspelled field",
            board("row: []"),
            "3:1: unknown field `row`, did you mean `rows`?",
        ),
        (
            "a field that does not exist",
            board(&format!("colour: 3,\n{row}")),
            super::layouts::with_board_fields("3:1: unknown field `colour`, expected one of: "),
        ),
        (
            "a field in capitals",
            board(row).replace("name", "Name"),
            "1:8: unknown field `Name`, did you mean `name`?",
        ),
        (
            "a field of the wrong level",
            board("rows: [(at_mm: (0, 0), keys: \"Q W\", travel_mm: 3)]"),
            "3:37: unknown field `travel_mm` in `rows`: it is a field of `boards`, `keys`, `joysticks`",
        ),
        (
            "a misspelled value",
            board(&format!("shape: flat,\n{row}")),
            "3:8: unknown value `flat`, did you mean `Flat`?",
        ),
        (
            "a misspelled key",
            board("rows: [(at_mm: (0, 0), keys: \"Q Entre\")]"),
            "3:33: unknown key `Entre`, did you mean `Enter`?",
        ),
        (
            "a key that no name is near",
            board("rows: [(at_mm: (0, 0), keys: \"Q Zzyzx\")]"),
            "3:33: unknown key `Zzyzx`; `ademan layout keys` lists all keys",
        ),
        (
            "keys without blanks",
            board("rows: [(at_mm: (0, 0), keys: \"ZXCV\")]"),
            "3:31: unknown key `ZXCV`; keys are separated by blanks, as in `Z X C V`; `ademan layout keys` lists all keys",
        ),
        (
            "a character in place of a key",
            board("rows: [(at_mm: (0, 0), keys: \"Q €\")]"),
            "3:33: unknown key `€`; `action: Text(\"€\")` types this character; `ademan layout keys` lists all keys",
        ),
        (
            "keys with commas",
            board("rows: [(at_mm: (0, 0), keys: \"Q, W, E\")]"),
            "3:31: `Q,` is not a key: keys are separated by blanks, not by commas",
        ),
        (
            "a combination of keys",
            key("code: \"Ctrl+V\", at_mm: (0, 0)"),
            "4:8: `Ctrl+V` is a combination of keys, not a key: `sequences: {\"NAME\": [Tap(\"Ctrl V\")]}` presses it, \
             and a key with `action: Sequence(\"NAME\")` starts it",
        ),
        (
            "a key of another program",
            key("code: \"Super_L\", at_mm: (0, 0)"),
            "4:8: unknown key `Super_L`, did you mean `MetaLeft`?",
        ),
        (
            "an unknown layer",
            key("layer: \"symbols\", at_mm: (0, 0)"),
            "4:9: unknown layer `symbols`",
        ),
        (
            "a layer for a key that is not there",
            layout("layers: [(name: \"x\", keys: {\"E\": \"1\"})]"),
            "2:30: this layout has no such key: unknown key `E`",
        ),
        (
            "a label for a key that is not there",
            layout("labels: {\"Qu\": \"q\"}"),
            "2:11: this layout has no such key: unknown key `Qu`, did you mean `Q`?",
        ),
    ]
}

fn structure() -> Vec<Mistake> {
    vec![
        (
            "a missing field",
            key("code: \"A\""),
            "5:1: the field `at_mm` is missing",
        ),
        (
            "a field twice",
            key("code: \"A\", at_mm: (0, 0), code: \"B\""),
            "4:27: duplicate field `code`",
        ),
        (
            "a map for a list",
            layout("layers: {\"x\": {\"Q\": \"1\"}}"),
            "2:9: expected a list: `[…]`, not `{…}`",
        ),
        (
            "a key without action",
            key("at_mm: (0, 0)"),
            "5:1: the key has none of `code`, `layer` and `action`",
        ),
        (
            "a hold that is a text",
            key("code: \"A\", at_mm: (0, 0), hold: \"ControlLeft\""),
            "4:33: expected fields in parentheses: `(…)`",
        ),
        (
            "an action that is a text",
            key("name: \"hi\", action: \"hi\", at_mm: (0, 0)"),
            "4:21: expected one of these names, without quotes: Key, Layer, Text, Multitap, Sequence, Command, Clutch, Precision, NoOp",
        ),
        (
            "no boards",
            "Layout(name: \"t\")".into(),
            "1:15: the layout has no keys and no other controls, add `boards`",
        ),
        (
            "a board without keys",
            board("pitch_mm: 19"),
            "1:15: board 1 has no keys",
        ),
    ]
}

fn meaning() -> Vec<Mistake> {
    vec![
        (
            "a key twice",
            board("rows: [(at_mm: (0, 0), keys: \"Q W Q\")]"),
            "3:35: duplicate name `Q`: there is a key with this name in line 3, list it in `keys` with another `name`",
        ),
        (
            "keys that overlap",
            board("rows: [(at_mm: (0, 0), keys: \"Q W\", pitch_mm: 10)]"),
            "3:33: the key `W` overlaps the key `Q` of line 3 by 7 mm",
        ),
        (
            "a press point below the release point",
            key("code: \"A\", at_mm: (0, 0), press_at: 0.2"),
            "4:8: press_at 0.2 of the key `A` must be greater than release_at 0.25",
        ),
        (
            "a latch of a letter",
            key("code: \"A\", at_mm: (0, 0), latch: Lock"),
            "4:8: `A` cannot have a latch, only modifiers and layers can",
        ),
        (
            "a chord of one key",
            layout("chords: [(keys: \"Q\", action: Key(\"A\"))]"),
            "2:18: a chord has 2 to 10 keys, this one has 1",
        ),
        (
            "thresholds that are equal",
            layout(
                "triggers: [(name: \"t\", when: Pinch(finger: \"index\", on_mm: 20, off_mm: 20), action: Key(\"A\"))]",
            ),
            "2:20: the trigger `t` turns on and off at 20, set different values for on_mm and off_mm",
        ),
        (
            "the thumb pinching itself",
            layout("triggers: [(name: \"t\", when: Pinch(finger: \"thumb\"), action: Key(\"A\"))]"),
            "2:45: the thumb pinches with another finger, name that finger",
        ),
        (
            "a text that is too long",
            key(&format!(
                "name: \"long\", action: Text(\"{}\"), at_mm: (0, 0)",
                "x".repeat(33)
            )),
            "4:29: a key types at most 32 characters, not 33",
        ),
    ]
}

#[test]
fn each_mistake_has_a_message_that_names_it() {
    let mut wrong = Vec::new();
    println!("| mistake | message |\n|---|---|");
    for (kind, text, expected) in mistakes() {
        let message = match Layout::parse(&text, "t.ron") {
            Ok(_) => "no error".to_owned(),
            Err(error) => error.to_string(),
        };
        let first = message.lines().next().unwrap_or_default();
        let first = first.strip_prefix("t.ron:").unwrap_or(first);
        println!("| {kind} | {} |", first.replace('|', "\\|"));
        if first != expected {
            wrong.push(format!("{kind}: {first:?}, not {expected:?}"));
        }
    }
    assert!(wrong.is_empty(), "{}", wrong.join("\n"));
    assert!(mistakes().len() >= 46);
}

#[test]
fn all_mistakes_of_a_file_are_reported_at_once_in_the_order_of_the_file() {
    let text = "Layout(name: \"t\", boards: [\n(pose: (anchor: elbow, height: 3), pitch_mm: 0,\nrows: [(at_mm: (0, 0), keys: \"Q W\", \
                travel_mm: 3),\n(at_mm: (0, inf), keys: \"E\")],\nkeys: [(code: \"A\", at_mm: (0, 9), latch: Lokc, size_mm: (17, 17)),\n\
                (code: \"B\"),\n(code: \"C\", at_mm: (0, 9), hold: ())])])";
    assert_eq!(
        lines(text),
        [
            "2:24: unknown field `height`, did you mean `height_mm`?",
            "2:46: 0 is out of range: a pitch is 1 to 500 mm",
            "3:37: unknown field `travel_mm` in `rows`: it is a field of `boards`, `keys`, `joysticks`",
            "4:13: inf is out of range: an offset is -2000 to 2000 mm",
            "5:42: unknown value `Lokc`, did you mean `Lock`?",
            "5:57: expected a name before the parentheses, one of: Box, Disc; such as `Box(17, 17)`",
            "6:11: the field `at_mm` is missing",
            "7:35: the hold has neither a `code` nor a `layer`",
        ]
    );
    let layered = layout(
        "labels: {\"E\": \"e\"}, layers: [(name: \"x\", keys: {\"Q\": \"Entre\", \"W\": \"Entre\"})],\nchords: [(keys: \"Q\", action: Key(\"A\"))]",
    );
    let layered = layered.replace("Q W\"", "Q W Entre W Tba\", pitch_mm: 25");
    assert_eq!(
        lines(&layered),
        [
            "1:86: unknown key `Entre`, did you mean `Enter`? (also in line 2)",
            "1:92: duplicate name `W`: there is a key with this name in line 1, list it in `keys` with another `name`",
            "1:94: unknown key `Tba`, did you mean `Tab`?",
            "2:11: this layout has no such key: unknown key `E`",
            "3:18: a chord has 2 to 10 keys, this one has 1",
        ]
    );
}

#[test]
fn a_value_with_a_name_is_one_error() {
    let position = key("code: \"A\", at_mm: (x: 0, y: 0)");
    assert_eq!(lines(&position), ["4:20: expected a number"]);
    let action = key("action: Key(code: \"A\"), name: \"a\", at_mm: (0, 0)");
    assert_eq!(
        lines(&action),
        ["4:13: expected a text in quotes: `\"code\"`"]
    );
}

#[test]
fn an_error_that_follows_from_another_one_is_not_reported() {
    let text = layout(
        "layers: [(name: \"x\", keys: {\"Entre\": \"1\", \"Q\": \"2\"})], labels: {\"Entre\": \"e\"}",
    );
    let text = text.replace("Q W\"", "Entre\"").replace("\"Q\": \"2\"", "");
    assert_eq!(
        lines(&text),
        ["1:82: unknown key `Entre`, did you mean `Enter`?"]
    );
    let sequence = |key: &str, steps: &str| {
        let first =
            format!("(name: \"a\", when: HandShape(name: \"fist\"), action: Key(\"{key}\"))");
        let second = "(name: \"b\", when: HandShape(name: \"open-hand\"))";
        let third = format!("(name: \"s\", when: Sequence(steps: [{steps}]), action: Key(\"A\"))");
        lines(&layout(&format!(
            "triggers: [{first},\n{second},\n{third}]"
        )))
    };
    assert_eq!(
        sequence("Entre", "\"a\", \"b\""),
        ["2:68: unknown key `Entre`, did you mean `Enter`?"]
    );
    assert_eq!(
        sequence("Enter", "\"b\", \"s\""),
        ["4:42: unknown trigger before the sequence `s`"]
    );
}

#[test]
fn at_most_20_errors_are_listed_and_many_are_not_slow() {
    let keys: String = (0..5000).map(|n| format!("Key{n} ")).collect();
    let lines = lines(&board(&format!(
        "rows: [(at_mm: (0, 0), keys: \"{keys}\")]"
    )));
    assert_eq!(lines.len(), 21);
    assert_eq!(lines[20], " 283 more errors");
}

#[test]
fn a_board_that_is_pressed_by_bending_has_one_key_for_each_finger_and_its_hand_no_other_board() {
    let bend = |fields: &str, rest: &str| {
        format!(
            "Layout(name: \"t\", boards: [(contact: Bend, pose: (anchor: elbow),\n{fields})\n{rest}])"
        )
    };
    let key = |finger: &str, x: u32| {
        format!("(code: \"{x}\", finger: \"{finger}\", at_mm: ({x}0, 0), size_mm: Box(5, 5)),")
    };
    let index = format!("keys: [{}]", key("index", 1));
    let touched = ", (pose: (anchor: elbow), rows: [(at_mm: (0, 0), keys: \"Q\")])";
    let second = ", (contact: Bend, hand: \"left\", pose: (anchor: elbow),\nkeys: [(code: \"Q\", finger: \"index\", at_mm: (0, 0))])";
    let twice = format!("keys: [{}{}]", key("index", 1), key("index", 2));
    let without = "keys: [(code: \"Q\", at_mm: (0, 0))]";
    let rows = "rows: [(at_mm: (0, 0), keys: \"Q\")]";
    let right = format!("hand: \"right\", {index}");
    assert!(Layout::parse(&bend(&right, second), "t.ron").is_ok());
    for (text, message) in [
        (bend(&twice, ""), "the second one of the index finger"),
        (bend(without, ""), "each with a `finger`"),
        (bend(rows, ""), "each with a `finger`"),
        (bend(&index, touched), "for the other `hand`"),
        (bend(&index, second), "for the other `hand`"),
    ] {
        let found = lines(&text);
        assert!(
            found.len() == 1 && found[0].contains(message),
            "{text}: {found:?}"
        );
    }
}

#[test]
fn a_chord_of_a_layer_has_one_action_and_no_activation_of_its_own() {
    for (chords, message) in [
        (
            "(keys: \"Q W\", action: Key(\"A\")), (keys: \"W Q\", action: Key(\"B\"))",
            "duplicate chord in the layer `x`",
        ),
        (
            "(keys: \"Q W\", action: Key(\"A\"), hold: (code: \"B\"))",
            "for all layers",
        ),
        ("(keys: \"Q W\", action: Layer(\"y\"))", "unknown layer `y`"),
    ] {
        let found = lines(&layout(&format!(
            "layers: [(name: \"x\", keys: {{}}, chords: [{chords}])]"
        )));
        assert!(found.len() == 1 && found[0].contains(message), "{found:?}");
    }
}

/// The first line of each error, without the file.
fn lines(text: &str) -> Vec<String> {
    let error = Layout::parse(text, "t.ron").expect_err("the layout is wrong");
    let lines = error.to_string();
    let lines = lines.lines().filter_map(|line| line.strip_prefix("t.ron:"));
    lines.map(str::to_owned).collect()
}
