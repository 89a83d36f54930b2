//! The first day of a person: a glove or hand that a layout was not written for, new files, a narrow terminal.

use std::path::Path;
use std::process::{Command, Stdio};

use super::{Ended, ademan, file, run, run_to_end, text};
use crate::support::binary::copy_binary;

#[test]
fn a_glove_that_measures_no_arm_is_told_the_layouts_below_its_fingers() {
    let folder = tempfile::tempdir().unwrap();
    let setup = file(&folder, "setup.ron", "Setup(glove: \"lucidgloves\")");
    let check = |layout: &str| {
        run(["layout", "check", layout, "--setup", &setup])
            .done()
            .err
    };
    let message = check("qwerty-flat");
    assert!(message.contains("controls out of reach"), "{message}");
    assert!(message.contains("this glove measures no arm"), "{message}");
    assert!(message.contains("such as `chords-bend`"), "{message}");
    assert!(!message.contains("`drive`"), "feet and head: {message}");
    assert!(!message.contains("nearer"), "{message}");
    assert_eq!(check("chords-bend"), "");
    let with_camera = "Setup(source: \"serial:/dev/ttyUSB0?protocol=lucidgloves\", \
                 arm_source: \"udp:127.0.0.1:9000?protocol=body-landmarks\")";
    let with_camera = file(&folder, "camera.ron", with_camera);
    let checked = run(["layout", "check", "qwerty-flat", "--setup", &with_camera]).done();
    assert_eq!(checked.err, "", "a camera measures the arm");
}

#[test]
fn a_webcam_is_told_which_layouts_need_the_elbow() {
    let folder = tempfile::tempdir().unwrap();
    let webcam = "Setup(source: \"udp:127.0.0.1:9000?protocol=hand-landmarks\")";
    let setup = file(&folder, "setup.ron", webcam);
    let check = |layout: &str| {
        run(["layout", "check", layout, "--setup", &setup])
            .done()
            .err
    };
    for layout in ["direct", "joint", "space"] {
        let expected = format!("warning: {layout}: the layout needs the elbow, which `udp:");
        let message = check(layout);
        assert!(message.contains(&expected), "{message}");
    }
    assert_eq!(check("webcam-mouse"), "");
}

#[test]
fn a_board_that_is_too_near_is_said_to_be_too_near() {
    let folder = tempfile::tempdir().unwrap();
    let board = |pose: &str| {
        let text = format!(
            "Layout(name: \"board\", boards: [(pose: (anchor: elbow, bearing_deg: 35, {pose}), rows: [(at_mm: (0, 0), keys: \"N\")])])"
        );
        let path = file(&folder, "board.ron", text);
        run(["layout", "check", &path]).done().err
    };
    let near = board("forward_mm: 60, height_mm: -45");
    assert!(
        near.contains("out of reach") && near.contains("too near: move it away"),
        "{near}"
    );
    let far = board("forward_mm: 900, height_mm: -45");
    assert!(far.contains("move the board nearer"), "{far}");
    let high = board("forward_mm: 300, height_mm: 400");
    assert!(high.contains("too high: move it down"), "{high}");
}

#[test]
fn a_left_handed_check_is_left_handed_and_a_mirrored_layout_passes_it() {
    let folder = tempfile::tempdir().unwrap();
    let setup = file(&folder, "left.ron", "Setup(glove: \"unam-hc11-left\")");
    let checked = run(["layout", "check", "qwerty-flat", "--setup", &setup]).done();
    checked.reported("controls out of reach");
    let command =
        "`ademan layout new NAME --from qwerty-flat --mirror` copies it for the left hand";
    checked.reported(command);
    let typed = |layout: &str| {
        run([
            "run",
            &setup,
            "--layout",
            layout,
            "--source",
            "typist:hi",
            "--output",
            "transcript",
            "--control",
            "off",
        ])
    };
    let refused = typed("qwerty-flat");
    refused.reported("for the right hand");

    let mine = text(&folder.path().join("mine.ron")).to_owned();
    run(["layout", "new", &mine, "--from", "qwerty-flat", "--mirror"]).done();
    for arguments in [
        &["layout", "check", &mine][..],
        &["layout", "check", &mine, "--setup", &setup],
    ] {
        assert_eq!(run(arguments).done().err, "", "{arguments:?}");
    }
    let typed = typed(&mine).done();
    assert!(
        typed.out.contains("down H") && typed.out.contains("down I"),
        "{}",
        typed.out
    );
    let other_hand = run(["run", "--source", "typist:hi", "--layout", &mine]);
    other_hand.reported("name a glove of that hand, such as `unam-hc11-left`");
}

