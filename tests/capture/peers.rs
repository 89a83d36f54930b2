//! Data that other programs wrote: motion capture files with positions that independent readers computed, and key points
//! in the images of four cameras with positions that another optimiser computed.

use std::collections::BTreeMap;
use std::fs;
use std::path::{Path, PathBuf};

use ademan::capture::Sample;
use ademan::capture::bvh::{Bvh, HandJoints, HandJointsError, PositionChannels, Skeleton};
use ademan::capture::protocol::{ProtocolOptions, markers};
use ademan::hand::{Joint, JointPositions, Side};
use glam::{DMat3, DQuat, DVec2, DVec3};
use serde_json::{Value, json};

use crate::support::peers::peer;

/// Largest difference, as a fraction of the size of the figure.
const TOLERANCE: f64 = 1e-6;

/// Positions by frame and by joint.
type Frames = BTreeMap<u64, BTreeMap<String, [f64; 3]>>;

/// Returns the motion capture files with their names. Prints that they are not there and returns none without their folder.
fn files() -> Vec<(String, PathBuf)> {
    let Some(folder) = peer("bvh") else {
        return Vec::new();
    };
    let entries = fs::read_dir(&folder).expect("a folder");
    let paths = entries.flatten().map(|entry| entry.path());
    let files = paths.filter(|path| path.extension().is_some_and(|end| end == "bvh"));
    let name = |path: &Path| {
        path.file_stem()
            .unwrap_or_default()
            .to_string_lossy()
            .into_owned()
    };
    let files: Vec<_> = files.map(|path| (name(&path), path)).collect();
    assert!(!files.is_empty(), "no file in {}", folder.display());
    files
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
        for (&frame, joints) in &expected {
            let positions = bvh.positions(frame, PositionChannels::Replace);
            for (joint, position) in names.iter().zip(positions) {
                let Some(place) = joints.get(joint) else {
                    continue;
                };
                worst = worst.max(position.distance((*place).into()) / size);
                compared += 1;
            }
        }
        println!("{name}: {compared} positions, largest difference {worst:.1e} of the size");
        let count: usize = expected.values().map(BTreeMap::len).sum();
        assert!(
            count > 0 && compared >= count,
            "{name}: {compared} of {count}"
        );
        assert!(worst <= TOLERANCE, "{name}: {worst:e}");
    }
}

#[test]
fn arms_and_fingers_of_all_conventions_are_found() {
    for (name, path) in files() {
        let bvh = Bvh::parse(&fs::read(&path).unwrap()).unwrap();
        let joints = HandJoints::find(&bvh.motion().skeleton, Side::Right);
        let count = match &joints {
            Ok(joints) => joints.iter().count(),
            Err(HandJointsError::NoWrist { .. }) => 0,
            Err(error) => panic!("{name}: {error}"),
        };
        println!("{name}: {count} joints of the right hand");
        let expected = match name.as_str() {
            // Arm, and one joint of index finger and thumb with their tips.
            "cmu_cgspeed_walk" => 7,
            "rokoko_fingers_dance" | "blender_export_all_positions" => Joint::COUNT,
            "mocapbank_crlf" => 4,
            "makehuman_tpose_position_channels" => Joint::COUNT,
            "fair_wave_hello" => 5,
            // It has no arms.
            "rotation_first_root" => 0,
            _ => panic!("add the number of joints of {name}"),
        };
        assert_eq!(count, expected, "{name}: {joints:?}");
    }
}

/// Least confidence of a key point that counts.
const MIN_CONFIDENCE: f64 = 0.3;

fn numbers(value: &Value) -> Vec<f64> {
    serde_json::from_value(value.clone()).expect("a list of numbers")
}

/// A camera in the convention of OpenCV, with its key points as a camera of a marker line.
fn camera(camera: &Value, names: &[String], points: &Value) -> Value {
    let rotation = DVec3::from_slice(&numbers(&camera["rotation"]));
    let world_from_camera = DQuat::from_scaled_axis(rotation).inverse();
    let position = -(world_from_camera * DVec3::from_slice(&numbers(&camera["translation"])));
    let rows: Vec<Vec<f64>> = camera["matrix"]
        .as_array()
        .unwrap()
        .iter()
        .map(numbers)
        .collect();
    let matrix = DMat3::from_cols_array_2d(&std::array::from_fn(|column| {
        std::array::from_fn(|row| rows[row][column])
    }));
    let (focal, center) = ([rows[0][0], rows[1][1]], [rows[0][2], rows[1][2]]);
    let seen = names
        .iter()
        .zip(points.as_array().unwrap())
        .filter_map(|(name, point)| {
            let point = numbers(point);
            let pixel = matrix.inverse() * DVec3::new(point[0], point[1], 1.0);
            let ideal = undistorted(pixel.truncate(), &numbers(&camera["distortions"]));
            let image = DVec2::from(focal) * ideal + DVec2::from(center);
            (point[2] >= MIN_CONFIDENCE).then(|| json!({"label": name, "image": image.to_array()}))
        });
    json!({
        "position": position.to_array(),
        "orientation": world_from_camera.to_array(),
        "focal_px": focal,
        "center_px": center,
        "markers": seen.collect::<Vec<_>>(),
    })
}

