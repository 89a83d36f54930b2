//! Gloves as people make them, with a rule of their own, on a pseudo-terminal: calibrated, found and typed with.

use std::fs;
use std::io::{BufRead, BufReader};
use std::process::Stdio;

use ademan::document::Document;
use ademan::files::Load;
use ademan::hand::{Dof, Input};
use ademan::layout::Glove;
use tempfile::TempDir;

use crate::support::home_made_glove::{BUILD, Build, Wearer};
use crate::support::process::Process;
use crate::text_line::pressed_keys;
use crate::{Ended, ademan, file, run, run_in};

/// Runs `ademan calibrate` in a folder, and takes the poses that it asks for.
fn calibrate(wearer: &Wearer, folder: &TempDir, arguments: &[&str]) -> Ended {
    let source = format!("serial:{}?protocol=lucidgloves", wearer.port());
    let mut command = ademan(["calibrate", "--countdown", "0.5", "--source", &source]);
    command.args(arguments).current_dir(folder.path());
    wearer.pose_for(command).into()
}

fn read_glove(folder: &TempDir, name: &str) -> Glove {
    let text = fs::read_to_string(folder.path().join(name)).expect("a file");
    println!("{text}");
    Glove::parse(&Document::new(name, text)).expect("a glove")
}

/// Returns the angle of a joint in degrees at a bend of all fingers.
fn degrees(glove: &Glove, build: &Build, dof: Dof, bend: f64) -> f64 {
    let quiet = Build {
        noise: 0,
        ..build.clone()
    };
    let line = quiet.line([bend; 5], &mut fastrand::Rng::with_seed(0));
    let fields = ademan::capture::protocol::lucidgloves::Fields::parse(line.as_bytes());
    let channels = fields.expect("a packet").channels(4095);
    let mut rows = glove.map.rows().iter();
    let row = rows
        .find(|row| row.dof == dof)
        .expect("the joint is measured");
    let count = f64::from(channels.counts[row.channel]);
    glove.map.radians(row, count).to_degrees()
}

/// Asserts that a glove file bends the fingers of a build as the person does, types with it, and keeps what the glove does not measure.
fn assert_usable(folder: &TempDir, name: &str, build: &Build) {
    let glove = read_glove(folder, name);
    for (dof, bent) in [
        (Dof::IndexMcpFlexion, 90.0),
        (Dof::MiddlePipFlexion, 100.0),
        (Dof::LittleDipFlexion, 70.0),
    ] {
        let [straight, closed] = [0.0, 1.0].map(|bend| degrees(&glove, build, dof, bend));
        assert!(straight.abs() < 8.0, "{dof}: {straight}");
        assert!((closed - bent).abs() < 12.0, "{dof}: {closed}");
    }
    let shipped = Glove::load("lucidgloves").expect("a glove").map;
    let elbow = |map: &ademan::estimate::ChannelMap| {
        let mut assumed = map.assumed_angles().iter();
        let elbow = assumed.find(|(dof, _)| *dof == Dof::ElbowFlexion);
        elbow.expect("it is assumed").1
    };
    assert!((elbow(&glove.map) - elbow(&shipped)).abs() < 1e-9);
    assert_eq!(glove.map.inputs().len(), Input::ALL.len());
    assert_eq!(glove.map.inputs(), shipped.inputs());

    let path = file(folder, "chords.txt", build.chords());
    let source = format!("file:{path}?protocol=lucidgloves&rate_hz=100");
    let glove_path = folder.path().join(name);
    let glove_path = glove_path.to_str().expect("UTF-8");
    let arguments = ["run", "--source", &source, "--layout", "chords-bend"];
    let typed = run(arguments.into_iter().chain(["--glove", glove_path])).done();
    assert_eq!(
        pressed_keys(&typed.out),
        ["H", "O", "D", "A"],
        "{}",
        typed.err
    );
}

#[test]
fn a_glove_that_sends_five_curls_is_calibrated_and_types_with_its_file() {
    let folder = tempfile::tempdir().expect("a folder");
    let wearer = Wearer::start(BUILD);
    let ended = calibrate(&wearer, &folder, &["--out", "mine"]).done();
    let score = ended
        .out
        .lines()
        .find_map(|line| line.strip_prefix("score "));
    let score = score.and_then(|line| line.strip_suffix(" of 100"));
    let score: u8 = score.expect("a score").parse().expect("a number");
    assert!(score > 60, "{score}");
    ended.printed("index-mcp-abduction      not sent");
    ended.printed("(middle-mcp-flexion) counts the other way");
    assert!(!ended.out.contains("dead"), "{}", ended.out);
    ended.printed("use it: ademan run --glove mine.ron --source 'serial:");
    // It measures no arm.
    ended.printed("' --layout chords-bend\n");
    assert_usable(&folder, "mine.ron", &BUILD);
    // The recording knows what was not sent.
    let again = ["calibrate", "--from", "mine.mcap", "--out", "again.ron"];
    run_in(folder.path(), again).done();
    let text = |name| fs::read(folder.path().join(name)).expect("a file");
    assert_eq!(text("again.ron"), text("mine.ron"));
}

#[test]
fn a_channel_that_is_sent_and_never_changes_is_dead() {
    let folder = tempfile::tempdir().expect("a folder");
    let build = Build {
        rest: "F2047G2047P0(BB)2047",
        ..BUILD
    };
    let wearer = Wearer::start(build);
    let ended = calibrate(&wearer, &folder, &["--out", "mine"]).exited(1);
    let reason = "channel 6 (index-mcp-abduction) stays at 2047 in every pose: the sensor is dead";
    ended.reported(reason);
    let errors = &ended.err;
    assert!(!errors.contains("channel 7"), "it was not sent: {errors}");
    assert!(!folder.path().join("mine.ron").exists());
}

