//! Security requirements that the sources and the packaged files show.

use crate::security::{files, read, root};
use crate::sources::{CORE, program, shipped};

/// The files of the library and their code.
fn library() -> Vec<(String, String)> {
    let all = program().into_iter();
    let library = all.filter(|(name, _)| !name.starts_with("bin/"));
    library.chain(shipped(CORE)).collect()
}

/// The files of the library whose code contains this.
fn containing(what: &str) -> Vec<String> {
    let found = library()
        .into_iter()
        .filter(|(_, code)| code.contains(what));
    let mut names: Vec<_> = found.map(|(name, _)| name).collect();
    names.sort();
    names
}

#[test]
fn only_the_watchdog_and_its_call_of_systemd_are_ever_started() {
    let started = [
        "output/watchdog/linux/link.rs",
        "output/watchdog/pipes/link.rs",
        "output/watchdog_process/linux/scope.rs",
    ];
    assert_eq!(containing("Command::new("), started);
    for word in ["libloading", "dlopen", ".exec("] {
        assert_eq!(containing(word), [""; 0], "{word}");
    }
    // The loader of OpenXR, when the source `openxr:` is opened or the doctor looks for a headset.
    let loading = ["capture/transport/openxr/hand_session.rs"];
    assert_eq!(containing("Entry::load"), loading);
}

#[test]
fn no_file_of_a_user_reads_the_environment() {
    // The environment names sockets, displays and sessions. The content of files is used as written.
    let may = [
        "doctor/",
        "output/",
        "session/control_socket/",
        "session/focus/linux/",
    ];
    for (name, code) in library() {
        let reads = code.contains("env::var");
        assert!(
            !reads || may.iter().any(|prefix| name.starts_with(prefix)),
            "{name}"
        );
    }
    assert!(!containing("env::var").is_empty(), "the pattern is found");
}

/// The files with unsafe code, and the number of its places.
const UNSAFE: [(&str, usize); 6] = [
    // The loader of OpenXR, a library of another program, and a session that could have graphics.
    (
        "crates/runtime/src/capture/transport/openxr/hand_session.rs",
        2,
    ),
    // A system call for which no library has a safe function.
    ("crates/runtime/src/priority/linux.rs", 1),
    // The names of the functions that a page calls: an attribute for them is unsafe, and nothing else there is.
    ("crates/web/src/abi.rs", 1),
    ("crates/web/src/abi_recordings.rs", 1),
    ("crates/web/src/abi_score.rs", 1),
    ("crates/web/src/abi_words.rs", 1),
];

#[test]
fn the_program_contains_no_unsafe_code_but_what_is_listed() {
    assert!(read("Cargo.toml").contains("[workspace.lints.rust]\nunsafe_code = \"deny\""));
    // The lint refuses code that no attribute permits.
    let mut found = Vec::new();
    for folder in ["src", "crates"] {
        for (path, text) in files(&root().join(folder), ".rs") {
            let permissions = text.matches("(unsafe_code").count();
            if permissions > 0 {
                found.push((path, permissions));
            }
        }
    }
    let mut expected = UNSAFE.map(|(file, places)| (root().join(file), places));
    found.sort();
    expected.sort();
    assert_eq!(found, expected);
}

#[test]
fn the_udev_rules_give_uinput_to_its_own_group_or_the_seat_and_never_to_input() {
    for (file, grant) in [
        ("packaging/60-ademan.rules", "GROUP=\"uinput\""),
        ("packaging/60-ademan-uaccess.rules", "TAG+=\"uaccess\""),
    ] {
        let text = read(file);
        let rules: Vec<_> = text.lines().filter(|line| !line.starts_with('#')).collect();
        let for_uinput: Vec<_> = rules
            .iter()
            .filter(|rule| rule.contains("KERNEL==\"uinput\""))
            .collect();
        assert_eq!(for_uinput.len(), 1, "{file}");
        assert!(for_uinput[0].contains(grant), "{file}: {for_uinput:?}");
        for rule in rules {
            assert!(!rule.contains("GROUP=\"input\""), "{file}: {rule}");
            let is_open = rule.contains("MODE=\"0666\"") || rule.contains("MODE=\"666\"");
            assert!(!is_open, "{file}: {rule}");
        }
    }
}

#[test]
fn all_dependencies_come_from_the_registry_with_a_checksum() {
    for lock in ["Cargo.lock", "benches/peers/Cargo.lock"] {
        let text = read(lock);
        let packages: Vec<_> = text.split("[[package]]").skip(1).collect();
        assert!(packages.len() > 50, "{lock}");
        for package in packages {
            let is_own = package.trim_start().starts_with("name = \"ademan");
            let has_checksum = package.contains("checksum = ");
            assert!(is_own || has_checksum, "{lock}: {package}");
        }
    }
    let rules = read("deny.toml");
    for rule in ["unknown-registry = \"deny\"", "unknown-git = \"deny\""] {
        assert!(rules.contains(rule), "{rule}");
    }
    assert!(read(".ci/run").contains("cargo deny check"));
}
