use super::*;
use crate::capture::protocol::{Decoder, options};
use crate::time::Timestamp;

/// The orientation of a sensor with any north and up, and later ones: turned by 30° about its own X, Y and Z, and by 50° about Z,
/// then -20° about Y, then 70° about X. A program of its own has multiplied the quaternions.
const NEUTRAL: &str = "0.3206267,0.3254486,0.2166729,0.8627483";
const TURNED: [&str; 4] = [
    "0.2254693,0.3973435,0.4325857,0.7772717",
    "0.2536225,0.0910636,0.2922743,0.9175831",
    "0.0864059,0.3704383,0.1250577,0.9163351",
    "-0.3610591,0.4063560,0.5377068,0.6445017",
];

fn decode(decoder: &mut LineDecoder<ImuParser>, text: &str) -> Vec<Displacement> {
    let mut found = Vec::new();
    decoder.push(text.as_bytes(), &mut |packet| match packet.sample {
        Sample::Displacement { displacement } => found.push(displacement),
        other => panic!("{other:?}"),
    });
    found
}

fn rotation(displacement: &Displacement) -> Quat {
    displacement.rotation().expect("a rotation")
}

fn assert_near(found: Vec3, expected: Vec3) {
    assert!(found.distance(expected) < 1e-5, "{found}, not {expected}");
}

#[test]
fn the_first_line_is_the_pose_at_rest_and_later_ones_turn_about_the_axes_of_the_forearm() {
    let lines = [&[NEUTRAL][..], &TURNED].concat().join("\n") + "\n";
    let mut decoder = decoder(&options(&[(&JOINT, "elbow")]));
    let found = decode(&mut decoder, &lines);
    assert_eq!(found.len(), 5);
    assert!(
        found
            .iter()
            .all(|it| it.joint == Joint::Elbow && it.translation() == Vec3::ZERO)
    );
    let [rest, roll, pitch, yaw, all]: [Quat; 5] = std::array::from_fn(|it| rotation(&found[it]));
    let (forward, left, up) = (Vec3::NEG_Z, Vec3::NEG_X, Vec3::Y);
    let (sin, cos) = 30_f32.to_radians().sin_cos();
    assert_near(rest * forward, forward);
    assert_near(rest * up, up);
    // The left side rises, the fingers fall, the fingers go to the left: right-handed about forward, left and up.
    assert_near(roll * left, cos * left + sin * up);
    assert_near(pitch * forward, cos * forward - sin * up);
    assert_near(yaw * forward, cos * forward + sin * left);
    let turn = |axis, degrees: f32| Quat::from_axis_angle(axis, degrees.to_radians());
    let expected = turn(up, 50.0) * turn(left, -20.0) * turn(forward, 70.0);
    for axis in [forward, left, up] {
        assert_near(all * axis, expected * axis);
    }
}

#[test]
fn the_bearing_turns_the_axes_and_not_the_pose_at_rest() {
    let lines = format!("{NEUTRAL}\n{}\n", TURNED[1]);
    let mut decoder = decoder(&options(&[(&BEARING, "90")]));
    let found = decode(&mut decoder, &lines);
    let (sin, cos) = 30_f32.to_radians().sin_cos();
    assert_near(rotation(&found[0]) * Vec3::X, Vec3::X);
    // The forearm points to the right, and its fingers fall.
    assert_near(rotation(&found[1]) * Vec3::X, cos * Vec3::X - sin * Vec3::Y);
}

#[test]
fn lines_of_both_orders_separators_and_times_are_read() {
    let mut by_order = decoder(&options(&[(&ORDER, "xyzw")]));
    let found = decode(
        &mut by_order,
        "0.3254486 0.2166729 0.8627483 0.3206267\r\n\n",
    );
    assert_eq!(found.len(), 1);
    let mut decoder = decoder(&ProtocolOptions::default());
    let mut times = Vec::new();
    let lines = format!(
        "{NEUTRAL}\n{NEUTRAL} time_us=5\n{NEUTRAL}, time_us=5\n0.32\t0.325 0.217 0.863 time_us=9\n"
    );
    decoder.push(lines.as_bytes(), &mut |packet| times.push(packet.sent_at));
    assert_eq!(times, [None, Some(Timestamp(5)), Some(Timestamp(9))]);
    assert_eq!(decoder.stats().invalid.get(InvalidPacket::OutOfOrder), 1);
}

