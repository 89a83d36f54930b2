//! Names, paths and words that would forge messages, in every command that prints them.

use std::path::Path;
use std::process::{Command, Output};

use serde_json::Value;
use tempfile::TempDir;

use crate::Ended;
use crate::control::ctl;
use crate::support::binary::ademan;
use crate::support::run::{ARMED, Run, shipped};

/// Ends a command, clears the screen, colors and reverses the text, and continues with false lines.
const NAME: &str =
    "x;touch PWNED \u{1b}[2J\u{9b}31m\u{202e}\u{2066}\u{2028}\u{2029}\nerror: forged\nsudo forged";

/// The start of its printed form.
const PRINTED: &str = r"x;touch PWNED \u{1b}[2J\u{9b}31m\u{202e}";

/// Maximum length of a printed line, in bytes: a message, and what precedes a field of clap.
const MAX_LINE_BYTES: usize = 2_100;

/// Commands in which `NAME` stands for the name. All print it.
const COMMANDS: &[&[&str]] = &[
    &["NAME"],
    &["--NAME"],
    &["run", "--NAME"],
    &["run", "NAME"],
    &["run", "--source", "NAME"],
    &["run", "--source", "x:NAME"],
    &["run", "--source", "serial:/dev/NAME?NAME=1"],
    &["run", "--source", "serial:/dev/NAME?baud=NAME"],
    &["run", "--source", "serial:/dev/NAME?protocol=NAME"],
    &[
        "run",
        "--source",
        "stdin:?protocol=lucidgloves&maximum=NAME",
    ],
    &["run", "--source", "ws:127.0.0.1:1?origin=NAME"],
    &["run", "--source", "tcp:NAME"],
    &["run", "--source", "file:NAME"],
    &["run", "--source", "recording:NAME"],
    &["run", "--source", "typist:a", "--output", "NAME"],
    &["run", "--source", "typist:a", "--output", "desktop:NAME"],
    &[
        "run",
        "--source",
        "typist:a",
        "--output",
        "transcript:no/NAME",
    ],
    &["run", "--source", "typist:a", "--layout", "NAME"],
    &["run", "--source", "typist:a", "--glove", "NAME"],
    &["run", "--source", "typist:a", "--record", "no/NAME"],
    &["run", "--source", "typist:a", "--control", "no/NAME"],
    &["run", "--source", "typist:a", "--share", "NAME"],
    &[
        "run",
        "--source",
        "typist:a",
        "--share",
        "json+NAME:127.0.0.1:1",
    ],
    &["run", "--source", "typist:a", "--role", "NAME"],
    &["run", "--source", "typist:a", "--log", "no/NAME"],
    &["share", "json:NAME"],
    &["record", "no/NAME", "--source", "typist:a"],
    &["replay", "NAME"],
    &["replay", "NAME", "--speed", "NAME"],
    &["export", "no/NAME", "--source", "typist:a"],
    &["export", "a.bvh", "--rate-hz", "NAME"],
    &["trace", "NAME"],
    &["trace", "angles", "--source", "file:NAME"],
    &[
        "delay",
        "--source",
        "file:NAME",
        "--arm-source",
        "file:NAME",
    ],
    &["calibrate", "NAME"],
    &["calibrate", "--glove", "NAME", "--demo"],
    &["demo", "--layout", "NAME"],
    &["layout", "show", "NAME"],
    &["layout", "show", "media", "--svg", "no/NAME"],
    &["layout", "show", "media", "--hand", "NAME,1"],
    &["layout", "check", "NAME"],
    &["layout", "check", "media", "--setup", "NAME"],
    &["layout", "fields", "NAME"],
    &["layout", "keys", "NAME"],
    &["layout", "new", "no/NAME"],
    &["layout", "new", "new NAME"],
    &["glove", "new", "no/NAME"],
    &["glove", "new", "a", "--from", "NAME"],
    &["setup", "new", "no/NAME"],
    &["script", "new", "no/NAME", "--from", "media"],
    &["doctor", "--source", "serial:/dev/NAME"],
    &["doctor", "--source", "file:NAME"],
    &["doctor", "--output", "transcript:NAME"],
    &["doctor", "NAME"],
    &["ctl", "NAME"],
    &["ctl", "--socket", "NAME", "state"],
    &["ctl", "nudge", "NAME", "0", "0"],
    &["system-files", "NAME"],
    &["completions", "NAME"],
    &["man", "file/NAME"],
    // With a setup whose field is the name.
    &["run", "source.ron"],
    &["run", "output.ron", "--source", "typist:a"],
    &["run", "layout.ron", "--source", "typist:a"],
    &["run", "glove.ron", "--source", "typist:a"],
    &["run", "profile.ron", "--source", "typist:a"],
    &["run", "panic-key.ron", "--source", "typist:a"],
    &["doctor", "serial.ron"],
];

