//! Messages and exit codes for wrong use: what failed, why, what to do; exit code 2.

use super::{ademan, file, run, run_to_end};

/// Runs a command line and asserts the exit code 2 and parts of the message.
fn refused(line: &str, words: &[&str]) {
    refused_with(2, line, words);
}

fn refused_with(code: i32, line: &str, words: &[&str]) {
    let ended = run(line.split(' '));
    let expected = Some(code);
    assert_eq!(ended.code, expected, "`{line}`: {}{}", ended.out, ended.err);
    for word in words {
        assert!(
            ended.err.contains(word),
            "`{line}` does not print {word:?}: {}",
            ended.err
        );
    }
    assert!(!ended.err.contains("panicked"), "{}", ended.err);
}

#[test]
fn an_output_without_a_required_capability_is_refused_before_the_source_is_opened() {
    let folder = tempfile::tempdir().unwrap();
    let board =
        "[(pose: (anchor: elbow), rows: [(at_mm: (0, 0), keys: \"A PadSouth MouseLeft\")])]";
    let layout = format!("Layout(name: \"pad\", boards: {board})");
    let layout = file(&folder, "pad.ron", layout);
    let run = format!("run --source serial:/dev/nope --layout {layout} --output");
    let reason = "the layout requires `PadSouth`, which `desktop` does not support";
    refused(
        &format!("{run} desktop"),
        &[reason, "add the output `uinput`: `desktop,uinput`"],
    );
    refused(&format!("{run} transcript,desktop"), &[reason]);
    refused(
        &format!("{run} none,desktop,none,desktp"),
        &["did you mean `desktop`?"],
    );
}

#[test]
fn arguments_of_a_wrong_kind_are_named_and_what_exists_is_listed() {
    let number = "this is not a number; write one such as 2.5 or -5";
    refused(
        "ctl nudge a b c",
        &["invalid value 'a' for '<x_mm>'", number],
    );
    refused(
        "ctl nudge 0 0 -5cm",
        &["invalid value '-5cm' for '<z_mm>'", number],
    );
    for text in ["NaN", "inf", "1e400"] {
        refused(&format!("ctl scale {text}"), &[number]);
    }
    let all =
        "`serial:`, `tcp:`, `tcp+tls:`, `udp:`, `ws:`, `headset:`, `zenoh:`, `openxr:`, `file:`";
    refused("run --source typst", &[all, "did you mean `typist:…`?"]);
    refused("run --source zzz:a", &["available: serial, tcp"]);
    refused(
        "run --source file:x?protocol=zzz",
        &["available: hc11, text-line"],
    );
    refused(
        "run --source typist:a --output zzz",
        &["available: transcript"],
    );
    refused(
        "layout keys Spaec",
        &["no key has `Spaec`", "did you mean `Space`?"],
    );
    refused(
        "run --source typist:a --decoder auto:fr",
        &["unknown language `fr`; the languages are `en` and `es`"],
    );
    for script in ["", " "] {
        let ended = run(["demo", "--script", script]).exited(2);
        ended.reported("the script is empty; name a file, or write an action such as `tap NAME`");
    }
}

#[test]
fn keys_are_found_by_alias_code_and_character() {
    let keys = |word: &str| run(["layout", "keys", word]).done().out;
    assert!(
        keys("vol").contains("AudioVolumeUp                115  123  XF86AudioRaiseVolume  VolUp"),
        "{}",
        keys("vol")
    );
    assert!(keys("lmb").contains("MouseLeft"), "{}", keys("lmb"));
    assert!(keys(";").contains("Semicolon"), "{}", keys(";"));
    assert!(keys("57").contains("Space"), "{}", keys("57"));
    assert!(keys("hash").contains("\n3 "), "{}", keys("hash"));
    assert!(keys("tilde").contains("Backquote"), "{}", keys("tilde"));
    let json = run(["layout", "keys", "Win", "--json"]).done().out;
    let json: serde_json::Value = serde_json::from_str(&json).unwrap();
    assert_eq!(json[0]["name"], "MetaLeft");
    assert_eq!(
        (&json[0]["evdev"], &json[0]["x11"]),
        (&125.into(), &133.into())
    );
    assert_eq!(json[0]["keysym"], "Super_L");
}

