//! The house keeps its shape: data flows one way, stages know no clock, files stay small.

#[path = "architecture/evidence.rs"]
mod evidence;
#[path = "architecture/fault_table.rs"]
mod fault_table;
#[path = "architecture/faults.rs"]
mod faults;
#[path = "architecture/security.rs"]
mod security;
#[path = "architecture/security_sources.rs"]
mod security_sources;
#[path = "architecture/security_table.rs"]
mod security_table;

use std::fs;
use std::path::{Path, PathBuf};

/// The modules in the order in which data flows. Each may use those before it.
const FLOW: &[&str] = &[
    "time",
    "names",
    "hand",
    "document",
    "command",
    "advice",
    "capture",
    "estimate",
    "kinematics",
    "contact",
    "device",
    "output",
    "snapshot",
    "trace",
    "recorder",
    "layout",
    "pipeline",
    "sim",
    "setup",
    "session",
    "reload",
    "control",
    "panic_keys",
    "doctor",
];

/// Modules that work between a reading and its events.
const STAGES: &[&str] = &["estimate", "kinematics", "contact", "device", "pipeline"];

/// The only places that may ask for the operating system.
const MAY_HAVE_CFG: &[&str] = &[
    "capture/mod.rs",
    "capture/thread/tests.rs",
    "output/mod.rs",
    "output/tests.rs",
    "doctor/mod.rs",
    "emergency.rs",
    "bin/ademan/main.rs",
    "reload.rs",
];

const LONGEST_FILE: usize = 500;

fn root() -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("src")
}

fn sources() -> Vec<(String, String)> {
    let mut found = Vec::new();
    collect(&root(), &mut found);
    assert!(
        found.len() > 20,
        "the sources are where this test looks for them"
    );
    found
}

fn collect(folder: &Path, found: &mut Vec<(String, String)>) {
    for entry in fs::read_dir(folder).expect("a folder of sources").flatten() {
        let path = entry.path();
        if path.is_dir() {
            collect(&path, found);
        } else if path.extension().is_some_and(|extension| extension == "rs") {
            let name = path
                .strip_prefix(root())
                .expect("below src")
                .display()
                .to_string();
            found.push((name, fs::read_to_string(&path).expect("a source file")));
        }
    }
}

/// The module of the flow that a file belongs to; none for `lib.rs` and the binary.
fn module_of(file: &str) -> Option<usize> {
    let first = file.split(['/', '.']).next()?;
    FLOW.iter().position(|module| *module == first)
}

/// A source without its tests and comments.
fn code(text: &str) -> String {
    let before_tests = text.split("#[cfg(test)]").next().expect("a first part");
    before_tests
        .lines()
        .filter(|line| !line.trim_start().starts_with("//"))
        .collect::<Vec<_>>()
        .join("\n")
}

#[test]
fn a_stage_imports_what_comes_before_it_and_nothing_after_it() {
    let mut wrong = Vec::new();
    for (file, text) in sources() {
        let Some(place) = module_of(&file) else {
            continue;
        };
        for used in code(&text).split("crate::").skip(1) {
            let name: String = used
                .chars()
                .take_while(|c| c.is_alphanumeric() || *c == '_')
                .collect();
            if FLOW
                .iter()
                .position(|module| *module == name)
                .is_some_and(|other| other > place)
            {
                wrong.push(format!("{file} uses {name}, which comes after it"));
            }
        }
    }
    assert!(wrong.is_empty(), "{wrong:#?}");
}

#[test]
fn every_module_has_its_place_in_the_flow() {
    let lib = fs::read_to_string(root().join("lib.rs")).expect("lib.rs");
    let declared: Vec<&str> = lib
        .lines()
        .filter_map(|line| line.strip_prefix("pub mod ")?.strip_suffix(';'))
        .collect();
    assert_eq!(declared, FLOW);
}

#[test]
fn stages_know_no_clock_no_lock_and_no_thread() {
    let forbidden = [
        "Instant",
        "SystemTime",
        "Mutex",
        "RwLock",
        "std::thread",
        "sleep(",
        "HashMap",
        "HashSet",
    ];
    let mut wrong = Vec::new();
    for (file, text) in sources() {
        let is_stage = module_of(&file).is_some_and(|place| STAGES.contains(&FLOW[place]));
        if !is_stage {
            continue;
        }
        let code = code(&text);
        wrong.extend(
            forbidden
                .iter()
                .filter(|word| code.contains(**word))
                .map(|word| format!("{file}: {word}")),
        );
    }
    assert!(wrong.is_empty(), "{wrong:#?}");
}

#[test]
fn only_the_two_ends_the_runtime_a_watched_file_and_a_played_glove_call_a_clock() {
    let allowed = [
        "capture/",
        "output/",
        "runtime.rs",
        "reload.rs",
        "reload/watching.rs",
        "lab/player.rs",
        "bin/",
    ];
    for (file, text) in sources() {
        let may = allowed.iter().any(|place| file.starts_with(place));
        assert!(
            may || !code(&text).contains("Instant::now"),
            "{file} calls a clock"
        );
    }
}

#[test]
fn only_the_two_ends_the_control_socket_and_the_doctor_ask_for_the_operating_system() {
    for (file, text) in sources() {
        let asks = code(&text).contains("cfg(target_os") || code(&text).contains("cfg(unix");
        assert!(
            !asks || MAY_HAVE_CFG.contains(&file.as_str()),
            "{file} asks for the system"
        );
    }
}

#[test]
fn files_stay_under_500_lines() {
    for (file, text) in sources() {
        let lines = text.lines().count();
        assert!(
            lines <= LONGEST_FILE,
            "{file} has {lines} lines: look for the second idea in it"
        );
    }
}

/// Somebody sets it, back too. Only how old a file is goes by it: that is compared for being the same.
#[test]
fn nothing_goes_by_the_clock_on_the_wall() {
    for (file, text) in sources() {
        let goes = code(&text).contains("SystemTime") || code(&text).contains("ClockId::Realtime");
        assert!(
            !goes || file == "reload/watched_file.rs",
            "{file} goes by the clock on the wall"
        );
    }
}

#[test]
fn a_lock_that_a_panic_has_poisoned_is_used_all_the_same() {
    let is_of_tests = |file: &str| file.ends_with("tests.rs");
    for (file, text) in sources().into_iter().filter(|(file, _)| !is_of_tests(file)) {
        let code: String = code(&text).split_whitespace().collect();
        for taken in [".lock().unwrap()", ".lock().expect("] {
            assert!(!code.contains(taken), "{file} dies of a poisoned lock");
        }
    }
}
