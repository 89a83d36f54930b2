//! Rules that neither Cargo nor a lint checks: the order of the stages, and the places that read a clock, start a program or show a
//! path. Beside them, the tests that faults and security requirements rely on.

mod evidence;
mod fault_table;
mod packages;
mod security_table;
mod sources;

use std::fs;

use sources::SHIPPED;

const COMMAND: &str = "src/bin/";
const EVENT_LOOP: &str = "crates/runtime/src/session/event_loop/";
const OPENXR: &str = "crates/runtime/src/capture/transport/openxr/hand_session.rs";

#[test]
fn a_stage_imports_only_earlier_stages() {
    let library = fs::read_to_string("crates/core/src/lib.rs").expect("the library");
    let lines = library.lines();
    let order: Vec<_> = lines
        .filter_map(|line| line.strip_prefix("pub mod ")?.strip_suffix(';'))
        .collect();
    let stage = |path: &str| {
        let name = path
            .split(|c: char| !c.is_alphanumeric() && c != '_')
            .next();
        order.iter().position(|&module| Some(module) == name)
    };
    let mut imports = 0;
    for (name, code) in SHIPPED.iter() {
        let Some(from) = name.strip_prefix("crates/core/src/").and_then(stage) else {
            continue;
        };
        for to in code.split("crate::").skip(1).filter_map(stage) {
            assert!(to <= from, "{name} imports {}", order[to]);
            imports += 1;
        }
    }
    assert!(imports > 300, "only {imports} imports were found");
}

/// Returns the file of each place in the program with this code.
fn places(code: &str) -> Vec<&'static str> {
    let files = SHIPPED.iter();
    files
        .flat_map(|(name, text)| text.matches(code).map(move |_| name.as_str()))
        .collect()
}

/// Fails unless each of these folders and files has this code, and no other place has it.
fn assert_only_in(code: &str, allowed: &[&str]) {
    let found = places(code);
    for name in &found {
        let may = allowed.iter().any(|place| name.starts_with(place));
        assert!(may, "{name} contains `{code}`");
    }
    for place in allowed {
        let has = found.iter().any(|name| name.starts_with(place));
        assert!(has, "{place} does not contain `{code}`");
    }
}

#[test]
#[rustfmt::skip]
fn only_the_ends_of_the_flow_and_a_played_glove_read_a_clock() {
    assert_only_in("Instant::now", &[
        "crates/runtime/src/capture/",
        "crates/runtime/src/network/",
        "crates/runtime/src/output/",
        EVENT_LOOP,
        "crates/runtime/src/session/",
        "crates/runtime/src/share/",
        "crates/runtime/src/sim/player.rs",
        COMMAND,
    ]);
}

/// The wall clock can be set back. The age of a file is read from it, and only compared for equality, or gives the order of a list;
/// lines of a log and results of practice tell their time.
#[test]
#[rustfmt::skip]
fn nothing_depends_on_the_wall_clock() {
    assert_only_in("SystemTime", &[
        "crates/runtime/src/session/reload/",
        "crates/studio/src/recordings.rs",
        "src/bin/ademan/messages/log_file.rs",
        "src/bin/ademan/practice/report.rs",
    ]);
    assert_only_in("ClockId::Realtime", &[]);
}

/// A release waits for nothing. Threads of other outputs wait; the access check is a part of `doctor`.
#[test]
fn the_session_loop_does_not_sleep() {
    let mut sleeping = places("sleep(");
    sleeping.retain(|name| name.starts_with(EVENT_LOOP) || name.contains("/output/uinput/"));
    assert_eq!(
        sleeping,
        ["crates/runtime/src/output/uinput/linux/check.rs"]
    );
}

/// `Path::display` writes control characters as they are. A path is escaped in a message by `escape_path`, and as data it is a text.
#[test]
fn a_path_becomes_part_of_a_message_by_being_escaped() {
    assert_only_in(".display()", &[]);
}

#[test]
fn a_poisoned_lock_is_used_all_the_same() {
    assert_only_in(".lock().unwrap()", &[]);
    assert_only_in(".lock().expect(", &[]);
}

/// The command also starts what a person asks it for, such as a browser or `ffmpeg`.
#[test]
#[rustfmt::skip]
fn only_the_watchdog_and_its_call_of_systemd_are_ever_started() {
    assert_only_in("Command::new(", &[
        "crates/runtime/src/output/watchdog/linux/link.rs",
        "crates/runtime/src/output/watchdog/pipes/link.rs",
        "crates/runtime/src/output/watchdog_process/linux/scope.rs",
        COMMAND,
    ]);
    assert_only_in(".exec(", &[COMMAND]);
    assert_only_in("libloading", &[]);
    assert_only_in("dlopen", &[]);
    // The loader of OpenXR, when the source `openxr:` is opened or the doctor looks for a headset.
    assert_only_in("Entry::load", &[OPENXR]);
}

/// The environment names sockets, displays and sessions. The content of files is used as written.
#[test]
#[rustfmt::skip]
fn no_file_of_a_user_reads_the_environment() {
    assert_only_in("env::var", &[
        "crates/runtime/src/doctor/",
        "crates/runtime/src/output/",
        "crates/runtime/src/session/focus/linux/",
        COMMAND,
    ]);
}

/// A lint of the workspace refuses unsafe code that no attribute permits, in each package that adopts the lints.
#[test]
#[rustfmt::skip]
fn the_program_contains_no_unsafe_code_but_what_is_listed() {
    let manifest = fs::read_to_string("Cargo.toml").expect("the workspace");
    assert!(manifest.contains("[workspace.lints.rust]\nunsafe_code = \"deny\""));
    let crates = fs::read_dir("crates").expect("the crates").flatten();
    let crates = crates.map(|entry| entry.path().join("Cargo.toml"));
    let packages: Vec<_> = crates.chain(["Cargo.toml".into(), "layouts/Cargo.toml".into()]).collect();
    assert!(packages.len() > 8, "{packages:?}");
    for package in packages {
        let text = fs::read_to_string(&package).expect("a manifest");
        assert!(text.contains("\n[lints]\nworkspace = true\n"), "{package:?}");
    }
    assert_eq!(places("(unsafe_code"), [
        // The loader of OpenXR, a library of another program, and a session that could have graphics.
        OPENXR,
        OPENXR,
        // A system call for which no library has a safe function.
        "crates/runtime/src/priority/linux.rs",
        // The names of the functions that a page calls: an attribute for them is unsafe, and nothing else there is.
        "crates/web/src/abi.rs",
        "crates/web/src/abi_recordings.rs",
        "crates/web/src/abi_score.rs",
        "crates/web/src/abi_words.rs",
    ]);
}
