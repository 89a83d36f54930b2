//! `ademan calibrate`: the session on a terminal and in lines, the glove file, and recordings.

use std::fs;
use std::path::Path;
use std::time::Duration;

use ademan::calibrate::{
    CalibrationPose, CaptureState, MARKS_KIND, Procedure, ProcedureState, marks_to_text,
};
use ademan::capture::recording::RecordedSetup;
use ademan::capture::{Reading, Sample};
use ademan::document::Document;
use ademan::estimate::Estimate;
use ademan::files::{Load, OpenDocument};
use ademan::hand::{Joint, Side};
use ademan::kinematics::{ArmModel, BoneLengths};
use ademan::layout::Glove;
use ademan::recorder::Recorder;
use ademan::sim::{GloveFault, SimulatedWearer};
use ademan::time::Timestamp;
use tempfile::TempDir;

#[cfg(target_os = "linux")]
use crate::ademan;
#[cfg(target_os = "linux")]
use crate::view::{screen::Screen, set_terminal};
use crate::{Ended, run_in};

/// Runs `ademan calibrate` in a folder, without a terminal.
pub fn calibrate(folder: &TempDir, arguments: &[&str]) -> Ended {
    let ended = run_in(folder.path(), ["calibrate"].iter().chain(arguments));
    println!("{}{}", ended.out, ended.err);
    ended
}

pub fn folder() -> TempDir {
    tempfile::tempdir().expect("a folder")
}

pub fn read(folder: &TempDir, name: &str) -> String {
    fs::read_to_string(folder.path().join(name)).expect("a file")
}

#[test]
fn a_simulated_person_gets_a_glove_file_and_its_recording_gives_the_same_file_twice() {
    let folder = folder();
    let ended = calibrate(&folder, &["--demo", "--out", "mine"]).done();
    for expected in [
        "pose 1 of 13: rest: lay the hand",
        "pose 13 of 13: elbow-bent:",
        " of 100\n",
        "index-mcp-flexion",
        "wrote mine.ron",
        "undo: remove mine.ron",
        "kept the readings: mine.mcap",
        "ademan run --glove mine.ron",
    ] {
        ended.printed(expected);
    }
    let text = read(&folder, "mine.ron");
    let glove = Glove::parse(&Document::new("mine.ron", text.clone())).expect("a glove");
    assert!(!glove.rest_pose.is_empty(), "`zero` returns to it");
    let shipped = Glove::load("unam-hc11").expect("a glove");
    assert_ne!(glove.map, shipped.map);
    for name in ["first", "second"] {
        calibrate(&folder, &["--from", "mine.mcap", "--out", name]).done();
        assert_eq!(read(&folder, &format!("{name}.ron")), text, "{name}");
    }
}

#[test]
fn a_file_is_replaced_only_by_force_and_its_old_version_is_kept() {
    let folder = folder();
    calibrate(&folder, &["--demo", "1", "--out", "mine"]).done();
    let first = read(&folder, "mine.ron");
    let refused = calibrate(&folder, &["--demo", "2", "--out", "mine.ron"]).exited(2);
    refused.reported("mine.ron exists").reported("--force");
    let out = refused.out;
    assert!(
        !out.contains("pose 1"),
        "it is refused before the session: {out}"
    );
    assert_eq!(read(&folder, "mine.ron"), first);

    let forced = ["--demo", "2", "--out", "mine.ron", "--force"];
    let forced = calibrate(&folder, &forced).done();
    forced.printed("undo: mv mine.ron.bak mine.ron");
    assert_ne!(read(&folder, "mine.ron"), first);
    assert_eq!(read(&folder, "mine.ron.bak"), first);
    // The readings of the first session are not lost either.
    assert!(folder.path().join("mine.mcap").exists());
    assert!(folder.path().join("mine.2.mcap").exists());
}

#[test]
fn a_glove_file_of_the_person_is_the_default_destination() {
    let folder = folder();
    let ended = calibrate(&folder, &["--demo"]).done();
    ended.printed("wrote my-unam-hc11.ron");
    let refused = calibrate(&folder, &["--demo", "--glove", "my-unam-hc11.ron"]).exited(2);
    refused.reported("my-unam-hc11.ron exists");
}

