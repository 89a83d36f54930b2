//! Files that the program writes and reads: recordings, transcripts, layouts, setups, documentation.

use std::path::Path;
use std::process::Command;

use super::{file, run, run_to_end, text};

const TYPED: &str = "typist:Hi you";

fn root(path: &str) -> String {
    format!("{}/{path}", env!("CARGO_MANIFEST_DIR"))
}

/// Records a hand that types, and returns the path of the recording.
pub fn recorded(folder: &tempfile::TempDir) -> String {
    let path = folder.path().join("hand.mcap");
    let path = text(&path).to_owned();
    let ended = run(["record", &path, "--source", TYPED]).done();
    ended.reported("readings:");
    assert_eq!(ended.out, "");
    path
}

#[test]
fn a_replay_gives_the_same_transcript_at_any_speed() {
    let folder = tempfile::tempdir().unwrap();
    let path = recorded(&folder);
    let first = run(["replay", &path]).done().out;
    let keys: Vec<&str> = first
        .lines()
        .filter_map(|line| line.split_once("down "))
        .map(|(_, key)| key)
        .collect();
    assert_eq!(keys, ["ShiftLeft", "H", "I", "Space", "Y", "O", "U"]);
    assert_eq!(run(["replay", &path]).done().out, first);
    assert_eq!(run(["replay", &path, "--speed", "20"]).done().out, first);
}

#[test]
fn a_truncated_recording_is_played_up_to_the_cut_and_fails() {
    let folder = tempfile::tempdir().unwrap();
    let path = recorded(&folder);
    let whole = run(["replay", &path]).done().out;
    let bytes = std::fs::read(&path).unwrap();
    let cut = file(&folder, "cut.mcap", &bytes[..bytes.len() / 2]);
    let ended = run(["replay", &cut]).exited(3);
    ended.reported("the recording is cut off at byte ");
    let same = ended
        .out
        .lines()
        .zip(whole.lines())
        .take_while(|(one, other)| one == other)
        .count();
    assert!(same > 0 && same < whole.lines().count(), "{}", ended.out);
    // Keys that are pressed at the cut are released there.
    let mut rest = ended.out.lines().skip(same);
    assert!(rest.all(|line| line.contains(" up ")), "{}", ended.out);
    let count = |word: &str| ended.out.matches(word).count();
    assert_eq!(count("down "), count(" up "), "{}", ended.out);
}

#[test]
fn a_replay_of_a_recorded_run_gives_its_transcript() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("run.mcap");
    let live = run(["run", "--source", "typist:ok", "--record", text(&path)])
        .done()
        .out;
    assert_eq!(live.lines().count(), 4, "{live}");
    assert_eq!(run(["replay", text(&path)]).done().out, live);
    #[cfg(unix)]
    {
        use std::os::unix::fs::PermissionsExt;
        let mode = std::fs::metadata(&path).unwrap().permissions().mode();
        assert_eq!(mode & 0o777, 0o600);
    }
}

#[test]
fn messages_do_not_contain_typed_text() {
    const CANARY: &str = "canary";
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("run.mcap");
    let log = folder.path().join("run.log");
    let source = format!("typist:{CANARY}");
    let ended = run([
        "run",
        "-vv",
        "--log",
        text(&log),
        "--source",
        &source,
        "--record",
        text(&path),
        "--output",
        "none",
    ])
    .done();
    ended.reported("armed");
    let logged = std::fs::read_to_string(&log).expect("a log");
    assert!(logged.contains("armed"), "{logged}");
    let replayed = run(["replay", "-vv", text(&path), "--output", "none"]).done();
    for messages in [ended.err, logged, replayed.err] {
        assert!(!messages.to_lowercase().contains(CANARY), "{messages}");
        assert!(!messages.contains("down"), "{messages}");
    }
}

#[test]
fn a_run_whose_recording_cannot_be_created_leaves_no_file() {
    let folder = tempfile::tempdir().unwrap();
    let existing = file(&folder, "mine.mcap", "mine");
    let [transcript, both] = ["typed.txt", "both"].map(|name| folder.path().join(name));
    let output = format!("transcript:{}", text(&transcript));
    for (recordings, reason) in [
        (["--record", &existing, "--view", "log"], "exists"),
        (
            ["--record", text(&both), "--record-bvh", text(&both)],
            "names the same file",
        ),
    ] {
        let arguments = ["run", "--source", "typist:hi", "--output", &output];
        let ended = run(arguments.into_iter().chain(recordings)).exited(2);
        ended.reported(reason);
        assert!(!transcript.exists() && !both.exists(), "{}", ended.err);
    }
}

