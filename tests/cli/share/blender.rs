//! The bones of VMC on a skeleton in Blender.

use std::collections::BTreeMap;
use std::fs;
use std::path::Path;
use std::process::{Command, Stdio};
use std::time::{Duration, Instant};

use glam::DVec3;

use crate::support::process::Process;
use crate::support::python::python;
use crate::{ademan, run};

/// Makes a skeleton of a right arm in the T pose, receives datagrams until the sender is silent, and writes the directions of
/// the bones after the last one.
const RECEIVER: &str = r##"
import json, os, socket, sys
packages, out = sys.argv[-2:]
sys.path.append(packages)
import bpy
from mathutils import Quaternion, Vector
from pythonosc.osc_packet import OscPacket

FINGERS = ["Thumb", "Index", "Middle", "Ring", "Little"]
parents = {"UpperArm": None, "LowerArm": "UpperArm", "Hand": "LowerArm"}
for finger in FINGERS:
    parent = "Hand"
    for part in ["Proximal", "Intermediate", "Distal"]:
        parents[finger + part] = parent
        parent = finger + part

bpy.ops.object.armature_add()
skeleton = bpy.context.object
bpy.ops.object.mode_set(mode="EDIT")
bones = skeleton.data.edit_bones
bones.remove(bones[0])
for name, parent in parents.items():
    bone = bones.new(name)
    bone.parent = bones[parent] if parent else None
    bone.head = bone.parent.tail if parent else Vector((0, 0, 0))
    along = (1, 0, -1) if name.startswith("Thumb") else (1, 0, 0)
    bone.tail = bone.head + Vector(along).normalized() * 0.03
bpy.ops.object.mode_set(mode="POSE")

receiver = socket.socket(socket.AF_INET, socket.SOCK_DGRAM)
receiver.bind(("127.0.0.1", 0))
with open(out + ".new", "w") as file:
    file.write(str(receiver.getsockname()[1]))
os.rename(out + ".new", out + ".port")
receiver.settimeout(60)
packet = receiver.recv(65536)
receiver.settimeout(3)
while True:
    try:
        packet = receiver.recv(65536)
    except TimeoutError:
        break
for timed in OscPacket(packet).messages:
    message = timed.message
    if message.address == "/VMC/Ext/Bone/Pos" and message.params[0].startswith("Right"):
        bone = skeleton.pose.bones[message.params[0][5:]]
        x, y, z, w = message.params[4:8]
        rest = bone.bone.matrix_local.to_quaternion()
        bone.rotation_mode = "QUATERNION"
        # The frame of Unity is left-handed: its Z points forward.
        bone.rotation_quaternion = rest.inverted() @ Quaternion((w, -x, -y, z)) @ rest
bpy.context.view_layer.update()
with open(out, "w") as file:
    json.dump({bone.name: list(bone.tail - bone.head) for bone in skeleton.pose.bones}, file)
"##;

/// The bones and the joints at their ends.
const BONES: [(&str, &str, &str); 15] = [
    ("UpperArm", "shoulder", "elbow"),
    ("LowerArm", "elbow", "wrist"),
    ("Hand", "wrist", "middle-finger-phalanx-proximal"),
    (
        "IndexProximal",
        "index-finger-phalanx-proximal",
        "index-finger-phalanx-intermediate",
    ),
    (
        "IndexIntermediate",
        "index-finger-phalanx-intermediate",
        "index-finger-phalanx-distal",
    ),
    (
        "IndexDistal",
        "index-finger-phalanx-distal",
        "index-finger-tip",
    ),
    (
        "MiddleProximal",
        "middle-finger-phalanx-proximal",
        "middle-finger-phalanx-intermediate",
    ),
    (
        "MiddleIntermediate",
        "middle-finger-phalanx-intermediate",
        "middle-finger-phalanx-distal",
    ),
    (
        "MiddleDistal",
        "middle-finger-phalanx-distal",
        "middle-finger-tip",
    ),
    (
        "RingProximal",
        "ring-finger-phalanx-proximal",
        "ring-finger-phalanx-intermediate",
    ),
    (
        "RingIntermediate",
        "ring-finger-phalanx-intermediate",
        "ring-finger-phalanx-distal",
    ),
    (
        "RingDistal",
        "ring-finger-phalanx-distal",
        "ring-finger-tip",
    ),
    (
        "LittleProximal",
        "pinky-finger-phalanx-proximal",
        "pinky-finger-phalanx-intermediate",
    ),
    (
        "LittleIntermediate",
        "pinky-finger-phalanx-intermediate",
        "pinky-finger-phalanx-distal",
    ),
    (
        "LittleDistal",
        "pinky-finger-phalanx-distal",
        "pinky-finger-tip",
    ),
];

