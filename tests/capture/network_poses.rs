//! Datagrams of opentrack and VMC on real sockets; the package python-osc makes datagrams of VMC too.

use std::net::{SocketAddr, UdpSocket};
use std::process::Command;
use std::time::Instant;

use ademan::capture::protocol::{InvalidPacket, opentrack};
use ademan::capture::{CaptureEvent, Reading, Sample, Source, SourceEvent, open, spawn};
use ademan::hand::{ArmBone, BoneRotations, Displacement, Joint};
use glam::{Quat, Vec3};

use crate::serial::wait_for_warning;
use crate::support::free_address::free_address;
use crate::support::python::python;
use crate::text_line::{TIMEOUT, samples, uri};

/// Opens a source of datagrams in this format at a free port.
fn open_at_free_port(format: &str) -> (Box<dyn Source>, SocketAddr) {
    let address = free_address();
    let source = open(&uri(&format!("udp:{address}?protocol={format}"))).expect("the port is free");
    (source, address)
}

#[test]
fn datagrams_of_opentrack_of_another_size_are_dropped() {
    let (mut source, address) = open_at_free_port("opentrack&joint=elbow");
    let sender = UdpSocket::bind("127.0.0.1:0").expect("a free port");
    let pose = opentrack::encode(&[10.0, 20.0, -30.0, 0.0, 0.0, 0.0]);
    let not_finite = opentrack::encode(&[f64::NAN; 6]);
    for datagram in [
        &pose[..47],
        &[&pose[..], b"\0"].concat(),
        b"",
        &not_finite,
        &pose,
    ] {
        sender.send_to(datagram, address).unwrap();
    }
    let position = Vec3::new(0.1, 0.2, -0.3);
    let displacement = Displacement::new(Joint::Elbow, position, Quat::IDENTITY);
    let received = samples(&mut *source, 1);
    assert_eq!(received, [Sample::Displacement { displacement }]);
    let stats = source.stats();
    assert_eq!((stats.readings, stats.skipped_bytes), (1, 47 + 49 + 48));
    for reason in [
        InvalidPacket::Truncated,
        InvalidPacket::WrongSize,
        InvalidPacket::NotFinite,
    ] {
        assert_eq!(stats.invalid.get(reason), 1, "{reason}");
    }
}

#[test]
fn datagrams_of_another_sender_are_dropped_until_the_first_is_silent() {
    let (mut source, address) = open_at_free_port("opentrack");
    let [first, second] = [0, 1].map(|_| UdpSocket::bind("127.0.0.1:0").expect("a free port"));
    let pose = |x: f64| opentrack::encode(&[x, 0.0, 0.0, 0.0, 0.0, 0.0]);
    let position = |sample: &Sample| match sample {
        Sample::Displacement { displacement } => displacement.translation().x,
        other => panic!("{other:?}"),
    };
    for (socket, x) in [
        (&first, 1.0),
        (&second, 90.0),
        (&first, 2.0),
        (&second, 91.0),
    ] {
        socket.send_to(&pose(x), address).unwrap();
    }
    let received = samples(&mut *source, 2);
    assert_eq!(
        received.iter().map(position).collect::<Vec<_>>(),
        [0.01, 0.02]
    );
    assert_eq!(source.stats().invalid.get(InvalidPacket::UnknownSender), 1);
    // The second one continues alone.
    let start = Instant::now();
    loop {
        second.send_to(&pose(92.0), address).unwrap();
        match source.next().expect("the source has no errors") {
            SourceEvent::Reading(reading) => {
                assert_eq!(position(&reading.sample), 0.92);
                break;
            }
            _ => assert!(start.elapsed() < TIMEOUT, "never accepted"),
        }
    }
    assert!(source.stats().invalid.get(InvalidPacket::UnknownSender) > 2);
}

