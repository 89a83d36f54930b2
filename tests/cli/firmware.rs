//! The sketch in `firmware/`, compiled for this machine, and its bytes on a pseudo-terminal.

use std::io::{BufRead, BufReader, Read, Write};
use std::path::{Path, PathBuf};
use std::process::{Command, Output, Stdio};
use std::thread;
use std::time::Duration;

use ademan::capture::{SourceUri, open_loopback};
use serde_json::Value;

use crate::support::binary::ademan;
use crate::support::process::{Process, lock_spawning};

/// Compiles the sketch to a program with the stand-in for the Arduino library, with these macros. The reason if there is no compiler.
fn run_compiler(macros: &[&str], program: &Path) -> Result<Output, String> {
    let test = Path::new(env!("CARGO_MANIFEST_DIR")).join("firmware/test");
    let mut compiler = Command::new("g++");
    // The language of the compiler for AVR boards.
    compiler
        .args("-std=c++11 -O1 -Wall -Wextra -Werror -I".split(' '))
        .arg(&test);
    compiler.args(macros.iter().map(|name| format!("-D{name}")));
    compiler.arg(test.join("fake.cpp")).arg("-o").arg(program);
    compiler.output().map_err(|error| format!("g++: {error}"))
}

/// Returns the program that the compiler makes of the sketch. The reason if there is no compiler.
fn compile(macros: &[&str], folder: &Path) -> Result<PathBuf, String> {
    let program = folder.join("sketch");
    let output = run_compiler(macros, &program)?;
    let errors = String::from_utf8_lossy(&output.stderr);
    assert!(output.status.success(), "{errors}");
    Ok(program)
}

/// Returns the first readings that `ademan trace` gets of a sketch over a serial line; `None` without a compiler.
fn readings(macros: &[&str], protocol: &str, count: usize) -> Option<Vec<Value>> {
    let folder = tempfile::tempdir().expect("a folder");
    let sketch = match compile(macros, folder.path()) {
        Ok(sketch) => sketch,
        Err(reason) => {
            println!("SKIPPED: no compiler for C++: {reason}");
            return None;
        }
    };
    let mut sketch = Command::new(sketch);
    Some(readings_of(sketch.arg("100000000"), protocol, count))
}

/// Returns the first readings that `ademan trace` gets over a serial line of what a command writes.
pub(crate) fn readings_of(sketch: &mut Command, protocol: &str, count: usize) -> Vec<Value> {
    let uri: SourceUri = format!("serial:/dev/null?protocol={protocol}")
        .parse()
        .expect("a source");
    let mut line = {
        let _alone = lock_spawning();
        open_loopback(uri.format().expect("a protocol").clone()).expect("a line")
    };
    let mut trace = ademan(["trace", "readings", "--source", &line.uri.to_string()]);
    trace
        .stdin(Stdio::null())
        .stdout(Stdio::piped())
        .stderr(Stdio::null());
    let mut trace = Process::start(&mut trace).expect("the program starts");
    sketch.stdout(Stdio::piped());
    let mut sketch = Process::start(sketch).expect("the sketch starts");
    let mut sent = sketch.0.stdout.take().expect("stdout is piped");
    let sender = thread::spawn(move || {
        let mut bytes = [0; 64];
        while let Ok(length @ 1..) = sent.read(&mut bytes) {
            if line.writer.write_all(&bytes[..length]).is_err() {
                break;
            }
            thread::sleep(Duration::from_millis(1));
        }
    });
    let received = BufReader::new(trace.0.stdout.take().expect("stdout is piped"));
    let received = received.lines().map_while(Result::ok).take(count);
    let readings: Vec<Value> = received
        .map(|reading| serde_json::from_str(&reading).expect("an object"))
        .collect();
    drop((sketch, trace));
    sender.join().expect("the bytes are sent");
    assert_eq!(readings.len(), count);
    readings
}

/// Returns the counts of a reading.
pub(crate) fn counts(reading: &Value) -> Vec<u64> {
    let counts = reading["channels"].as_array().expect("counts");
    counts.iter().filter_map(Value::as_u64).collect()
}

/// Returns the angle by which a reading turns the wrist about the vertical, and asserts that it turns about nothing else.
pub(crate) fn wrist_degrees(reading: &Value) -> f64 {
    let displacement = &reading["displacement"];
    assert_eq!(displacement["joint"], "wrist");
    let number = |index: usize| displacement["rotation"][index].as_f64().expect("a number");
    let [x, y, z, w] = std::array::from_fn(number);
    assert!(x.abs() < 2e-4 && z.abs() < 2e-4, "{reading}");
    assert!((y.hypot(w) - 1.0).abs() < 1e-3, "{reading}");
    2.0 * y.atan2(w).to_degrees()
}

