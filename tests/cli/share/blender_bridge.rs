//! The add-on of `ademan bridge blender` in Blender, with a hand that is shared.

use std::collections::BTreeMap;
use std::fs;
use std::io::{BufRead, BufReader};
use std::path::Path;
use std::process::{Command, Stdio};

use ademan::hand::Dof;
use glam::{DQuat, DVec3};
use serde_json::{Value, json};

use crate::support::process::Process;
use crate::{ademan, run, text};

/// The text is longer than the test takes.
const TEXT: &str = "hola hola hola hola hola hola hola hola hola hola hola hola hola hola hola hola hola hola hola hola \
                    hola hola hola hola hola hola hola hola hola hola hola hola hola hola hola hola hola hola hola hola";

/// Largest angle between a bone in Blender and the pose, in degrees.
const MAX_DEGREES: f64 = 0.05;

/// The turn of the table, about the vertical, in degrees.
const TURN_DEG: f64 = 30.0;

/// Bones of the skeleton, and the joints at their ends.
const BONES: [(&str, &str, &str); 9] = [
    ("upper", "shoulder", "elbow"),
    ("lower", "elbow", "wrist"),
    ("hand", "wrist", "middle-finger-phalanx-proximal"),
    (
        "index1",
        "index-finger-phalanx-proximal",
        "index-finger-phalanx-intermediate",
    ),
    (
        "index2",
        "index-finger-phalanx-intermediate",
        "index-finger-phalanx-distal",
    ),
    ("index3", "index-finger-phalanx-distal", "index-finger-tip"),
    ("thumb1", "thumb-metacarpal", "thumb-phalanx-proximal"),
    ("thumb2", "thumb-phalanx-proximal", "thumb-phalanx-distal"),
    ("thumb3", "thumb-phalanx-distal", "thumb-tip"),
];

/// Channels of a property with the scale and offset of its row.
const VALUES: [(&str, &str, f64, f64); 4] = [
    ("location", "index-pip-flexion", 2.5, 0.75),
    ("shape", "index-dip-flexion", 0.5, 0.125),
    ("jaw", "wrist-flexion", -1.0, 0.1),
    ("lens", "elbow-flexion", 10.0, 30.0),
];

/// The channels whose angles `ademan bridge blender --channels` lists.
fn angle_channels() -> Vec<Dof> {
    let listed = run(["bridge", "blender", "--channels"]).done().out;
    let names = listed.lines().filter_map(|line| line.split(' ').next());
    names.filter_map(|name| name.parse().ok()).collect()
}

fn table(channels: &[Dof]) -> Value {
    let attach = |channel: &str, scale: f64, offset: f64, target: &str, attribute: &str| json!({"device": "right", "channel": channel, "scale": scale, "offset": offset, "target": target, "attribute": attribute});
    let attributes = [
        ("Cube", "location.x"),
        ("Cube", "data.shape_keys.key_blocks[\"Fist\"].value"),
        ("Rig/jaw", "rotation_euler.z"),
        ("Camera", "data.lens"),
    ];
    let mut rows: Vec<Value> = VALUES
        .iter()
        .zip(attributes)
        .map(|(&(_, channel, scale, offset), (target, attribute))| {
            attach(channel, scale, offset, target, attribute)
        })
        .collect();
    for channel in channels {
        let attribute = format!("[\"c_{channel}\"]");
        rows.push(attach(channel.name(), 1.0, 0.0, "Cube", &attribute));
    }
    rows.push(attach("wrist.x", 1.0, 0.0, "Nothing", "location.x"));
    rows.push(attach("wrist.x", 1.0, 0.0, "Cube", "location"));
    let mut bones: Vec<Value> = BONES
        .iter()
        .map(|(bone, joint, _)| json!({"device": "right", "joint": joint, "target": format!("Rig/{bone}")}))
        .collect();
    bones.push(json!({"device": "right", "joint": "index-finger-tip", "target": "Rig/jaw"}));
    bones.push(json!({"device": "both", "joint": "wrist", "target": "Rig/jaw"}));
    json!({"format": "ademan-mapping", "version": 1, "turn_deg": TURN_DEG, "attach": rows, "bones": bones})
}