#[test]
fn exchanged_sensors_of_fingers_are_found_put_right_and_typed_with() {
    let folder = tempfile::tempdir().expect("a folder");
    // The plugs of three fingers are one place further.
    let build = Build {
        order: [0, 2, 3, 1, 4],
        ..BUILD
    };
    let wearer = Wearer::start(build.clone());
    let ended = calibrate(&wearer, &folder, &["--fingers", "--out", "mine"]).done();
    for expected in [
        "pose 10 of 10: little-bent: bend only the little finger",
        "thumb    10, 11, 12\n",
        "index    23, 24, 25 (starting glove: ring)\n",
        "middle   15, 16, 17 (starting glove: index)\n",
        "ring     19, 20, 21 (starting glove: middle)\n",
        "little   27, 28, 29\n",
        "exchanged sensors: the new file has each at the finger that it follows\n",
    ] {
        ended.printed(expected);
    }
    let out = &ended.out;
    assert!(!out.contains("--fingers"), "it was done: {out}");
    assert_usable(&folder, "mine.ron", &build);
    // From the new file on, and from the recording, each sensor is at its finger.
    let source = format!("serial:{}?protocol=lucidgloves", wearer.port());
    let mut again = ademan(["calibrate", "--fingers", "--countdown", "0.5"]);
    again.args(["--source", &source, "--glove", "mine.ron", "--out", "again"]);
    again.current_dir(folder.path());
    let posed = Ended::from(wearer.pose_for(again)).done();
    posed.printed("ring     19, 20, 21\n");
    assert!(!posed.out.contains("exchanged sensors"), "{}", posed.out);
    let kept = ["calibrate", "--from", "mine.mcap", "--out", "kept.ron"];
    run_in(folder.path(), kept).done();
    let text = |name| fs::read(folder.path().join(name)).expect("a file");
    assert_eq!(text("kept.ron"), text("mine.ron"));
}

#[test]
fn the_channels_of_a_glove_that_sends_five_curls_are_found() {
    let folder = tempfile::tempdir().expect("a folder");
    // It follows the index finger, and measures none.
    let build = Build {
        has_trigger: true,
        ..BUILD
    };
    let wearer = Wearer::start(build.clone());
    let ended = calibrate(&wearer, &folder, &["--discover", "--out", "found"]).done();
    assert!(!ended.out.contains("not clear"), "{}", ended.out);
    let next = format!(
        "next: ademan calibrate --glove found.ron --source 'serial:{}?protocol=lucidgloves",
        wearer.port()
    );
    ended.printed(&next);
    let glove = read_glove(&folder, "found.ron");
    let channels = |finger| {
        let rows = glove.map.rows().iter();
        let own = rows.filter(move |row| row.dof.finger() == Some(finger));
        own.map(|row| row.channel).collect::<Vec<_>>()
    };
    for (channel, &finger) in ademan::hand::Finger::ALL.iter().enumerate() {
        assert_eq!(channels(finger), [channel; 3], "{finger}");
    }
    assert_usable(&folder, "found.ron", &build);
}

#[test]
fn home_made_gloves_are_shown_without_a_glove() {
    for (kind, expected) in [
        ("curls", "score "),
        ("inverted", "(index-mcp-flexion) counts the other way"),
        ("narrow", "score "),
        ("noisy", "score "),
        (
            "dead",
            "(ring-mcp-flexion) stays at 2047 in every pose: the sensor is dead",
        ),
    ] {
        let folder = tempfile::tempdir().expect("a folder");
        let demo = ["calibrate", "--demo", "--demo-glove", kind, "--out", "mine"];
        let ended = run_in(folder.path(), demo).done();
        println!("{kind}\n{}", ended.out);
        assert!(ended.out.contains(expected), "{kind}: {}", ended.out);
        assert_eq!(ended.out.contains("dead"), kind == "dead", "{}", ended.out);
        ended.printed("index-mcp-abduction      not sent");
        let glove = read_glove(&folder, "mine.ron");
        assert_eq!(glove.map.inputs().len(), Input::ALL.len());
    }
    let folder = tempfile::tempdir().expect("a folder");
    let demo = [
        "calibrate",
        "--discover",
        "--demo",
        "--demo-glove",
        "curls",
        "--out",
        "found",
    ];
    run_in(folder.path(), demo).done();
    assert_eq!(read_glove(&folder, "found.ron").map.rows().len(), 15);
}

#[test]
fn exchanged_sensors_are_shown_without_a_glove() {
    let folder = tempfile::tempdir().expect("a folder");
    let demo = ["calibrate", "--demo", "--demo-glove", "swapped"];
    let demo = demo.into_iter().chain(["--fingers", "--out", "mine"]);
    let ended = run_in(folder.path(), demo).done();
    for expected in [
        "middle   23, 24, 25 (starting glove: ring)\n",
        "ring     19, 20, 21 (starting glove: middle)\n",
    ] {
        ended.printed(expected);
    }
}

#[test]
fn a_glove_whose_protocol_is_not_named_is_recognized() {
    let wearer = Wearer::start(BUILD);
    let source = format!("serial:{}", wearer.port());
    let mut command = ademan(["run", "--source", &source]);
    command.stdout(Stdio::null()).stderr(Stdio::piped());
    let mut program = Process::start(&mut command).expect("it starts");
    let stderr = program.0.stderr.take().expect("it is piped");
    let mut lines = BufReader::new(stderr).lines().map_while(Result::ok);
    let line = lines.find(|line| line.contains("no valid packet"));
    let line = line.expect("a warning");
    assert!(
        line.contains("looks like LucidGloves: add protocol=lucidgloves"),
        "{line}"
    );
}
