//! `ademan trace --stats`: the parameters of bend sensors whose errors are known.

use ademan::capture::Reading;
use ademan::estimate::ChannelMap;
use ademan::files::Load;
use ademan::hand::Side;
use ademan::layout::Glove;
use ademan::setup::Setup;
use ademan::sim::{SensorErrors, SimulatedWearer};
use serde_json::Value;
use tempfile::TempDir;

use super::{run, text};
use crate::support::recording::{Readings, record_source};

/// The smallest span of the sensors that are compared, in counts of 255: smaller ones are mostly play.
const MIN_SPAN: f64 = 40.0;

fn glove() -> ChannelMap {
    Glove::load("unam-hc11").expect("a glove").map
}

/// Records readings with the default setup. Returns the source.
fn record(folder: &TempDir, readings: Vec<Reading>) -> String {
    let path = folder.path().join("cycles.mcap");
    let setup = Setup::default().load_files().expect("the default setup");
    record_source(&path, &setup, Readings::new(readings));
    format!("recording:{}", text(&path))
}

fn stats(source: &str, arguments: &[&str]) -> String {
    let all = ["trace", "--stats", "--source", source];
    run(all.iter().chain(arguments)).done().out
}

fn channels(out: &str) -> Vec<Value> {
    let json: Value = serde_json::from_str(out).expect("JSON");
    json["sensors"][0]["channels"]
        .as_array()
        .expect("a list")
        .clone()
}

#[track_caller]
fn assert_close(channel: &Value, quantity: &str, expected: f64, tolerance: f64) {
    let counts = channel[quantity]["counts"].as_f64().expect("a number");
    let difference = (counts - expected).abs();
    assert!(
        difference <= tolerance,
        "{quantity} {counts} instead of {expected}: {channel}"
    );
}

#[test]
fn the_errors_of_a_simulated_glove_are_found() {
    let map = glove();
    for (seed, hysteresis, drift, noise) in [
        (1, 0.0, 0.0, 0.004),
        (2, 0.03, 0.01, 0.004),
        (3, 0.06, -0.02, 0.006),
    ] {
        let folder = tempfile::tempdir().unwrap();
        let errors = SensorErrors {
            hysteresis,
            drift_per_minute: drift,
            noise,
        };
        let mut person = SimulatedWearer::new(seed, &map, Side::Right);
        let readings = person.cycles(6, errors, &map);
        let source = record(&folder, readings);
        println!("{}", stats(&source, &[]));
        let channels = channels(&stats(&source, &["--json"]));
        let [flat, fist] = person.ends().map(|angles| person.sensors().exact(&angles));
        let mut compared = 0;
        for channel in &channels {
            let index = channel["channel"].as_u64().unwrap() as usize;
            let span = (fist[index] - flat[index]).abs();
            let (low, high) = (fist[index].min(flat[index]), fist[index].max(flat[index]));
            if span < MIN_SPAN || low < 20.0 || high > 235.0 {
                continue;
            }
            compared += 1;
            assert!(channel["missing"].is_null(), "{channel}");
            // The converter rounds: the variance of a step of one count is 1/12.
            let jitter = ((255.0 * noise).powi(2) + 1.0 / 12.0).sqrt();
            // The play shortens the way: half of it at each end.
            assert_close(
                channel,
                "span",
                span - 255.0 * hysteresis,
                1.0_f64.max(jitter),
            );
            let within = 0.7_f64.max(0.6 * jitter);
            assert_close(channel, "hysteresis", 255.0 * hysteresis, within);
            let deviation = channel["drift_standard_error"]["counts"].as_f64().unwrap();
            let drift_within = 0.5_f64.max(3.0 * deviation);
            assert_close(channel, "drift_per_minute", 255.0 * drift, drift_within);
            assert_close(channel, "jitter", jitter, 0.1 * jitter);
            assert_close(channel, "repeatability", 0.0, 0.3 + 0.6 * jitter);
            let percent = channel["hysteresis"]["percent"].as_f64().unwrap();
            let counts = channel["hysteresis"]["counts"].as_f64().unwrap();
            let expected = counts / channel["span"]["counts"].as_f64().unwrap() * 100.0;
            assert!((percent - expected).abs() < 1e-9);
        }
        assert!(compared >= 4, "{compared} channels of seed {seed}");
    }
}

#[test]
fn the_table_says_what_a_short_recording_lacks() {
    let map = glove();
    let folder = tempfile::tempdir().unwrap();
    let mut person = SimulatedWearer::new(4, &map, Side::Right);
    let readings = person.cycles(
        2,
        SensorErrors {
            noise: 0.004,
            ..Default::default()
        },
        &map,
    );
    let out = stats(&record(&folder, readings), &[]);
    println!("{out}");
    assert!(
        out.contains("sensors of the right hand\nchannel  joint"),
        "{out}"
    );
    assert!(
        out.contains(
            "2 of 3 holds at the low end, 2 of 3 holds at the high end, 2 of 3 holds half-way"
        ),
        "{out}"
    );
    assert!(
        out.contains("docs/calibration.md#parameters-of-the-sensors"),
        "{out}"
    );
    let index = out
        .lines()
        .find(|line| line.contains(" index-"))
        .expect("a row");
    assert!(index.ends_with('–'), "no drift of two cycles: {index}");
}