#[test]
fn a_left_hand_starts_from_the_left_glove() {
    let folder = folder();
    let demo = ["--demo", "--hand", "left"];
    let curls = [&demo[..], &["--demo-glove", "curls"]].concat();
    for (arguments, file) in [
        (&demo[..], "my-unam-hc11-left.ron"),
        (&curls[..], "my-lucidgloves-left.ron"),
    ] {
        calibrate(&folder, arguments).done();
        let glove = Glove::parse(&Document::new(file, read(&folder, file)));
        assert_eq!(glove.expect("a glove").side, Side::Left);
    }
    let named = [&demo[..], &["--glove", "unam-hc11"]].concat();
    // The file states its hand.
    calibrate(&folder, &named).exited(2);
}

#[test]
fn a_glove_with_a_dead_sensor_is_refused_with_the_reason_and_nothing_is_written() {
    let folder = folder();
    let shipped = Document::open("unam-hc11").expect("a glove");
    let glove = Glove::parse(&shipped).expect("a glove");
    let rows = glove.map.rows().iter();
    let index: Vec<_> = rows
        .filter(|row| row.dof.finger() == Some(ademan::hand::Finger::Index))
        .collect();
    let channel = index.first().expect("sensors of the index finger").channel;
    let wearer =
        SimulatedWearer::new(3, &glove.map, glove.side).with_fault(GloveFault::Dead(channel));
    record(&folder.path().join("dead.mcap"), &glove, wearer);
    let ended = calibrate(&folder, &["--from", "dead.mcap", "--out", "mine"]).exited(1);
    ended.reported("not usable").reported("dead");
    ended.reported(&format!("channel {channel} (index-"));
    assert!(!folder.path().join("mine.ron").exists());
}

#[test]
fn the_channels_of_an_unknown_glove_are_found_and_the_new_file_is_calibrated() {
    let folder = folder();
    let arguments = ["--discover", "--demo", "--hand", "right", "--out", "found"];
    let ended = calibrate(&folder, &arguments).done();
    ended.printed("index-bent: bend only the index finger");
    ended.printed("next: ademan calibrate --glove found.ron");
    let found = Glove::parse(&Document::new("found.ron", read(&folder, "found.ron")));
    let found = found.expect("a glove").map;
    let worn = Glove::load("unam-hc11")
        .expect("the glove of the person")
        .map;
    for finger in ["index", "middle", "ring", "little"] {
        let channels = |map: &ademan::estimate::ChannelMap| {
            let rows = map.rows().iter();
            let mut channels: Vec<usize> = rows
                .filter(|row| {
                    row.dof.name().starts_with(finger) && row.dof.name().ends_with("flexion")
                })
                .map(|row| row.channel)
                .collect();
            channels.sort_unstable();
            channels.dedup();
            channels
        };
        assert_eq!(channels(&found), channels(&worn), "{finger}");
    }
    calibrate(&folder, &["--demo", "--glove", "found.ron", "--force"]).done();
}

/// Records the calibration of a person.
fn record(path: &Path, glove: &Glove, wearer: SimulatedWearer) {
    let (setup, readings) = take_poses(glove, wearer);
    write_readings(path, &setup, &readings);
}

/// Returns the readings of a person who takes all poses, with the marks of the poses.
pub fn take_poses(glove: &Glove, mut wearer: SimulatedWearer) -> (RecordedSetup, Vec<Reading>) {
    let mut procedure = Procedure::for_glove(&glove.map, Duration::from_secs(1));
    let mut readings = Vec::new();
    while let Some(pose) = procedure.pose() {
        wearer.take(pose);
        let (time, channels) = wearer.next_packet();
        let state = procedure.push(time, &channels);
        assert!(time.seconds() < 600.0, "{pose} is not captured: {state:?}");
        readings.push(Reading::new(time, None, Sample::Channels(channels)));
        if let ProcedureState::Pose(_, CaptureState::Captured) = state {
            println!("{pose} at {:.1} s", time.seconds());
        }
    }
    let marks = marks_to_text(procedure.marks());
    let setup = RecordedSetup::default().with(MARKS_KIND, "poses", &marks);
    (setup, readings)
}