/// Largest angle between a bone in Blender and the pose, in degrees.
const MAX_DEGREES: f64 = 0.1;

#[test]
fn a_skeleton_in_blender_takes_the_pose_of_the_arm() {
    let packages = match python("osc-receiver", "pythonosc", &["python-osc==1.9.3"]) {
        Ok(python) => packages_of(&python),
        Err(reason) => {
            println!("SKIPPED: cannot install the package python-osc: {reason}");
            return;
        }
    };
    let folder = tempfile::tempdir().expect("a folder");
    let (out, setup) = (folder.path().join("bones"), folder.path().join("setup.ron"));
    let text = r#"Setup(source: "typist:Hi", layout: "qwerty-flat",
        arm: Measured(hand_length_mm: 189, forearm_length_mm: 262))"#;
    fs::write(&setup, text).expect("a file");
    let setup = setup.to_str().expect("UTF-8");
    let mut blender = Command::new("blender");
    let arguments = "--background --factory-startup --python-exit-code 1 --python-expr";
    blender.args(arguments.split(' ')).arg(RECEIVER);
    blender.args(["--", &packages, out.to_str().expect("UTF-8")]);
    blender.stdout(Stdio::null());
    let mut blender = match Process::start(&mut blender) {
        Ok(blender) => blender,
        Err(error) => {
            println!("SKIPPED: cannot start Blender: {error}");
            return;
        }
    };
    let port = wait_for_file(&out.with_extension("port"));
    let share = format!("vmc:127.0.0.1:{port}");
    let options = ["--control", "off", "--output", "none", "--share", &share];
    let typed = ademan(["run", setup].iter().chain(&options)).status();
    assert!(typed.expect("the program starts").success());
    assert!(blender.0.wait().expect("a child process").success());
    let bones = fs::read_to_string(&out).expect("the directions");
    let bones: BTreeMap<String, [f64; 3]> = serde_json::from_str(&bones).expect("JSON");
    let poses = run(["trace", "pose", "--setup", setup]);
    let pose = poses.out.lines().last().expect("a pose");
    let pose: serde_json::Value = serde_json::from_str(pose).expect("JSON");
    let joint = |name: &str| -> DVec3 {
        let position = pose["positions"][name].clone();
        DVec3::from_array(serde_json::from_value(position).expect(name))
    };
    let error = |(bone, from, to): (&str, &str, &str)| {
        let direction = DVec3::from_array(bones[bone]);
        direction
            .angle_between(joint(to) - joint(from))
            .to_degrees()
    };
    let errors = BONES.map(error);
    for ((bone, ..), degrees) in BONES.iter().zip(errors) {
        println!("{bone}: {degrees:.1}°");
    }
    assert!(
        errors.iter().all(|&degrees| degrees < MAX_DEGREES),
        "{errors:?}"
    );
}

/// Returns the folder of the packages of a Python.
fn packages_of(python: &Path) -> String {
    let code = "import sysconfig; print(sysconfig.get_paths()['purelib'])";
    let output = Command::new(python).args(["-c", code]).output();
    let output = output.expect("Python starts").stdout;
    String::from_utf8(output).expect("UTF-8").trim().to_owned()
}

fn wait_for_file(path: &Path) -> String {
    let start = Instant::now();
    while !path.exists() && start.elapsed() < Duration::from_mins(2) {
        std::thread::sleep(Duration::from_millis(50));
    }
    fs::read_to_string(path).expect("the receiver writes its port")
}
