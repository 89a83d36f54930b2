//! Security requirements for a program that types, and the tests that show that each is met.
//!
//! This module prints the table and checks that a requirement that was met stays met: every test that the table names
//! exists and runs.

use std::fs;
use std::path::{Path, PathBuf};

use crate::evidence::objection;
use crate::security_table::{REQUIREMENTS, Status};

/// The folder of the package.
pub fn root() -> PathBuf {
    PathBuf::from(env!("CARGO_MANIFEST_DIR"))
}

/// The text of a file of the package.
pub fn read(path: &str) -> String {
    let path = root().join(path);
    fs::read_to_string(&path).unwrap_or_else(|error| panic!("{}: {error}", path.display()))
}

/// The files below a folder whose names have this ending, with their texts.
pub fn files(folder: &Path, ending: &str) -> Vec<(PathBuf, String)> {
    let mut found = Vec::new();
    for entry in fs::read_dir(folder).expect("a folder").flatten() {
        let path = entry.path();
        if path.is_dir() {
            found.extend(files(&path, ending));
        } else if path.to_string_lossy().ends_with(ending) {
            let text = fs::read_to_string(&path).expect("a text file");
            found.push((path, text));
        }
    }
    found
}

#[test]
fn every_requirement_is_met_by_existing_tests_or_has_a_reason_why_not() {
    let mut objections = Vec::new();
    for (index, requirement) in REQUIREMENTS.iter().enumerate() {
        assert_eq!(requirement.number, index + 1, "the table is in order");
        println!("S{:<2} {}", requirement.number, requirement.name);
        let (tests, exception) = match requirement.status {
            Status::Met(tests) => (tests, ""),
            Status::Partly(tests, exception) => (tests, exception),
            Status::NotApplicable(reason) => {
                println!("     not applicable yet: {reason}");
                assert!(!reason.is_empty());
                continue;
            }
        };
        assert!(!tests.is_empty(), "S{} names no test", requirement.number);
        for (file, name) in tests {
            println!("     {file}: {name}");
        }
        if !exception.is_empty() {
            println!("     not so far: {exception}");
        }
        objections.extend(tests.iter().filter_map(|&test| objection(test)));
    }
    assert_eq!(REQUIREMENTS.len(), 22);
    assert!(objections.is_empty(), "{objections:#?}");
}

#[test]
fn the_security_policy_lists_every_requirement() {
    let policy = read("SECURITY.md");
    for requirement in REQUIREMENTS {
        let row = format!("| S{} |", requirement.number);
        assert!(policy.contains(&row), "SECURITY.md lacks the row {row}");
    }
}