#[test]
fn every_shipped_layout_for_one_hand_is_within_reach_of_the_other_when_mirrored() {
    let folder = tempfile::tempdir().unwrap();
    let setup = file(&folder, "left.ron", "Setup(glove: \"unam-hc11-left\")");
    let list = run(["layout", "list", "--json"]).done().out;
    let list: serde_json::Value = serde_json::from_str(&list).unwrap();
    let mut checked = 0;
    for row in list.as_array().unwrap() {
        let name = row["name"].as_str().unwrap();
        let path = text(&folder.path().join(format!("left-{name}.ron"))).to_owned();
        let created = run(["layout", "new", &path, "--from", name, "--mirror"]);
        if name.contains("two") {
            created.reported("boards for both hands");
            continue;
        }
        created.done();
        let ended = run(["layout", "check", &path, "--setup", &setup]).done();
        // The other hand carries its board.
        if name == "wrist-remote" {
            ended.reported("set `other_hand`");
            continue;
        }
        assert_eq!(ended.err, "", "{name}");
        checked += 1;
    }
    assert!(checked > 15, "{checked}");
}

#[test]
fn a_layout_that_does_not_fit_a_hand_is_not_called_valid() {
    let folder = tempfile::tempdir().unwrap();
    let arc = "Layout(name: \"arc\", boards: [(pose: (anchor: elbow, bearing_deg: 35, height_mm: -45),\n\
               shape: Arc(radius_mm: 260), rows: [(at_mm: (810, 0), keys: \"A\")])])";
    let path = file(&folder, "arc.ron", arc);
    let check = |hand: &str| run(["layout", "check", &path, "--hand", hand]);
    assert!(check("150,265").done().out.contains("valid"));
    let ended = check("180,170").exited(2);
    assert_eq!(ended.out, "", "{}", ended.err);
    ended.reported("beyond the ends of its arc");
}

#[test]
fn boards_in_one_place_are_a_warning_with_the_distance() {
    let folder = tempfile::tempdir().unwrap();
    let board = |right_mm: i32, key: &str| {
        format!(
            "(pose: (anchor: elbow, bearing_deg: 35, forward_mm: 320, height_mm: -45, right_mm: {right_mm}), \
             size_mm: Box(17, 17), rows: [(at_mm: (0, 0), keys: \"{key}\")]),"
        )
    };
    let check = |right_mm: i32| {
        let layout = format!(
            "Layout(name: \"two\", boards: [{}{}])",
            board(0, "A"),
            board(right_mm, "B")
        );
        let path = file(&folder, "two.ron", layout);
        (
            run(["layout", "check", &path]).done().err,
            run(["layout", "check", &path, "--json"]).done().out,
        )
    };
    let (text, json) = check(15);
    let warning = "boards 1 and 2 overlap by 2.0 mm at `A` and `B`";
    assert!(
        text.contains(warning) && json.contains(warning),
        "{text}{json}"
    );
    let (fitting, _) = check(18);
    assert_eq!(fitting, "");
}

#[test]
fn a_layer_that_nothing_activates_is_a_warning() {
    let folder = tempfile::tempdir().unwrap();
    let check = |keys: &str| {
        let layout = format!(
            "Layout(name: \"digits\", boards: [(\
             pose: (anchor: elbow, bearing_deg: 35, forward_mm: 320, height_mm: -45), keys: [\
             (code: \"A\", at_mm: (0, 0)), {keys}])], layers: [(name: \"digits\", keys: {{\"A\": \"1\"}})])"
        );
        let path = file(&folder, "digits.ron", layout);
        run(["layout", "check", &path]).done().err
    };
    let warned = check("");
    let warning = "nothing activates the layer `digits`; add a key with `layer: \"digits\"`";
    assert!(warned.contains(warning), "{warned}");
    for keys in [
        "(layer: \"digits\", latch: OneShot, at_mm: (19, 0))",
        "(code: \"B\", hold: (layer: \"digits\"), at_mm: (19, 0))",
    ] {
        assert_eq!(check(keys), "", "{keys}");
    }
}

