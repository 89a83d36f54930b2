//! Faults and security requirements, and the tests that show that each is met.
//!
//! The tests are beside the parts that they are about. This module prints the tables and checks that what was covered stays
//! covered: every test that a table names exists and runs.

use std::fs;

use Coverage::{Missing, Partly, Tests};

use crate::fault_table::FAULTS;
use crate::security_table::REQUIREMENTS;

/// A file of this package, and a test in it. In `tests/outputs/vm/` it may also be a line that the scenario prints.
pub type Evidence = (&'static str, &'static str);

/// An event that goes wrong, or a requirement.
pub struct Row {
    number: usize,
    name: &'static str,
    coverage: Coverage,
}

pub const fn row(number: usize, name: &'static str, coverage: Coverage) -> Row {
    Row {
        number,
        name,
        coverage,
    }
}

/// The evidence that a fault ends as it should, or that a requirement is met.
pub enum Coverage {
    /// These tests.
    Tests(&'static [Evidence]),
    /// These tests, with this exception.
    Partly(&'static [Evidence], &'static str),
    /// None, for this reason.
    Missing(&'static str),
}

/// Prints a table and checks it. Returns the numbers of the rows without tests.
fn check(table: &[Row]) -> Vec<usize> {
    let mut objections = Vec::new();
    let mut missing = Vec::new();
    for (index, row) in table.iter().enumerate() {
        assert_eq!(row.number, index + 1, "the table is in order");
        println!("{:3} {}", row.number, row.name);
        let (tests, exception): (&[Evidence], _) = match row.coverage {
            Tests(tests) => (tests, None),
            Partly(tests, exception) => (tests, Some(exception)),
            Missing(reason) => (&[], Some(reason)),
        };
        for &(file, name) in tests {
            println!("     {file}: {name}");
            objections.extend(objection((file, name)));
        }
        if let Some(exception) = exception {
            println!("     not covered: {exception}");
            assert!(!exception.is_empty(), "row {} has no reason", row.number);
        }
        if tests.is_empty() {
            missing.push(row.number);
        }
    }
    assert!(objections.is_empty(), "{objections:#?}");
    missing
}

/// Returns the reason why a piece of evidence proves nothing, if there is one.
fn objection((file, name): Evidence) -> Option<String> {
    let Ok(text) = fs::read_to_string(file) else {
        return Some(format!("there is no file {file} for `{name}`"));
    };
    if !is_compiled(file) {
        return Some(format!("{file} is part of no program"));
    }
    let is_line = || text.contains(&format!("scene.report(\"{name}\")"));
    let exists = is_test(&text, name) || file.starts_with("tests/outputs/vm/") && is_line();
    (!exists).then(|| format!("{file} has no test `{name}` that runs"))
}

/// Returns `true` if `text` has a test function of this name that is not ignored.
fn is_test(text: &str, name: &str) -> bool {
    let start = format!("fn {name}()");
    let mut attributes = String::new();
    for line in text.lines().map(str::trim_start) {
        if line.starts_with(&start) {
            return attributes.contains("\n#[test]") && !attributes.contains("\n#[ignore");
        }
        if !line.starts_with("#[") {
            attributes.clear();
        }
        attributes += "\n";
        attributes += line;
    }
    false
}

/// Returns `true` if a program declares the file as a module.
fn is_compiled(file: &str) -> bool {
    let path = file.trim_end_matches(".rs").trim_end_matches("/mod");
    let (folder, module) = path.rsplit_once('/').expect("a file is in a folder");
    let declared = format!("mod {module};");
    let parents = ["/mod.rs", "/main.rs", "/lib.rs", ".rs"];
    ["main", "lib"].contains(&module)
        || parents.iter().any(|parent| {
            let text = fs::read_to_string(format!("{folder}{parent}")).unwrap_or_default();
            text.lines().any(|line| line.trim().ends_with(&declared))
        })
}

#[test]
fn all_covered_faults_stay_covered() {
    assert_eq!(FAULTS.len(), 111);
    assert_eq!(check(FAULTS), [15], "faults without a test");
}

#[test]
fn every_security_requirement_is_met_by_existing_tests_or_has_a_reason_why_not() {
    assert_eq!(REQUIREMENTS.len(), 22);
    assert_eq!(check(REQUIREMENTS), [3], "requirements without a test");
    let policy = fs::read_to_string("SECURITY.md").expect("the security policy");
    for requirement in REQUIREMENTS {
        let row = format!("| S{} |", requirement.number);
        assert!(policy.contains(&row), "SECURITY.md lacks the row {row}");
    }
}

#[test]
fn a_test_that_is_removed_ignored_or_no_test_is_no_evidence() {
    let text = "#[test]\nfn runs() {\n}\n#[test]\n#[ignore]\nfn waits() {}\nfn helps() {}\n#[test] // fn talks() {}\n";
    assert!(is_test(text, "runs"));
    for name in ["waits", "helps", "talks", "run", "uns"] {
        assert!(!is_test(text, name), "{name}");
    }
    let here = "tests/architecture/evidence.rs";
    assert!(objection((here, "all_covered_faults_stay_covered")).is_none());
    assert!(objection((here, "all_covered_faults")).is_some());
    assert!(objection(("tests/gone.rs", "all_covered_faults_stay_covered")).is_some());
    assert!(objection(("tests/outputs/vm/typing.rs", "pigs fly")).is_some());
    assert!(!is_compiled("tests/architecture/absent.rs"));
    assert!(is_compiled("tests/outputs/vm/mod.rs"));
}
