use ademan::capture::hc11::{Framing, Hc11Decoder, body};
use ademan::capture::protocol::Decoder;
use ademan::capture::{Channels, Reading, Sample};
use ademan::document::Document;
use ademan::estimate::{
    AffineMap, ChannelMap, Estimate, Estimator, EstimatorSettings, JointAngles, Smoothing,
    divider_voltage,
};
use ademan::files::Load;
use ademan::hand::{Dof, Finger, Joint};
use ademan::kinematics::{ArmModel, Link};
use ademan::layout::Glove;
use ademan::time::Timestamp;
use parry3d::math::{Pose, Vec3};
use serde_json::Value;

use super::check::{assert_close, bytes, list, number, numbers, text};

/// The rounding error of `f32` kinematics in centimetres: 1 µm per metre, for an arm of 57 cm.
const F32_CM: f64 = 0.57e-4;

/// Returns the map of the shipped glove with its disabled rows.
fn full_map() -> ChannelMap {
    let shipped = Document::shipped("unam-hc11").expect("the shipped glove");
    let lines = shipped.text.lines().map(|line| {
        let is_disabled = line.trim_start().starts_with("disabled:");
        if is_disabled { ")," } else { line }
    });
    let text = lines.collect::<Vec<_>>().join("\n");
    let glove = Glove::parse(&Document::new("enabled.ron", text));
    glove.expect("a glove without disabled rows").map
}

/// Returns the shipped arm in its own frame instead of the world's.
fn arm() -> ArmModel {
    let shipped = ArmModel::load("unam").expect("the shipped arm loads");
    let links: Vec<Link> = shipped.links().to_vec();
    ArmModel::new(shipped.side(), links, Pose::IDENTITY, 0.005).expect("the same links")
}

fn link_named<'a>(arm: &'a ArmModel, name: &str) -> &'a Link {
    let mut links = arm.links().iter();
    let found = links.find(|link| link.name == name);
    found.unwrap_or_else(|| panic!("no link {name}"))
}

fn dof_of(arm: &ArmModel, link: &str) -> Dof {
    link_named(arm, link).dof.expect("a joint")
}

fn reading(number: u64, body: &[u8]) -> Reading {
    Reading::new(
        Timestamp(1_000 * (number + 1)),
        None,
        Sample::Channels(Channels {
            full_scale: 255,
            counts: body.iter().map(|byte| u16::from(*byte)).collect(),
            unsent: Default::default(),
        }),
    )
}

fn estimator(map: ChannelMap) -> Estimator {
    let settings = EstimatorSettings::unchecked(Smoothing::RecursiveAverage);
    Estimator::new(settings).with_channels(&map)
}

fn centimetres(position: Vec3) -> [f64; 3] {
    position.to_array().map(|metres| f64::from(metres) * 100.0)
}

fn assert_position(ours: Vec3, theirs: &Value, tolerance: f64, what: &str) {
    for (one, other) in centimetres(ours).iter().zip(numbers(theirs)) {
        assert_close(*one, other, tolerance, what);
    }
}