#[test]
fn wrong_names_in_a_setup_have_a_line() {
    let folder = tempfile::tempdir().unwrap();
    for (field, expected) in [
        (
            "output: \"desktp\"",
            ":2:9: `output`: unknown output `desktp`, did you mean `desktop`?",
        ),
        (
            "output: \"none:x\"",
            ":2:9: `output`: the output `none:x` takes no argument",
        ),
        (
            "panic_keys: [\"ControlLef\"]",
            ":2:14: `panic_keys`: unknown key `ControlLef`, did you mean `ControlLeft`?",
        ),
        (
            "panic_keys: [\"MouseLeft\"]",
            ":2:14: `panic_keys`: `MouseLeft` is not a key of a keyboard",
        ),
        (
            "profiles_by_application: [(application: \"foot\", profile: \"mian\")]",
            ":2:58: `profiles_by_application`: unknown profile `mian`, did you mean `main`?; add it to `profiles`",
        ),
        (
            "profiles_by_application: [(application: \" \", profile: \"main\")]",
            ":2:26: `profiles_by_application`: the name of an application is empty",
        ),
        (
            "profiles_by_application: [(application: \"foot\", profile: \"main\"), (application: \"Foot\", profile: \"main\")]",
            ":2:81: `profiles_by_application`: two rules for `Foot`",
        ),
        (
            "profiles: [(name: \"media\", layout: \"numpad\"), (name: \"media\", layout: \"arrows\")]",
            ":2:54: `profiles`: the name `media` is the name of two profiles",
        ),
        (
            "text: (mode: Auto, language: \"fr\")",
            ":2:30: `language`: unknown language `fr`; the languages are `en` and `es`",
        ),
        (
            "stall_timeout_ms: 300.5",
            ":2:22: expected a whole number, in digits only",
        ),
        (
            "stall_timeout_ms: 1e400",
            ":2:19: expected a whole number, in digits only",
        ),
        (
            "stall_timeout_ms: -300",
            ":2:20: the number is negative, or too large",
        ),
        (
            "profiles: [(name: \"main\", layout: \"numpad\")]",
            ":2:19: `profiles`: the name `main` is the name of the first layout",
        ),
        (
            "profiles: [(name: \"\", layout: \"numpad\")]",
            ":2:19: `profiles`: the name `` is empty",
        ),
        (
            "profiles: [(name: \"a\\nb\", layout: \"numpad\")]",
            ":2:19: `profiles`: the name `a\\nb` is empty, has a blank at an end or a control character",
        ),
    ] {
        let setup = file(&folder, "wrong.ron", format!("Setup(\n{field},\n)"));
        for command in ["run", "doctor"] {
            let ended = run([command, &setup, "--source", "typist:a"]).exited(2);
            ended.reported(&format!("wrong.ron{expected}"));
        }
    }
}

/// A machine may have keyboards that this user can read: both commands agree all the same.
#[test]
fn doctor_finds_the_panic_keys_that_a_run_refuses() {
    let folder = tempfile::tempdir().unwrap();
    let setup = "Setup(source: \"typist:a\", panic_keys: [\"ControlLeft\", \"ControlRight\"])";
    let setup = file(&folder, "setup.ron", setup);
    let started = run(["run", &setup, "--output", "none", "--control", "off"]);
    let checked = run(["doctor", &setup]);
    let line = checked.out.lines().find(|line| line.contains("panic keys"));
    let line = line.unwrap_or_else(|| panic!("{}", checked.out));
    if started.err.contains("panic_keys: ") {
        assert!(
            line.starts_with("missing ") && line.contains(" needed "),
            "{line}"
        );
        checked.exited(1);
    } else {
        assert!(line.starts_with("ok "), "{line}")
    }
}

#[test]
fn a_new_setup_types_into_other_programs() {
    let folder = tempfile::tempdir().unwrap();
    let path = text(&folder.path().join("mine")).to_owned();
    run(["setup", "new", &path]).done();
    let checked = run(["doctor", &format!("{path}.ron"), "--json"]);
    let json: serde_json::Value = serde_json::from_str(&checked.out).unwrap();
    let checks = json["checks"].as_array().unwrap();
    let needed = |name: &str| {
        checks
            .iter()
            .any(|it| it["check"] == name && it["needed"] == true)
    };
    assert!(needed("display") || needed("compositor"), "{}", checked.out);
}

#[test]
fn new_files_go_to_the_standard_output_on_request() {
    let folder = tempfile::tempdir().unwrap();
    let printed = |arguments: &str| {
        let mut command = ademan(arguments.split(' '));
        run_to_end(command.current_dir(folder.path())).done().out
    };
    let root = env!("CARGO_MANIFEST_DIR");
    let shipped = |path: &str| std::fs::read_to_string(format!("{root}/{path}")).unwrap();
    assert_eq!(printed("setup new -"), shipped("examples/setup.ron"));
    assert!(printed("layout new - --from numpad").contains("Layout("));
    assert!(printed("layout new - --from numpad --mirror").contains("hand: \"left\""));
    assert!(printed("glove new -").contains("Glove("));
    assert_eq!(
        printed("script new - --from media"),
        shipped("examples/scripts/media.txt")
    );
    assert_eq!(std::fs::read_dir(folder.path()).unwrap().count(), 0);
}

