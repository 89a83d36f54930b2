//! Tests of marker lines.

use std::fmt::Write;

use glam::DVec3;

use super::*;
use crate::capture::protocol::options;
use crate::hand::{Joint, JointPositions};
use crate::time::Timestamp;

const CAMERAS: [DVec3; 4] = [
    DVec3::new(2.0, 2.0, 2.0),
    DVec3::new(-2.0, 2.0, 2.0),
    DVec3::new(-2.0, 1.5, -2.0),
    DVec3::new(2.0, 1.8, -2.0),
];

/// Returns the line of cameras that see labelled points; the label `-` is none.
fn line(seen: &[(DVec3, &[(&str, DVec3)])]) -> String {
    let cameras = seen.iter().map(|(camera, markers)| {
        let markers = markers.iter().map(|(label, position)| {
            let point = camera.lerp(*position, 0.4).to_array();
            match *label {
                "-" => format!(r#"{{"point":{point:?}}}"#),
                label => format!(r#"{{"label":"{label}","point":{point:?}}}"#),
            }
        });
        let markers: Vec<String> = markers.collect();
        let position = camera.to_array();
        format!(
            r#"{{"position":{position:?},"markers":[{}]}}"#,
            markers.join(",")
        )
    });
    let cameras: Vec<String> = cameras.collect();
    format!(r#"{{"cameras":[{}]}}"#, cameras.join(","))
}

fn decode(options: &ProtocolOptions, lines: &[String]) -> Vec<Packet> {
    let mut decoder = (PROTOCOL.decoder)(options);
    let mut packets = Vec::new();
    for line in lines {
        decoder.push(line.as_bytes(), &mut |packet| packets.push(packet));
        decoder.push(b"\r\n", &mut |packet| packets.push(packet));
    }
    packets
}

fn positions(packet: &Packet) -> JointPositions {
    match &packet.sample {
        Sample::Joints { positions } => *positions,
        other => panic!("{other:?}"),
    }
}

/// Returns the joints of one line and their positions in millimetres.
fn joints(options: &ProtocolOptions, line: String) -> String {
    let packets = decode(options, &[line]);
    let Some(packet) = packets.first() else {
        return "none".to_owned();
    };
    let mut text = String::new();
    for (joint, position) in positions(packet).known() {
        // Adding 0 makes −0 positive.
        let [x, y, z] = ((position * 1000.0).round() + 0.0).to_array();
        let _ = write!(text, "{joint} {x} {y} {z};");
    }
    text
}

const ELBOW: DVec3 = DVec3::new(0.2, 1.0, 0.0);
const TIP: DVec3 = DVec3::new(0.2, 1.0, -0.4);
const OTHER: DVec3 = DVec3::new(0.1, 1.1, -0.35);

#[test]
fn labelled_markers_of_four_cameras_are_joints_in_metres() {
    let seen: [(&str, DVec3); 2] = [("elbow", ELBOW), ("RightHandIndex4", TIP)];
    let all = CAMERAS.map(|camera| (camera, &seen[..]));
    let expected = "elbow 200 1000 0;index-finger-tip 200 1000 -400;";
    assert_eq!(joints(&options(&[]), line(&all)), expected);
    assert_eq!(joints(&options(&[]), line(&all[..2])), expected);
    assert_eq!(joints(&options(&[]), line(&all[..1])), "none");
    let in_decimetres = options(&[(&UNIT, "100"), (&UP, "z")]);
    let z_up = "elbow 20 0 -100;index-finger-tip 20 -40 -100;";
    assert_eq!(joints(&in_decimetres, line(&all)), z_up);
    let left = options(&[(&HAND, "left")]);
    assert_eq!(joints(&left, line(&all)), "elbow 200 1000 0;");
}

#[test]
fn a_label_in_one_image_is_enough() {
    let seen = [
        (CAMERAS[0], &[("-", OTHER), ("-", ELBOW), ("-", TIP)][..]),
        (
            CAMERAS[1],
            &[("thumb-tip", TIP), ("-", ELBOW), ("-", OTHER)][..],
        ),
        (CAMERAS[2], &[("elbow", ELBOW)][..]),
    ];
    let expected = "elbow 200 1000 0;thumb-tip 200 1000 -400;";
    assert_eq!(joints(&options(&[]), line(&seen)), expected);
}

#[test]
fn a_wrong_label_in_one_of_three_images_is_left_out() {
    let right: &[(&str, DVec3)] = &[("elbow", ELBOW)];
    let wrong: &[(&str, DVec3)] = &[("elbow", OTHER)];
    let seen = [
        (CAMERAS[0], right),
        (CAMERAS[1], wrong),
        (CAMERAS[2], right),
    ];
    assert_eq!(joints(&options(&[]), line(&seen)), "elbow 200 1000 0;");
    assert_eq!(joints(&options(&[]), line(&seen[..2])), "none");
}

#[test]
fn a_marker_without_a_position_is_hidden_and_leaves_the_others() {
    let elbow: &[(&str, DVec3)] = &[("elbow", ELBOW)];
    let seen = line(&[(CAMERAS[0], elbow), (CAMERAS[1], elbow)]);
    let with = |field: &str| {
        let first = format!(r#""markers":[{{"label":"thumb-tip"{field}}},"#);
        joints(&options(&[]), seen.replacen(r#""markers":["#, &first, 1))
    };
    for field in ["", r#","point":null"#, r#","direction":[0,0,0]"#] {
        assert_eq!(with(field), "elbow 200 1000 0;", "{field}");
    }
    for field in [
        r#","image":[1,2]"#,
        r#","direction":[1,0,0],"point":[1,0,0]"#,
    ] {
        assert_eq!(with(field), "none", "{field}");
    }
    let misspelt = seen.replace("point", "pont");
    let parsed = MarkerParser::new(&options(&[])).parse(misspelt.as_bytes(), &mut |_| {});
    let message = parsed.unwrap_err().to_string();
    assert!(message.contains("no marker has a `point`"), "{message}");
}

#[test]
fn an_image_position_needs_the_orientation_of_the_camera() {
    // A camera at +Z that looks along −Z: its Y axis points down and its Z axis along the view.
    let camera = |orientation: &str| {
        format!(
            r#"{{"position":[0,1,2],{orientation}"focal_px":[800,800],"center_px":[640,360],
               "markers":[{{"label":"elbow","image":[720,360]}}]}}"#
        )
    };
    let line = |orientation: &str| {
        let other = r#"{"position":[2.2,1,0],"markers":[{"label":"elbow","direction":[-3,0,0]}]}"#;
        format!(r#"{{"cameras":[{},{other}]}}"#, camera(orientation)).replace('\n', " ")
    };
    let seen = |orientation| joints(&options(&[]), line(orientation));
    assert_eq!(seen(r#""orientation":[1,0,0,0],"#), "elbow 200 1000 0;");
    assert_eq!(seen(r#""orientation":[1,1,0,0],"#), "none");
    assert_eq!(seen(""), "none");
}

#[test]
fn the_elbow_is_corrected_and_the_wrist_lies_between_its_markers() {
    let arm = |wrist: DVec3| {
        let markers = [
            ("RSHO", DVec3::new(0.2, 1.3, 0.0)),
            // At its outer side.
            ("RELB", ELBOW - DVec3::X * 0.04),
            ("RWRA", wrist + DVec3::X * 0.03),
            ("RWRB", wrist - DVec3::X * 0.03),
            ("LWRB", wrist),
        ];
        line(&[(CAMERAS[0], &markers[..]), (CAMERAS[1], &markers[..])])
    };
    let offset = options(&[(&ELBOW_OFFSET, "40")]);
    let bent = arm(DVec3::new(0.2, 1.0, -0.25));
    let straight = arm(DVec3::new(0.2, 0.75, 0.0));
    let packets = decode(&offset, &[straight.clone(), bent, straight]);
    for packet in &packets {
        let elbow = positions(packet).get(Joint::Elbow).unwrap();
        assert!(elbow.distance(ELBOW) < 1e-8, "{elbow}");
    }
    let wrist = positions(&packets[1]).get(Joint::Wrist).unwrap();
    assert!(wrist.distance(DVec3::new(0.2, 1.0, -0.25)) < 1e-9);
}

#[test]
fn lines_that_are_late_or_come_twice_are_dropped_and_a_restarted_sender_is_accepted() {
    let valid = line(&CAMERAS.map(|camera| (camera, &[("elbow", ELBOW)][..])));
    let timed = |time: u64| valid.replacen('{', &format!(r#"{{"time_us":{time},"#), 1);
    let sent = [
        2_000_000, 2_010_000, 2_005_000, 2_010_000, 2_020_000, 4_000, 8_000,
    ];
    let packets = decode(&options(&[]), &sent.map(timed));
    let times: Vec<u64> = packets
        .iter()
        .map(|packet| packet.time.unwrap().0)
        .collect();
    assert_eq!(times, [2_000_000, 2_010_000, 2_020_000, 4_000, 8_000]);
}

#[test]
fn invalid_lines_are_skipped_and_times_are_kept() {
    let valid = line(&CAMERAS.map(|camera| (camera, &[("elbow", ELBOW)][..])));
    let timed = |time: &str| valid.replacen('{', &format!(r#"{{"time_us":{time},"#), 1);
    let many = line(&[(CAMERAS[0], &[("-", TIP); 65][..])]);
    let lines = [
        "nonsense".to_owned(),
        timed("12500"),
        timed("-1"),
        timed("9007199254740993"),
        valid.replacen("[2.0", "[1e999", 1),
        many,
        valid.clone(),
    ];
    let packets = decode(&options(&[]), &lines);
    let times: Vec<_> = packets.iter().map(|packet| packet.time).collect();
    assert_eq!(times, [Some(Timestamp(12_500)), None]);
    assert!(
        packets
            .iter()
            .all(|packet| packet.side == Some(Side::Right))
    );
}

#[test]
fn invalid_lines_are_counted_by_reason() {
    let valid = line(&CAMERAS.map(|camera| (camera, &[("elbow", ELBOW)][..])));
    let timed = |time: u64| valid.replacen('{', &format!(r#"{{"time_us":{time},"#), 1);
    let mut decoder = (PROTOCOL.decoder)(&options(&[]));
    for (sent, expected) in [
        (timed(2_000_000), None),
        (timed(2_000_000), Some(InvalidPacket::OutOfOrder)),
        (timed(1_950_000), Some(InvalidPacket::OutOfOrder)),
        (timed(1_500_000), Some(InvalidPacket::TooOld)),
        (timed(500_000), None),
        (
            valid[..valid.len() / 2].to_owned(),
            Some(InvalidPacket::Truncated),
        ),
        (
            line(&[(CAMERAS[0], &[("-", TIP); 65][..])]),
            Some(InvalidPacket::WrongSize),
        ),
        (
            " ".repeat(MarkerParser::MAX_LINE_BYTES + 1),
            Some(InvalidPacket::WrongSize),
        ),
        (
            valid.replacen("[2.0", "[1e999", 1),
            Some(InvalidPacket::NotFinite),
        ),
        ("noise".to_owned(), Some(InvalidPacket::Unknown)),
    ] {
        let before = decoder.stats().invalid;
        decoder.push(format!("{sent}\n").as_bytes(), &mut |_| {});
        let mut counted = before;
        if let Some(reason) = expected {
            counted.count(reason);
        }
        let after = decoder.stats().invalid;
        assert_eq!(after, counted, "{:.40}", sent);
        assert_eq!(decoder.last_error().map(|error| error.reason), expected);
    }
}

#[test]
fn fixed_bones_keep_the_length_of_a_forearm_whose_markers_have_noise() {
    let mut random = fastrand::Rng::with_seed(12);
    // A standard deviation of 1 mm along each axis.
    let mut noisy = |point: DVec3| {
        let mut axis = || ((0..12).map(|_| random.f64()).sum::<f64>() - 6.0) * 1e-3;
        point + DVec3::new(axis(), axis(), axis())
    };
    let lines: Vec<String> = (0..800)
        .map(|index| {
            let turn = f64::from(index) * 0.01;
            let elbow = DVec3::new(0.1, 0.9, 0.0);
            let wrist = elbow + 0.26 * DVec3::new(turn.cos(), 0.0, turn.sin());
            let markers = [
                ("shoulder", noisy(elbow + 0.3 * DVec3::Y)),
                ("elbow", noisy(elbow)),
                ("wrist", noisy(wrist)),
            ];
            line(&CAMERAS.map(|camera| (camera, &markers[..])))
        })
        .collect();
    let spread_mm = |bones: &str| {
        let packets = decode(&options(&[(&BONES, bones)]), &lines);
        assert_eq!(packets.len(), lines.len());
        // The first 3 s measure the lengths.
        let lengths = packets[300..].iter().map(|packet| {
            let positions = positions(packet);
            let joint = |joint| positions.get(joint).expect("it is labelled");
            joint(Joint::Elbow).distance(joint(Joint::Wrist)) * 1000.0
        });
        let lengths: Vec<f64> = lengths.collect();
        let [least, most] =
            [f64::min, f64::max].map(|of| lengths.iter().copied().reduce(of).unwrap());
        println!("forearm with {bones} bones: {least:.3} to {most:.3} mm");
        most - least
    };
    let (free, fixed) = (spread_mm("free"), spread_mm("fixed"));
    assert!(free > 5.0 && fixed < 1e-6, "{free} {fixed}");
}

#[test]
fn a_line_without_a_marker_of_the_hand_states_why() {
    let reason = |option: &[(&ProtocolOption, &str)], label: &str| {
        let mut parser = MarkerParser::new(&options(option));
        let line = line(&[
            (CAMERAS[0], &[(label, ELBOW)]),
            (CAMERAS[1], &[(label, ELBOW)]),
        ]);
        let error = parser.parse(line.as_bytes(), &mut |_| {}).unwrap_err();
        error.to_string()
    };
    for (label, expected) in [
        ("LELB", "the labels are of the left hand; use `hand=left`"),
        (
            "m1",
            "no label names a joint of an arm or hand: `m1`; use names such as",
        ),
        ("-", "no marker has a label"),
    ] {
        let found = reason(&[], label);
        assert!(found.contains(expected), "{label}: {found}");
    }
    let of_right = reason(&[(&HAND, "left")], "RightHand");
    assert!(of_right.contains("use `hand=right`"), "{of_right}");
    let mut parser = MarkerParser::new(&options(&[]));
    let alone = line(&[
        (CAMERAS[0], &[("elbow", ELBOW)]),
        (CAMERAS[1], &[("foo", OTHER)]),
    ]);
    let error = parser.parse(alone.as_bytes(), &mut |_| {}).unwrap_err();
    assert!(error.to_string().contains("seen by two cameras"), "{error}");
}