#[test]
fn datagrams_that_are_no_packets_keep_no_sender_out() {
    let (mut source, address) = open_at_free_port("opentrack");
    let [glove, other] = [0, 1].map(|_| UdpSocket::bind("127.0.0.1:0").expect("a free port"));
    let pose = |x: f64| opentrack::encode(&[x, 0.0, 0.0, 0.0, 0.0, 0.0]);
    let mut received = 0;
    for _ in 0..20 {
        for junk in [&b""[..], b"junk", &opentrack::encode(&[f64::NAN; 6])] {
            other.send_to(junk, address).unwrap();
        }
        glove.send_to(&pose(1.0), address).unwrap();
        for _ in 0..5 {
            let event = source.next().expect("the source has no errors");
            received += usize::from(matches!(event, SourceEvent::Reading(_)));
        }
    }
    assert!(received >= 10, "{received} of 20");
    // A sender that was active keeps no other one out with junk either.
    let start = Instant::now();
    loop {
        glove.send_to(b"junk", address).unwrap();
        other.send_to(&pose(2.0), address).unwrap();
        match source.next().expect("the source has no errors") {
            SourceEvent::Reading(Reading {
                sample: Sample::Displacement { displacement },
                ..
            }) if displacement.translation().x == 0.02 => break,
            _ => assert!(start.elapsed() < TIMEOUT, "never accepted"),
        }
    }
}

/// Returns an OSC message with these floats.
fn osc(address: &str, name: Option<&str>, floats: &[f32]) -> Vec<u8> {
    let padded = |text: &str| {
        let mut bytes = text.as_bytes().to_vec();
        bytes.resize(bytes.len() / 4 * 4 + 4, 0);
        bytes
    };
    let types = if name.is_some() { "s" } else { "" };
    let types = format!(",{types}{}", "f".repeat(floats.len()));
    let numbers = floats.iter().flat_map(|number| number.to_be_bytes());
    let mut bytes = padded(address);
    bytes.extend(padded(&types));
    bytes.extend(name.map(padded).unwrap_or_default());
    bytes.extend(numbers);
    bytes
}

/// Checks that a frame of a second sender, which sends `start` before it, has no bone of the first one.
fn check_frame_after_another_sender(start: &[&[u8]]) {
    let (mut source, address) = open_at_free_port("vmc");
    let [first, second] = [0, 1].map(|_| UdpSocket::bind("127.0.0.1:0").expect("a free port"));
    let bone = |name| {
        let numbers = [0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 1.0];
        osc("/VMC/Ext/Bone/Pos", Some(name), &numbers)
    };
    first.send_to(&bone("LeftHand"), address).unwrap();
    let frame = [bone("RightHand"), osc("/VMC/Ext/T", None, &[1.0])];
    for datagram in start.iter().copied().chain(frame.iter().map(Vec::as_slice)) {
        second.send_to(datagram, address).unwrap();
    }
    let Sample::Bones { bones } = samples(&mut *source, 1).remove(0) else {
        panic!("not bones");
    };
    assert_eq!(bones.left.known().count(), 0, "of the first sender");
    assert_eq!(bones.right.known().count(), 1);
}

#[test]
fn no_frame_is_made_of_the_datagrams_of_two_senders() {
    check_frame_after_another_sender(&[]);
}

#[test]
fn an_empty_datagram_does_not_let_the_bones_of_another_sender_pass_for_its_own() {
    check_frame_after_another_sender(&[&b""[..]]);
}

#[test]
fn a_single_datagram_of_another_sender_is_reported_without_another_one() {
    let (source, address) = open_at_free_port("opentrack");
    let [first, second] = [0, 1].map(|_| UdpSocket::bind("127.0.0.1:0").expect("a free port"));
    let pose = opentrack::encode(&[1.0; 6]);
    let capture = spawn(source).expect("a thread");
    first.send_to(&pose, address).unwrap();
    let counted = |event: CaptureEvent| match event {
        CaptureEvent::Reading { stats, .. } | CaptureEvent::Noise(stats) => {
            stats.invalid.get(InvalidPacket::UnknownSender)
        }
        other => panic!("{other:?}"),
    };
    assert_eq!(counted(capture.events().recv_timeout(TIMEOUT).unwrap()), 0);
    // Nothing else arrives after it.
    second.send_to(&pose, address).unwrap();
    assert_eq!(counted(capture.events().recv_timeout(TIMEOUT).unwrap()), 1);
}