#[test]
fn the_demo_writes_a_transcript_and_prints_its_statistics() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("demo.txt");
    let output = format!("transcript:{}", path.display());
    let ended = run(["demo", "--text", "Ok", "--output", &output]).done();
    for word in [
        "typed      \"Ok\"",
        "words/min of correct text",
        "0.00 % character error rate",
        "0 substitutions, 0 insertions, 0 deletions",
        "1 run with --noise 0 --seed 0",
        "0 lost",
        "p99",
    ] {
        ended.printed(word);
    }
    let transcript = std::fs::read_to_string(path).unwrap();
    let events: Vec<&str> = transcript.lines().map(|line| line[13..].trim()).collect();
    let keys = [
        "down ShiftLeft",
        "down O",
        "up   O",
        "up   ShiftLeft",
        "down K",
        "up   K",
    ];
    assert_eq!(events, keys);
}

#[test]
fn the_demo_has_a_text_for_a_board_of_digits() {
    let ended = run(["demo", "--layout", "numpad", "--fast"]).done();
    ended.printed("typed      \"3.14159*2-0.5\"");
}

#[test]
fn the_demo_plays_a_script_and_prints_its_events() {
    let folder = tempfile::tempdir().unwrap();
    let script = file(
        &folder,
        "two keys.txt",
        "press Numpad1; wait 50\ntap Numpad5 # up and down\n",
    );
    let ended = run(["demo", "--layout", "numpad", "--script", &script]).done();
    let events: Vec<&str> = ended
        .out
        .lines()
        .filter(|line| line.starts_with(' '))
        .map(|line| &line[13..])
        .collect();
    let keys = [
        "down Numpad1",
        "up   Numpad1",
        "down Numpad5",
        "up   Numpad5",
    ];
    assert_eq!(events, keys, "{}", ended.out);
    for word in ["plays ", "played     4 events", "0 lost", "p99"] {
        ended.printed(word);
    }
}

#[test]
fn a_script_is_a_source() {
    let source = "script:tap ArrowLeft; tap ArrowUp";
    let ended = run(["trace", "touches", "--layout", "arrows", "--source", source]).done();
    let pressed = ended
        .out
        .lines()
        .filter(|line| line.contains("\"pressed\""));
    let pressed: Vec<&str> = pressed.collect();
    assert_eq!(pressed.len(), 2, "{}", ended.out);
    assert!(pressed[0].contains("ArrowLeft") && pressed[1].contains("ArrowUp"));
}

#[test]
fn the_example_setup_contains_every_field_with_its_default_except_source_and_output() {
    use ademan::setup::Setup;
    let example = Setup::load(&root("examples/setup.ron")).unwrap();
    assert!(example.source.is_some());
    assert_eq!(example.output, "desktop");
    let default = Setup::default();
    let without_both = Setup {
        source: None,
        output: default.output.clone(),
        ..example
    };
    assert_eq!(without_both, default);

    let written = std::fs::read_to_string(root("examples/setup.ron")).unwrap();
    let fields = serde_json::to_value(Setup::default()).unwrap();
    for field in fields.as_object().unwrap().keys() {
        assert!(written.contains(&format!("\n    {field}: ")), "{field}");
    }
}

#[test]
fn paths_in_a_setup_are_relative_to_it_and_flags_override_it() {
    let folder = tempfile::tempdir().unwrap();
    let layout = std::fs::read_to_string(root("examples/one-key.ron")).unwrap();
    file(&folder, "board.ron", layout);
    let setup = file(
        &folder,
        "setup.ron",
        "Setup(source: \"typist:a\", layout: \"board.ron\", arm_immediately: true)",
    );
    let ended = run(["run", &setup]).exited(2);
    ended.reported("cannot type 'a'");
    let with_layout = run(["run", &setup, "--layout", "qwerty-flat"]).done();
    assert_eq!(with_layout.out.lines().count(), 2, "{}", with_layout.out);
}

