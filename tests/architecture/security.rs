//! What is required for the security of whoever types with this program, and the tests that prove it.
//!
//! The list is printed, and a requirement that was met stays so: every test that it names is there and runs.

use std::fs;
use std::path::{Path, PathBuf};

use crate::evidence::doubt;
use crate::security_table::{REQUIREMENTS, State};

pub fn root() -> PathBuf {
    PathBuf::from(env!("CARGO_MANIFEST_DIR"))
}

pub fn read(path: &str) -> String {
    let path = root().join(path);
    fs::read_to_string(&path).unwrap_or_else(|error| panic!("{}: {error}", path.display()))
}

/// The files of a folder that end like this, with what is in them.
pub fn files(folder: &Path, end: &str) -> Vec<(PathBuf, String)> {
    let mut found = Vec::new();
    for entry in fs::read_dir(folder).expect("a folder").flatten() {
        let path = entry.path();
        if path.is_dir() {
            found.extend(files(&path, end));
        } else if path.to_string_lossy().ends_with(end) {
            let text = fs::read_to_string(&path).expect("a text");
            found.push((path, text));
        }
    }
    found
}

#[test]
fn every_requirement_is_met_by_tests_that_are_there_or_it_is_said_why_not() {
    let mut doubts = Vec::new();
    for (place, requirement) in REQUIREMENTS.iter().enumerate() {
        assert_eq!(requirement.number, place + 1, "they are in order");
        println!("S{:<2} {}", requirement.number, requirement.name);
        let (witnesses, rest) = match requirement.state {
            State::Met(witnesses) => (witnesses, ""),
            State::Partly(witnesses, rest) => (witnesses, rest),
            State::NotApplicable(reason) => {
                println!("     not applicable yet: {reason}");
                assert!(!reason.is_empty());
                continue;
            }
        };
        assert!(
            !witnesses.is_empty(),
            "S{} names no test",
            requirement.number
        );
        for (file, name) in witnesses {
            println!("     {file}: {name}");
        }
        if !rest.is_empty() {
            println!("     not so far: {rest}");
        }
        doubts.extend(witnesses.iter().filter_map(|&witness| doubt(witness)));
    }
    assert_eq!(REQUIREMENTS.len(), 22);
    assert!(doubts.is_empty(), "{doubts:#?}");
}

#[test]
fn the_promises_of_the_security_policy_name_every_requirement() {
    let policy = read("SECURITY.md");
    for requirement in REQUIREMENTS {
        let row = format!("| S{} |", requirement.number);
        assert!(policy.contains(&row), "SECURITY.md says nothing of {row}");
    }
}