/// Checks the wire order, the glove file and the arm file against the tables.
pub fn channels(file: &Value) -> usize {
    let tolerance = number(&file["tolerance"]["absolute"]);
    for row in list(&file["wire"]) {
        let (step, port) = (number(&row["mux_step"]), number(&row["adc_port"]));
        assert_eq!(8.0 * step + port, number(&row["wire_index"]));
        assert_eq!(8.0 * port + step + 1.0, number(&row["sensor_number"]));
    }
    let (map, arm) = (full_map(), arm());
    let elements = list(&file["elements"]);
    assert_eq!(map.rows().len(), elements.len());
    for (order, (row, element)) in map.rows().iter().zip(elements).enumerate() {
        assert_eq!(order as f64, number(&element["order"]));
        let label = element["label"].as_str().unwrap_or("");
        assert_eq!(row.label, label);
        let link = link_named(&arm, text(&element["link"]));
        assert_eq!(Some(row.dof), link.dof, "{label}");
        assert_eq!(link.axis, axis(&element["axis"]), "{label}");
        assert_eq!(row.channel as f64, number(&element["channel"]), "{label}");
        let gain = number(&element["factor_numerator_over_255"]) / 255.0;
        for factor in [gain, number(&element["factor"])] {
            assert_close(row.calibration.gain, factor, tolerance, label);
        }
        for count in [0.0, 100.0, 255.0] {
            let wanted = number(&element["initial_rotation"])
                + (count + number(&element["offset"])) * number(&element["factor"]);
            assert_close(row.calibration.apply(count), wanted, tolerance, label);
        }
    }
    let links = list(&file["links"]);
    assert_eq!(arm.links().len(), links.len());
    for (ours, theirs) in arm.links().iter().zip(links) {
        assert_link(&arm, ours, theirs);
    }
    let maya = list(&file["maya"]);
    for row in maya {
        let channel = number(&row["channel"]);
        let mut channels = map.rows().iter().map(|read| read.channel as f64);
        assert!(channels.any(|used| used == channel), "{row}");
    }
    list(&file["wire"]).len() + elements.len() + links.len() + maya.len()
}

fn assert_link(arm: &ArmModel, ours: &Link, theirs: &Value) {
    assert_eq!(ours.name, text(&theirs["id"]));
    let parent = ours.parent.map(|index| arm.links()[index].name.as_str());
    assert_eq!(parent, theirs["parent"].as_str(), "{}", ours.name);
    assert_position(ours.offset, &theirs["offset"], F32_CM, &ours.name);
    assert_eq!(ours.axis, axis(&theirs["axis"]), "{}", ours.name);
    let length = f64::from(ours.length) * 100.0;
    assert_close(length, number(&theirs["length"]), F32_CM, &ours.name);
}

fn axis(name: &Value) -> Vec3 {
    match text(name) {
        "x" => Vec3::X,
        "y" => Vec3::Y,
        "z" => Vec3::Z,
        other => panic!("no axis {other}"),
    }
}

/// Evaluates a row of the Maya script: value = count × 360 / 255, attribute = value × scale + offset.
fn maya_value(row: &Value, value: f64) -> f64 {
    let map = AffineMap {
        gain: number(&row["scale"]) * 360.0 / 255.0,
        offset: number(&row["offset"]),
    };
    map.apply(value)
}

/// Checks calibration and filters packet by packet. The algorithms of the glove's original programs are implemented here
/// for comparison.
pub fn pipeline(file: &Value) -> usize {
    let mut cases = 0;
    for case in list(&file["cases"]) {
        corrected(case, number(&file["tolerance"]["angles_rad"]));
        as_coded(case, &file["tolerance"]);
        cases += list(&case["frames"]).len();
    }
    cases + linear(file) + fit(file) + divider(file)
}

/// Checks the corrected filters. Each row has its own estimator, because several rows share an angle.
fn corrected(case: &Value, tolerance: f64) {
    let name = text(&case["name"]);
    for (index, row) in full_map().rows().iter().enumerate() {
        let mut estimator = estimator(ChannelMap::new(vec![row.clone()], 255));
        for (frame, wanted) in list(&case["frames"]).iter().enumerate() {
            let reading = reading(frame as u64, &bytes(&wanted["body"]));
            let estimate = estimator.update(&reading).expect("nothing is rejected");
            let wanted = number(&wanted["corrected_angles"][index]);
            assert_close(estimate.angles.get(row.dof), wanted, tolerance, name);
        }
    }
}

