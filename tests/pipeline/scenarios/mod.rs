//! Scenarios: a hand plays while something happens to the run, and these events are expected.
//!
//! The files are `tests/scenarios/*.txt`. A scenario begins with `## ` and its name; `setup:` names its layout. Lines at
//! the margin are the script, indented lines the transcript of the line above:
//!
//! ```text
//! ## a stall releases everything after its timeout
//! setup: qwerty-flat
//! press H; wait 100
//!     =paused t:303ms =running t:418ms dn:H
//! silent 300
//!     t:358ms up:H =stalled
//! lift; wait 400
//!     =running t:1105ms =stopped
//! ```
//!
//! A script consists of orders of the simulated hand (`docs/scripts.md`) and of orders about the run (`directive.rs`).
//! The transcript is a summary in the words of [`transcript`](crate::rig::transcript), with `=STATE` for a new state. At
//! the end the hand leaves all controls and the pipeline is stopped. The last words, in brackets, count rejected readings
//! by reason, bytes outside of packets, stalls and suppressed presses.
//!
//! After an intended change: `ADEMAN_WRITE=1 cargo test --test pipeline scenarios`, and review the difference.

mod directive;
mod file;
mod rig;

use std::collections::BTreeSet;
use std::fs;
use std::panic::{AssertUnwindSafe, catch_unwind};
use std::path::{Path, PathBuf};

use self::file::ScenarioFile;

/// Defines a test for each file of scenarios.
macro_rules! scenario_files {
    ($($name:ident),* $(,)?) => {
        const FILES: &[&str] = &[$(stringify!($name)),*];

        $(#[test]
        fn $name() {
            play_file(stringify!($name));
        })*
    };
}

scenario_files!(
    arm, arming, bends, faults, gestures, layers, lines, multitap, notes, reloads, sequences,
    steps, swipes, together, waits
);

fn folder() -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("tests/scenarios")
}

/// Plays the scenarios of a file and compares their transcripts.
fn play_file(name: &str) {
    let path = folder().join(name).with_extension("txt");
    let expected = fs::read_to_string(&path).expect("a file of scenarios");
    let mut file = ScenarioFile::parse(&path, &expected);
    assert!(!file.scenarios.is_empty(), "{name} has no scenarios");
    let mut panicked = Vec::new();
    for scenario in &mut file.scenarios {
        if catch_unwind(AssertUnwindSafe(|| rig::play(scenario))).is_err() {
            panicked.push(scenario.name.clone());
        }
    }
    println!("{} scenarios", file.scenarios.len());
    assert!(panicked.is_empty(), "panicked: {panicked:#?}");
    let found = file.to_string();
    if found == expected {
        return;
    }
    if std::env::var_os("ADEMAN_WRITE").is_some() {
        fs::write(&path, &found).expect("the transcripts can be written");
        return;
    }
    panic!("{}", file::difference(&expected, &found));
}

#[test]
fn every_file_of_scenarios_has_a_test() {
    let entries = fs::read_dir(folder()).expect("the folder of scenarios");
    let paths = entries.map(|entry| entry.expect("a file").path());
    let texts = paths.filter(|path| path.extension().is_some_and(|extension| extension == "txt"));
    let stem = |path: PathBuf| {
        path.file_stem()
            .map(|stem| stem.to_string_lossy().into_owned())
    };
    let found: BTreeSet<String> = texts.filter_map(stem).collect();
    let tested = FILES.iter().map(|&name| name.to_owned()).collect();
    assert_eq!(found, tested);
}