#[test]
fn the_layouts_in_the_readme_are_valid() {
    let folder = tempfile::tempdir().unwrap();
    let readme = std::fs::read_to_string(root("README.md")).unwrap();
    let layouts: Vec<&str> = readme
        .split("```ron\n")
        .skip(1)
        .filter_map(|rest| rest.split("```").next())
        .filter(|block| block.starts_with("Layout("))
        .collect();
    assert!(!layouts.is_empty());
    for layout in layouts {
        let path = file(&folder, "board.ron", layout);
        run(["layout", "check", &path]).done();
        assert!(run(["layout", "show", &path]).done().out.ends_with('\n'));
    }
}

#[test]
fn layouts_are_listed_in_aligned_columns() {
    let list = run(["layout", "list"]).done().out;
    let columns: Vec<usize> = list
        .lines()
        .map(|line| {
            let (name, _) = line.split_once(' ').unwrap();
            line.len() - line[name.len()..].trim_start().len()
        })
        .collect();
    assert!(
        columns.len() >= 5 && columns.iter().all(|column| *column == columns[0]),
        "{list}"
    );
}

#[test]
fn sources_outputs_and_gloves_are_listed_with_an_example() {
    let sources = run(["sources"]).done().out;
    for part in [
        "serial:PORT",
        "ademan run --source 'typist:hello'",
        "?protocol=text-line",
    ] {
        assert!(sources.contains(part), "{sources}");
    }
    let outputs = run(["outputs", "--json"]).done().out;
    let outputs: serde_json::Value = serde_json::from_str(&outputs).unwrap();
    assert_eq!(outputs[1]["name"], "desktop");
    let gloves = run(["gloves"]).done().out;
    for example in [
        "--source serial:/dev/ttyUSB0 --glove unam-hc11-left\n",
        "--source 'serial:/dev/ttyUSB0?protocol=lucidgloves' --glove lucidgloves-left\n",
    ] {
        assert!(gloves.contains(example), "{gloves}");
    }
    run(["man"]).exited(2);
}

#[test]
fn completions_and_manual_pages_are_generated() {
    for (shell, word) in [
        ("bash", "-F _ademan ademan"),
        ("zsh", "#compdef ademan"),
        ("fish", "--command ademan"),
    ] {
        let script = run(["completions", shell]).done().out;
        assert!(script.contains(word), "{shell}");
    }
    let folder = tempfile::tempdir().unwrap();
    let pages = folder.path().join("man1");
    run(["man", text(&pages)]).done();
    for page in ["ademan.1", "ademan-demo.1", "ademan-layout-check.1"] {
        let page = std::fs::read_to_string(pages.join(page)).unwrap();
        assert!(page.contains(".SH NAME"), "{page}");
    }
}

#[test]
fn the_examples_of_the_library_run() {
    let folder = Path::new(env!("CARGO_BIN_EXE_ademan")).with_file_name("examples");
    for (example, lines) in [
        ("custom_source", 6),
        ("custom_control", 3),
        ("replay_to_stdout", 24),
    ] {
        let program = folder.join(example);
        if !program.exists() {
            println!("SKIPPED: {example} is not built; `cargo test` builds it");
            continue;
        }
        let ended = run_to_end(&mut Command::new(program));
        assert_eq!(ended.done().out.lines().count(), lines, "{example}");
    }
}

#[test]
fn a_new_layout_is_a_copy_and_overwrites_nothing() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("mine");
    let output = run(["layout", "new", text(&path), "--from", "numpad"])
        .done()
        .out;
    assert!(output.contains("mine.ron"), "{output}");
    let written = std::fs::read_to_string(folder.path().join("mine.ron")).unwrap();
    assert!(written.contains("name: \"mine\""), "{written}");
    let mine = text(&path).to_owned() + ".ron";
    assert!(run(["layout", "check", &mine]).done().out.contains("valid"));
    let again = run(["layout", "new", &mine]).exited(2);
    again.reported("choose another name or remove it");
}

#[test]
fn keys_out_of_reach_of_the_default_hand_are_listed() {
    let folder = tempfile::tempdir().unwrap();
    let far = "Layout(name: \"far\", boards: [(pose: (anchor: elbow, bearing_deg: 35, forward_mm: 320, height_mm: -45),\n\
               rows: [(at_mm: (0, 0), keys: \"N\"), (at_mm: (0, 200), keys: \"F\")])])";
    let path = file(&folder, "far.ron", far);
    let ended = run(["layout", "check", &path]).done();
    ended.reported("far.ron: 1 control out of reach, nearest first: `F` (");
    assert!(!ended.err.contains("`N`"), "{}", ended.err);
}

