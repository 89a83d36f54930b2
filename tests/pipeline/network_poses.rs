//! Hands from the network: bones of VMC and poses of opentrack, from their datagrams to keys.

use ademan::capture::Reading;
use ademan::capture::protocol::{Decoder, ProtocolOptions, imu, opentrack, vmc};
use ademan::device::{EventKind, Events};
use ademan::estimate::{Estimate, JointAngles, bones_from_angles};
use ademan::hand::{BoneRotations, Finger, Joint, Side};
use ademan::pipeline::{Pipeline, SourceRole};
use ademan::setup::Setup;
use ademan::sim::UsTextField;
use ademan::time::Timestamp;

use crate::support::source::{TYPING_RATE_HZ, typing_estimates};
use crate::support::wearer::load_layout;

fn setup(source: &str) -> Setup {
    Setup {
        source: Some(source.parse().expect("a source")),
        role: Some(SourceRole::Both),
        ..Setup::default()
    }
}

/// Steps the pipeline with the packets of a datagram at `time`; appends the events.
fn receive(
    decoder: &mut dyn Decoder,
    datagram: &[u8],
    time: Timestamp,
    pipeline: &mut Pipeline,
    events: &mut Events,
) {
    let mut emit = |packet: ademan::capture::protocol::Packet| {
        let reading = Reading::new(time, Some(Side::Right), packet.sample);
        let _ = pipeline.step(&reading, events);
    };
    decoder.push(datagram, &mut emit);
    decoder.finish(&mut emit);
}

#[test]
fn the_bones_of_a_typing_hand_type_the_same_text() {
    let setup = setup("udp:127.0.0.1:39539?protocol=vmc");
    let mut pipeline = setup.load_files().expect("a valid setup").pipeline();
    let mut decoder = vmc::decoder();
    let mut field = UsTextField::new();
    let mut events = Events::new();
    for (index, estimate) in typing_estimates("Hola").0.iter().enumerate() {
        let bones = BoneRotations {
            right: bones_from_angles(&estimate.angles, Side::Right),
            ..BoneRotations::default()
        };
        let time = Timestamp::from_seconds((index + 1) as f64 / TYPING_RATE_HZ);
        events.clear();
        receive(
            &mut decoder,
            &vmc::encode(&bones),
            time,
            &mut pipeline,
            &mut events,
        );
        events.iter().for_each(|event| field.handle(event));
    }
    assert_eq!(field.text(), "Hola");
    assert_eq!(field.pressed().count(), 0);
    assert_eq!(pipeline.rejected().iter().sum::<u64>(), 0);
}

/// The distance of the pad of the index finger at rest above the key, in millimetres.
const GAP_MM: f32 = 20.0;

/// Returns a layout with a key below the index finger of an arm at rest.
fn key_below_the_finger() -> String {
    let arm = Setup::default()
        .load_files()
        .expect("the default setup")
        .arm;
    let pose = arm.forward(&Estimate::new(Timestamp(0), JointAngles::default()));
    let tip = pose.position(Joint::tip(Finger::Index)).expect("the tip") * 1000.0;
    let height = tip.y - 1000.0 * pose.tip_radius - GAP_MM;
    format!(
        r#"Layout(name: "One key", boards: [
            (pose: (anchor: world, forward_mm: {}, height_mm: {height}), travel_mm: 10,
             keys: [(code: "J", at_mm: ({}, 0), size_mm: Box(15, 15))]),
        ])"#,
        -tip.z, tip.x
    )
}

