//! The sketch in `firmware/` as the compiler for AVR and the Arduino library make it, on a simulated Arduino Nano (simavr). Times
//! are on the clock of the simulated board.

use std::fs::{self, File};
use std::path::Path;
use std::process::{Command, Stdio};

use serde_json::Value;
use tempfile::TempDir;

use crate::firmware::{counts, readings_of, wrist_degrees};
use crate::{run, text};

/// Code with which the script ends if it lacks a tool or a library.
const MISSING: i32 = 77;

/// A simulated board with the sketch.
struct Board {
    folder: TempDir,
}

/// Bytes that a board has sent, and what the simulator has measured.
struct Sent {
    path: String,
    measured: Value,
}

impl Board {
    /// Builds the sketch with this format. `None`, with a message, if something is not installed.
    fn build(format: &str) -> Option<Self> {
        let folder = tempfile::tempdir().expect("a folder");
        let script = Path::new(env!("CARGO_MANIFEST_DIR")).join("firmware/test/avr/build");
        let mut script = Command::new(script);
        script.arg(folder.path()).arg(format!("FORMAT={format}"));
        let built = script.output().expect("the script starts");
        let out = String::from_utf8_lossy(&built.stdout);
        let errors = String::from_utf8_lossy(&built.stderr);
        if built.status.code() == Some(MISSING) {
            println!("SKIPPED: {}", out.trim());
            return None;
        }
        assert!(built.status.success(), "{out}{errors}");
        Some(Self { folder })
    }

    /// Returns the command that runs the board for this time.
    fn command(&self, milliseconds: u32, options: &[&str]) -> Command {
        let mut board = Command::new(self.folder.path().join("board"));
        board.arg(self.folder.path().join("sketch.elf"));
        board.arg(milliseconds.to_string()).args(options);
        board.stdin(Stdio::null());
        board
    }

    /// Runs the board for this time, without a receiver.
    fn run(&self, milliseconds: u32, options: &[&str]) -> Sent {
        let path = self.folder.path().join("sent");
        let file = File::create(&path).expect("a file");
        let mut board = self.command(milliseconds, options);
        let ended = board.stdout(file).output().expect("the simulator starts");
        let measured = String::from_utf8_lossy(&ended.stderr);
        assert!(ended.status.success(), "{measured}");
        println!("{measured}");
        Sent {
            path: text(&path).to_owned(),
            measured: serde_json::from_str(&measured).expect("an object"),
        }
    }
}

impl Sent {
    fn measured(&self, name: &str) -> f64 {
        let value = self.measured[name].as_f64();
        value.unwrap_or_else(|| panic!("no {name}"))
    }

    fn text(&self) -> String {
        fs::read_to_string(&self.path).expect("text")
    }

    /// Returns the readings that the program makes of the bytes.
    fn readings(&self, protocol: &str) -> Vec<Value> {
        let source = format!("file:{}?protocol={protocol}", self.path);
        let traced = run(["trace", "readings", "--source", &source]).done();
        let readings = traced.out.lines().map(serde_json::from_str::<Value>);
        readings.collect::<Result<_, _>>().expect("objects")
    }

    /// Asserts what holds for each format: the bit rate, the LED, and memory that the stack leaves.
    fn check_board(&self) {
        let byte_us = self.measured("shortest_byte_us");
        // 115 200 baud within 3 %.
        assert!((84.2..=89.4).contains(&byte_us), "{byte_us}");
        let changes = self.measured("led_changes");
        assert!((7.0..=8.0).contains(&changes), "{changes} in 2 s");
        assert!(self.measured("free_bytes") > 1024.0);
    }
}

#[test]
fn an_arduino_nano_sends_each_count_on_its_channel_and_is_read_on_after_a_reset() {
    let Some(board) = Board::build("FORMAT_HC11") else {
        return;
    };
    let sent = board.run(2000, &["reset=1000"]);
    sent.check_board();
    assert!(sent.measured("shortest_settle_us") >= 10.0);
    let cut = sent.measured("sent_before_reset") as usize % 66;
    assert!((2..64).contains(&cut), "the reset is between packets");
    let readings = sent.readings("hc11");
    let wired = (0..64).map(|channel| if channel < 32 { channel } else { 0 });
    let expected: Vec<u64> = wired.collect();
    for reading in &readings {
        assert_eq!(counts(reading), expected);
    }
    // A byte takes 93 us here, because the simulator has no second buffer: 324 packets fill the line.
    assert!(readings.len() > 315, "{} packets in 2 s", readings.len());
}

