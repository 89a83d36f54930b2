use ademan::capture::protocol::text_line;
use serde_json::Value;

use super::check::{list, numbers, text};

/// Checks the numbers of each valid line, and the refusal of the others with the same reason.
pub fn lines(file: &Value) -> usize {
    let cases = list(&file["cases"]);
    for case in cases {
        let name = text(&case["name"]);
        match (
            text_line::parse(text(&case["line"])),
            case["error"].as_str(),
        ) {
            (Ok(values), None) => assert_eq!(values[..], numbers(&case["values"]), "{name}"),
            (Err(ours), Some(theirs)) => {
                let theirs = theirs.replace("no values", "0 values");
                let theirs = theirs.trim_start_matches("a ");
                assert!(
                    ours.to_string().contains(theirs),
                    "{name}: {ours}, not {theirs}"
                );
            }
            (ours, theirs) => panic!("{name}: {ours:?}, not {theirs:?}"),
        }
    }
    cases.len()
}
