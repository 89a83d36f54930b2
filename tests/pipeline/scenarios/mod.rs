//! Scenarios: what a hand does and what happens to the run meanwhile, and what has to go out.
//!
//! Each file of this folder that ends in `.txt` has some. A scenario begins with `## ` and its name; `setup:`
//! says on which layout it is played. Lines at the margin are what happens, indented ones what goes out
//! before the next of them:
//!
//! ```text
//! ## a stall lets go at its limit
//! setup: qwerty-flat
//! press H; wait 100
//!     =paused t:303ms =running t:418ms dn:H
//! silent 300
//!     t:358ms up:H =stalled
//! lift; wait 400
//!     =running t:1105ms =stopped
//! ```
//!
//! What happens are orders of the simulated hand (docs/scripts.md) and words about the run (`directive.rs`), apart by
//! `;`. What goes out is `dn:` and `up:` with a key, other events alike, `=` with a state, `t:` with the
//! time since the word before. What goes on for a while, such as the value of a slider, is told once, with where
//! it was first and last. The hand goes on until it is off everything at the end; then the run is stopped.
//! In brackets at the very end: readings that were not accepted, by reason, bytes that were no frames, stalls.
//!
//! After a change that is meant: `ADEMAN_WRITE=1 cargo test --test pipeline scenarios`, and read the difference.

mod directive;
mod file;
mod rig;

use std::fs;
use std::panic::{AssertUnwindSafe, catch_unwind};
use std::path::{Path, PathBuf};
use std::sync::Mutex;

use self::file::{Scenario, ScenarioFile};

/// Fewer than these are not enough.
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

/// Plays all of them, on as many threads as there are processors. Gives the names of those that panicked.
fn play_all(scenarios: Vec<&mut Scenario>) -> Vec<String> {
    let left = Mutex::new(scenarios);
    let panicked = Mutex::new(Vec::new());
    let threads = std::thread::available_parallelism().map_or(1, usize::from);
    let play_some = || {
        loop {
            let next = left.lock().expect("nobody panics with it").pop();
            let Some(scenario) = next else {
                return;
            };
            let name = scenario.name.clone();
            if catch_unwind(AssertUnwindSafe(|| rig::play(scenario))).is_err() {
                panicked.lock().expect("nobody panics with it").push(name);
            }
        }
    };
    std::thread::scope(|scope| {
        (0..threads).for_each(|_| drop(scope.spawn(play_some)));
    });
    panicked.into_inner().expect("nobody panics with it")
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