/// Checks the algorithms of the original servers: signed-byte slip, integer mean, feedback shared by all rows of a channel.
fn as_coded(case: &Value, tolerance: &Value) {
    let name = text(&case["name"]);
    let rows = full_map().rows().to_vec();
    let mut readings = [0_i64; 64];
    let mut fed_back = [(0.0, 0.0); 64];
    let mut maya_before: Vec<f64> = vec![0.0; 64];
    let maya_rows = maya_rows();
    for frame in list(&case["frames"]) {
        let body = bytes(&frame["body"]);
        let slipped: Vec<i64> = body
            .iter()
            .map(|byte| i64::from(*byte) - i64::from(*byte > 127))
            .collect();
        for (reading, count) in readings.iter_mut().zip(&slipped) {
            *reading = (count + *reading).div_euclid(2);
        }
        let wanted: Vec<i64> = numbers(&frame["as_coded_readings"])
            .iter()
            .map(|n| *n as i64)
            .collect();
        assert_eq!(readings.to_vec(), wanted, "{name}");
        for (row, angle) in rows.iter().zip(numbers(&frame["as_coded_angles"])) {
            let (newer, older) = fed_back[row.channel];
            let x = row.calibration.apply(readings[row.channel] as f64);
            let y = (x + newer + older) / 3.0;
            fed_back[row.channel] = (y, newer);
            assert_close(y, angle, number(&tolerance["angles_rad"]), name);
        }
        let line = &frame["as_coded_line_degrees"];
        for (channel, (newest, _)) in fed_back.iter().enumerate() {
            // A channel without a row is 0.
            let degrees = line[channel.to_string()].as_f64().unwrap_or(0.0);
            let tolerance = number(&tolerance["line_degrees"]);
            assert_close(newest.to_degrees(), degrees, tolerance, name);
        }
        let values: Vec<f64> = slipped.iter().map(|count| *count as f64).collect();
        for (row, value) in maya_rows.iter().zip(numbers(&frame["c_server_maya"])) {
            let channel = number(&row["channel"]) as usize;
            let mean = (values[channel] + maya_before[channel]) / 2.0;
            let ours = maya_value(row, mean);
            assert_close(ours, value, number(&tolerance["maya"]), name);
        }
        maya_before = values;
    }
}

/// Returns the rows of the Maya script, which are in the file of the channels.
fn maya_rows() -> Vec<Value> {
    let path = super::folder().join("glove_channels.json");
    let text = std::fs::read_to_string(path).expect("glove_channels.json is in the same folder");
    let file: Value = serde_json::from_str(&text).expect("valid JSON");
    list(&file["maya"]).clone()
}

fn linear(file: &Value) -> usize {
    let tolerance = number(&file["tolerance"]["linear"]);
    let cases = list(&file["linear"]);
    for case in cases {
        let value = |name: &str| number(&case[name]);
        let map = AffineMap::from_counts(
            value("offset_counts"),
            value("factor"),
            value("initial_rotation"),
        );
        assert_close(
            map.apply(value("reading")),
            value("angle_counts_form"),
            tolerance,
            "linear",
        );
        assert_close(map.gain, value("text_form_factor"), tolerance, "linear");
        assert_close(map.offset, value("text_form_offset"), tolerance, "linear");
    }
    cases.len()
}

fn fit(file: &Value) -> usize {
    let tolerance = number(&file["tolerance"]["fit"]);
    let cases = list(&file["fit"]);
    for case in cases {
        let readings = numbers(&case["readings"]);
        let poses: Vec<(f64, f64)> = readings
            .into_iter()
            .zip(numbers(&case["angles_degrees"]))
            .collect();
        let fitted = AffineMap::fit(&poses);
        if case["factor"].is_null() {
            assert!(fitted.is_err(), "poses without a solution");
            continue;
        }
        let map = fitted.expect("poses with a solution");
        assert_close(map.gain, number(&case["factor"]), tolerance, "fit");
        assert_close(map.offset, number(&case["offset"]), tolerance, "fit");
    }
    cases.len()
}

fn divider(file: &Value) -> usize {
    let tolerance = number(&file["tolerance"]["divider"]);
    let cases = list(&file["divider"]);
    for case in cases {
        let value = |name: &str| number(&case[name]);
        let volt = divider_voltage(value("r1_kohm"), value("r2_kohm"), value("supply_volt"));
        assert_close(volt, value("vx_volt"), tolerance, "divider");
    }
    cases.len()
}

