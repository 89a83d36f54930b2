//! Rules that neither Cargo nor a lint checks: the order of the stages, and the places that read a clock, start a program or show a
//! path. Beside them, the tests that faults and security requirements rely on.

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
#[path = "architecture/sources.rs"]
mod sources;

use sources::{CORE, modules, program, shipped};

/// The places that may read a clock. The core may not: its lints forbid it.
const MAY_READ_A_CLOCK: &[&str] = &[
    "network/",
    "capture/",
    "output/",
    "session/",
    "share/",
    "studio/",
    "sim/player.rs",
    "bin/",
];

#[test]
fn a_stage_imports_only_earlier_stages() {
    let order = modules(CORE);
    let position = |module: &str| order.iter().position(|other| other == module);
    let mut imports = 0;
    for (name, code) in shipped(CORE) {
        let module = name.split(['/', '.']).next().expect("a first part");
        for rest in code.split("crate::").skip(1) {
            let used = rest
                .split(|c: char| !c.is_alphanumeric() && c != '_')
                .next();
            let Some((from, to)) = position(module).zip(used.and_then(position)) else {
                continue;
            };
            assert!(to <= from, "{name} imports {}", order[to]);
            imports += 1;
        }
    }
    assert!(imports > 300, "only {imports} imports were found");
}

#[test]
fn only_the_ends_of_the_flow_and_a_played_glove_read_a_clock() {
    for (name, code) in program() {
        let may = MAY_READ_A_CLOCK
            .iter()
            .any(|prefix| name.starts_with(prefix));
        assert!(
            may || !code.contains("Instant::now"),
            "{name} reads a clock"
        );
    }
}

/// The wall clock can be set back. The age of a file is read from it, and only compared for equality, or gives the order of a list;
/// lines of a log and results of practice tell their time.
#[test]
fn nothing_depends_on_the_wall_clock() {
    for (name, code) in program() {
        let depends = code.contains("SystemTime") || code.contains("ClockId::Realtime");
        let tells = [
            "bin/ademan/messages/log_file.rs",
            "bin/ademan/practice/report.rs",
            "studio/recordings.rs",
        ];
        let may = name.starts_with("session/reload/") || tells.contains(&name.as_str());
        assert!(may || !depends, "{name} reads the wall clock");
    }
}

/// A release waits for nothing. Threads of other outputs wait; the access check is a part of `doctor`.
#[test]
fn the_session_loop_does_not_sleep() {
    let loops = ["session/event_loop/", "output/uinput/linux/"];
    let mut files = 0;
    for (name, code) in program() {
        if loops.iter().any(|prefix| name.starts_with(prefix)) && !name.ends_with("/check.rs") {
            assert!(!code.contains("sleep("), "{name} sleeps");
            files += 1;
        }
    }
    assert!(files > 5, "only {files} files were found");
}

/// `Path::display` writes control characters as they are. A path is escaped in a message, and as data it is a text.
#[test]
fn a_path_becomes_part_of_a_message_by_being_escaped() {
    for (name, code) in program().into_iter().chain(shipped(CORE)) {
        assert!(!code.contains(".display()"), "{name}: use `escape_path`");
    }
}

#[test]
fn a_poisoned_lock_is_used_all_the_same() {
    for (name, code) in program() {
        for panics in [".lock().unwrap()", ".lock().expect("] {
            assert!(!code.contains(panics), "{name} panics at a poisoned lock");
        }
    }
}
