//! Data that other programs wrote: motion capture files with positions that independent readers computed.
//!
//! They are in the folder `ADEMAN_PEERS` (default: `../shared/peers`), which is not part of the project.

use std::collections::BTreeMap;
use std::fs;
use std::path::{Path, PathBuf};

use ademan::capture::bvh::{Bvh, HandJoints, PositionChannels, Skeleton};
use ademan::hand::{Joint, Side};

/// Largest difference, as a fraction of the size of the figure.
const TOLERANCE: f64 = 1e-6;

/// Positions by frame and by joint.
type Frames = BTreeMap<u64, BTreeMap<String, [f64; 3]>>;

fn folder() -> PathBuf {
    match std::env::var_os("ADEMAN_PEERS") {
        Some(folder) => folder.into(),
        None => Path::new(env!("CARGO_MANIFEST_DIR")).join("../shared/peers"),
    }
}

/// Returns the motion capture files with their names, or prints that there are none.
fn files() -> Vec<(String, PathBuf)> {
    let folder = folder().join("bvh");
    let Ok(entries) = fs::read_dir(&folder) else {
        println!("SKIPPED: there is no folder {}", folder.display());
        return Vec::new();
    };
    let paths = entries.flatten().map(|entry| entry.path());
    let files = paths.filter(|path| path.extension().is_some_and(|end| end == "bvh"));
    let name = |path: &Path| {
        path.file_stem()
            .unwrap_or_default()
            .to_string_lossy()
            .into_owned()
    };
    files.map(|path| (name(&path), path)).collect()
}

/// Returns the name of each node; `joint#end` is the End Site of `joint`.
fn names(skeleton: &Skeleton) -> Vec<String> {
    let nodes = skeleton.nodes();
    let name = |index: usize| nodes[index].name.clone().unwrap_or_default();
    let named = (0..nodes.len()).map(|index| match nodes[index].name {
        Some(_) => name(index),
        None => format!(
            "{}#end",
            name(nodes[index].parent.expect("an End Site has a parent"))
        ),
    });
    named.collect()
}

fn size(frames: &Frames) -> f64 {
    let extent = |axis: usize| {
        let values = frames
            .values()
            .flat_map(|frame| frame.values().map(|at| at[axis]));
        let (low, high) = values.fold((f64::MAX, f64::MIN), |(low, high), value| {
            (low.min(value), high.max(value))
        });
        high - low
    };
    extent(0).max(extent(1)).max(extent(2))
}

#[test]
fn files_of_other_programs_give_the_positions_of_independent_readers() {
    for (name, path) in files() {
        let bvh =
            Bvh::parse(&fs::read(&path).unwrap()).unwrap_or_else(|error| panic!("{name}: {error}"));
        let expected: Frames =
            serde_json::from_slice(&fs::read(path.with_extension("json")).unwrap()).unwrap();
        let names = names(&bvh.motion().skeleton);
        let size = size(&expected);
        let (mut worst, mut compared) = (0.0_f64, 0);
        for (&frame, expected) in &expected {
            let positions = bvh.positions(frame, PositionChannels::Replace);
            for (joint, position) in names.iter().zip(positions) {
                let Some(expected) = expected.get(joint) else {
                    continue;
                };
                worst = worst.max(position.distance((*expected).into()) / size);
                compared += 1;
            }
        }
        println!("{name}: {compared} positions, largest difference {worst:.1e} of the size");
        assert!(compared > 0 && worst <= TOLERANCE, "{name}: {worst:e}");
    }
}

#[test]
fn arms_and_fingers_of_all_conventions_are_found() {
    for (name, path) in files() {
        let bvh = Bvh::parse(&fs::read(&path).unwrap()).unwrap();
        let joints = HandJoints::find(&bvh.motion().skeleton, Side::Right);
        let count = joints.as_ref().map_or(0, |joints| joints.iter().count());
        println!("{name}: {count} joints of the right hand");
        let least = match name.as_str() {
            // Arm, and one joint of index finger and thumb with their tips.
            "cmu_cgspeed_walk" => 7,
            "rokoko_fingers_dance" | "blender_export_all_positions" => Joint::COUNT,
            "mocapbank_crlf" => 4,
            "makehuman_tpose_position_channels" => 18,
            "fair_wave_hello" => 5,
            _ => 0,
        };
        assert!(count >= least, "{name}: {joints:?}");
    }
}
