//! The `ademan` program without a display: messages, exit codes, files, control socket.

#[path = "../support/mod.rs"]
mod support;

mod arm;
mod body;
mod body_landmarks;
mod browser;
mod bvh;
mod calibrate;
#[cfg(target_os = "linux")]
mod calibrate_faults;
mod calibrate_hands;
#[cfg(target_os = "linux")]
mod calibrate_interrupted;
mod camera_pictures;
mod cameras;
#[cfg(target_os = "linux")]
mod completion;
mod config_folder;
#[cfg(unix)]
mod control;
mod cut_recordings;
mod demos;
mod determinism;
mod doctor;
mod doctor_parts;
#[cfg(target_os = "linux")]
mod faults;
mod files;
#[cfg(target_os = "linux")]
mod firmware;
#[cfg(target_os = "linux")]
mod firmware_avr;
mod first_use;
#[cfg(target_os = "linux")]
mod haptics;
mod help;
mod holistic;
#[cfg(target_os = "linux")]
mod home_made_gloves;
#[cfg(target_os = "linux")]
mod idle;
mod lab;
mod lab_designs;
#[cfg(unix)]
mod lab_shards;
#[cfg(unix)]
mod lab_study;
mod language_models;
#[cfg(unix)]
mod learned_words;
#[cfg(unix)]
mod learning;
mod log_options;
mod lucidgloves;
#[cfg(target_os = "linux")]
mod lucidgloves_controller;
mod markers;
#[cfg(all(unix, feature = "tls"))]
mod network;
mod new_files;
mod persons;
mod pictures;
mod practice;
#[cfg(target_os = "linux")]
mod process_limits;
mod protocols;
#[cfg(unix)]
mod recorded_messages;
mod reload;
#[cfg(unix)]
mod roles;
mod schema;
#[cfg(target_os = "linux")]
mod security;
#[cfg(target_os = "linux")]
mod senders;
mod sensor_parameters;
mod share;
mod signals;
mod simulated_hand;
mod source_recordings;
#[cfg(target_os = "linux")]
mod start;
mod stuck_tracker;
mod terminal;
mod text_line;
mod traces;
mod two_gloves;
mod two_sources;
#[cfg(target_os = "linux")]
mod view;
mod web;
#[cfg(unix)]
mod webcam;
mod writes;
mod wrong_use;
#[cfg(all(unix, feature = "zenoh"))]
mod zenoh;

use std::ffi::OsStr;
use std::io::Write;
use std::path::Path;
use std::process::{Command, Output, Stdio};

use serde_json::Value;

/// The program on a machine without a desktop.
fn ademan(arguments: impl IntoIterator<Item = impl AsRef<OsStr>>) -> Command {
    let mut command = crate::support::binary::ademan(arguments);
    command
        .env_remove("DISPLAY")
        .env_remove("WAYLAND_DISPLAY")
        .env_remove("XDG_RUNTIME_DIR")
        .env("RUST_BACKTRACE", "0")
        .stdin(Stdio::null());
    command
}

/// Exit code and output of a program that has ended.
struct Ended {
    code: Option<i32>,
    out: String,
    err: String,
}

impl Ended {
    /// Asserts that the program succeeded.
    #[track_caller]
    fn done(self) -> Self {
        self.exited(0)
    }

    /// Asserts that the program exited with this code.
    #[track_caller]
    fn exited(self, code: i32) -> Self {
        assert_eq!(self.code, Some(code), "{}{}", self.out, self.err);
        self
    }

    /// Asserts that the standard output contains this text.
    #[track_caller]
    fn printed(&self, part: &str) -> &Self {
        let is_there = self.out.contains(part);
        assert!(is_there, "no {part:?}: {}{}", self.out, self.err);
        self
    }

    /// Asserts that the standard error contains this text.
    #[track_caller]
    fn reported(&self, part: &str) -> &Self {
        let is_there = self.err.contains(part);
        assert!(is_there, "no {part:?}: {}{}", self.out, self.err);
        self
    }
}

impl From<Output> for Ended {
    fn from(output: Output) -> Self {
        Self {
            code: output.status.code(),
            out: String::from_utf8(output.stdout).expect("the program writes UTF-8"),
            err: String::from_utf8(output.stderr).expect("the program writes UTF-8"),
        }
    }
}

/// Runs a command to its end.
fn run_to_end(command: &mut Command) -> Ended {
    command.output().expect("the program starts").into()
}

/// Runs the program with these arguments.
fn run(arguments: impl IntoIterator<Item = impl AsRef<OsStr>>) -> Ended {
    run_to_end(&mut ademan(arguments))
}

/// Runs the program in a folder.
fn run_in(folder: &Path, arguments: impl IntoIterator<Item = impl AsRef<OsStr>>) -> Ended {
    run_to_end(ademan(arguments).current_dir(folder))
}

/// Returns the objects in lines of JSON.
fn objects(lines: &str) -> Vec<Value> {
    let objects = lines.lines().map(serde_json::from_str);
    objects.map(|it| it.expect("a line of JSON")).collect()
}

/// Returns the numbers in a list of JSON.
fn numbers(list: &Value) -> Vec<f64> {
    let numbers = list.as_array().expect("a list").iter();
    numbers.map(|it| it.as_f64().expect("a number")).collect()
}

/// A path as an argument.
fn text(path: &Path) -> &str {
    path.to_str().expect("the path is UTF-8")
}

/// Creates a file and returns its path.
fn file(folder: &tempfile::TempDir, name: &str, content: impl AsRef<[u8]>) -> String {
    let path = folder.path().join(name);
    let mut file = std::fs::File::create(&path).unwrap();
    file.write_all(content.as_ref()).unwrap();
    text(&path).to_owned()
}
