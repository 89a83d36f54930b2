//! The sixty faults that are tried on this program, and the tests that prove what comes of each.
//!
//! The tests themselves are where the parts are that they are about. This one prints the list and sees to it that a
//! fault that was covered stays so: that every test that the list names is there and runs.
#![cfg(target_os = "linux")]

#[path = "faults/clients.rs"]
mod clients;
#[path = "faults/disks.rs"]
mod disks;
#[path = "faults/files.rs"]
mod files;
#[path = "faults/line.rs"]
mod line;
#[path = "faults/lines.rs"]
mod lines;
#[path = "desktop/press.rs"]
#[allow(dead_code)]
mod press;
#[path = "faults/readings.rs"]
mod readings;
mod support;
#[path = "faults/table.rs"]
mod table;
#[path = "faults/wearer.rs"]
mod wearer;

use std::fs;
use std::path::{Path, PathBuf};

use table::{COVERED, FAULTS, Fault, Proof};

/// What proves it: a file of this package, and a test in it or a line that the scenario in the virtual machine says.
type Witness = (&'static str, &'static str);

fn root() -> PathBuf {
    PathBuf::from(env!("CARGO_MANIFEST_DIR"))
}

/// Why the witness proves nothing, if so.
fn doubt((file, name): Witness) -> Option<String> {
    let Ok(text) = fs::read_to_string(root().join(file)) else {
        return Some(format!("there is no file {file}"));
    };
    if !is_compiled(Path::new(file)) {
        return Some(format!("{file} is in no test program"));
    }
    let is_there = match file.starts_with("tests/vm/") {
        true => text.contains(&format!("scene.tell(\"{name}\")")),
        false => is_test(&text, name),
    };
    (!is_there).then(|| format!("{file} has no test `{name}` that runs"))
}

/// Whether `text` has a function of this name that is a test and is not left out.
fn is_test(text: &str, name: &str) -> bool {
    let start = format!("fn {name}()");
    let lines: Vec<&str> = text.lines().map(str::trim_start).collect();
    let Some(place) = lines.iter().position(|line| line.starts_with(&start)) else {
        return false;
    };
    let before = lines[..place].iter().rev();
    let attributes: Vec<_> = before.take_while(|line| line.starts_with("#[")).collect();
    let has = |attribute: &str| attributes.iter().any(|line| line.starts_with(attribute));
    has("#[test]") && !has("#[ignore")
}

/// Whether the file is one that some program is made of.
fn is_compiled(file: &Path) -> bool {
    let folder = file.parent().expect("a file is in a folder");
    let module = file.file_stem().expect("it has a name").to_string_lossy();
    if folder == Path::new("tests") || module == "main" || module == "mod" || module == "lib" {
        return true;
    }
    let parents = [
        folder.join("mod.rs"),
        folder.join("main.rs"),
        folder.join("lib.rs"),
        folder.with_extension("rs"),
    ];
    parents.iter().any(|parent| {
        let text = fs::read_to_string(root().join(parent)).unwrap_or_default();
        let declared = format!("mod {module};");
        text.lines().any(|line| line.trim().ends_with(&declared))
    })
}

fn is_covered(fault: &Fault) -> bool {
    matches!(fault.proof, Proof::By(_))
}

#[test]
fn every_fault_that_was_covered_still_is() {
    let mut doubts = Vec::new();
    for fault in FAULTS {
        println!("{:2} {}", fault.number, fault.name);
        match fault.proof {
            Proof::By(witnesses) => {
                for (file, name) in witnesses {
                    println!("     {file}: {name}");
                }
                doubts.extend(witnesses.iter().filter_map(|&witness| doubt(witness)));
            }
            Proof::NotYet(reason) => println!("     NOT YET: {reason}"),
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
            Proof::By(witnesses) => !witnesses.is_empty(),
            Proof::NotYet(reason) => !reason.is_empty(),
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
    assert!(doubt(("tests/faults.rs", "the_list_is_whole")).is_none());
    assert!(doubt(("tests/faults.rs", "the_list")).is_some());
    assert!(doubt(("tests/gone.rs", "the_list_is_whole")).is_some());
    assert!(doubt(("tests/vm/typing.rs", "pigs fly")).is_some());
    assert!(!is_compiled(Path::new("tests/faults/nobody.rs")));
}