/// Inverts the distortion k1, k2, p1, p2 of OpenCV by iteration.
fn undistorted(distorted: DVec2, coefficients: &[f64]) -> DVec2 {
    let [k1, k2, p1, p2] = coefficients[..] else {
        panic!("four coefficients");
    };
    let mut ideal = distorted;
    for _ in 0..20 {
        let r2 = ideal.length_squared();
        let radial = 1.0 + k1 * r2 + k2 * r2 * r2;
        let DVec2 { x, y } = ideal;
        let tangential = DVec2::new(
            2.0 * p1 * x * y + p2 * (r2 + 2.0 * x * x),
            p1 * (r2 + 2.0 * y * y) + 2.0 * p2 * x * y,
        );
        ideal = (distorted - tangential) / radial;
    }
    ideal
}

/// Decodes one line of markers of a hand in metres with +Z up.
fn decode(hand: &str, line: &Value) -> JointPositions {
    let mut options = ProtocolOptions::default();
    for (name, value) in [("hand", hand), ("up", "z"), ("max_gap_mm", "300")] {
        let found = markers::PROTOCOL
            .options
            .iter()
            .find(|option| option.name == name);
        options.set(found.expect("an option"), value).unwrap();
    }
    let mut decoded = JointPositions::default();
    let mut decoder = (markers::PROTOCOL.decoder)(&options);
    decoder.push(
        format!("{line}\n").as_bytes(),
        &mut |packet| match packet.sample {
            Sample::Joints { positions } => decoded = positions,
            other => panic!("{other:?}"),
        },
    );
    decoded
}

#[test]
fn the_arms_of_a_person_before_four_cameras_are_where_another_program_found_them() {
    let Some(path) = peer("markers/pose2sim_balancing_4cam.json") else {
        return;
    };
    let text = fs::read(path).expect("a file");
    let file: Value = serde_json::from_slice(&text).unwrap();
    let names: Vec<String> = serde_json::from_value(file["keypoint_names"].clone()).unwrap();
    let cameras = file["cameras"].as_object().unwrap();
    let (mut distances, mut consistent) = (Vec::new(), Vec::new());
    for frame in file["frames"].as_array().unwrap() {
        let seen = cameras
            .iter()
            .map(|(name, described)| camera(described, &names, &frame["points2d"][name]));
        let line = json!({"cameras": seen.collect::<Vec<_>>()});
        for (hand, letter) in [("right", "R"), ("left", "L")] {
            let decoded = decode(hand, &line);
            for (joint, name) in [
                (Joint::Shoulder, "Shoulder"),
                (Joint::Elbow, "Elbow"),
                (Joint::Wrist, "Wrist"),
            ] {
                let name = format!("{letter}{name}");
                let (Some(found), Some(expected)) =
                    (decoded.get(joint), frame["xyz_lsq"].get(&name).map(numbers))
                else {
                    continue;
                };
                let expected = DVec3::new(expected[0], expected[2], -expected[1]);
                let distance = found.distance(expected);
                distances.push(distance);
                if frame["rms_px"][&name].as_f64().unwrap() < 8.0 {
                    consistent.push(distance);
                }
            }
        }
    }
    distances.sort_by(f64::total_cmp);
    consistent.sort_by(f64::total_cmp);
    let median = distances[distances.len() / 2];
    println!(
        "{} positions, median distance {:.1} mm; {} with a residual below 8 pixels, largest distance {:.1} mm",
        distances.len(),
        median * 1000.0,
        consistent.len(),
        consistent.last().copied().unwrap_or_default() * 1000.0
    );
    assert!(distances.len() > 200 && !consistent.is_empty());
    // The published calibration has a residual of 14 pixels, 25 mm at the distance of the person.
    assert!(median < 0.015, "{median}");
    assert!(
        consistent.iter().all(|&distance| distance < 0.01),
        "{consistent:?}"
    );
}
