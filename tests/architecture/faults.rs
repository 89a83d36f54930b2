//! The faults, and the tests that show the consequences of each.
//!
//! The tests are beside the parts that they are about. This module prints the table and checks that a fault that was
//! covered stays covered: every test that the table names exists and runs.

use std::path::Path;

use crate::evidence::{is_compiled, is_test, objection};
use crate::fault_table::{COVERED, Coverage, FAULTS, Fault};

fn is_covered(fault: &Fault) -> bool {
    matches!(fault.coverage, Coverage::Tests(_))
}

#[test]
fn every_covered_fault_stays_covered() {
    let mut objections = Vec::new();
    for fault in FAULTS {
        println!("{:2} {}", fault.number, fault.name);
        match fault.coverage {
            Coverage::Tests(tests) => {
                for (file, name) in tests {
                    println!("     {file}: {name}");
                }
                objections.extend(tests.iter().filter_map(|&test| objection(test)));
            }
            Coverage::Missing(reason) => println!("     NOT YET: {reason}"),
        }
    }
    let covered: Vec<u8> = FAULTS
        .iter()
        .filter(|fault| is_covered(fault))
        .map(|fault| fault.number)
        .collect();
    println!("covered {} of {}", covered.len(), FAULTS.len());
    assert!(objections.is_empty(), "{objections:#?}");
    assert_eq!(covered, COVERED, "covered now, and before");
}

#[test]
fn the_table_is_complete() {
    let numbers: Vec<u8> = FAULTS.iter().map(|fault| fault.number).collect();
    assert_eq!(numbers, (1..=110).collect::<Vec<u8>>());
    for fault in FAULTS {
        let is_filled = match fault.coverage {
            Coverage::Tests(tests) => !tests.is_empty(),
            Coverage::Missing(reason) => !reason.is_empty(),
        };
        assert!(is_filled, "fault {} is empty", fault.number);
    }
}

#[test]
fn a_test_that_is_removed_ignored_or_no_test_is_no_evidence() {
    let text = "#[test]\nfn runs() {\n}\n#[test]\n#[ignore]\nfn waits() {}\nfn helps() {}\n#[test] // fn talks() {}\n";
    assert!(is_test(text, "runs"));
    for name in ["waits", "helps", "talks", "run", "uns"] {
        assert!(!is_test(text, name), "{name}");
    }
    let here = "tests/architecture/faults.rs";
    assert!(objection((here, "the_table_is_complete")).is_none());
    assert!(objection((here, "the_table")).is_some());
    assert!(objection(("tests/gone.rs", "the_table_is_complete")).is_some());
    assert!(objection(("tests/outputs/vm/typing.rs", "pigs fly")).is_some());
    assert!(!is_compiled(Path::new("tests/architecture/absent.rs")));
    assert!(is_compiled(Path::new("tests/outputs/vm/mod.rs")));
}