/// Starts a simulated hand that types and shares its pose at a port.
fn typist(port: u16) -> Process {
    let (source, share) = (format!("typist:{TEXT}"), format!("pose:127.0.0.1:{port}"));
    let options = ["run", "--control", "off", "--output", "none"];
    let options = options
        .into_iter()
        .chain(["--source", &source, "--share", &share]);
    let mut command = ademan(options);
    command.stdout(Stdio::null()).stderr(Stdio::null());
    Process::start(&mut command).expect("the program starts")
}

/// Returns the lines of a stage by their time.
fn traced(stage: &str) -> BTreeMap<u64, Value> {
    let source = format!("typist:{TEXT}");
    let lines = run(["trace", stage, "--source", &source]).done().out;
    let lines = lines.lines().map(|line| {
        let line: Value = serde_json::from_str(line).expect("JSON");
        (line["time_us"].as_u64().expect("a time"), line)
    });
    lines.collect()
}

/// The results that Blender prints.
struct Results(Box<dyn Iterator<Item = Value>>);

impl Results {
    /// Returns the next result.
    fn any(&mut self) -> Value {
        self.0.next().expect("Blender runs to the end")
    }

    /// Returns the next result, which has this field.
    fn next(&mut self, field: &str) -> Value {
        let result = self.any();
        assert!(result.get(field).is_some(), "no {field}: {result}");
        result
    }
}

fn start_blender(addon: &Path, table: &Path, port: u16) -> Option<(Process, Results)> {
    let script = concat!(
        env!("CARGO_MANIFEST_DIR"),
        "/tests/cli/share/blender_bridge.py"
    );
    let mut blender = Command::new("blender");
    blender.args([
        "--background",
        "--factory-startup",
        "--python-exit-code",
        "1",
    ]);
    blender.args(["--python", script, "--", text(addon), text(table)]);
    blender.arg(port.to_string()).stdout(Stdio::piped());
    let mut blender = match Process::start(&mut blender) {
        Ok(blender) => blender,
        Err(error) => {
            println!("SKIPPED: cannot start Blender: {error}");
            return None;
        }
    };
    let stdout = BufReader::new(blender.0.stdout.take().expect("it is piped"));
    let lines = stdout.lines().map_while(Result::ok);
    let results = lines.filter_map(|line| {
        let result = line.strip_prefix("RESULT ")?;
        Some(serde_json::from_str(result).expect("JSON"))
    });
    Some((blender, Results(Box::new(results))))
}