#[test]
fn damaged_lines_are_counted_by_reason_and_are_no_neutral_pose() {
    let mut decoder = decoder(&ProtocolOptions::default());
    for (line, reason, count) in [
        ("nan,0,0,1", InvalidPacket::NotFinite, 1),
        ("inf,0,0,1", InvalidPacket::NotFinite, 2),
        ("0,0,0,0", InvalidPacket::Unknown, 1),
        ("1e200,0,0,1e200", InvalidPacket::Unknown, 2),
        // A digit was lost: 0.9980 became 0.980.
        ("0.5,0.5,0.5,0.05", InvalidPacket::Unknown, 3),
        ("x,0,0,1", InvalidPacket::Unknown, 4),
        ("1,0,0,0 time_us=-1", InvalidPacket::Unknown, 5),
    ] {
        assert_eq!(decode(&mut decoder, &format!("{line}\n")), [], "{line}");
        assert_eq!(decoder.stats().invalid.get(reason), count, "{line}");
    }
    for line in ["1,0,0", "1,0,0,0,0"] {
        assert_eq!(decode(&mut decoder, &format!("{line}\n")), [], "{line}");
    }
    let found = decode(&mut decoder, &format!("{NEUTRAL}\n"));
    assert_near(rotation(&found[0]) * Vec3::X, Vec3::X);
}

#[test]
fn a_length_within_a_tenth_is_scaled_to_one() {
    let mut decoder = decoder(&ProtocolOptions::default());
    let found = decode(&mut decoder, "1.05,0,0,0\n0.95,0,0,0\n1.2,0,0,0\n");
    assert_eq!(found.len(), 2);
    for displacement in found {
        let (_, [x, y, z, w]) = displacement.to_arrays();
        assert!((Quat::from_xyzw(x, y, z, w).length() - 1.0).abs() < 1e-6);
    }
}

#[test]
fn missing_lines_do_not_move_the_neutral_pose_and_a_new_stream_has_its_own() {
    let mut decoder = decoder(&ProtocolOptions::default());
    decode(&mut decoder, &format!("{NEUTRAL}\n"));
    let after_a_gap = decode(&mut decoder, &format!("garbage\n{}\n", TURNED[3]));
    assert!(rotation(&after_a_gap[0]).angle_between(Quat::IDENTITY) > 1.0);
    decoder.reset();
    let restarted = decode(&mut decoder, &format!("{}\n", TURNED[3]));
    assert!(rotation(&restarted[0]).angle_between(Quat::IDENTITY) < 1e-3);
}

#[test]
fn a_line_that_lost_its_start_before_a_serial_port_was_opened_is_no_neutral_pose() {
    let mut decoder = decoder(&ProtocolOptions::default());
    decoder.start_anywhere();
    // The sign of `-0.7` was lost.
    assert_eq!(decode(&mut decoder, "0.7,0.7,0,0\n"), []);
    let stats = decoder.stats();
    assert_eq!((stats.readings, stats.skipped_bytes), (0, 12));
    assert_eq!(stats.invalid.get(InvalidPacket::Truncated), 1);
    assert_eq!(decode(&mut decoder, &format!("{NEUTRAL}\n")).len(), 1);
    decoder.reset();
    let after_the_loss = decode(&mut decoder, &format!("0.7,0.7,0,0\n{NEUTRAL}\n"));
    assert_eq!(after_the_loss.len(), 1);
    let turn = rotation(&after_the_loss[0]);
    assert!(turn.angle_between(Quat::IDENTITY) < 1e-3);
}

#[test]
fn text_after_a_packet_is_a_restart_with_a_neutral_pose_of_its_own() {
    for (text, is_restart) in [
        ("BNO055 started", true),
        (
            "rst:0x1 (POWERON_RESET),boot:0x13 (SPI_FAST_FLASH_BOOT)",
            true,
        ),
        ("Calibration: Sys=3 Gyro=3 Accel=1", false),
        ("0.99812,0.01221,-0.05", false),
        ("0.99812,0.0p221,-0.05102,0.03015 time_us=", false),
        ("nan,nan,nan,nan", false),
        ("infinity,0,0,1", false),
    ] {
        let mut decoder = decoder(&ProtocolOptions::default());
        let before = decode(&mut decoder, &format!("{text}\n{NEUTRAL}\n"));
        assert_eq!(before.len(), 1, "{text}");
        assert!(!decoder.take_restart(), "{text} is a start");
        let after = decode(&mut decoder, &format!("{text}\n{text}\n{}\n", TURNED[3]));
        assert_eq!(decoder.take_restart(), is_restart, "{text}");
        assert!(!decoder.take_restart(), "{text} is reported once");
        let is_neutral = rotation(&after[0]).angle_between(Quat::IDENTITY) < 1e-3;
        assert_eq!(is_neutral, is_restart, "{text}");
    }
}
