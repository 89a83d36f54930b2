//! Tests of lines of hand landmarks.

use super::*;
use crate::capture::Sample;
use crate::capture::protocol::{InvalidPackets, options};

/// A right hand with half-bent fingers, palm down, in front of a camera at the origin.
fn right_hand() -> JointPositions {
    let mut positions = JointPositions::default();
    positions.set(Joint::Wrist, DVec3::new(0.1, -0.2, -0.3));
    for (column, finger) in Finger::ALL.iter().enumerate() {
        let joints = finger.joints();
        let column = column as f64;
        for (bone, &joint) in joints[joints.len() - 4..].iter().enumerate() {
            let bone = bone as f64;
            let drop = 0.01 * bone * bone;
            let offset = DVec3::new(0.02 * column - 0.04, -drop, -0.08 - 0.03 * bone + drop);
            positions.set(joint, DVec3::new(0.1, -0.2, -0.3) + offset);
        }
    }
    positions
}

fn mirrored(positions: &JointPositions) -> JointPositions {
    let mut mirrored = JointPositions::default();
    for (joint, position) in positions.known() {
        mirrored.set(joint, position.with_x(-position.x));
    }
    mirrored
}

fn decode(pairs: &[(&ProtocolOption, &str)], lines: &[String]) -> (Vec<Packet>, InvalidPackets) {
    let mut decoder = (PROTOCOL.decoder)(&options(pairs));
    let mut packets = Vec::new();
    for line in lines {
        decoder.push(line.as_bytes(), &mut |packet| packets.push(packet));
    }
    (packets, decoder.stats().invalid)
}

fn joints(packet: &Packet) -> JointPositions {
    match &packet.sample {
        Sample::Joints { positions } => *positions,
        other => panic!("{other:?}"),
    }
}

fn assert_close(found: &JointPositions, expected: &JointPositions) {
    for (joint, position) in expected.known() {
        let found = found.get(joint).expect("a joint");
        assert!(
            found.distance(position) < 1e-6,
            "{joint}: {found} {position}"
        );
    }
}

const HEAD: (&ProtocolOption, &str) = (&CAMERA, "head");

#[test]
fn hands_are_where_the_camera_sees_them() {
    let (right, left) = (right_hand(), mirrored(&right_hand()));
    let line = encode(Some(7), &[(Side::Right, right), (Side::Left, left)]);
    let (packets, invalid) = decode(&[HEAD], &[line]);
    assert_eq!((packets.len(), invalid.total()), (2, 0));
    assert_eq!(packets[0].side, Some(Side::Left));
    assert_close(&joints(&packets[0]), &left);
    assert_eq!(packets[1].side, Some(Side::Right));
    assert_close(&joints(&packets[1]), &right);
}

/// Replaces the fields of a line.
fn edit(line: &str, change: impl FnOnce(&mut serde_json::Value)) -> String {
    let mut value = serde_json::from_str(line).expect("a line");
    change(&mut value);
    format!("{value}\n")
}

#[test]
fn pixels_are_the_same_as_fractions_of_the_image() {
    let line = encode(None, &[(Side::Right, right_hand())]);
    let in_pixels = edit(&line, |value| {
        let points = value["hands"][0]["image"].as_array_mut().expect("points");
        for point in points {
            let [x, y, z] = [0, 1, 2].map(|axis| point[axis].as_f64().expect("a number"));
            *point = serde_json::json!([x * 640.0, y * 480.0, z * 640.0]);
        }
    });
    let (packets, _) = decode(&[HEAD], &[in_pixels]);
    assert_close(&joints(&packets[0]), &right_hand());
}

