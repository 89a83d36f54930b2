use super::*;

/// A line with the smallest accepted values of all fields.
fn smallest(spec: &CommandSpec) -> String {
    let mut line = format!(r#"{{"command":"{}""#, spec.name);
    for field in spec.fields {
        line += &match field.kind {
            FieldKind::Number { min, .. } => format!(r#","{}":{min}"#, field.name),
            FieldKind::Whole { min, .. } => format!(r#","{}":{min}"#, field.name),
            FieldKind::Name => format!(r#","{}":"sofa""#, field.name),
            FieldKind::OneOf(words) => format!(r#","{}":"{}""#, field.name, words[0]),
        };
    }
    line + "}"
}

fn error(text: &str) -> String {
    Command::from_json(text).unwrap_err().to_string()
}

#[test]
fn every_command_is_listed_and_survives_a_round_trip() {
    for spec in SPECS {
        let command = Command::from_json(&smallest(spec)).unwrap();
        assert_eq!(command.name(), spec.name);
        assert_eq!(command.spec().name, spec.name);
        assert_eq!(command.check(), Ok(()));
        let json = serde_json::to_string(&command).unwrap();
        assert_eq!(Command::from_json(&json), Ok(command));
        assert_eq!(command.to_string().parse(), Ok(command));
    }
}

#[test]
fn json_is_compact_and_keeps_decimal_fractions() {
    let nudge = Command::Nudge {
        x_mm: 0.0,
        y_mm: -1.5,
        z_mm: 0.1,
    };
    assert_eq!(
        serde_json::to_string(&nudge).unwrap(),
        r#"{"command":"nudge","x_mm":0.0,"y_mm":-1.5,"z_mm":0.1}"#
    );
    assert_eq!(nudge.to_string(), "nudge 0 -1.5 0.1");
}

#[test]
fn invalid_commands_are_explained() {
    let table = [
        (
            r#"{"command":"paus"}"#,
            "unknown command `paus`, did you mean `pause`?",
        ),
        (
            r#"{"comand":"pause"}"#,
            "unknown field `comand`, did you mean `command`?",
        ),
        (
            "{}",
            "the field `command` is missing; write a command such as",
        ),
        (
            r#"{"command":"pause","deg":1}"#,
            "`pause` has no field `deg`",
        ),
        (
            r#"{"command":"save","name":"x"}"#,
            "`save` has no field `name`",
        ),
        (r#"{"command":"tilt"}"#, "`tilt` needs the field `deg`"),
        (
            r#"{"command":"profile"}"#,
            "`profile` needs the field `name`",
        ),
        (
            r#"{"command":"scale","factor":0}"#,
            "`factor` is 0.5 to 2, not 0",
        ),
        (
            r#"{"command":"scale","factor":3.0}"#,
            "`factor` is 0.5 to 2, not 3",
        ),
        (
            r#"{"command":"tilt","deg":1e308}"#,
            "`deg` is -90 to 90, not 1e+308",
        ),
        (
            r#"{"command":"tilt","deg":1e999}"#,
            "not a command: number out of range at line 1",
        ),
        (
            r#"{"command":"tilt","deg":"1"}"#,
            "`deg` is -90 to 90, not \"1\"",
        ),
        (
            r#"{"command":"pause","command":"stop"}"#,
            "not a command: duplicate field `command`",
        ),
        (
            r#"{"command":"tilt","deg":1,"deg":2}"#,
            "not a command: duplicate field `deg`",
        ),
        ("", "not a command: EOF while parsing a value"),
        (
            "[1]",
            "not a command: invalid type: sequence, expected a map",
        ),
        (
            r#"{"command":"state"}{"command":"stop"}"#,
            "not a command: trailing characters",
        ),
    ];
    for (text, expected) in table {
        let error = error(text);
        assert!(error.starts_with(expected), "{text}: {error}");
    }
    let long = format!(r#"{{"command":"profile","name":"{}"}}"#, "x".repeat(65));
    assert!(error(&long).starts_with("`name` is a name of at most 64 bytes, not"));
}

#[test]
fn a_number_out_of_range_is_refused_also_if_it_was_not_parsed() {
    let error = |command: Command| command.check().unwrap_err().to_string();
    let tilt = error(Command::Tilt { deg: 91.0 });
    assert_eq!(tilt, "`deg` is -90 to 90, not 91");
    let scale = error(Command::Scale { factor: 2.1 });
    assert_eq!(scale, "`factor` is 0.5 to 2, not 2.1");
    assert!(Command::Scale { factor: f32::NAN }.check().is_err());
}

#[test]
fn invalid_words_are_explained() {
    for (text, expected) in [
        ("paus", "unknown command `paus`, did you mean `pause`?"),
        ("", "unknown command ``"),
        ("nudge 1 2", "`nudge` needs the field `z_mm`"),
        ("tilt steep", "`deg` is -90 to 90, not \"steep\""),
        ("scale 3", "`factor` is 0.5 to 2, not 3"),
        ("pause now", "`pause` has no argument `now`"),
    ] {
        let error = text.parse::<Command>().unwrap_err();
        assert_eq!(error.to_string(), expected);
    }
    let profile: Command = "profile  my layout ".parse().unwrap();
    assert_eq!(profile.to_string(), "profile my layout");
}

#[test]
fn deeply_nested_json_is_refused() {
    for deep in ["[", "{\"command\":", "{\"deg\":["] {
        error(&deep.repeat(4096 / deep.len()));
    }
}

#[test]
fn the_words_and_whole_numbers_of_text_commands_are_checked() {
    assert_eq!(
        "text auto".parse(),
        Ok(Command::Text {
            mode: TextMode::Auto
        })
    );
    assert_eq!("candidate 2".parse(), Ok(Command::Candidate { number: 2 }));
    let names: Vec<&str> = TextMode::ALL.iter().map(|mode| mode.name()).collect();
    assert_eq!(names, TextMode::NAMES);
    for (line, expected) in [
        (
            "text loud",
            "`mode` is `literal`, `suggest`, `auto`, not \"loud\"",
        ),
        ("candidate 4", "`number` is a whole number, 1 to 3, not 4"),
        (
            "candidate 1.5",
            "`number` is a whole number, 1 to 3, not 1.5",
        ),
    ] {
        let error = line.parse::<Command>().unwrap_err().to_string();
        assert_eq!(error, expected);
    }
}