/// Commands that print no more than an excerpt with the name.
const OTHER_COMMANDS: &[&[&str]] = &[
    &["run", "--source", "script:NAME"],
    &["demo", "--script", "NAME", "--layout", "media"],
    &["layout", "check", "key.ron"],
    &["layout", "check", "field.ron"],
];

/// A folder with setups and layouts that contain `name`.
fn folder(name: &str) -> TempDir {
    let folder = tempfile::tempdir().expect("a folder");
    let quoted = format!("{name:?}");
    let setup = |field: &str| format!("Setup({field})").replace("NAME", &quoted);
    let layout = |key: &str, field: &str| {
        format!(
            "Layout(name: \"a\", boards: [(pose: (anchor: elbow), \
             rows: [(at_mm: (0, 0), keys: {key})], {field})])"
        )
    };
    let serial = format!("{:?}", format!("serial:/dev/{name}"));
    for (file, text) in [
        ("source.ron", setup("source: NAME")),
        ("output.ron", setup("output: NAME")),
        ("layout.ron", setup("layout: NAME")),
        ("glove.ron", setup("glove: NAME")),
        (
            "profile.ron",
            setup("profiles: [(name: NAME, layout: \"media\"), (name: NAME, layout: \"media\")]"),
        ),
        ("panic-key.ron", setup("panic_keys: [NAME]")),
        ("serial.ron", format!("Setup(source: {serial})")),
        ("key.ron", layout(&quoted, "")),
        (
            "field.ron",
            layout("\"A\"", "xxxx: 1").replace("xxxx", &field_name(name)),
        ),
        ("file", String::new()),
    ] {
        std::fs::write(folder.path().join(file), text).expect("a file");
    }
    folder
}

/// A name of a field cannot contain much of the name.
fn field_name(name: &str) -> String {
    name.chars().filter(|c| c.is_alphanumeric()).collect()
}

fn run(folder: &Path, arguments: &[String]) -> Output {
    ademan(arguments)
        .current_dir(folder)
        .env_remove("XDG_RUNTIME_DIR")
        .env_remove("DISPLAY")
        .env_remove("WAYLAND_DISPLAY")
        .env("HOME", folder)
        .env("XDG_CONFIG_HOME", folder)
        .stdin(std::process::Stdio::null())
        .output()
        .expect("the program starts")
}

/// Asserts that no character acts on a terminal, that no line is a forged one, and that none is long.
fn judge(context: &str, bytes: &[u8], max_line: usize) {
    let text = String::from_utf8_lossy(bytes);
    let acts = |c: char| {
        c != '\n'
            && (c.is_control()
                || matches!(c, '\u{200e}' | '\u{200f}' | '\u{2028}'..='\u{202e}' | '\u{2066}'..='\u{2069}'))
    };
    let found = text.chars().find(|c| acts(*c));
    assert_eq!(found, None, "{context}: {text:?}");
    for line in text.lines() {
        let words = line.trim_start();
        let is_forged = words.starts_with("error: forged") || words.starts_with("sudo forged");
        assert!(!is_forged, "{context}: {text}");
        let (length, start) = (line.len(), line.chars().take(300).collect::<String>());
        assert!(length <= max_line, "{context}: {length} bytes: {start}");
    }
}

fn judge_output(context: &str, output: &Output, max_line: usize) -> String {
    judge(context, &output.stdout, max_line);
    judge(context, &output.stderr, max_line);
    let all = [&output.stdout[..], &output.stderr].concat();
    String::from_utf8_lossy(&all).into_owned()
}