#[test]
fn the_readme_shows_the_transcript_that_the_program_prints() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("hand.mcap");
    run(["record", text(&path), "--source", "typist:Hi"]).done();
    let replayed = run(["replay", text(&path)]).done();
    let readme = concat!(env!("CARGO_MANIFEST_DIR"), "/README.md");
    let readme = std::fs::read_to_string(readme)
        .unwrap()
        .replace("\r\n", "\n");
    let shown = format!(
        "$ ademan replay hand.mcap\n{}{}",
        replayed.out, replayed.err
    );
    assert!(readme.contains(&shown), "{shown}");
}

#[cfg(unix)]
#[test]
fn the_unit_is_written_to_its_folder_for_the_program_that_writes_it() {
    let folder = tempfile::tempdir().unwrap();
    let install = |name: &str| {
        let mut command = ademan(["system-files", name, "--install"]);
        command
            .env("HOME", folder.path())
            .env_remove("XDG_DATA_HOME")
            .env("XDG_CONFIG_HOME", folder.path().join("config"));
        run_to_end(&mut command)
    };
    let written = folder.path().join("config/systemd/user/ademan.service");
    let ended = install("unit").done();
    ended.printed(text(&written));
    let unit = std::fs::read_to_string(&written).unwrap();
    let program = env!("CARGO_BIN_EXE_ademan");
    for line in [
        format!("ExecStart={program} run "),
        format!("ExecStopPost=-{program} release-keys"),
        format!("ExecPaths=/usr {program} "),
    ] {
        assert!(unit.contains(&line), "{line}");
    }
    assert!(!unit.contains("/usr/bin/ademan"));
    install("desktop").done();
    assert!(
        folder
            .path()
            .join(".local/share/applications/ademan.desktop")
            .is_file()
    );
    for (name, message) in [
        ("unit", "exists"),
        ("udev", "with sudo"),
        ("all", "with sudo"),
    ] {
        let refused = install(name);
        assert!(
            refused.code != Some(0) && refused.err.contains(message),
            "{}",
            refused.err
        );
    }
}

#[cfg(unix)]
#[test]
fn a_file_of_a_person_needs_an_absolute_folder() {
    let folder = tempfile::tempdir().unwrap();
    let install = |config: &Path| {
        let mut command = ademan(["system-files", "unit", "--install"]);
        command
            .current_dir(folder.path())
            .env("HOME", "home")
            .env("XDG_CONFIG_HOME", config);
        run_to_end(&mut command)
    };
    let refused = install(Path::new("config")).exited(2);
    refused.reported("set HOME");
    let mut left = std::fs::read_dir(folder.path()).unwrap();
    assert!(left.next().is_none(), "nothing is in the working folder");
    let config = folder.path().join("config");
    install(&config).done();
    assert!(config.join("systemd/user/ademan.service").is_file());
}

#[cfg(target_os = "linux")]
#[test]
fn a_unit_names_a_program_with_any_letters_and_the_next_command_works() {
    let folder = tempfile::tempdir().unwrap();
    let folder = folder.path();
    let home = folder.join("home");
    let install = |program: &Path| {
        let mut command = Command::new(program);
        command
            .args(["system-files", "unit", "--install"])
            .env("HOME", &home)
            .env_remove("XDG_RUNTIME_DIR")
            .env("XDG_CONFIG_HOME", home.join("my config"));
        run_to_end(&mut command)
    };
    let unit = home.join("my config/systemd/user/ademan.service");
    for (name, start, stop) in [
        (
            "mi año 5%",
            "\"F/mi año 5%%/ademan\"",
            "\"-F/mi año 5%%/ademan\"",
        ),
        ("niño", "F/niño/ademan", "-F/niño/ademan"),
        ("a$b", ":F/a$b/ademan", "-:F/a$b/ademan"),
    ] {
        let program = folder.join(name).join("ademan");
        std::fs::create_dir(folder.join(name)).unwrap();
        copy_binary(&program);
        let ended = install(&program).done();
        let written = std::fs::read_to_string(&unit).unwrap();
        let [start, stop] = [start, stop].map(|word| word.replace('F', text(folder)));
        assert!(
            written.contains(&format!("\nExecStart={start} run ")),
            "{written}"
        );
        let stops = format!("\nExecStopPost={stop} release-keys\n");
        assert!(written.contains(&stops), "{written}");
        let paths = format!("\nExecPaths=/usr {} ", start.replace(':', ""));
        assert!(written.contains(&paths), "{written}");
        verify_unit(&unit, folder);
        std::fs::remove_file(&unit).unwrap();
        let next = ended
            .out
            .lines()
            .find_map(|line| line.strip_prefix("next: "));
        let next = next.and_then(|next| next.split_once(", then ")).unwrap().0;
        let mut shell = Command::new("sh");
        shell.args(["-c", next]).env("HOME", &home);
        let path = format!("{}:/usr/bin:/bin", folder.join(name).display());
        let created = shell.env("PATH", path).output().unwrap();
        assert!(created.status.success(), "{next}: {created:?}");
        std::fs::remove_file(home.join("my config/ademan/setup.ron")).unwrap();
    }
    let quoted = folder.join("it's");
    std::fs::create_dir(&quoted).unwrap();
    copy_binary(&quoted.join("ademan"));
    let refused = install(&quoted.join("ademan")).exited(2);
    refused.reported("move the program");
    assert!(!unit.exists());
}