#[test]
fn the_fields_of_layouts_are_found_by_structure_and_by_name() {
    let fields = |word: &str| run(["layout", "fields", word]).done().out;
    let slider = fields("SLIDER");
    assert!(slider.starts_with("Slider: "), "{slider}");
    let length = slider.lines().find(|line| line.contains("length_mm"));
    let length: Vec<&str> = length.expect("a row").split_whitespace().collect();
    assert_eq!(
        length[..6],
        ["length_mm", "required", "1", "to", "500", "mm"]
    );
    let named = fields("dead_zone");
    for structure in ["Joystick: ", "Pointer: ", "PointingMode: "] {
        assert!(named.contains(structure), "{structure}\n{named}");
    }
    let json = run(["layout", "fields", "knob", "--json"]).done().out;
    let tables: Vec<serde_json::Value> = serde_json::from_str(&json).expect("JSON");
    assert_eq!(tables.len(), 1);
    assert_eq!(tables[0]["name"], "Knob");
    let refused = run(["layout", "fields", "slidr"]).exited(2);
    refused.reported("did you mean");
}

#[test]
fn a_program_built_for_x11_refuses_a_wayland_session() {
    let mut run = ademan(["run", "--output", "desktop", "--source", "typist:hi"]);
    // There might be an X server beside the compositor.
    run.env("WAYLAND_DISPLAY", "/nowhere/wayland-0")
        .env("DISPLAY", ":0");
    let ended = run_to_end(&mut run).exited(2);
    let words = if !ademan::output::SUPPORTS_WAYLAND {
        "was built for X11, whose keys do not reach Wayland programs; build it with \
              `--features wayland`, or use the output `uinput`; to type only in X11 programs, unset \
              WAYLAND_DISPLAY"
    } else {
        "no compositor answers at /nowhere/wayland-0"
    };
    ended.reported(words);
}

#[test]
fn invalid_sources_are_refused_with_a_remedy() {
    let cases: [(&str, &[&str]); 21] = [
        ("run", &["no source is given", "--source", "typist:hello"]),
        ("trace readings", &["no source is given"]),
        ("run --source foo", &["starts with one of", "`serial:`"]),
        ("run --source serail:x", &["did you mean `serial`?"]),
        (
            "run --source serial:",
            &["`serial:` is followed by nothing"],
        ),
        (
            "run --source /dev/ttyUSB0",
            &["write `serial:/dev/ttyUSB0`"],
        ),
        (
            "run --source 192.168.1.7:4001",
            &["write `tcp:192.168.1.7:4001`"],
        ),
        ("run --source hand.mcap", &["write `recording:hand.mcap`"]),
        (
            "run --source serial:/dev/nope",
            &["cannot open", "there is no such port"],
        ),
        (
            "run --source serial:/dev/x?bod=9600",
            &["did you mean `baud`?"],
        ),
        ("run --source serial:/dev/x?baud=fast", &["`baud=115200`"]),
        (
            "run --source udp:127.0.0.1:9000?protocol=vmc&hand=left",
            &["packets have both arms; `other_hand` in the setup"],
        ),
        (
            "run --source file:/nope",
            &["cannot open file:/nope", "No such file"],
        ),
        ("run --source file:/", &["this is a directory"]),
        (
            "run --source tcp:127.0.0.1:1",
            &["check that the server is on"],
        ),
        ("run --source tcp:here", &["write `tcp:HOST:PORT`"]),
        (
            "run --source tcp:127.0.0.1:1 --role keybord",
            &["[possible values: pointer, keys, both]"],
        ),
        (
            "run --source recording:/nope",
            &["cannot open recording:/nope"],
        ),
        ("run --source typist:é", &["cannot type 'é'"]),
        (
            "run --source script:tap;tap",
            &["script:1:1: NAME is missing after this", "`tap NAME [X Y]`"],
        ),
        (
            "run --source script:no.txt",
            &["no.txt: there is no such file"],
        ),
    ];
    for (line, words) in cases {
        refused(line, words);
    }
}