#[test]
fn bones_and_properties_follow_a_shared_hand_and_are_baked() {
    let folder = tempfile::tempdir().expect("a folder");
    let (addon, table_path) = (
        folder.path().join("addon.py"),
        folder.path().join("table.json"),
    );
    let written = run(["bridge", "blender", "--output", text(&addon)]).done();
    assert_eq!(written.err, format!("wrote {}\n", addon.display()));
    let channels = angle_channels();
    assert_eq!(channels.len(), 24);
    fs::write(&table_path, table(&channels).to_string()).expect("a file");
    let port = crate::support::free_address::free_address().port();
    let mut hand = typist(port);
    let Some((mut blender, mut results)) = start_blender(&addon, &table_path, port) else {
        return;
    };
    assert_eq!(results.next("timer")["timer"], true);
    let connected = results.next("connect_s");
    // It does not wait for the hand. A busy machine may take any time for the rest.
    assert!(connected["connect_s"].as_f64().expect("seconds") < 30.0);
    let faults = [
        "attach 29: there is no object `Nothing`",
        "attach 30: `location` is not a number; add the axis, as in `location.x`",
        "bones 10: no bone begins at a joint `index-finger-tip`",
        "bones 11: the device is `both`; it is `left` or `right`",
    ];
    assert_eq!(connected["faults"], json!(faults));
    let (poses, angles) = (traced("pose"), traced("angles"));
    check_live(&mut results, &channels, &poses, &angles);
    check_bakes(&mut results, &angles);

    results.next("lose");
    hand.0.kill().expect("it runs");
    hand.0.wait().expect("a child process");
    let lost = results.next("lost")["lost"].to_string();
    assert!(
        lost.contains(&format!("no connection to 127.0.0.1:{port}")),
        "{lost}"
    );
    assert!(lost.contains("connecting again"), "{lost}");
    let _again = typist(port);
    let back = results.next("back");
    assert_eq!(
        (&back["back"], &back["connections"]),
        (&json!("receiving"), &json!(2))
    );

    check_changes(&mut results);
    let refused = results.next("messages");
    let reasons = [
        "it is not JSON",
        "it has no `\"format\"",
        "version is 9",
        "`bones` is not a list",
    ];
    for (message, reason) in refused["messages"]
        .as_array()
        .expect("a list")
        .iter()
        .zip(reasons)
    {
        let message = message.as_str().expect("a text");
        assert!(
            message.contains(reason) && message.contains("table.json"),
            "{message}"
        );
    }
    assert_eq!(refused["table"], true);
    assert_eq!(
        results.next("starting_faults")["starting_faults"],
        json!([])
    );
    let removed = results.next("removed")["removed"].to_string();
    assert!(removed.contains("has been removed"), "{removed}");
    assert_eq!(results.next("disconnected")["disconnected"], true);
    results.next("end");
    assert!(blender.0.wait().expect("a child process").success());
}

/// Checks that the add-on continues after a restart of the program, an undo, an edit of the skeleton, and a table that fails.
fn check_changes(results: &mut Results) {
    let recorded = results.next("recorded_after");
    assert!(recorded["recorded_after"].as_u64() > Some(10), "{recorded}");
    assert_eq!(recorded["in_order"], true);
    assert_eq!(results.next("after_undo")["after_undo"], true);
    let deletion = results.next("after_deletion")["after_deletion"].to_string();
    assert!(
        deletion.contains("object `Rig` has no bone `index3`"),
        "{deletion}"
    );
    let set = results.next("pass_index");
    let expected = json!({"pass_index": 3, "hidden": true, "locked": true, "faults": []});
    assert_eq!(set, expected);
    let failed = results.next("failed")["failed"].to_string();
    assert!(
        failed.contains("expected an int type; correct it"),
        "{failed}"
    );
}