pub fn forward_kinematics(file: &Value) -> usize {
    let arm = arm();
    let tolerance = number(&file["tolerance"]["absolute"]) + F32_CM;
    let cases = list(&file["cases"]);
    for case in cases {
        let name = text(&case["name"]);
        let mut angles = JointAngles::default();
        for (link, angle) in case["angles"].as_object().expect("angles") {
            angles.set(dof_of(&arm, link), number(angle));
        }
        let poses = arm.link_poses(&angles);
        let index = |wanted_name: &str| {
            arm.links()
                .iter()
                .position(|link| link.name == wanted_name)
                .expect("a link")
        };
        for (link, wanted) in case["pivot"].as_object().expect("pivots") {
            assert_position(
                poses[index(link)].translation,
                wanted,
                tolerance,
                &format!("{name} {link}"),
            );
        }
        let hand = arm.forward(&Estimate::new(Timestamp(0), angles));
        for (finger, wanted) in case["tip"].as_object().expect("tips") {
            let tip = hand
                .fingertip(finger.parse().expect("a finger"))
                .expect("a tip");
            assert_position(tip, wanted, tolerance, &format!("{name} {finger} tip"));
        }
        assert_rotation(&poses[index("wrist_z")], &case["hand_rotation"], name);
        let index_tip = hand.get(Joint::tip(Finger::Index)).expect("a tip");
        assert_rotation(index_tip, &case["index_tip_rotation"], name);
    }
    cases.len()
}

/// Checks a rotation matrix. Eight links that all turn by a quarter or half a turn add up `f32` rounding of 2.3e-6. An error of 1e-6 moves
/// the hand, at most 0.57 m from the shoulder, by 0.6 µm.
fn assert_rotation(pose: &Pose, rows: &Value, name: &str) {
    let matrix = parry3d::math::Mat3::from_quat(pose.rotation);
    for (index, row) in list(rows).iter().enumerate() {
        for (ours, theirs) in matrix.row(index).to_array().iter().zip(numbers(row)) {
            assert_close(f64::from(*ours), theirs, 4e-6, name);
        }
    }
}

/// Checks fingertips from bytes. All 26 rows of the table drive the arm, also those that the glove file disables.
pub fn end_to_end(file: &Value) -> usize {
    let tolerance = number(&file["tolerance"]["absolute"]) + F32_CM;
    let arm = arm();
    let cases = list(&file["cases"]);
    for case in cases {
        let name = text(&case["name"]);
        let mut bodies = Vec::new();
        let mut decoder = Hc11Decoder::new(Framing::Double06);
        decoder.push(&bytes(&case["hex"]), &mut |packet| {
            bodies.push(body(&packet.sample).expect("channels"))
        });
        decoder.finish(&mut |packet| bodies.push(body(&packet.sample).expect("channels")));
        let frames = list(&case["frames"]);
        assert_eq!(bodies.len() as f64, number(&case["n_frames"]), "{name}");
        assert_eq!(bodies.len(), frames.len(), "{name}");
        let mut estimator = estimator(full_map());
        for (number, (body, wanted)) in bodies.iter().zip(frames).enumerate() {
            let estimate = estimator
                .update(&reading(number as u64, body))
                .expect("nothing is rejected");
            let hand = arm.forward(estimate);
            let wrist = hand.position(Joint::Wrist).expect("a wrist");
            assert_position(wrist, &wanted["wrist_z"], tolerance, name);
            for (finger, tip) in wanted["tip"].as_object().expect("tips") {
                let ours = hand
                    .fingertip(finger.parse().expect("a finger"))
                    .expect("a tip");
                assert_position(ours, tip, tolerance, &format!("{name} {finger}"));
            }
        }
    }
    cases.len()
}
