//! JSON Schemas of the file formats, checked by the validator of Python.

use std::fs;
use std::path::{Path, PathBuf};
use std::process::Command;

use super::{run, text};
use crate::support::python::python;

/// The formats, and where their files are.
const FORMATS: [(&str, &[&str]); 6] = [
    (
        "layout",
        &[
            "layouts/keyboards",
            "layouts/pointers",
            "layouts/panels",
            "examples/lab",
        ],
    ),
    ("glove", &["layouts/gloves"]),
    ("arm", &["layouts/arms"]),
    ("person", &["layouts/persons"]),
    ("setup", &["examples/setup.ron"]),
    ("learned", &["tests/support/learned.ron"]),
];

/// Writes the schema of a format and its files in their JSON form. Returns the number of files.
fn write_format(folder: &Path, format: &str, places: &[&str]) -> usize {
    let folder = folder.join(format);
    fs::create_dir(&folder).expect("a folder");
    let schema = run(["schema", format]).done().out;
    fs::write(folder.join("schema"), schema).expect("a file");
    let project = Path::new(env!("CARGO_MANIFEST_DIR"));
    let mut files: Vec<PathBuf> = Vec::new();
    for place in places.iter().map(|place| project.join(place)) {
        match fs::read_dir(&place) {
            Ok(entries) => files.extend(entries.map(|entry| entry.expect("a file").path())),
            Err(_) => files.push(place),
        }
    }
    files.retain(|file| file.extension().is_some_and(|ending| ending == "ron"));
    for (index, file) in files.iter().enumerate() {
        let json = run(["schema", format, text(file)]).done().out;
        // Files in two folders may have one name.
        let name = file.file_stem().expect("a name").to_string_lossy();
        fs::write(folder.join(format!("{index}-{name}.json")), json).expect("a file");
    }
    files.len()
}

#[test]
fn every_shipped_file_is_valid_and_each_change_of_it_is_reported() {
    let python = match python("jsonschema", "jsonschema", &["jsonschema>=4,<5"]) {
        Ok(python) => python,
        Err(reason) => {
            println!("SKIPPED: no Python with jsonschema: {reason}");
            return;
        }
    };
    let folder = tempfile::tempdir().unwrap();
    let counts = FORMATS.map(|(format, places)| write_format(folder.path(), format, places));
    let script = concat!(env!("CARGO_MANIFEST_DIR"), "/tests/support/validate.py");
    let checked = Command::new(python).arg(script).arg(folder.path()).output();
    let checked = checked.expect("Python starts");
    let out = String::from_utf8_lossy(&checked.stdout);
    let err = String::from_utf8_lossy(&checked.stderr);
    assert!(checked.status.success(), "{out}{err}");
    for ((format, _), count) in FORMATS.iter().zip(counts) {
        assert!(count > 0, "{format}");
        let line = format!("{format}: {count} valid, ");
        assert!(out.contains(&line), "{line}: {out}");
    }
}

#[test]
fn the_json_form_of_a_file_is_refused_with_the_place_of_a_missing_bracket() {
    let folder = tempfile::tempdir().unwrap();
    let file = super::file(&folder, "open.ron", "Layout(name: \"a\", boards: [(");
    let ended = run(["schema", "layout", &file]).exited(2);
    ended.reported("brackets are not balanced");
}

#[test]
fn a_schema_has_units_ranges_and_defaults() {
    let schema: serde_json::Value =
        serde_json::from_str(&run(["schema", "layout"]).done().out).unwrap();
    let pitch = &schema["$defs"]["Board"]["properties"]["pitch_mm"];
    assert_eq!(pitch["minimum"], 1);
    assert_eq!(pitch["maximum"], 500);
    assert_eq!(pitch["default"], 19);
    assert_eq!(pitch["unit"], "mm");
    let setup: serde_json::Value =
        serde_json::from_str(&run(["schema", "setup"]).done().out).unwrap();
    let fields = &setup["$defs"]["Setup"]["properties"];
    assert_eq!(fields["stall_timeout_ms"]["default"], 200);
    for (name, min, max) in [
        ("stall_timeout_ms", 20, 10_000),
        ("max_presses_per_second", 1, 1_000),
    ] {
        assert_eq!(fields[name]["minimum"], min, "{name}");
        assert_eq!(fields[name]["maximum"], max, "{name}");
    }
    assert_eq!(fields["layout"]["default"], "qwerty-flat");
}

#[test]
fn the_schema_of_what_was_learned_has_the_units_and_ranges_of_its_fields() {
    let schema: serde_json::Value =
        serde_json::from_str(&run(["schema", "learned"]).done().out).unwrap();
    assert_eq!(schema["title"], "Learned");
    let described = |table: &str, field: &str| {
        let description = &schema["$defs"][table]["properties"][field]["description"];
        description.as_str().expect("a description").to_owned()
    };
    for (table, field, words) in [
        ("Learned", "words", "at most 512, each of 1 to 64 bytes"),
        ("Learned", "keys", "at most 256"),
        ("LearnedTaps", "taps", "0 to 10000"),
        (
            "LearnedTaps",
            "offset_mm",
            "in millimetres, each -100 to 100",
        ),
        ("LearnedKey", "scatter_mm", "in millimetres, each 0 to 100"),
        ("LearnedKey", "correlation", "-1 to 1"),
        ("LearnedErrors", "missed", "0 to 10000"),
    ] {
        let description = described(table, field);
        assert!(
            description.contains(words),
            "{table}.{field}: {description}"
        );
    }
    let required = &schema["$defs"]["LearnedKey"]["required"];
    assert!(
        required.as_array().is_some_and(|it| it.len() == 5),
        "{required}"
    );
}

#[test]
fn a_file_of_what_was_learned_is_no_layout_and_the_error_names_it() {
    let ended = run(["layout", "check", "tests/support/learned.ron"]).exited(2);
    ended.reported("expected `Layout(…)`, found `Learned`");
}