/// Checks the directions of bones and the values of properties while the hand moves.
fn check_live(
    results: &mut Results,
    channels: &[Dof],
    poses: &BTreeMap<u64, Value>,
    angles: &BTreeMap<u64, Value>,
) {
    let (mut worst_degrees, mut worst_value, mut moved) = (0.0_f64, 0.0_f64, Vec::new());
    let looks = loop {
        let result = results.any();
        if let Some(looks) = result["looks"].as_u64() {
            break looks;
        }
        let time_us = result["time_us"].as_u64().expect("a time");
        let (pose, angles) = (&poses[&time_us]["positions"], &angles[&time_us]["angles"]);
        let joint = |name: &str| {
            let [x, y, z]: [f64; 3] = serde_json::from_value(pose[name].clone()).expect(name);
            DQuat::from_rotation_z(TURN_DEG.to_radians()) * DVec3::new(x, -z, y)
        };
        let vector = |kind: &str, bone: &str| -> DVec3 {
            let vector: [f64; 3] = serde_json::from_value(result[kind][bone].clone()).expect(bone);
            DVec3::from(vector)
        };
        for (bone, from, to) in BONES {
            let angle = vector("bones", bone).angle_between(joint(to) - joint(from));
            worst_degrees = worst_degrees.max(angle.to_degrees());
        }
        // The back of the hand stays up, and the elbow bends in the plane of its skeleton.
        let knuckle = |finger: &str| joint(&format!("{finger}-finger-phalanx-proximal"));
        let across = knuckle("index") - knuckle("pinky");
        let palm = across.cross(knuckle("middle") - joint("wrist"));
        let palm_degrees = vector("palms", "hand").angle_between(palm).to_degrees();
        let out_of_plane = vector("palms", "upper").dot(vector("bones", "lower"));
        worst_degrees = worst_degrees
            .max(palm_degrees)
            .max(out_of_plane.asin().abs().to_degrees());
        let value = |name: &str| result["values"][name].as_f64().expect("a value");
        let angle = |channel: &str| angles[channel].as_f64().unwrap_or(0.0);
        for (name, channel, scale, offset) in VALUES {
            let expected = angle(channel) * scale + offset;
            worst_value = worst_value.max((value(name) - expected).abs());
        }
        for channel in channels {
            worst_value = worst_value.max((value(channel.name()) - angle(channel.name())).abs());
        }
        moved.push(value("location"));
    };
    assert_eq!(moved.len() as u64, looks);
    assert!(looks >= 25, "{looks}");
    println!("largest angle {worst_degrees:.5}°, largest difference of a value {worst_value:.2e}");
    assert!(worst_degrees < MAX_DEGREES, "{worst_degrees}°");
    assert!(worst_value < 1e-4, "{worst_value}");
    moved.sort_by(f64::total_cmp);
    assert!(moved[moved.len() - 1] - moved[0] > 0.5, "{moved:?}");
}

/// Checks the key frames of a recording at 50 Hz and at the rate of the scene.
fn check_bakes(results: &mut Results, angles: &BTreeMap<u64, Value>) {
    for rate in [50.0, 24.0] {
        let baked = results.next("rate_hz");
        let seconds = baked["seconds"].as_f64().expect("seconds");
        let keys: Vec<[f64; 2]> = serde_json::from_value(baked["keys"].clone()).expect("keys");
        assert_eq!(keys.len(), (seconds * rate + 1e-6) as usize + 1);
        let start_us = baked["start_us"].as_u64().expect("a time");
        let mut worst = 0.0_f64;
        for (index, [frame, value]) in keys.iter().enumerate() {
            assert!(
                (frame - (11.0 + index as f64 * 24.0 / rate)).abs() < 1e-3,
                "{frame}"
            );
            let time_us = start_us as f64 + index as f64 * 1e6 / rate;
            let (_, channel, scale, offset) = VALUES[0];
            let expected = at_time(angles, time_us, channel) * scale + offset;
            worst = worst.max((value - expected).abs());
        }
        println!(
            "{rate} Hz: {} key frames, largest difference {worst:.2e}",
            keys.len()
        );
        assert!(worst < 1e-3, "{worst}");
        // Four numbers of each of nine bones, and the turn of the jaw.
        let bone_keys: Vec<usize> =
            serde_json::from_value(baked["bone_keys"].clone()).expect("numbers");
        assert_eq!(bone_keys, vec![keys.len(); 9 * 4 + 1]);
    }
}

/// Returns an angle at a time, linearly between two readings.
fn at_time(angles: &BTreeMap<u64, Value>, time_us: f64, channel: &str) -> f64 {
    let angle = |line: &Value| line["angles"][channel].as_f64().expect("an angle");
    let (before_us, before) = angles
        .range(..=time_us as u64)
        .next_back()
        .expect("a reading");
    let Some((after_us, after)) = angles.range(time_us as u64 + 1..).next() else {
        return angle(before);
    };
    let fraction = (time_us - *before_us as f64) / (after_us - before_us) as f64;
    angle(before) + fraction * (angle(after) - angle(before))
}
