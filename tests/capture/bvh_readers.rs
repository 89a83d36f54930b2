//! Motion capture files of the program, read by independent programs.

use std::fs;
use std::process::Command;

use ademan::hand::Joint;

use crate::support::python::python;
use crate::support::source::{TYPING_RATE_HZ, bvh_text, typing_poses};

const TEXT: &str = "Hola";

/// Prints the frame time, and the positions of all joints in all frames, computed from what the package `bvh` reads: one line
/// of JSON per frame, in the unit of the file.
const PACKAGE_READER: &str = r##"
import json, math, sys
from bvh import Bvh

def rotation(axis, degrees):
    c, s = math.cos(math.radians(degrees)), math.sin(math.radians(degrees))
    return {
        "X": [[1, 0, 0], [0, c, -s], [0, s, c]],
        "Y": [[c, 0, s], [0, 1, 0], [-s, 0, c]],
        "Z": [[c, -s, 0], [s, c, 0], [0, 0, 1]],
    }[axis]

def product(a, b):
    return [[sum(a[i][k] * b[k][j] for k in range(3)) for j in range(3)] for i in range(3)]

def moved(origin, turned, offset):
    return [origin[i] + sum(turned[i][k] * offset[k] for k in range(3)) for i in range(3)]

file = Bvh(open(sys.argv[1]).read())
print(json.dumps(file.frame_time))
for frame in range(file.nframes):
    positions, rotations = {}, {}
    for name in file.get_joints_names():
        parent = file.joint_parent(name)
        parent = parent.name if parent else None
        turned = rotations.get(parent, [[1, 0, 0], [0, 1, 0], [0, 0, 1]])
        offset = list(file.joint_offset(name))
        channels = file.joint_channels(name)
        values = file.frame_joint_channels(frame, name, channels)
        for channel, value in zip(channels, values):
            if channel.endswith("position"):
                offset["XYZ".index(channel[0])] = value
        positions[name] = moved(positions.get(parent, [0, 0, 0]), turned, offset)
        for channel, value in zip(channels, values):
            if channel.endswith("rotation"):
                turned = product(turned, rotation(channel[0], value))
        rotations[name] = turned
        ends = [node for node in file.get_joint(name).children if node.value[:2] == ["End", "Site"]]
        for node in ends:
            positions[name + "#end"] = moved(positions[name], turned, [float(n) for n in node["OFFSET"]])
    print(json.dumps(positions))
"##;

/// Prints the same as read by Blender, whose Z points up. Version 3.4 opens files in a mode that Python 3.11 no longer has.
const BLENDER_READER: &str = r##"
import bpy, builtins, json, sys
plain_open = open
builtins.open = lambda file, mode="r", *rest, **named: plain_open(file, mode.replace("U", ""), *rest, **named)
bpy.ops.import_anim.bvh(
    filepath=sys.argv[-1], axis_forward="-Z", axis_up="Y", use_fps_scale=False, update_scene_fps=True
)
armature = bpy.context.object
scene = bpy.context.scene
first, last = (int(frame) for frame in armature.animation_data.action.frame_range)
out = plain_open(sys.argv[-2], "w")
print(json.dumps(scene.render.fps_base / scene.render.fps), file=out)
for frame in range(first, last + 1):
    scene.frame_set(frame)
    positions = {}
    for bone in armature.pose.bones:
        for name, end in ((bone.name, bone.head), (bone.name + "#end", bone.tail)):
            x, y, z = armature.matrix_world @ end
            positions[name] = [x, z, -y]
    print(json.dumps(positions), file=out)
out.close()
"##;

/// Names of the joints that the readers give.
const NAMES: [(&str, Joint); 8] = [
    ("RightArm", Joint::Shoulder),
    ("RightForeArm", Joint::Elbow),
    ("RightHand", Joint::Wrist),
    ("RightHandIndex1", Joint::IndexPhalanxProximal),
    ("RightHandIndex3", Joint::IndexPhalanxDistal),
    ("RightHandIndex3#end", Joint::IndexTip),
    ("RightHandThumb3#end", Joint::ThumbTip),
    ("RightHandPinky3#end", Joint::LittleTip),
];

/// Checks what a reader printed of the file of a hand that types [`TEXT`].
fn check(out: &str) {
    let mut lines = out.lines();
    let frame_time: f64 = lines.next().unwrap().parse().unwrap();
    assert!(
        (frame_time * TYPING_RATE_HZ - 1.0).abs() < 1e-6,
        "{frame_time}"
    );
    let poses = typing_poses(TEXT);
    let (mut frames, mut worst) = (0, 0.0_f64);
    for (frame, line) in lines.enumerate() {
        let read: serde_json::Value = serde_json::from_str(line).unwrap();
        let time = poses[0].time.0 as f64 * 1e-6 + frame as f64 * frame_time;
        let at_time = poses
            .iter()
            .rfind(|pose| pose.time.0 as f64 * 1e-6 <= time + 1e-6);
        let pose = at_time.expect("a pose at or before the frame");
        for (name, joint) in NAMES {
            let read: Vec<f64> = serde_json::from_value(read[name].clone()).expect(name);
            let [x, y, z] = pose.position(joint).expect(name).as_dvec3().to_array();
            let expected = [-x, y, -z];
            for (ours, theirs) in read.iter().zip(expected) {
                worst = worst.max((ours * 10.0 - theirs * 1000.0).abs());
            }
        }
        frames += 1;
    }
    println!("{frames} frames, largest difference {worst:.6} mm");
    assert!(
        frames >= poses.len() - 1,
        "{frames} of {} frames",
        poses.len()
    );
    assert!(worst < 1.0, "{worst} mm");
}

#[test]
fn a_python_package_gives_the_captured_positions_within_a_millimetre() {
    let python = match python("bvh-reader", "bvh", &["bvh==0.3"]) {
        Ok(python) => python,
        Err(reason) => {
            println!("SKIPPED: cannot install the package bvh: {reason}");
            return;
        }
    };
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("hand.bvh");
    fs::write(&path, bvh_text(TEXT)).unwrap();
    let reader = Command::new(python)
        .args(["-c", PACKAGE_READER])
        .arg(&path)
        .output();
    let reader = reader.expect("it starts");
    let messages = String::from_utf8_lossy(&reader.stderr);
    assert!(reader.status.success(), "{messages}");
    check(&String::from_utf8(reader.stdout).unwrap());
}

#[test]
fn blender_gives_the_captured_positions_within_a_millimetre() {
    let folder = tempfile::tempdir().unwrap();
    let in_folder = |name: &str| folder.path().join(name);
    let (file, script, out) = (
        in_folder("hand.bvh"),
        in_folder("read.py"),
        in_folder("out"),
    );
    fs::write(&file, bvh_text(TEXT)).unwrap();
    fs::write(&script, BLENDER_READER).unwrap();
    let blender = Command::new("blender")
        .args([
            "--background",
            "--factory-startup",
            "-noaudio",
            "--python-exit-code",
            "1",
        ])
        .arg("--python")
        .arg(&script)
        .arg("--")
        .args([&out, &file])
        .output();
    let Ok(blender) = blender else {
        println!("SKIPPED: blender is not installed; Debian's package is `blender`");
        return;
    };
    let messages = String::from_utf8_lossy(&blender.stderr);
    assert!(blender.status.success(), "{messages}");
    check(&fs::read_to_string(out).unwrap());
}