#[test]
fn packets_of_64_counts_arrive_in_wire_order_from_both_boards() {
    for (board, channels) in [(None, 32), (Some("ESP32"), 48)] {
        let macros: Vec<&str> = ["FORMAT=FORMAT_HC11"].into_iter().chain(board).collect();
        let Some(readings) = readings(&macros, "hc11", 20) else {
            return;
        };
        // The stand-in has the count of its index on each channel; the rest of the packet is not wired.
        let wired = (0..64).map(|channel| if channel < channels { channel } else { 0 });
        let expected: Vec<u64> = wired.collect();
        for reading in readings {
            assert_eq!(counts(&reading), expected, "{board:?}");
        }
    }
}

#[test]
fn curls_of_five_fingers_arrive_as_lines_of_lucidgloves() {
    let macros = ["FORMAT=FORMAT_LUCIDGLOVES"];
    let Some(readings) = readings(&macros, "lucidgloves&max=1023", 20) else {
        return;
    };
    // The program joins a stream that runs: its first line may be cut.
    let readings = &readings[1..];
    let first = counts(&readings[0]);
    for reading in readings {
        assert_eq!(counts(reading), first);
    }
    // The curls of 3, 7, 11, 15 and 19 of 1023, on the scale of the glove file.
    let expected = [3.0, 7.0, 11.0, 15.0, 19.0].map(|count: f64| count / 1023.0);
    let full_scale = readings[0]["full_scale"].as_f64().expect("a full scale");
    for curl in expected {
        let count = (curl * full_scale).round() as u64;
        let is_near = |found: &u64| found.abs_diff(count) <= 1;
        assert!(first.iter().any(is_near), "{count} in {first:?}");
    }
}

#[test]
fn quaternions_of_the_inertial_sensor_turn_the_wrist_about_the_vertical() {
    let Some(readings) = readings(&["FORMAT=FORMAT_IMU"], "imu", 50) else {
        return;
    };
    let mut latest = -1.0_f64;
    for reading in readings {
        // A degree per line, and two after a request that has failed.
        let degrees = wrist_degrees(&reading);
        let turned = degrees.rem_euclid(360.0) - latest.max(0.0);
        assert!(latest < 0.0 || turned > 0.5, "{degrees} after {latest}");
        latest = degrees.rem_euclid(360.0);
    }
    assert!(latest > 45.0, "{latest}");
}

#[test]
fn a_finger_without_a_sensor_is_refused_by_the_compiler() {
    let folder = tempfile::tempdir().expect("a folder");
    let macros = ["FORMAT=FORMAT_LUCIDGLOVES", "MUX_INPUTS=1"];
    match run_compiler(&macros, &folder.path().join("sketch")) {
        Err(reason) => println!("SKIPPED: no compiler for C++: {reason}"),
        Ok(output) => {
            let errors = String::from_utf8_lossy(&output.stderr);
            assert!(
                errors.contains("a channel that no pin measures"),
                "{errors}"
            );
        }
    }
}

/// Returns the pins of a list in the settings of the sketch: of the ESP32, and of Arduino boards.
fn pins(list: &str) -> [String; 2] {
    let settings = include_str!("../../firmware/ademan_glove/config.h");
    let lines = settings.lines().filter(|line| line.contains(list));
    let lists = lines.filter_map(|line| {
        let (_, rest) = line.split_once('{')?;
        let (pins, _) = rest.split_once('}')?;
        Some(pins.to_owned())
    });
    let lists: Vec<String> = lists.collect();
    lists.try_into().expect("a list for each kind of board")
}

#[test]
fn the_guide_names_the_pins_of_the_settings() {
    let guide = include_str!("../../docs/firmware.md");
    let [esp32, arduino] = pins("ANALOG_PINS[]");
    let analog = format!("| outputs of the multiplexers | {arduino} | {esp32} |");
    let [esp32_select, arduino_select] = pins("SELECT_PINS[]");
    let digital: Vec<String> = arduino_select
        .split(", ")
        .map(|pin| format!("D{pin}"))
        .collect();
    let digital = digital.join(", ");
    let select = format!("| select S0, S1, S2 | {digital} | {esp32_select} |");
    for row in [analog, select] {
        assert!(guide.contains(&row), "no {row}");
    }
}
