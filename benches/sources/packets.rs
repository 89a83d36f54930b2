//! The packets of a simulated person who types, by protocol.

use std::time::Duration;

use ademan::capture::protocol::{Carriers, EncoderPlan};
use ademan::capture::{Reading, Sample, SampleKind, SourceUri, StreamFormat};
use ademan::hand::{Joint, JointPositions, Side};
use ademan::layout::Person;
use ademan::setup::{LoadedSetup, OtherHand, Setup};
use ademan::sim::{
    Sensor, SimulatedTypist, TypingKeys, TypistSettings, packet_period, taps_for_text,
};
use ademan::time::Timestamp;
use glam::DVec3;
use serde_json::json;

const TEXT: &str = "the quick brown fox";

/// Markers that each camera sees.
const MARKERS: usize = 40;

/// A setup and the packets of its source.
pub struct Stream {
    pub setup: Setup,
    pub packets: Vec<Vec<u8>>,
    pub period: Duration,
    pub is_datagram: bool,
}

/// Returns a setup whose source has this protocol.
fn setup(protocol: &str) -> (Setup, StreamFormat) {
    let carrier = match protocol {
        "vmc" | "opentrack" => "udp:127.0.0.1:9000",
        _ => "file:x",
    };
    let source: SourceUri = format!("{carrier}?protocol={protocol}")
        .parse()
        .expect("a source");
    let format = source.format().expect("a stream").clone();
    let setup = Setup {
        source: Some(source),
        ..Setup::default()
    };
    (setup, format)
}

/// Returns what the sensor of one hand measures in each packet.
fn samples(setup: &LoadedSetup, kind: SampleKind, format: &StreamFormat) -> Vec<Sample> {
    let map = setup.glove.as_ref().map(|glove| &glove.map);
    let sensor = Sensor::for_kind(kind, map).expect("a sensor");
    let settings = TypistSettings {
        name: "bench".into(),
        packet_period: packet_period(format),
        noise: 0.0,
        seed: 0,
        person: Person::default(),
        keys: TypingKeys::default(),
    };
    let taps = taps_for_text(TEXT, &setup.layout, false).expect("keys");
    let hands = [(&setup.arm, sensor)];
    let typist = SimulatedTypist::with_hands(&settings, &taps, &setup.layout.scene, &hands);
    let mut typist = typist.expect("keys in reach");
    std::iter::from_fn(|| typist.next_samples())
        .map(|mut samples| samples.remove(0).1)
        .collect()
}

/// Returns the packets of one hand.
pub fn typing(protocol: &str) -> Stream {
    let (setup, format) = setup(protocol);
    let loaded = setup.clone().load_files().expect("a valid setup");
    let samples = samples(&loaded, format.protocol.sample, &format);
    encode(setup, &format, samples, |time, sample| {
        vec![Reading::new(time, Some(Side::Right), sample)]
    })
}

/// Returns the packets of two hands that type the same, mirrored.
pub fn both_hands(protocol: &str) -> Stream {
    let (setup, format) = setup(protocol);
    let setup = Setup {
        other_hand: Some(OtherHand::default()),
        ..setup
    };
    let loaded = setup.clone().load_files().expect("a valid setup");
    let samples = samples(&loaded, format.protocol.sample, &format);
    encode(setup, &format, samples, |time, sample| {
        let left = Reading::new(time, Some(Side::Left), mirrored(&sample));
        vec![left, Reading::new(time, Some(Side::Right), sample)]
    })
}

fn encode(
    setup: Setup,
    format: &StreamFormat,
    samples: Vec<Sample>,
    readings: impl Fn(Timestamp, Sample) -> Vec<Reading>,
) -> Stream {
    let packet_period = packet_period(format);
    let count = samples.len() as u64;
    let plan = EncoderPlan {
        packet_period,
        count_packets: &|| count,
    };
    let mut encoder = format.encoder(&plan).expect("an encoder");
    let packet = |(number, sample)| {
        let time = Timestamp(0) + packet_period * (number as u32 + 1);
        let mut bytes = Vec::new();
        encoder(&readings(time, sample), &mut bytes);
        bytes
    };
    Stream {
        packets: samples.into_iter().enumerate().map(packet).collect(),
        setup,
        period: packet_period,
        is_datagram: format.protocol.carriers == Carriers::Datagrams,
    }
}

/// Returns the sample of the other hand.
fn mirrored(sample: &Sample) -> Sample {
    let mut sample = sample.clone();
    match &mut sample {
        Sample::Joints { positions } => {
            for (joint, position) in positions.clone().known() {
                positions.set(joint, position.with_x(-position.x));
            }
        }
        Sample::Bones { bones } => bones.left = bones.right,
        Sample::Body(body) => {
            for pair in body.points[11..25].chunks_exact_mut(2) {
                let [x, y, z] = pair[1].position;
                pair[0].position = [-x, y, z];
                pair[0].confidence = pair[1].confidence;
            }
        }
        _ => {}
    }
    sample
}

/// Returns a setup and the joint positions of its typing hand.
pub fn positions() -> (LoadedSetup, Vec<Sample>) {
    let (setup, format) = setup("openxr");
    let setup = setup.load_files().expect("a valid setup");
    let samples = samples(&setup, SampleKind::Joints, &format);
    (setup, samples)
}

/// Returns the lines of four cameras, of which the first ones label their markers.
pub fn markers(labelling_cameras: usize) -> Stream {
    let (setup, format) = setup("markers");
    let loaded = setup.clone().load_files().expect("a valid setup");
    let samples = samples(&loaded, SampleKind::Joints, &format);
    let line = |(number, sample): (usize, &Sample)| match sample {
        Sample::Joints { positions } => {
            let time_us = 10_000 * (number + 1);
            format!("{}\n", marker_line(time_us, positions, labelling_cameras)).into_bytes()
        }
        _ => Vec::new(),
    };
    Stream {
        packets: samples.iter().enumerate().map(line).collect(),
        setup,
        period: Duration::from_millis(10),
        is_datagram: false,
    }
}

fn marker_line(
    time_us: usize,
    positions: &JointPositions,
    labelling_cameras: usize,
) -> serde_json::Value {
    const CAMERAS: [DVec3; 4] = [
        DVec3::new(0.8, 1.0, 0.3),
        DVec3::new(-0.9, 0.9, -0.2),
        DVec3::new(0.1, 1.2, -1.4),
        DVec3::new(0.9, 0.4, -0.9),
    ];
    let joints = positions
        .known()
        .map(|(joint, at)| (joint.name().to_owned(), at));
    // Markers of the other arm and of the trunk.
    let others = (Joint::COUNT..).map(|number| {
        let (sine, cosine) = (number as f64 * 2.4).sin_cos();
        let at = DVec3::new(-0.4 + 0.2 * cosine, 0.02 * number as f64 - 0.5, 0.2 * sine);
        (format!("other-{number}"), at)
    });
    let all: Vec<(String, DVec3)> = joints.chain(others).take(MARKERS).collect();
    let camera = |(index, camera): (usize, &DVec3)| {
        let markers = all.iter().map(|(label, at)| {
            let direction = (*at - *camera)
                .to_array()
                .map(|axis| (axis * 1e6).round() / 1e6);
            if index < labelling_cameras {
                json!({ "label": label, "direction": direction })
            } else {
                json!({ "direction": direction })
            }
        });
        json!({ "position": camera.to_array(), "markers": markers.collect::<Vec<_>>() })
    };
    let cameras: Vec<_> = CAMERAS.iter().enumerate().map(camera).collect();
    json!({ "time_us": time_us, "cameras": cameras })
}