#[test]
fn a_hand_without_points_is_relative_to_its_wrist_and_one_without_a_shape_has_the_size_of_its_palm()
{
    let line = encode(None, &[(Side::Right, right_hand())]);
    let without = |field: &str| {
        edit(&line, |value| {
            value["hands"][0]
                .as_object_mut()
                .expect("a hand")
                .remove(field);
        })
    };
    let (packets, _) = decode(&[HEAD], &[without("image")]);
    let found = joints(&packets[0]);
    let wrist = right_hand().get(Joint::Wrist).expect("a wrist");
    for (joint, expected) in right_hand().known() {
        let found = found.get(joint).expect("a joint");
        assert!(found.distance(expected - wrist) < 1e-9, "{joint}");
    }
    let (image_packets, _) = decode(&[HEAD], &[without("world")]);
    let image_joints = joints(&image_packets[0]);
    let at = |joint| image_joints.get(joint).expect("a joint");
    let palm = at(Joint::Wrist).distance(at(Joint::MiddlePhalanxProximal));
    assert!((0.06..0.1).contains(&palm), "{palm}");
    assert!(at(Joint::IndexTip).distance(wrist) < 0.3);
}

#[test]
fn a_mirrored_image_and_labels_that_assume_one_give_the_same_hand() {
    let right = right_hand();
    // A mirrored image shows a left hand, and the label says so.
    let flipped = encode(None, &[(Side::Left, mirrored(&right))]);
    let (packets, _) = decode(&[HEAD, (&MIRRORED, "yes")], &[flipped]);
    assert_eq!(packets[0].side, Some(Side::Right));
    assert_close(&joints(&packets[0]), &right);

    let swapped = encode(None, &[(Side::Left, right)]);
    let (swapped_packets, invalid) = decode(
        &[HEAD, (&SWAP_HANDS, "yes")],
        std::slice::from_ref(&swapped),
    );
    assert_eq!(swapped_packets[0].side, Some(Side::Right));
    assert_close(&joints(&swapped_packets[0]), &right);
    assert_eq!(invalid.total(), 0);

    let (unswapped, rejected) = decode(&[HEAD], &[swapped]);
    assert_eq!((unswapped.len(), rejected.total()), (0, 1), "backwards");
}

#[test]
fn a_wrong_label_is_refused_with_options_that_are_not_set_yet() {
    let right = encode(None, &[(Side::Right, right_hand())]);
    for (option, advice) in [
        (
            (&SWAP_HANDS, "yes"),
            "try `swap_hands=no` or `mirrored=yes`",
        ),
        (
            (&SWAP_HANDS, "no"),
            "try `swap_hands=yes` or `mirrored=yes`",
        ),
    ] {
        let mut parser = HandParser::new(&options(&[HEAD, option]));
        // The fingers of a left hand bend the other way.
        let label = if option.1 == "yes" { "right" } else { "left" };
        let line = right.replace("\"right\"", &format!("\"{label}\""));
        let error = parser
            .parse(line.trim_end().as_bytes(), &mut |_| {})
            .unwrap_err();
        assert!(error.to_string().contains(advice), "{error}");
    }
}

#[test]
fn a_hand_with_a_wrong_label_does_not_hide_the_other_one() {
    let (right, left) = (right_hand(), mirrored(&right_hand()));
    for hands in [
        [(Side::Right, right), (Side::Right, left)],
        [(Side::Right, left), (Side::Right, right)],
        [(Side::Right, right), (Side::Left, right)],
    ] {
        let line = encode(None, &hands);
        // The wrong one may be the more certain one.
        let less_certain = line.replacen("\"score\":1.0", "\"score\":0.9", 1);
        for image in [line, less_certain] {
            let (packets, invalid) = decode(&[HEAD], &[image]);
            assert_eq!((packets.len(), invalid.total()), (1, 0), "{hands:?}");
            assert_eq!(packets[0].side, Some(Side::Right));
            assert_close(&joints(&packets[0]), &right);
        }
    }
}