#[test]
fn the_documented_script_has_all_holds() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("script.mcap");
    let script = concat!(
        "script:",
        env!("CARGO_MANIFEST_DIR"),
        "/examples/sensor-cycles.txt"
    );
    run(["record", text(&path), "--source", script]).done();
    let source = format!("recording:{}", text(&path));
    let out = stats(&source, &["--json"]);
    let json: Value = serde_json::from_str(&out).expect("JSON");
    let angles = &json["hands"][0]["angles_deg"];
    assert!(angles["jitter_raw"].is_f64(), "{angles}");
    let complete = channels(&out);
    let complete = complete
        .iter()
        .filter(|channel| channel["missing"].is_null());
    for channel in complete.clone() {
        assert_close(channel, "hysteresis", 0.0, 1.0);
        assert_close(channel, "drift_per_minute", 0.0, 1.0);
    }
    assert!(complete.count() >= 8, "{out}");
}

/// Calibrates in a folder. Returns the glove file that it writes.
fn calibrate(folder: &TempDir, arguments: &[&str]) -> ChannelMap {
    let out = folder.path().join("lagging.ron");
    let all = ["calibrate", "--force", "--out", text(&out)];
    let written = run(all.iter().chain(arguments)).done().out;
    println!("{written}");
    Glove::load(text(&out)).expect("the written glove").map
}

#[test]
fn the_hysteresis_of_a_recording_is_written_to_the_glove_file() {
    let map = glove();
    let folder = tempfile::tempdir().unwrap();
    let errors = SensorErrors {
        hysteresis: 0.03,
        noise: 0.002,
        ..Default::default()
    };
    let mut person = SimulatedWearer::new(2, &map, Side::Right);
    let source = record(&folder, person.cycles(4, errors, &map));
    let path = source.trim_start_matches("recording:");
    let written = calibrate(&folder, &["--glove", "unam-hc11", "--hysteresis", path]);
    assert!(
        written.hystereses().len() >= 4,
        "{:?}",
        written.hystereses()
    );
    for &(channel, counts) in written.hystereses() {
        assert!((counts - 7.65).abs() < 1.0, "{counts} on channel {channel}");
    }
    assert_eq!(written.rows(), map.rows());
}

#[test]
fn a_typical_hysteresis_is_a_part_of_the_ranges_of_the_fingers() {
    let folder = tempfile::tempdir().unwrap();
    let mine = folder.path().join("mine.ron");
    run(["calibrate", "--demo", "--out", text(&mine)]).done();
    let ranges = Glove::load(text(&mine)).expect("a calibrated glove").map;
    let written = calibrate(&folder, &["--glove", text(&mine), "--hysteresis", "5%"]);
    assert!(written.hystereses().len() >= 8);
    for row in written.rows() {
        let expected = match (row.dof.finger(), ranges.range(row.channel)) {
            (Some(_), Some((low, high))) => (high - low) * 0.05,
            _ => 0.0,
        };
        let counts = written.hysteresis(row.channel);
        assert!((counts - expected).abs() < 0.51, "{}: {counts}", row.dof);
    }
    let again = folder.path().join("lagging.ron");
    let removed = calibrate(&folder, &["--glove", text(&again), "--hysteresis", "0%"]);
    assert_eq!(removed.hystereses(), []);
    let glove = ["calibrate", "--glove", "unam-hc11", "--hysteresis"];
    let out = ["--out", text(&again), "--force"];
    for (value, message) in [
        ("4%", "calibrate the glove first"),
        ("30%", "expected 0 to 20 percent"),
        ("4", "a percentage ends with `%`, such as 4%"),
        ("4,5", "a percentage ends with `%`, such as 4%"),
    ] {
        let failed = run(glove.iter().chain(&[value]).chain(&out)).exited(2);
        failed.reported(message);
    }
}

#[test]
fn a_percentage_lists_the_sensors_without_a_range_in_one_line() {
    let folder = tempfile::tempdir().unwrap();
    let mine = folder.path().join("curls.ron");
    let demo = ["calibrate", "--demo", "--demo-glove", "curls", "--out"];
    run(demo.iter().chain(&[text(&mine)])).done();
    let glove = ["calibrate", "--glove", text(&mine), "--hysteresis"];
    let written = run(glove.iter().chain(&["4%", "--force"])).done().out;
    let without: Vec<&str> = written
        .lines()
        .filter(|line| line.contains("range_counts"))
        .collect();
    let expected = "channels 5, 6, 7, 8, 9: no `range_counts`; the calibration got no counts of them, or found a fault";
    assert_eq!(without, [expected]);
    // The glove file exists and there is no terminal to ask in, but the missing recording comes first.
    let missing = run(glove.iter().chain(&["none.mcap"])).exited(2);
    missing.reported("cannot open recording:none.mcap: No such file");
}