#[test]
fn a_tracked_wrist_presses_the_key_below_its_index_finger_once() {
    let setup = setup("udp:127.0.0.1:4242?protocol=opentrack");
    let mut pipeline = load_layout(&key_below_the_finger(), setup).pipeline();
    let mut decoder = opentrack::decoder(Joint::Wrist);
    let (mut events, mut transcript) = (Events::new(), Vec::new());
    let still = std::iter::repeat_n(0.0, 60);
    let down = (0..=16).map(|step| -0.2 * f64::from(step));
    let up = (0..=16).rev().map(|step| -0.2 * f64::from(step));
    let heights = still.chain(down).chain(up);
    for (index, centimetres) in heights.enumerate() {
        let datagram = opentrack::encode(&[0.0, centimetres, 0.0, 0.0, 0.0, 0.0]);
        let time = Timestamp(10_000 * (index as u64 + 1));
        events.clear();
        receive(&mut decoder, &datagram, time, &mut pipeline, &mut events);
        transcript.extend(events.iter().filter_map(|event| match event.kind {
            EventKind::KeyDown(key) => Some(format!("down {key}")),
            EventKind::KeyUp(key) => Some(format!("up {key}")),
            _ => None,
        }));
    }
    assert_eq!(transcript, ["down J", "up J"]);
}

#[test]
fn a_displacement_turns_the_hand_about_its_joint_and_leaves_the_elbow() {
    let setup = setup("udp:127.0.0.1:4242?protocol=opentrack");
    let arm = setup.load_files().expect("a valid setup").arm;
    let mut estimate = Estimate::new(Timestamp(0), JointAngles::default());
    let rest = arm.forward(&estimate);
    let mut decoder = opentrack::decoder(Joint::Wrist);
    decoder.push(
        &opentrack::encode(&[10.0, 0.0, 0.0, 90.0, 0.0, 0.0]),
        &mut |_| {},
    );
    decoder.finish(&mut |packet| match packet.sample {
        ademan::capture::Sample::Displacement { displacement } => {
            estimate.displacement = Some(displacement);
        }
        other => panic!("{other:?}"),
    });
    let turned = arm.forward(&estimate);
    let position = |pose: &ademan::kinematics::HandPose, joint| pose.position(joint).unwrap();
    assert_eq!(
        position(&turned, Joint::Elbow),
        position(&rest, Joint::Elbow)
    );
    let wrist = position(&turned, Joint::Wrist) - position(&rest, Joint::Wrist);
    assert!(wrist.distance(glam::Vec3::X * 0.1) < 1e-6, "{wrist}");
    let tip = Joint::tip(Finger::Middle);
    let before = position(&rest, tip) - position(&rest, Joint::Wrist);
    let after = position(&turned, tip) - position(&turned, Joint::Wrist);
    // A quarter turn to the left: forward becomes left.
    let expected = glam::Vec3::new(before.z, before.y, -before.x);
    assert!(after.distance(expected) < 1e-5, "{after}, not {expected}");
}

#[test]
fn an_inertial_sensor_on_the_hand_lowers_the_fingertip_on_a_key_and_raises_it() {
    let setup = setup("serial:/dev/ttyUSB0?protocol=imu");
    let mut pipeline = load_layout(&key_below_the_finger(), setup).pipeline();
    let mut decoder = imu::decoder(&ProtocolOptions::default());
    let (mut events, mut transcript) = (Events::new(), Vec::new());
    // The fingers fall by up to 12° about the axis to the left, which moves the fingertip down by more than the gap.
    let still = std::iter::repeat_n(0.0, 60);
    let down = (0..=24).map(|step| 0.5 * f64::from(step));
    let up = (0..=24).rev().map(|step| 0.5 * f64::from(step));
    for (index, degrees) in still.chain(down).chain(up).enumerate() {
        let (sin, cos) = (degrees.to_radians() / 2.0).sin_cos();
        // Lines are lost, and one has lost digits.
        let line = match index {
            70..73 => continue,
            75 => "0.9,0,0".to_owned(),
            _ => format!("{cos:.5},0,{sin:.5},0\n"),
        };
        let time = Timestamp(10_000 * (index as u64 + 1));
        events.clear();
        receive(
            &mut decoder,
            line.as_bytes(),
            time,
            &mut pipeline,
            &mut events,
        );
        transcript.extend(events.iter().filter_map(|event| match event.kind {
            EventKind::KeyDown(key) => Some(format!("down {key}")),
            EventKind::KeyUp(key) => Some(format!("up {key}")),
            _ => None,
        }));
    }
    assert_eq!(transcript, ["down J", "up J"]);
}