/// Checks that systemd finds the programs of a unit, where it is installed.
#[cfg(target_os = "linux")]
fn verify_unit(unit: &Path, runtime: &Path) {
    let mut verify = Command::new("systemd-analyze");
    verify
        .args(["--user", "--man=no", "verify"])
        .arg(unit)
        .env("XDG_RUNTIME_DIR", runtime);
    let Ok(verified) = verify.output() else {
        println!("SKIPPED: systemd-analyze is not installed");
        return;
    };
    let errors = String::from_utf8_lossy(&verified.stderr);
    let is_wrong = |reason: &str| errors.contains(reason);
    assert!(!is_wrong("is not executable"), "{errors}");
    assert!(!is_wrong("special characters"), "{errors}");
    assert!(!is_wrong("ignoring"), "{errors}");
}

#[cfg(target_os = "linux")]
#[test]
fn messages_break_between_words_on_a_narrow_terminal() {
    let folder = tempfile::tempdir().unwrap();
    let setup = file(&folder, "setup.ron", "Setup(glove: \"lucidgloves\")");
    let program = env!("CARGO_BIN_EXE_ademan");
    let command =
        format!("stty rows 30 columns 60; exec {program} layout check qwerty-flat --setup {setup}");
    let shown = Command::new("script")
        .args(["--quiet", "--return", "--command", &command, "/dev/null"])
        .env("SHELL", "/bin/sh")
        .stdin(Stdio::null())
        .output();
    let shown = match shown {
        Err(error) if error.kind() == std::io::ErrorKind::NotFound => {
            println!("SKIPPED: `script` of util-linux is not installed");
            return;
        }
        shown => String::from_utf8(shown.unwrap().stdout).unwrap(),
    };
    let lines: Vec<&str> = shown.lines().filter(|line| !line.is_empty()).collect();
    assert!(lines.len() > 3, "{shown}");
    assert!(
        lines.iter().all(|line| line.chars().count() <= 60),
        "{shown}"
    );
    let words: Vec<&str> = shown.split_whitespace().collect();
    let whole = run(["layout", "check", "qwerty-flat", "--setup", &setup]).done();
    let messages = format!("{}{}", whole.out, whole.err);
    assert_eq!(words, messages.split_whitespace().collect::<Vec<_>>());
}

#[test]
fn the_bridge_of_the_webcam_asks_for_its_model_first() {
    let script = concat!(
        env!("CARGO_MANIFEST_DIR"),
        "/examples/bridges/mediapipe_webcam.py"
    );
    for (arguments, model) in [
        (&["no.task"][..], "hand_landmarker"),
        (&["--holistic", "no.task"], "holistic_landmarker"),
    ] {
        let mut python = Command::new("python3");
        let ended = match python.arg(script).args(arguments).output() {
            Err(error) if error.kind() == std::io::ErrorKind::NotFound => {
                println!("SKIPPED: python3 is not installed");
                return;
            }
            ended => Ended::from(ended.unwrap()).exited(1),
        };
        let place = format!("https://ai.google.dev/edge/mediapipe/solutions/vision/{model}");
        assert!(
            ended.err.starts_with("there is no model file 'no.task'"),
            "{}",
            ended.err
        );
        ended.reported(&place);
    }
}