pub fn write_readings(path: &Path, setup: &RecordedSetup, readings: &[Reading]) {
    let mut recorder = Recorder::create(path, setup).expect("a recording");
    for reading in readings {
        recorder.write_reading(reading).expect("it is written");
    }
    recorder.finish().expect("it is written");
}

#[test]
fn sources_that_need_no_glove_or_are_not_named_are_refused() {
    let folder = folder();
    let unnamed = calibrate(&folder, &[]).exited(2);
    unnamed.reported("no source is named").reported("--demo");
    fs::write(folder.path().join("angles.txt"), "0 ".repeat(64) + "\n").expect("a file");
    let source = "file:angles.txt?protocol=text-line";
    let angles = calibrate(&folder, &["--source", source]).exited(2);
    angles.reported("nothing to calibrate");
    let typist = calibrate(&folder, &["--source", "typist:hello"]).exited(1);
    typist.reported("ended at pose");
}

#[test]
fn typed_lengths_are_checked_and_give_the_line_for_the_setup() {
    let folder = folder();
    let lengths = ["--hand-length", "189", "--forearm-length", "262"];
    let demo = ["--demo", "--out", "mine"];
    let ended = calibrate(&folder, &[&demo[..], &lengths].concat()).done();
    let mut lines = ended.out.lines();
    let line = lines.find_map(|line| line.strip_prefix("in the setup file: "));
    let fields = line.expect("a line for the setup");
    let setup = format!("Setup(source: \"typist:a\", {fields})");
    fs::write(folder.path().join("setup.ron"), setup).expect("a file");
    run_in(folder.path(), ["run", "setup.ron"]).done();
    for (wrong, reason) in [
        (
            &lengths[..2],
            "give both --hand-length and --forearm-length",
        ),
        (
            &["--hand-length", "301", "--forearm-length", "262"],
            "'301' for '--hand-length <MM>': it is 100 to 300 mm",
        ),
        (
            &["--hand-length", "18.9", "--forearm-length", "26.2"],
            "'18.9' for '--hand-length <MM>': it is 100 to 300 mm; 18.9 cm are 189 mm",
        ),
        (
            &["--hand-length", "262", "--forearm-length", "189"],
            "with this hand it is 236 to 472 mm long; check that they are not exchanged",
        ),
        (
            &["--hand-length", "18.9cm", "--forearm-length", "262"],
            "is not a number",
        ),
    ] {
        let arguments = [&["--demo", "--out", "other"], wrong].concat();
        calibrate(&folder, &arguments).exited(2).reported(reason);
        assert!(!folder.path().join("other.ron").exists());
    }
}

#[test]
fn a_headset_measures_the_hand_the_table_and_the_place_of_a_board() {
    let bones = BoneLengths::from_hand_and_forearm(0.18, 0.25).expect("a person");
    let arm = ArmModel::anthropometric(Side::Right, &bones).expect("an arm");
    let hand = arm.forward(&Estimate::new(
        Timestamp(0),
        CalibrationPose::Spread.angles(),
    ));
    let joints: Vec<[f32; 3]> = Joint::ALL[Joint::Wrist.index()..]
        .iter()
        .map(|&joint| hand.position(joint).expect("all joints").to_array())
        .collect();
    let lines: String = (0..40)
        .map(|index| {
            let time = index * 20_000;
            format!(
                "{{\"time_us\":{time},\"hands\":[{{\"label\":\"right\",\"joints\":{joints:?}}}]}}\n"
            )
        })
        .collect();
    let folder = folder();
    fs::write(folder.path().join("hand.jsonl"), lines).expect("a file");
    let source = "file:hand.jsonl?protocol=webxr";
    let ended = calibrate(&folder, &["--source", source]).done();
    for expected in [
        "hand length: 178 mm",
        "table: -5 mm high, slope 0°",
        "in the layout: pose: (anchor: world, bearing_deg: ",
    ] {
        ended.printed(expected);
    }
    let known = ["--source", source, "--forearm-length", "262"];
    let known = calibrate(&folder, &known).done();
    let line = "in the setup file: arm: Measured(hand_length_mm: 178, forearm_length_mm: 262)";
    known.printed(line);
    let wrong = calibrate(&folder, &["--source", source, "--forearm-length", "126"]);
    wrong.printed("no lengths: no person has a hand of 178 mm");
}