#[test]
fn wrong_names_are_refused_with_the_valid_ones() {
    let cases: [(&str, &[&str]); 18] = [
        ("frob", &["unrecognized subcommand 'frob'"]),
        (
            "trace angels --source typist:a",
            &["readings, angles, pose, touches, presses, events, commands"],
        ),
        (
            "run --source typist:a --layout nunpad",
            &["did you mean `numpad`?"],
        ),
        (
            "run --source typist:a --layout /",
            &["directory, name a file in it"],
        ),
        (
            "run --source typist:a --layout no.ron",
            &["no.ron: there is no such file"],
        ),
        (
            "run --source typist:a --glove no",
            &[
                "no: there is no such file",
                "`ademan gloves` lists the names",
            ],
        ),
        (
            "run --source typist:a --output desktp",
            &["did you mean `desktop`?"],
        ),
        (
            "run --source typist:a --output desktop",
            &["DISPLAY is not set", "uinput"],
        ),
        (
            "run --source typist:a --output none:x",
            &["the output `none:x` takes no argument; available: transcript"],
        ),
        (
            "run --source typist:a --output transcript:/no/x",
            &["`transcript:/no/x`", "No such file"],
        ),
        (
            "run --source typist:a --record /no/x.mcap",
            &["cannot create the recording /no/x.mcap"],
        ),
        (
            "run no.ron",
            &["no.ron: there is no such file; `ademan setup new NAME` writes a setup"],
        ),
        (
            "run qwerty-arc",
            &["expected `Setup(…)`, found `Layout`; `--layout` names a layout"],
        ),
        ("replay /nope", &["cannot open recording:/nope"]),
        ("replay /", &["this is a directory, name a file in it"]),
        ("layout show arrow", &["did you mean `arrows`?"]),
        (
            "layout show arrows --svg /no/x.svg",
            &["cannot write /no/x.svg"],
        ),
        ("completions tcsh", &["possible values", "bash"]),
    ];
    for (line, words) in cases {
        refused(line, words);
    }
}

#[test]
fn the_demo_refuses_what_it_cannot_type() {
    let cases: [(&str, &[&str]); 8] = [
        ("demo --text é", &["cannot type 'é'", "US keymap"]),
        (
            "demo --text x --layout numpad",
            &["cannot type 'x'", "has the key X"],
        ),
        ("demo --baud 0", &["1200"]),
        ("demo --noise -1", &["0 to 50 counts"]),
        ("demo --text=", &["nothing to type"]),
        ("demo --text a --script lift", &["cannot be used with"]),
        ("demo --script tap;Q", &["script:1:1: ", "tap;Q\n", "^^^"]),
        (
            "demo --layout arrows --script tap\tQ",
            &["script:1:5: unknown target `Q`"],
        ),
    ];
    for (line, words) in cases {
        refused(line, words);
    }
}

#[test]
fn errors_in_a_setup_name_the_file_and_the_position() {
    let folder = tempfile::tempdir().unwrap();
    let cases: [(&str, &[&str]); 6] = [
        (
            "Setup(\n    layuot: \"arrows\",\n)",
            &["bad.ron:2:5:", "did you mean `layout`?", "^^^^^^"],
        ),
        (
            "Setup(source: \"tpyist:a\")",
            &["bad.ron:1:16:", "did you mean `typist`?"],
        ),
        (
            "Setup(source: \"typist:a\"",
            &["bad.ron:1:", "the `(` is not closed"],
        ),
        (
            "Setup(stall_timeout_ms: 5)",
            &["bad.ron:1:25: ", "`stall_timeout_ms` is 20 to 10000, not 5"],
        ),
        (
            "Setup(arm: Measured(hand_length_mm: 1, forearm_length_mm: 250))",
            &["bad.ron:1:12: ", "100 to 300 mm"],
        ),
        (
            "Setup(smoothing: OneEuro(min_cutoff_hz: 0, beta: 0, derivative_cutoff_hz: 1))",
            &["bad.ron:1:18: ", "0.001 to 10000 Hz"],
        ),
    ];
    for (content, words) in cases {
        let path = file(&folder, "bad.ron", content);
        refused(&format!("run {path}"), words);
    }
}

#[test]
fn all_invalid_values_of_a_setup_are_reported_at_once() {
    let folder = tempfile::tempdir().unwrap();
    let setup = "Setup(\n    panic_keys: [\"Foo\"],\n    max_presses_per_second: 0,\n    stall_timeout_ms: 5,\n    desktop_part: (left: 0.5, right: 0.5),\n)";
    let path = file(&folder, "bad.ron", setup);
    let errors = [
        "bad.ron:2:18: `panic_keys`: unknown key `Foo`",
        "bad.ron:3:29: `max_presses_per_second` is 1 to 1000, not 0",
        "bad.ron:4:23: `stall_timeout_ms` is 20 to 10000, not 5",
        "bad.ron:5:19: `desktop_part`: its edges are fractions of the desktop",
    ];
    refused(&format!("run {path}"), &errors);
}