#[test]
fn an_arduino_nano_sends_a_hundred_lines_of_curls_per_second() {
    let Some(board) = Board::build("FORMAT_LUCIDGLOVES") else {
        return;
    };
    let sent = board.run(2000, &[]);
    sent.check_board();
    let lines = sent.text();
    assert!(
        lines
            .lines()
            .rev()
            .skip(1)
            .all(|line| line == "A3B7C11D15E19"),
        "{lines}"
    );
    let count = lines.lines().count();
    assert!((199..=201).contains(&count), "{count} lines in 2 s");
    // Two for each finger.
    let conversions = sent.measured("conversions") as usize;
    assert!(conversions <= 10 * (count + 1), "{conversions} conversions");
    let readings = sent.readings("lucidgloves&max=1023");
    let expected =
        [3.0, 7.0, 11.0, 15.0, 19.0].map(|reading: f64| (reading * 4095.0 / 1023.0).round() as u64);
    assert!(readings.len() > 190, "{} readings", readings.len());
    assert_eq!(counts(&readings[0])[..5], expected);
}

#[test]
fn an_arduino_nano_sends_a_hundred_quaternions_per_second() {
    let Some(board) = Board::build("FORMAT_IMU") else {
        return;
    };
    let sent = board.run(2000, &[]);
    sent.check_board();
    let readings = sent.readings("imu");
    let count = readings.len();
    assert!((190..=201).contains(&count), "{count} lines in 2 s");
    let degrees: Vec<f64> = readings.iter().map(wrist_degrees).collect();
    for pair in degrees.windows(2) {
        let turned = (pair[1] - pair[0]).rem_euclid(360.0);
        assert!((turned - 1.0).abs() < 0.5, "{turned} degrees in a line");
    }
}

#[test]
fn a_missing_inertial_sensor_is_awaited_with_a_dark_led() {
    let Some(board) = Board::build("FORMAT_IMU") else {
        return;
    };
    let sent = board.run(2000, &["sensor=absent"]);
    assert_eq!(sent.text(), "");
    assert!(sent.measured("led_changes") < 1.0);
    let attempts = sent.measured("bus_starts");
    assert!(attempts > 20.0, "{attempts} attempts in 2 s");
}

#[test]
fn an_inertial_sensor_that_holds_the_bus_after_a_reset_of_the_board_is_freed() {
    let Some(board) = Board::build("FORMAT_IMU") else {
        return;
    };
    let sent = board.run(2000, &["sensor=stuck"]);
    sent.check_board();
    let count = sent.text().lines().count();
    assert!(count > 190, "{count} lines in 2 s");
}

#[test]
fn an_inertial_sensor_that_lost_its_power_is_started_again_and_no_line_is_zero() {
    let Some(board) = Board::build("FORMAT_IMU") else {
        return;
    };
    let sent = board.run(2000, &["power=1000"]);
    let lines = sent.text();
    assert!(
        !lines.contains("0.00000,0.00000,0.00000,0.00000"),
        "{lines}"
    );
    let after = lines.rsplit("BNO055 started\n").next().unwrap_or_default();
    let count = after.lines().count();
    assert!((70..=90).contains(&count), "{count} lines in 0.9 s");
}

#[test]
fn the_wrist_turns_from_a_new_neutral_pose_after_the_sensor_lost_its_power() {
    let Some(board) = Board::build("FORMAT_IMU") else {
        return;
    };
    // Each 0.5 s it loses its power, and its north turns by 200 degrees. It turns by a degree per line. The board runs until it is read.
    let mut command = board.command(u32::MAX, &["power=500"]);
    let readings = readings_of(command.stderr(Stdio::null()), "imu", 200);
    let degrees: Vec<f64> = readings.iter().map(wrist_degrees).collect();
    let is_expected = |angle: &f64| (-1.0..60.0).contains(angle);
    assert!(degrees.iter().all(is_expected), "{degrees:?}");
    assert!(!degrees.is_sorted(), "it never started again: {degrees:?}");
}
