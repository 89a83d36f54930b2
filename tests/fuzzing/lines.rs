//! All protocols of lines and datagrams: every byte is counted once, for any split of the stream.

use ademan::capture::Sample;
use ademan::capture::body::{BODY_LANDMARKS, BodyLandmarks, Landmark};
use ademan::capture::protocol::{
    Decoder, PROTOCOLS, Protocol, ProtocolOptions, body_landmarks, bvh, hand_landmarks, hc11,
    holistic, joint_sets, markers, opentrack, text_line, vmc,
};
use ademan::estimate::{Estimator, EstimatorSettings};
use ademan::files::Load;
use ademan::hand::{ArmBone, BoneRotations, Joint, JointAngles, JointPositions, Side};
use ademan::layout::Glove;
use glam::DVec3;

/// Protocols with a target of their own: packets without an end mark, and texts that are one packet.
const OTHERS: [&Protocol; 2] = [&hc11::PROTOCOL, &bvh::PROTOCOL];

fn decoder(protocol: &Protocol) -> Box<dyn Decoder> {
    (protocol.decoder)(&ProtocolOptions::default())
}

/// Decodes an input. The first byte is the length of the pieces that the rest arrives in. Returns `true` if there is a
/// line.
pub fn lines(data: &[u8]) -> bool {
    let Some((&length, stream)) = data.split_first() else {
        return false;
    };
    let mut has_line = false;
    for protocol in PROTOCOLS.iter().filter(|it| !OTHERS.contains(it)) {
        let whole = samples(decoder(protocol), stream, stream.len().max(1));
        let cut = samples(decoder(protocol), stream, usize::from(length).max(1));
        assert_eq!(whole, cut, "the lines depend on the split of the stream");
        estimate(&whole);
        has_line |= !whole.is_empty();
    }
    has_line
}

fn samples(mut decoder: Box<dyn Decoder>, stream: &[u8], length: usize) -> Vec<Sample> {
    let mut samples = Vec::new();
    let mut end = 0;
    for piece in stream.chunks(length) {
        decoder.push(piece, &mut |packet| {
            assert!(packet.end >= end, "the ends of packets go backwards");
            end = packet.end;
            samples.push(packet.sample);
        });
    }
    decoder.finish(&mut |packet| samples.push(packet.sample));
    let counts = decoder.stats();
    assert_eq!(counts.readings, samples.len() as u64);
    assert!(counts.skipped_bytes <= counts.bytes);
    assert_eq!(
        (decoder.pending_bytes(), counts.bytes),
        (0, stream.len() as u64)
    );
    samples
}

/// Estimates every sample; the results are finite.
fn estimate(samples: &[Sample]) {
    let glove = Glove::load("lucidgloves").expect("a shipped glove");
    let mut estimator = Estimator::new(EstimatorSettings::default()).with_channels(&glove.map);
    for (number, sample) in samples.iter().enumerate() {
        let reading = ademan::capture::Reading::new(
            ademan::time::Timestamp(33_000 * (number as u64 + 1)),
            Some(Side::ALL[number % Side::COUNT]),
            sample.clone(),
        );
        let Ok(estimate) = estimator.update(&reading) else {
            continue;
        };
        assert!(
            estimate
                .angles
                .radians()
                .iter()
                .all(|angle| angle.is_finite())
        );
        assert!(
            estimate
                .measured
                .iter()
                .all(|(_, position)| position.is_finite())
        );
    }
}

/// Returns a right hand in front of a camera at the origin.
fn hand() -> (Side, JointPositions) {
    let mut positions = JointPositions::default();
    for &joint in &Joint::ALL[Joint::Wrist.index()..] {
        let at = joint.index() as f64;
        positions.set(joint, DVec3::new(0.01 * at, -0.1, -0.3 - 0.002 * at * at));
    }
    (Side::Right, positions)
}

/// Returns a stream of lines of each protocol.
pub fn seeds() -> Vec<Vec<u8>> {
    let body = |number: usize| {
        let landmark = |index: usize| Landmark {
            position: [
                (index * index % 7) as f32 * 0.1,
                (index * number % 5) as f32 * -0.1,
                (index % 3) as f32 * 0.1,
            ],
            confidence: 0.25 * (number % 5) as f32,
        };
        body_landmarks::encode(&BodyLandmarks {
            points: (0..BODY_LANDMARKS).map(landmark).collect(),
        })
    };
    let stream = |text: String| [&[66], text.as_bytes()].concat();
    let valid = vec![
        stream(text_line::encode(&JointAngles::default()).repeat(3)),
        stream((1..5).map(body).collect()),
        stream(
            "A0B4095C2047D-1E99999F2047G2047P4096HJO(AB)2047(EB)0(BAA)1(CAD)4095\r\nA1B2(ZV)3Z\n"
                .into(),
        ),
        stream("0&1023&2047&4095&5&2047&2047&0&1&0&1&0&1\n\r\n".repeat(2)),
        stream(
            (1..4)
                .map(|_| hand_landmarks::encode(None, &[hand()]))
                .collect(),
        ),
        stream(
            (1..4)
                .map(|number| {
                    holistic::join(&body(number), &hand_landmarks::encode(None, &[hand()]))
                })
                .collect(),
        ),
        stream(
            (1..4)
                .map(|time| joint_sets::encode(&joint_sets::OPENXR, Some(time), &[hand()]))
                .collect(),
        ),
        stream(
            (1..4)
                .map(|time| joint_sets::encode(&joint_sets::WEBXR, Some(time), &[hand()]))
                .collect(),
        ),
        [
            &[7],
            &opentrack::encode(&[1.0, -2.0, 3.0, 40.0, -50.0, 60.0])[..],
        ]
        .concat(),
        [vec![9], vmc::encode(&bones())].concat(),
        stream("0.32,0.325,0.217,0.863\n0.225 0.397 0.433 0.777 time_us=5\n".into()),
        stream(markers::encode(Some(1), &hand().1)),
    ];
    [valid, super::hostile::osc()].concat()
}

/// Returns both arms with every bone.
fn bones() -> BoneRotations {
    let mut bones = BoneRotations::default();
    for (index, &bone) in ArmBone::ALL.iter().enumerate() {
        let turn = glam::Quat::from_rotation_x(0.1 * index as f32);
        bones.left.set(bone, turn);
        bones.right.set(bone, turn.inverse());
    }
    bones
}