#[test]
fn an_address_without_a_datagram_gives_a_warning() {
    let (mut source, address) = open_at_free_port("opentrack");
    let warning = format!("no datagram has arrived at udp:{address}?protocol=opentrack for 5 s");
    wait_for_warning(&mut *source, &warning);
}

/// Sends a frame as several programs do: bones in two bundles, the last of them inside the bundle of the state, with
/// additional arguments, a message that is not valid, an unknown bone and one of the body.
const SENDER: &str = r##"
import sys, math
from pythonosc import osc_bundle_builder, osc_message_builder, udp_client

def message(address, *arguments):
    builder = osc_message_builder.OscMessageBuilder(address)
    for argument in arguments:
        builder.add_arg(argument)
    return builder.build()

def bone(name, x, y, z, w, *more):
    return message("/VMC/Ext/Bone/Pos", name, 0.1, 0.2, 0.3, x, y, z, w, *more)

def bundle(*contents):
    builder = osc_bundle_builder.OscBundleBuilder(osc_bundle_builder.IMMEDIATELY)
    for content in contents:
        builder.add_content(content)
    return builder.build()

half = math.sqrt(0.5)
client = udp_client.UDPClient("127.0.0.1", int(sys.argv[1]))
client.send(bundle(
    bone("Hips", 0.0, 0.0, 0.0, 1.0),
    bone("RightLowerArm", 0.0, half, 0.0, half),
    bone("RightHand", 0.0, 0.0, 0.0, 0.0),
    bone("RightTentacle", 0.0, 0.0, 0.0, 1.0),
))
client.send(bundle(
    message("/VMC/Ext/Root/Pos", "root", 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 1.0),
    message("/VMC/Ext/OK", 1, 3, 0, 1),
    message("/VMC/Ext/T", 1.5),
    bundle(
        bone("LeftLittleDistal", half, 0.0, 0.0, half, 1.0, "more"),
        message("/VMC/Ext/Bone/Pos", "LeftHand", 1.0),
        message("/VMC/Ext/Blend/Val", "A", 0.5),
    ),
))
"##;

#[test]
fn bundles_of_python_osc_are_read_and_bad_messages_left_out() {
    let python = match python("osc-sender", "pythonosc", &["python-osc==1.10.2"]) {
        Ok(python) => python,
        Err(reason) => {
            println!("SKIPPED: cannot install the package python-osc: {reason}");
            return;
        }
    };
    let (mut source, address) = open_at_free_port("vmc");
    let sent = Command::new(python)
        .args(["-c", SENDER, &address.port().to_string()])
        .output()
        .expect("Python starts");
    let messages = String::from_utf8_lossy(&sent.stderr);
    assert!(sent.status.success(), "{messages}");
    let half = std::f32::consts::FRAC_1_SQRT_2;
    let mut expected = BoneRotations::default();
    let turned = Quat::from_xyzw(0.0, -half, 0.0, half);
    expected.right.set(ArmBone::LowerArm, turned);
    let bent = Quat::from_xyzw(-half, 0.0, 0.0, half);
    expected.left.set(ArmBone::LittleThird, bent);
    let Sample::Bones { bones } = samples(&mut *source, 1).remove(0) else {
        panic!("not bones");
    };
    for (found_arm, expected_arm) in [(bones.left, expected.left), (bones.right, expected.right)] {
        let names = |arm: &ademan::hand::ArmRotations| -> Vec<ArmBone> {
            arm.known().map(|(bone, _)| bone).collect()
        };
        assert_eq!(names(&found_arm), names(&expected_arm));
        for (bone, rotation) in expected_arm.known() {
            assert!(found_arm.get(bone).unwrap().abs_diff_eq(rotation, 1e-6));
        }
    }
    let stats = source.stats();
    assert_eq!((stats.readings, stats.skipped_bytes), (1, 0));
    assert_eq!(stats.invalid.total(), 2, "one in each datagram");
}