#[test]
fn a_layout_with_errors_is_drawn_with_all_of_them_and_refused() {
    let folder = tempfile::tempdir().unwrap();
    let faulty = "Layout(name: \"two\", boards: [(pose: (anchor: elbow, bearing_deg: 35, forward_mm: 320, height_mm: -45),\n\
                  keys: [(code: \"A\", at_mm: (0, 0)), (code: \"B\", at_mm: (10, 0)), (code: \"B\", at_mm: (60, 0))])])";
    let path = file(&folder, "two.ron", faulty);
    let messages = [
        "overlaps the key `A` of line 2 by 7 mm",
        "duplicate name `B`",
    ];
    for arguments in [
        vec!["layout", "check", &path],
        vec!["layout", "show", &path],
        vec!["layout", "show", &path, "--svg", "-"],
    ] {
        let ended = run(&arguments);
        assert_eq!(ended.code, Some(2), "{arguments:?}");
        for message in messages {
            assert!(ended.err.contains(message), "{arguments:?}: {}", ended.err);
        }
        match arguments[..] {
            ["layout", "check", ..] => assert!(ended.out.is_empty(), "{}", ended.out),
            [_, _, _, "--svg", _] => assert_eq!(ended.out.matches("class=\"fault\"").count(), 3),
            _ => assert!(ended.out.contains('A'), "{}", ended.out),
        }
    }
}

#[test]
fn one_cause_gives_one_warning_for_all_keys_out_of_reach() {
    let folder = tempfile::tempdir().unwrap();
    let key = |n: usize| {
        format!(
            "(code: \"A\", name: \"{n}\", at_mm: ({}, {})),",
            n % 50 * 20,
            n / 50 * 20
        )
    };
    let keys: String = (0..400).map(key).collect();
    let far = format!(
        "Layout(name: \"far\", boards: [(pose: (anchor: elbow, forward_mm: 1900), keys: [{keys}])])"
    );
    let path = file(&folder, "far.ron", far);
    let ended = run(["layout", "check", &path]).done();
    assert_eq!(ended.err.lines().count(), 1, "{}", ended.err);
    ended.reported("400 controls out of reach");
    ended.reported("and 388 more; move the board nearer");
}

#[test]
fn keys_that_the_simulated_hand_cannot_press_are_warnings() {
    let folder = tempfile::tempdir().unwrap();
    let key = |index: usize| {
        let (x, y) = (27 * (index % 3) as i32 - 27, 33 - 22 * (index / 3) as i32);
        format!(
            "(code: \"F{}\", at_mm: ({x}, {y}), size_mm: Box(24, 17)),",
            index + 1
        )
    };
    let keys: String = (0..12).map(key).collect();
    let pad = format!(
        "Layout(name: \"pad\", boards: [\n(pose: (anchor: elbow, bearing_deg: 35, forward_mm: 300, height_mm: -45), keys: [{keys}]),\n\
         (pose: (anchor: elbow, bearing_deg: 35, forward_mm: 190, height_mm: -45, right_mm: -10), shape: Arc(radius_mm: 90), keys: [\n\
         (code: \"Space\", at_mm: (0, 0)), (code: \"Enter\", at_mm: (19, 0))])])"
    );
    let path = file(&folder, "pad.ron", pad);
    let ended = run(["layout", "check", &path]).done();
    ended.reported(" cannot be pressed by the simulated hand: its ");
    ended.reported("would press `F");
}