#[test]
fn files_other_than_recordings_are_refused() {
    let folder = tempfile::tempdir().unwrap();
    let empty = file(&folder, "empty.mcap", "");
    refused_with(3, &format!("replay {empty}"), &["the file is empty"]);
    refused(
        &format!("record {empty} --source typist:a"),
        &["the file exists"],
    );
    for command in ["record --source typist:a", "run --source typist:a --record"] {
        let ended = run(command.split(' ').chain([empty.as_str()]));
        ended.reported("the file exists");
        assert!(!ended.err.contains("recording to"), "{}", ended.err);
    }
    let text = file(&folder, "text.mcap", "this is a letter, not a recording");
    refused_with(3, &format!("replay {text}"), &["it is not an MCAP file"]);
}

#[test]
fn a_check_counts_what_a_layout_without_keys_has() {
    let checked = run(["layout", "check", "space", "direct", "claws"]).done();
    for line in [
        "space: valid, 0 keys, 4 targets in space, 1 layer\n",
        "direct: valid, 0 keys, 1 pointer, 1 layer\n",
        " triggers, 1 layer\n",
    ] {
        assert!(checked.out.contains(line), "{line}: {}", checked.out);
    }
}

#[test]
fn all_layouts_are_checked_even_after_an_invalid_one() {
    let folder = tempfile::tempdir().unwrap();
    let wrong = file(&folder, "wrong.ron", "Layout(\n    nmae: \"x\",\n)");
    let ended = run(["layout", "check", &wrong, "numpad", "nope", "arrows"]).exited(2);
    assert_eq!(
        ended.out,
        "numpad: valid, 17 keys, 1 layer\narrows: valid, 4 keys, 1 layer\n"
    );
    ended.reported("wrong.ron:2:5: unknown field `nmae`");
    ended.reported("nope: there is no such file");
    assert!(
        ended.err.ends_with("error: 2 of 4 files cannot be used\n"),
        "{}",
        ended.err
    );
}

#[test]
fn the_program_without_arguments_prints_its_help() {
    let ended = run([""; 0]).exited(2);
    ended.reported("Start with `ademan demo`");
}

#[test]
fn a_field_with_an_error_in_it_is_not_said_to_be_missing() {
    let folder = tempfile::tempdir().unwrap();
    let pointer = "pointer: Pointer(\nmode: Direct(\npose: (anchor: elbow),\nsize_mm: (200, 120)\n),\n\
                   clicks: [(gesture: Pinch(\"pinky\"), action: Key(\"MouseLeft\"))]\n)";
    let layout = format!("Layout(name: \"two\", boards: [],\n{pointer}\n)");
    let layout = file(&folder, "two.ron", layout);
    let ended = run(["layout", "check", &layout]).exited(2);
    let first = "5:19: expected 3 values in parentheses, found 2";
    let second = "7:27: unknown finger `pinky`";
    for fault in [first, second] {
        ended.reported(fault);
    }
    assert!(!ended.err.contains("is missing"), "{}", ended.err);
}

#[test]
fn one_port_for_two_sources_is_refused_with_the_remedy() {
    let folder = tempfile::tempdir().unwrap();
    for (protocol, remedy) in [
        ("vmc", "name it once, as it shows both hands"),
        ("text-line", "give each source a port of its own"),
    ] {
        let source = format!("udp:127.0.0.1:7001?protocol={protocol}");
        let setup = format!(
            "Setup(source: \"{source}\", other_hand: (source: \"{source}&delay_ms=3\", role: Both), layout: \"qwerty-two-flat\")"
        );
        let setup = file(&folder, "setup.ron", setup);
        for command in ["run", "doctor"] {
            let ended = run([command, &setup]);
            assert_eq!(ended.code, Some(2), "{command}: {}", ended.err);
            assert!(ended.err.contains(remedy), "{command}: {}", ended.err);
        }
    }
}

#[test]
fn a_directory_is_named_as_one_wherever_a_file_may_be_named() {
    for line in [
        "person show .",
        "layout show .",
        "layout check .",
        "run --source typist:a --glove .",
    ] {
        refused(line, &["this is a directory"]);
    }
}
