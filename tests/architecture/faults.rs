//! The sixty faults that are tried on this program, and the tests that prove what comes of each.
//!
//! The tests themselves are where the parts are that they are about. This one prints the list and sees to it that a
//! fault that was covered stays so: that every test that the list names is there and runs.

use std::path::Path;

use crate::evidence::{doubt, is_compiled, is_test};
use crate::fault_table::{COVERED, Coverage, FAULTS, Fault};

fn is_covered(fault: &Fault) -> bool {
    matches!(fault.proof, Coverage::By(_))
}

#[test]
fn every_fault_that_was_covered_still_is() {
    let mut doubts = Vec::new();
    for fault in FAULTS {
        println!("{:2} {}", fault.number, fault.name);
        match fault.proof {
            Coverage::By(witnesses) => {
                for (file, name) in witnesses {
                    println!("     {file}: {name}");
                }
                doubts.extend(witnesses.iter().filter_map(|&witness| doubt(witness)));
            }
            Coverage::NotYet(reason) => println!("     NOT YET: {reason}"),
        }
    }
    let covered: Vec<u8> = FAULTS
        .iter()
        .filter(|fault| is_covered(fault))
        .map(|fault| fault.number)
        .collect();
    println!("covered {} of {}", covered.len(), FAULTS.len());
    assert!(doubts.is_empty(), "{doubts:#?}");
    assert_eq!(covered, COVERED, "what is covered, against what was");
}

#[test]
fn the_list_is_whole() {
    let numbers: Vec<u8> = FAULTS.iter().map(|fault| fault.number).collect();
    assert_eq!(numbers, (1..=60).collect::<Vec<u8>>());
    for fault in FAULTS {
        let says = match fault.proof {
            Coverage::By(witnesses) => !witnesses.is_empty(),
            Coverage::NotYet(reason) => !reason.is_empty(),
        };
        assert!(says, "{} says nothing", fault.number);
    }
}

#[test]
fn a_test_that_is_gone_left_out_or_none_is_no_proof() {
    let text = "#[test]\nfn runs() {\n}\n#[test]\n#[ignore]\nfn waits() {}\nfn helps() {}\n#[test] // fn talks() {}\n";
    assert!(is_test(text, "runs"));
    for name in ["waits", "helps", "talks", "run", "uns"] {
        assert!(!is_test(text, name), "{name}");
    }
    assert!(doubt(("tests/architecture/faults.rs", "the_list_is_whole")).is_none());
    assert!(doubt(("tests/architecture/faults.rs", "the_list")).is_some());
    assert!(doubt(("tests/gone.rs", "the_list_is_whole")).is_some());
    assert!(doubt(("tests/outputs/vm/typing.rs", "pigs fly")).is_some());
    assert!(!is_compiled(Path::new("tests/architecture/nobody.rs")));
}
