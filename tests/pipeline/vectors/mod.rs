//! Reference vectors: results of an independent implementation.
//!
//! Reads the files in the folder `ADEMAN_VECTORS` (default: `tests/vectors`) and prints the number of
//! cases of each. A missing file, a file without cases and a file that no check reads are failures.

mod arm_attributes;
mod bvh;
mod check;
mod glove;
mod joint_angles;
mod keypad;
pub mod markers;
mod one_euro;
mod packets;
mod text_line;

use std::path::{Path, PathBuf};

use self::check::Check;

/// The covered files, by the first word, with the check of each.
const COVERED: &[(&str, Check)] = &[
    ("glove_channels", glove::channels),
    ("glove_packets", packets::packets),
    ("glove_pipeline", glove::pipeline),
    ("glove_fk", glove::forward_kinematics),
    ("glove_end_to_end", glove::end_to_end),
    ("keypad_press", keypad::press),
    (
        "keypad_press as layout files",
        keypad::press_through_layouts,
    ),
    ("one_euro", one_euro::filter),
    ("triangulation", markers::triangulation),
    ("skeleton_fit", markers::skeleton_fit),
    ("bvh", bvh::files),
    ("arm_attributes", arm_attributes::attributes),
    ("max_shoulder_rotation", arm_attributes::full_rotation),
    ("joint_angles", joint_angles::rotations),
    ("tpose_angles", joint_angles::t_pose),
    ("glove_text_line", text_line::lines),
];

fn folder() -> PathBuf {
    match std::env::var_os("ADEMAN_VECTORS") {
        Some(folder) => folder.into(),
        None => PathBuf::from(env!("CARGO_MANIFEST_DIR")).join("tests/vectors"),
    }
}

#[test]
fn results_agree_with_the_reference_vectors() {
    let folder = folder();
    let mut failed = failures(&folder, COVERED);
    failed.extend(uncovered(&folder));
    assert!(failed.is_empty(), "{failed:#?}");
}

/// Checks cases of the same forms at the ends of ranges and in degenerate positions, from another implementation of the rules. The
/// tables of channels have no other values.
#[test]
fn results_agree_with_vectors_of_extreme_values() {
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("tests/extreme_vectors");
    let checks = COVERED.iter().copied();
    let checks: Vec<_> = checks
        .filter(|(name, _)| *name != "glove_channels")
        .collect();
    let mut failed = failures(&folder, &checks);
    failed.extend(uncovered(&folder));
    assert!(failed.is_empty(), "{failed:#?}");
}

/// Returns the files of the folder whose results are wrong.
fn failures(folder: &Path, checks: &[(&str, Check)]) -> Vec<String> {
    let mut failed = Vec::new();
    for (name, check) in checks {
        let path = folder.join(format!("{}.json", file_of(name)));
        let text = std::fs::read_to_string(&path)
            .unwrap_or_else(|error| panic!("cannot read {}: {error}", path.display()));
        let file = serde_json::from_str(&text)
            .unwrap_or_else(|error| panic!("cannot parse {}: {error}", path.display()));
        let result = std::panic::catch_unwind(|| check(&file));
        match result {
            Ok(cases) if cases > 0 => println!("{name}: {cases} cases"),
            Ok(_) => failed.push(format!("{name}: no cases")),
            Err(_) => failed.push(format!("{name}: see above")),
        }
    }
    failed
}

fn file_of(name: &str) -> &str {
    name.split(' ').next().unwrap_or(name)
}

/// Returns the files of the folder that no check reads.
fn uncovered(folder: &Path) -> Vec<String> {
    let entries = std::fs::read_dir(folder).expect("a folder of vectors");
    let mut names: Vec<String> = entries
        .flatten()
        .filter_map(|entry| Some(entry.path().file_stem()?.to_str()?.to_owned()))
        .filter(|name| COVERED.iter().all(|(covered, _)| file_of(covered) != name))
        .map(|name| format!("{name}: not covered"))
        .collect();
    names.sort();
    names
}