/// Runs all commands with a name.
fn run_all(name: &str, printed: &str) {
    let folder = folder(name);
    let texts = |commands: &'static [&[&str]]| {
        commands.iter().map(|command| {
            let arguments = command.iter().map(|word| word.replace("NAME", name));
            let output = run(folder.path(), &arguments.collect::<Vec<_>>());
            let context = command.join(" ");
            let text = judge_output(&context, &output, MAX_LINE_BYTES);
            (context, text)
        })
    };
    for (context, text) in texts(COMMANDS) {
        assert!(text.contains(printed), "{context}: {text}");
    }
    for (context, text) in texts(OTHER_COMMANDS) {
        assert!(text.contains("error: "), "{context}: {text}");
    }
}

#[test]
fn no_command_prints_a_forged_line_of_a_name() {
    run_all(NAME, PRINTED);
}

#[test]
fn no_command_prints_a_line_of_a_long_word() {
    run_all(&"x".repeat(60_000), &"x".repeat(50));
}

#[test]
fn lists_print_names_of_files_escaped() {
    let folder = folder(NAME);
    for (kind, shipped_file) in [
        ("layouts", "keyboards/qwerty-flat"),
        ("gloves", "gloves/unam-hc11"),
    ] {
        let own = folder.path().join("ademan").join(kind);
        std::fs::create_dir_all(&own).expect("a folder");
        let root = Path::new(env!("CARGO_MANIFEST_DIR")).join("layouts");
        let from = root.join(format!("{shipped_file}.ron"));
        std::fs::copy(from, own.join(format!("{NAME}.ron"))).expect("a file");
        let output = run(folder.path(), &[kind.into()]);
        let text = judge_output(kind, &output, MAX_LINE_BYTES);
        assert!(text.contains(PRINTED), "{text}");
        let as_json = run(folder.path(), &[kind.into(), "--json".into()]);
        judge_output(kind, &as_json, usize::MAX);
        let rows: Value = serde_json::from_slice(&as_json.stdout).expect("JSON");
        let mut names = rows
            .as_array()
            .expect("a list")
            .iter()
            .map(|row| &row["name"]);
        assert!(names.any(|name| name == NAME), "{rows}");
    }
    for command in [
        &["layout", "check", NAME, "--json"][..],
        &["doctor", "serial.ron", "--json"],
    ] {
        let arguments: Vec<String> = command.iter().map(|word| (*word).to_owned()).collect();
        let output = run(folder.path(), &arguments);
        judge_output(command[0], &output, usize::MAX);
        let read: Value = serde_json::from_slice(&output.stdout).expect("JSON");
        let texts = read.to_string();
        assert!(texts.contains("x;touch PWNED"), "{texts}");
    }
}

#[test]
fn variables_and_the_name_of_the_program_forge_no_line() {
    let folder = folder(NAME);
    let config = folder.path().join(NAME);
    std::fs::create_dir_all(config.join("ademan")).expect("a folder");
    std::fs::write(config.join("ademan/setup.ron"), "Setup(source: \"\")").expect("a file");
    let config = config.to_str().expect("the path is UTF-8");
    for (variable, value, command) in [
        ("DISPLAY", NAME, "doctor"),
        ("DISPLAY", NAME, "run --source typist:a --output desktop"),
        ("WAYLAND_DISPLAY", NAME, "doctor"),
        ("XDG_RUNTIME_DIR", config, "ctl state"),
        ("XDG_CONFIG_HOME", config, "run"),
        ("_ADEMAN_COMPLETE", NAME, "run"),
    ] {
        let output = ademan(command.split(' '))
            .current_dir(folder.path())
            .env_remove("DISPLAY")
            .env_remove("WAYLAND_DISPLAY")
            .env("XDG_RUNTIME_DIR", folder.path())
            .env(variable, value)
            .output();
        let context = format!("{variable} {command}");
        let text = judge_output(&context, &output.expect("it starts"), MAX_LINE_BYTES);
        // The library of the arguments removes the first sequence.
        assert!(text.contains(r"x;touch PWNED \u{"), "{context}: {text}");
    }
    let link = folder.path().join("ademan\nerror: forged\u{202e}");
    std::os::unix::fs::symlink(env!("CARGO_BIN_EXE_ademan"), &link).expect("a link");
    let output = Command::new(link).arg("nope").output();
    let text = judge_output("link", &output.expect("it starts"), MAX_LINE_BYTES);
    assert!(text.contains("Usage: ademan "), "{text}");
}

