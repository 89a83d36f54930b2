//! `ademan calibrate` beside a setup of every run, and with recordings of two hands.

use std::fs;

use ademan::capture::{Reading, Sample};
use ademan::document::Document;
use ademan::files::OpenDocument;
use ademan::hand::Side;
use ademan::layout::Glove;
use ademan::sim::SimulatedWearer;
use tempfile::TempDir;

use crate::calibrate::{calibrate, folder, read, take_poses, write_readings};
use crate::{Ended, ademan, run_to_end};

/// Calibrates in a folder with this setup of every run.
fn calibrate_beside(setup: &str, folder: &TempDir, arguments: &[&str]) -> Ended {
    let config = folder.path().join("config");
    fs::create_dir_all(config.join("ademan")).expect("a folder");
    fs::write(config.join("ademan/setup.ron"), setup).expect("a file");
    let mut command = ademan(["calibrate"]);
    command.args(arguments).env("XDG_CONFIG_HOME", config);
    run_to_end(command.current_dir(folder.path()))
}

#[test]
fn the_glove_of_the_other_hand_of_a_setup_is_calibrated() {
    let folder = folder();
    let setup = "Setup(glove: \"unam-hc11\", other_hand: (glove: \"unam-hc11-left\"))";
    let arguments = ["--demo", "--glove", "unam-hc11-left", "--out", "mine"];
    calibrate_beside(setup, &folder, &arguments).done();
    let glove = Glove::parse(&Document::new("mine.ron", read(&folder, "mine.ron")));
    assert_eq!(glove.expect("a glove").side, Side::Left);
}

#[test]
fn the_glove_of_the_other_hand_is_calibrated_with_the_source_of_that_hand() {
    let folder = folder();
    let setup = "Setup(source: \"file:first.bin?protocol=hc11\", glove: \"unam-hc11\", \
                 other_hand: (source: \"file:second.bin?protocol=hc11\", glove: \"unam-hc11-left\"))";
    for (glove, own, other) in [
        ("unam-hc11", "first.bin", "second.bin"),
        ("unam-hc11-left", "second.bin", "first.bin"),
    ] {
        let arguments = ["--glove", glove, "--out", "mine"];
        let ended = calibrate_beside(setup, &folder, &arguments);
        // There are no such files.
        ended.reported(own);
        assert!(!ended.err.contains(other), "{}", ended.err);
    }
}

#[test]
fn a_simulated_person_wears_a_glove_beside_a_setup_with_a_camera() {
    let folder = folder();
    let setup = "Setup(source: \"udp:127.0.0.1:9000?protocol=hand-landmarks\")";
    let ended = calibrate_beside(setup, &folder, &["--demo", "--out", "mine"]).done();
    ended.printed("wrote mine.ron");
}

#[test]
fn a_recording_of_two_gloves_calibrates_the_glove_of_one_hand() {
    let folder = folder();
    let shipped = Document::open("unam-hc11").expect("a glove");
    let glove = Glove::parse(&shipped).expect("a glove");
    let (setup, alone) = take_poses(&glove, SimulatedWearer::new(1, &glove.map, glove.side));
    let of = |side: Side, reading: &Reading, is_flat: bool| {
        let Sample::Channels(mut counts) = reading.sample.clone() else {
            panic!("{reading:?}");
        };
        if is_flat {
            counts.counts.iter_mut().for_each(|count| *count = 100);
        }
        Reading::new(reading.time, Some(side), Sample::Channels(counts))
    };
    let left: Vec<Reading> = alone.iter().map(|it| of(Side::Left, it, true)).collect();
    let both = alone.iter().zip(&left);
    let both: Vec<Reading> = both
        .flat_map(|(own, other)| [other.clone(), of(Side::Right, own, false)])
        .collect();
    for (name, readings) in [("one", &alone), ("two", &both), ("left", &left)] {
        let path = folder.path().join(format!("{name}.mcap"));
        write_readings(&path, &setup, readings);
    }
    let from = |name: &str| {
        let recording = format!("{name}.mcap");
        let arguments = ["--from", &recording, "--glove", "unam-hc11", "--out", name];
        calibrate(&folder, &arguments)
    };
    for name in ["one", "two"] {
        from(name).done();
    }
    assert_eq!(read(&folder, "two.ron"), read(&folder, "one.ron"));
    from("left").exited(2).reported("of the left hand only");
}