#[cfg(target_os = "linux")]
mod on_a_terminal {
    use super::*;
    use crate::support::home_made_glove::{BUILD, Wearer};

    fn start(folder: &TempDir, countdown: &str) -> Screen {
        let mut command = ademan(["calibrate", "--demo", "--out", "mine"]);
        command
            .args(["--countdown", countdown])
            .current_dir(folder.path());
        set_terminal(&mut command);
        Screen::start(&command, 80, 24)
    }

    #[test]
    fn a_whole_session_shows_poses_pictures_and_sensors_and_asks_before_it_replaces_a_file() {
        let folder = folder();
        fs::write(folder.path().join("mine.ron"), "precious").expect("a file");
        let mut screen = start(&folder, "0.5");
        let fist = screen.wait_for_text("fist: make a tight fist");
        println!("{fist}");
        for expected in [
            "calibrating UNAM flex glove",
            "pose 4 of 13  ●●●▶○○○○○○○○○",
            "from above",
            "from the side",
            "index-mcp-flexion",
            "r repeat   b back   s skip   q quit",
        ] {
            assert!(fist.contains(expected), "no {expected}:\n{fist}");
        }
        let is_picture = |line: &str| {
            line.chars()
                .any(|character| ('⠁'..='⣿').contains(&character))
        };
        assert!(
            fist.lines().filter(|line| is_picture(line)).count() > 6,
            "{fist}"
        );
        let held = screen.wait_for_text("hold still █");
        println!("{held}");
        screen.wait_for_text("replace mine.ron? [y/N]");
        assert_eq!(read(&folder, "mine.ron"), "precious");
        screen.assert_restored();
        screen.type_keys("y\r");
        assert!(screen.wait().success());
        let text = screen.text();
        println!("{text}");
        assert!(text.contains("wrote mine.ron"), "{text}");
        assert_eq!(read(&folder, "mine.ron.bak"), "precious");
        let glove = Document::new("mine.ron", read(&folder, "mine.ron"));
        Glove::parse(&glove).expect("a glove");
    }

    #[test]
    fn a_glove_of_another_protocol_is_named_while_its_readings_are_awaited() {
        let folder = folder();
        let wearer = Wearer::start(BUILD);
        let source = format!("serial:{}", wearer.port());
        let mut command = ademan(["calibrate", "--out", "mine", "--source", &source]);
        command.current_dir(folder.path());
        set_terminal(&mut command);
        let mut screen = Screen::start(&command, 80, 24);
        let keys = "r repeat   b back   s skip   q quit";
        let named = screen.wait_until("advice above the keys", |shown| {
            shown.contains("protocol=lucidgloves") && shown.contains(keys)
        });
        println!("{named}");
        screen.type_keys("q");
        assert_eq!(screen.wait().code(), Some(1));
        screen.assert_restored();
    }

    #[test]
    fn a_pose_is_repeated_skipped_and_taken_back_and_the_session_quits() {
        let folder = folder();
        // A key of a slow machine arrives during the pose that it is for.
        let mut screen = start(&folder, "2");
        screen.wait_for_text("pose 3 of 13  ●●▶");
        screen.type_keys("s");
        screen.wait_for_text("pose 4 of 13  ●●–▶");
        screen.type_keys("b");
        screen.wait_for_text("pose 3 of 13  ●●▶");
        screen.wait_for_text("pose 4 of 13  ●●●▶");
        screen.wait_for_text("hold still █");
        screen.type_keys("r");
        screen.wait_for_text("get ready");
        screen.resize(60, 16);
        screen.wait_for_text("pose 5 of 13  ●●●●▶");
        screen.type_keys("q");
        assert_eq!(screen.wait().code(), Some(1));
        screen.assert_restored();
        assert!(
            screen.text().contains("no file was written"),
            "{}",
            screen.text()
        );
        assert!(!folder.path().join("mine.ron").exists());
    }

    #[test]
    fn ctrl_c_restores_the_terminal_and_writes_nothing() {
        let folder = folder();
        let mut screen = start(&folder, "0.5");
        screen.wait_for_text("pose 2 of 13");
        screen.type_keys("\x03");
        screen.wait();
        screen.assert_restored();
        assert!(!folder.path().join("mine.ron").exists());
    }
}