#[test]
fn pictures_of_a_layout_contain_no_character_that_reverses_text() {
    let folder = tempfile::tempdir().expect("a folder");
    let layout = shipped("qwerty-flat").replace("QWERTY, 19 mm", "x\u{202e}\u{2066}draob\u{200f}");
    std::fs::write(folder.path().join("a.ron"), layout).expect("a file");
    for arguments in [["--svg", "-"], ["--html", "-"]] {
        let arguments = ["layout", "show", "a.ron"].into_iter().chain(arguments);
        let arguments: Vec<String> = arguments.map(str::to_owned).collect();
        let output = run(folder.path(), &arguments);
        let text = judge_output(&arguments.join(" "), &output, usize::MAX);
        assert!(text.contains("draob"), "{arguments:?}: {text}");
    }
}

#[test]
fn a_session_prints_names_of_its_layouts_and_profiles_escaped() {
    // A profile has at most 64 bytes and no control characters.
    const PROFILE: &str = "x;touch PWNED \u{202e}error: forged; sudo forged";
    let folder = tempfile::tempdir().expect("a folder");
    let layout = folder.path().join(format!("{NAME}.ron"));
    std::fs::write(&layout, shipped("qwerty-flat")).expect("a file");
    let layout = layout.to_str().expect("the path is UTF-8");
    let profiles = format!("profiles: [(name: {PROFILE:?}, layout: {layout:?})]");
    let mut run = Run::with_setup(&profiles, &["--control", "c.sock"]);
    run.wait_for_message(ARMED);
    let mut subscriber = ademan(["ctl", "subscribe", "--json", "--socket", "c.sock"]);
    subscriber.current_dir(run.folder.path());
    let subscriber = std::thread::spawn(move || subscriber.output().expect("it starts"));
    for (arguments, printed) in [
        (
            &["profile", "nope\u{9b}\u{202e}\nerror: forged"][..],
            r"nope\u{9b}\u{202e}\nerror",
        ),
        (
            &["profile", "zzz"],
            r"available: main, x;touch PWNED \u{202e}error",
        ),
        (&["profile", PROFILE], "done"),
        (&["state"], r"x;touch PWNED \u{202e}error"),
        (&["reload"], PRINTED),
        (&["save"], PRINTED),
        (&["nudge", "1", "0", "0"], "done"),
        (&["save"], PRINTED),
        (&["state", "--json"], r"PWNED \u202eerror"),
    ] {
        let Ended { out, err, .. } = ctl(&run, arguments);
        let context = format!("{arguments:?}");
        judge(&context, out.as_bytes(), MAX_LINE_BYTES);
        judge(&context, err.as_bytes(), MAX_LINE_BYTES);
        let text = out + &err;
        assert!(text.contains(printed), "{context}: {text}");
    }
    let state = ctl(&run, &["state", "--json"]).out;
    let state: Value = serde_json::from_str(&state).expect("JSON");
    assert_eq!(
        (&state["profile"], &state["layout"]),
        (&PROFILE.into(), &layout.into())
    );
    std::fs::write(layout, "Layout(").expect("a file");
    ctl(&run, &["reload"]).reported(PRINTED);
    ctl(&run, &["stop"]);
    run.program.0.wait().expect("it ends");
    judge_output(
        "subscribe",
        &subscriber.join().expect("no panic"),
        usize::MAX,
    );
    let messages: Vec<String> = run.messages.iter().collect();
    judge("messages", messages.join("\n").as_bytes(), MAX_LINE_BYTES);
}

#[test]
fn a_recording_prints_names_of_its_layouts_escaped() {
    let folder = tempfile::tempdir().expect("a folder");
    let layout = format!("{NAME}.ron");
    std::fs::write(folder.path().join(&layout), shipped("qwerty-flat")).expect("a file");
    let record = "run --source typist:a --control off --record r.mcap --layout";
    let replay = "replay r.mcap --layout";
    for (command, last) in [
        (record, &*layout),
        (replay, &*layout),
        ("trace events --source", "recording:r.mcap"),
        ("demo --text a --layout", &layout),
        ("layout check", &layout),
        ("layout show", &layout),
    ] {
        let words = command.split(' ').chain([last]).map(str::to_owned);
        let output = run(folder.path(), &words.collect::<Vec<_>>());
        let text = judge_output(command, &output, MAX_LINE_BYTES);
        assert!(output.status.success(), "{command}: {text}");
    }
}