#[test]
fn a_layout_is_checked_for_the_hand_of_a_flag_or_a_setup() {
    let folder = tempfile::tempdir().unwrap();
    let near = "Layout(name: \"near\", boards: [(pose: (anchor: elbow, bearing_deg: 35, forward_mm: 262, height_mm: -45,\n\
               fit: Off), rows: [(at_mm: (0, 0), keys: \"N\")])])";
    let path = file(&folder, "near.ron", near);
    let setup = "Setup(arm: Measured(hand_length_mm: 189, forearm_length_mm: 262))";
    let setup = file(&folder, "setup.ron", setup);
    let reaches = run(["layout", "check", &path]).done();
    assert_eq!(reaches.err, "");
    for flag in [["--hand", "189,262"], ["--setup", &setup]] {
        let ended = run(["layout", "check", &path, flag[0], flag[1]]).done();
        ended.reported("out of reach, nearest first: `N` (");
    }
    for wrong in ["189", "189,x", "1890,262", "262,189"] {
        let ended = run(["layout", "check", &path, "--hand", wrong]);
        assert_eq!(ended.code, Some(2), "{wrong}: {}", ended.err);
    }
}

#[test]
fn a_run_reports_the_keys_out_of_reach_of_its_hand() {
    let folder = tempfile::tempdir().unwrap();
    let far = "Layout(name: \"far\", boards: [(pose: (anchor: elbow, bearing_deg: 35, forward_mm: 320, height_mm: -45),\n\
               rows: [(at_mm: (0, 0), keys: \"N\"), (at_mm: (0, 200), keys: \"F\")])])";
    let path = file(&folder, "far.ron", far);
    let ended = run([
        "run",
        "--layout",
        &path,
        "--source",
        "script:wait 1500",
        "--control",
        "off",
    ]);
    ended.reported("far.ron: 1 control out of reach, nearest first: `F` (");
}

#[test]
fn a_check_prints_json_for_programs() {
    let folder = tempfile::tempdir().unwrap();
    let wrong = file(
        &folder,
        "wrong.ron",
        "Layout(name: \"w\",\nboards: [(pose: (anchor: elbow), kyes: [], pitch_mm: 0)])",
    );
    let ended = run(["layout", "check", "--json", "numpad", &wrong, "nowhere"]).exited(2);
    let json: serde_json::Value = serde_json::from_str(&ended.out).unwrap();
    let file = |index: usize| &json[index];
    assert_eq!(
        (&file(0)["valid"], &file(0)["keys"]),
        (&true.into(), &17.into())
    );
    assert_eq!(file(0)["warnings"], serde_json::json!([]));
    let errors = file(1)["errors"].as_array().unwrap();
    assert_eq!(errors.len(), 2, "{}", ended.out);
    assert_eq!(
        (&errors[0]["line"], &errors[0]["column"]),
        (&2.into(), &34.into())
    );
    let message = "unknown field `kyes`, did you mean `keys`?";
    assert_eq!(errors[0]["message"], message);
    assert_eq!(file(2)["errors"][0]["line"], serde_json::Value::Null);
    assert!(ended.err.lines().count() == 1, "{}", ended.err);
}

#[test]
fn a_recording_announces_its_growth_and_the_room_on_the_disk() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("hand.mcap");
    let ended = run(["record", text(&path), "--source", TYPED]).done();
    ended.reported("hand.mcap: up to 176 MB an hour at 175 readings per second");
    #[cfg(unix)]
    ended.reported("GB are free on its disk, enough for");
    // Without the schemas and the setup, which an hour does not repeat.
    let size = std::fs::metadata(&path).unwrap().len() - 100_000;
    let readings = ended
        .err
        .lines()
        .find_map(|line| line.split_once(" readings: "));
    let readings: u64 = readings.unwrap().0.parse().unwrap();
    let per_hour = size as f64 / readings as f64 * 175.0 * 3600.0;
    assert!(
        (3e7..1.76e8).contains(&per_hour),
        "{per_hour} bytes an hour"
    );
    let run_path = folder.path().join("run.mcap");
    let run_ended = run(["run", "--source", "typist:a", "--record", text(&run_path)]).done();
    run_ended.reported("MB an hour");
}

#[test]
fn a_recording_of_positions_grows_by_no_more_than_it_announces() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("markers.mcap");
    let source = "typist:hello?protocol=markers";
    let ended = run(["record", text(&path), "--source", source]).done();
    ended.reported("markers.mcap: up to 360 MB an hour at 100 readings per second");
    // Without the schemas and the setup, which an hour does not repeat.
    let size = std::fs::metadata(&path).unwrap().len() - 100_000;
    let readings = ended
        .err
        .lines()
        .find_map(|line| line.split_once(" readings: "));
    let readings: u64 = readings.unwrap().0.parse().unwrap();
    let per_hour = size as f64 / readings as f64 * 100.0 * 3600.0;
    assert!((1e8..3.6e8).contains(&per_hour), "{per_hour} bytes an hour");
}

