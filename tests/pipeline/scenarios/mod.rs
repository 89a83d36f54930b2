//! Scenarios: a hand plays, something happens to the run meanwhile, and these events are expected.
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

use std::fs;
use std::panic::{AssertUnwindSafe, catch_unwind};
use std::path::{Path, PathBuf};
use std::sync::Mutex;

use self::file::{Scenario, ScenarioFile};

/// The least number of scenarios.
const FEWEST: usize = 150;

fn folder() -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("tests/scenarios")
}

fn pages() -> Vec<(PathBuf, String)> {
    let entries = fs::read_dir(folder()).expect("the folder of scenarios");
    let paths = entries.map(|entry| entry.expect("a file").path());
    let mut paths: Vec<PathBuf> = paths
        .filter(|path| path.extension().is_some_and(|extension| extension == "txt"))
        .collect();
    paths.sort();
    let read = |path: PathBuf| {
        let text = fs::read_to_string(&path).expect("a text");
        (path, text)
    };
    paths.into_iter().map(read).collect()
}

/// Plays the scenarios on as many threads as there are processors, and returns the names of those that panic.
fn play_all(scenarios: Vec<&mut Scenario>) -> Vec<String> {
    let waiting = Mutex::new(scenarios);
    let panicked = Mutex::new(Vec::new());
    let threads = std::thread::available_parallelism().map_or(1, usize::from);
    let play_some = || {
        loop {
            let next = waiting.lock().expect("no panic while it is locked").pop();
            let Some(scenario) = next else {
                return;
            };
            let name = scenario.name.clone();
            if catch_unwind(AssertUnwindSafe(|| rig::play(scenario))).is_err() {
                panicked
                    .lock()
                    .expect("no panic while it is locked")
                    .push(name);
            }
        }
    };
    std::thread::scope(|scope| {
        (0..threads).for_each(|_| drop(scope.spawn(play_some)));
    });
    panicked.into_inner().expect("no panic while it is locked")
}

#[test]
fn every_scenario_gives_its_transcript() {
    let files = pages();
    let mut pages: Vec<ScenarioFile> = files
        .iter()
        .map(|(path, text)| ScenarioFile::parse(path, text))
        .collect();
    let scenarios = pages.iter_mut().flat_map(|page| &mut page.scenarios);
    let panicked = play_all(scenarios.collect());
    assert!(panicked.is_empty(), "panicked: {panicked:#?}");
    let mut wrong = Vec::new();
    for ((path, expected), page) in files.iter().zip(&pages) {
        let found = page.to_string();
        if found == *expected {
            continue;
        }
        if std::env::var_os("ADEMAN_WRITE").is_some() {
            fs::write(path, &found).expect("the transcripts can be written");
            continue;
        }
        wrong.push(format!(
            "{}:\n{}",
            path.display(),
            file::difference(expected, &found)
        ));
    }
    let count: usize = pages.iter().map(|page| page.scenarios.len()).sum();
    println!("{count} scenarios in {} files", pages.len());
    assert!(wrong.is_empty(), "{}", wrong.join("\n"));
    assert!(count >= FEWEST, "only {count} scenarios");
}
