//! `ademan webcam` and `ademan bridge webcam`: a hand in front of a camera, with the real bridge.

use std::process::{Command, Stdio};

use crate::support::peers::peer;
use crate::{file, run, run_in, run_to_end, text};

const MODELS: &str = "https://ai.google.dev/edge/mediapipe/solutions/vision/";

/// Returns `true` if there is a Python; prints SKIPPED without one.
fn has_python() -> bool {
    let found = Command::new("python3")
        .arg("--version")
        .stdout(Stdio::null())
        .status();
    if found.is_err() {
        println!("SKIPPED: there is no python3");
    }
    found.is_ok()
}

#[test]
fn the_bridge_of_the_webcam_is_printed_as_it_is_in_the_examples() {
    let printed = run(["bridge", "webcam"]).done().out;
    let path = concat!(
        env!("CARGO_MANIFEST_DIR"),
        "/examples/bridges/mediapipe_webcam.py"
    );
    assert_eq!(printed, std::fs::read_to_string(path).unwrap());
}

#[test]
fn without_a_model_the_message_says_where_it_comes_from_before_python_starts() {
    let folder = tempfile::tempdir().unwrap();
    for (arguments, model) in [
        (
            &["webcam", "--python", "/nowhere/python"][..],
            "hand_landmarker",
        ),
        (&["bridge", "webcam", "--run"], "hand_landmarker"),
        (
            &["webcam", "--model", "my_holistic.task"],
            "holistic_landmarker",
        ),
        (
            &[
                "bridge",
                "webcam",
                "--run",
                "--model",
                "pose_landmarker_lite.task",
            ],
            "pose_landmarker",
        ),
    ] {
        let ended = run_in(folder.path(), arguments);
        assert_eq!(ended.code, Some(2), "{arguments:?}: {}", ended.err);
        for part in [
            "there is no model file",
            "--model",
            &format!("{MODELS}{model}"),
        ] {
            assert!(ended.err.contains(part), "{arguments:?}: {}", ended.err);
        }
    }
    let missing = run_in(folder.path(), ["webcam", "--results", "no.json"]).exited(2);
    missing.reported("there is no file no.json");
}

#[test]
fn the_bridge_loads_no_module_of_the_working_folder() {
    if !has_python() {
        return;
    }
    let folder = tempfile::tempdir().unwrap();
    for module in ["argparse", "json", "math", "mediapipe", "cv2"] {
        let planted = format!("print('the {module} of a stranger')");
        file(&folder, &format!("{module}.py"), planted);
    }
    let results = file(&folder, "results.json", "{\"samples\":[{}]}");
    let arguments = ["bridge", "webcam", "--run", "--results", &results];
    let played = run_in(folder.path(), arguments).done();
    assert_eq!(played.out.lines().count(), 1, "{}", played.out);
    assert!(played.out.starts_with("{\"time_us\":"), "{}", played.out);
}

#[test]
fn a_python_a_camera_or_results_that_do_not_work_end_with_one_message() {
    if !has_python() {
        return;
    }
    let folder = tempfile::tempdir().unwrap();
    let results = file(&folder, "wrong.json", "{\"samples\":");
    file(&folder, "hand_landmarker.task", "no model");
    for (arguments, part) in [
        (
            &["webcam", "--python", "/nowhere/python"][..],
            "install Python 3",
        ),
        (
            &["webcam", "--camera", "/nowhere/camera"],
            "there is no camera, film or photo",
        ),
        (&["webcam", "--results", &results], "cannot read results"),
        (
            &["webcam", "--source", "udp:127.0.0.1:9"],
            "the source is the camera",
        ),
    ] {
        let ended = run_in(folder.path(), arguments);
        assert!(ended.code != Some(0), "{arguments:?}: {}", ended.err);
        assert!(ended.err.contains(part), "{arguments:?}: {}", ended.err);
        assert!(!ended.err.contains("Traceback"), "{}", ended.err);
        let errors = ended.err.lines().filter(|line| line.starts_with("error: "));
        assert_eq!(errors.count(), 1, "{}", ended.err);
    }
}

#[test]
fn a_python_that_the_system_manages_gets_an_environment_for_the_packages() {
    if !has_python() {
        return;
    }
    let folder = tempfile::tempdir().unwrap();
    let bridge = concat!(
        env!("CARGO_MANIFEST_DIR"),
        "/examples/bridges/mediapipe_webcam.py"
    );
    let script = "import runpy, sys, sysconfig\n\
        sys.prefix = sys.base_prefix\n\
        sysconfig.get_path = lambda name: sys.argv[2]\n\
        print(runpy.run_path(sys.argv[1])['install_command']())";
    let command = || {
        let mut python = Command::new("python3");
        python.args(["-c", script, bridge, text(folder.path())]);
        run_to_end(&mut python).done().out
    };
    assert!(command().contains("-m pip install"), "{}", command());
    file(&folder, "EXTERNALLY-MANAGED", "");
    let managed = command();
    assert!(managed.contains("-m venv ~/ademan-python"), "{managed}");
    assert!(
        managed.contains("--python ~/ademan-python/bin/python3"),
        "{managed}"
    );
}

#[test]
fn recorded_hands_go_through_the_bridge_into_a_session() {
    let hands = peer("landmarks/mediapipe_tasks_hands.json");
    let Some(hands) = hands.filter(|_| has_python()) else {
        return;
    };
    let lines = run(["bridge", "webcam", "--run", "--results", text(&hands)]).done();
    assert_eq!(lines.out.lines().count(), 6, "{}", lines.out);
    assert!(
        lines
            .out
            .lines()
            .all(|line| line.starts_with("{\"time_us\":"))
    );

    let folder = tempfile::tempdir().unwrap();
    let recording = folder.path().join("hands.mcap");
    let arguments = [
        "webcam",
        "--results",
        text(&hands),
        "--output",
        "transcript",
        "--record",
        text(&recording),
    ];
    let session = run(arguments);
    session.reported("6 readings");
    let replayed = run(["replay", text(&recording)]).done();
    replayed.reported("6 readings");
}

#[test]
fn a_hand_that_only_moves_is_told_what_its_layout_lacks() {
    if !has_python() {
        return;
    }
    let folder = tempfile::tempdir().unwrap();
    let script = concat!(env!("CARGO_MANIFEST_DIR"), "/tests/support/webcam_hand.py");
    let film = Command::new("python3")
        .args([script, "away"])
        .output()
        .unwrap();
    let film = file(&folder, "film.json", film.stdout);
    for (layout, part) in [
        ("ray", "the range of the pointer is "),
        ("webcam-mouse", "hold your hand open and still for a second"),
    ] {
        let ended = run(["webcam", "--results", &film, "--layout", layout]);
        assert!(ended.err.contains(part), "{layout}: {}", ended.err);
        assert_eq!(
            ended.err.matches("the right hand moves").count(),
            usize::from(layout == "ray"),
            "{}",
            ended.err
        );
    }
}