#[test]
fn a_file_without_a_packet_is_a_failure() {
    let folder = tempfile::tempdir().unwrap();
    let noise = file(&folder, "noise.bin", "no packet in here");
    let source = format!("file:{noise}");
    let ended = run(["run", "--control", "off", "--source", &source]).exited(1);
    ended.reported("sent no valid packet");
}

#[test]
fn a_run_that_cannot_start_leaves_no_recording() {
    let folder = tempfile::tempdir().unwrap();
    let recording = folder.path().join("session.mcap");
    let record = recording.display().to_string();
    let busy = std::net::TcpListener::bind("127.0.0.1:0").unwrap();
    let unused = format!("tcp:{}", busy.local_addr().unwrap());
    drop(busy);
    let starts = [
        ["--source", "typist:hi", "--output", "desktop"],
        ["--source", "typist:hi", "--output", "transcript:/no/folder"],
        ["--source", "serial:/dev/no-such-glove", "--output", "none"],
        ["--source", &unused, "--output", "none"],
    ];
    for arguments in starts {
        let flags = ["run", "--control", "off", "--record", &record];
        let ended = run([&flags[..], &arguments].concat());
        assert_ne!(ended.code, Some(0), "{arguments:?}");
        assert!(!recording.exists(), "{arguments:?}: {}", ended.err);
    }
}

#[test]
fn a_layout_that_names_a_profile_is_checked_without_the_setup_that_has_it() {
    let folder = tempfile::tempdir().unwrap();
    let keys = r#"keys: [(action: Command("profile media"), name: "media", at_mm: (0, 0))]"#;
    let layout =
        format!("Layout(name: \"a\", boards: [(pose: (anchor: elbow, forward_mm: 400), {keys})])");
    let path = file(&folder, "mix.ron", layout);
    let checked = run(["layout", "check", &path]).done();
    let note = "it names the profile `media`, which the setup must have; check it with `--setup`";
    checked.reported(note);
    let setup = file(&folder, "setup.ron", "Setup()");
    let refused = run(["layout", "check", &path, "--setup", &setup]).exited(2);
    refused.reported("unknown profile `media`");
}

#[test]
fn a_layout_with_a_key_of_the_system_is_checked_with_a_warning_unless_the_setup_allows_it() {
    let folder = tempfile::tempdir().unwrap();
    let keys = "keys: [(code: \"MetaLeft\", at_mm: (0, 0))]";
    let pose = "anchor: elbow, bearing_deg: 35, forward_mm: 320, height_mm: -45";
    let layout = format!("Layout(name: \"a\", boards: [(pose: ({pose}), {keys})])");
    let path = file(&folder, "start.ron", layout);
    let note = "the key `MetaLeft` acts on the system, so a run needs `allow_system_keys: true` in its setup";
    let setup = file(&folder, "setup.ron", "Setup()");
    let allowing = file(&folder, "allow.ron", "Setup(allow_system_keys: true)");
    let check = ["layout", "check", &path];
    let checked = run(check).done();
    checked.reported(note);
    let with_setup = run([&check[..], &["--setup", &setup]].concat()).done();
    with_setup.reported(note);
    let allowed = run([&check[..], &["--setup", &allowing]].concat()).done();
    assert!(!allowed.err.contains("MetaLeft"), "{}", allowed.err);
}

#[test]
fn a_layout_whose_keys_need_a_setup_is_drawn_and_toured_without_one() {
    let folder = tempfile::tempdir().unwrap();
    let profile = r#"(action: Command("profile media"), name: "media", at_mm: (0, 0))"#;
    let keys = format!("keys: [{profile}, (code: \"MetaLeft\", at_mm: (30, 0))]");
    let pose = "anchor: elbow, bearing_deg: 35, forward_mm: 320, height_mm: -45";
    let layout = format!("Layout(name: \"a\", boards: [(pose: ({pose}), {keys})])");
    let path = file(&folder, "mix.ron", layout);
    let picture = run(["layout", "show", &path, "--svg", "-"]).done();
    picture.printed("</svg>");
    let tour = run(["script", "new", "-", "--from", &path]).done();
    tour.printed("tap MetaLeft");
}