#[test]
fn a_hand_below_the_score_or_out_of_view_has_no_joints() {
    let seen = encode(None, &[(Side::Right, right_hand())]);
    let unsure = seen.replace("\"score\":1.0", "\"score\":0.49");
    let empty = "{\"hands\":[]}\n".to_owned();
    let lines = [
        empty.clone(),
        unsure.clone(),
        seen.clone(),
        unsure,
        empty,
        seen,
    ];
    let (packets, invalid) = decode(&[HEAD], &lines);
    assert_eq!(invalid.total(), 0);
    let known: Vec<_> = packets
        .iter()
        .map(|packet| joints(packet).known().count())
        .collect();
    assert_eq!(known, [HAND_LANDMARKS, 0, 0, HAND_LANDMARKS]);
    let times: Vec<_> = packets
        .iter()
        .map(|packet| packet.time.expect("a time").0)
        .collect();
    assert_eq!(times, [100_000, 133_333, 166_667, 200_000]);
}

#[test]
fn of_two_hands_with_one_label_the_more_certain_one_counts() {
    let sure = right_hand();
    let mut other = right_hand();
    other.set(Joint::IndexTip, DVec3::new(0.0, -0.2, -0.5));
    let line = encode(None, &[(Side::Right, other), (Side::Right, sure)]);
    let line = line.replacen("\"score\":1.0", "\"score\":0.6", 1);
    let (packets, _) = decode(&[HEAD], &[line]);
    assert_eq!(packets.len(), 1);
    assert_close(&joints(&packets[0]), &sure);
}

#[test]
fn invalid_lines_are_counted_by_reason() {
    let valid = encode(Some(2_000_000), &[(Side::Right, right_hand())]);
    let later = valid.replace("2000000", "3000000");
    let hand =
        |change: fn(&mut serde_json::Value)| edit(&later, |value| change(&mut value["hands"][0]));
    let size = later.replacen("\"image_size\":[640,480],", "", 1);
    for (line, reason, text) in [
        (
            format!("{}\n", &valid[..300]),
            InvalidPacket::Truncated,
            "EOF",
        ),
        (
            hand(|hand| {
                hand["world"].as_array_mut().expect("a list").pop();
            }),
            InvalidPacket::WrongSize,
            "20 landmarks",
        ),
        (
            hand(|hand| hand["world"][20] = serde_json::json!([0.0, 0.1])),
            InvalidPacket::WrongSize,
            "three to 8 numbers",
        ),
        (
            hand(|hand| hand["world"][20] = serde_json::json!([0.0, null, 0.1])),
            InvalidPacket::Unknown,
            "null, expected a number",
        ),
        (
            hand(|hand| hand["world"][20] = serde_json::json!([0.0, 0.1, 1e30])),
            InvalidPacket::NotFinite,
            "too far",
        ),
        (
            hand(|hand| hand["score"] = serde_json::json!(1.5)),
            InvalidPacket::NotFinite,
            "score",
        ),
        (size.clone(), InvalidPacket::Unknown, "need `image_size`"),
        (
            later.replacen("[640,480]", "[0,480]", 1),
            InvalidPacket::NotFinite,
            "image_size",
        ),
        (
            later
                .replacen("\"world\"", "\"words\"", 1)
                .replacen("\"image\"", "\"dots\"", 1),
            InvalidPacket::Unknown,
            "neither",
        ),
        (valid.clone(), InvalidPacket::OutOfOrder, "not later"),
        ("[[[[\n".to_owned(), InvalidPacket::Unknown, "invalid type"),
    ] {
        let mut decoder = (PROTOCOL.decoder)(&options(&[HEAD]));
        let mut packets = 0;
        decoder.push(valid.as_bytes(), &mut |_| packets += 1);
        decoder.push(line.as_bytes(), &mut |_| packets += 1);
        let invalid = decoder.stats().invalid;
        assert_eq!(
            (packets, invalid.get(reason)),
            (1, 1),
            "{text}: {invalid:?}"
        );
        let error = decoder.last_error().expect("an error").to_string();
        assert!(error.contains(text), "{text}: {error}");
    }
}
