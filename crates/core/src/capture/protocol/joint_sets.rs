//! Lines of JSON with the joints of hands that a headset follows: the 26 joints of OpenXR, the 25 of WebXR.
//!
//! ```json
//! {"time_us":12500,"hands":[{"label":"right","joints":[[0.1,1.0,-0.3],[0.1,1.0,-0.4],null,…]}]}
//! ```
//!
//! One object per instant. Joints are in the order of the specifications: OpenXR lists the palm, then the wrist; WebXR begins
//! with the wrist. Each is a position in metres, X to the right, Y up, −Z forward, or `null` if it is not followed, alone or in
//! place of a coordinate. A rotation (x, y, z, w) and a radius may follow the position; they do not count, because angles come
//! from the positions.

use arrayvec::ArrayVec;
use serde::Deserialize;

use super::encoder::{hands, time_us};
use super::lines::{LineDecoder, LineParser};
use super::space::{self, HAND};
use super::tracked_hands::{
    BestHands, Label, MAX_HANDS, MIN_SCORE, RATE, TrackedHands, TrackedPosition, certain,
    check_score,
};
use super::{
    Carriers, Encoder, EncoderPlan, InvalidPacket, Packet, PacketError, PositionNoise, Protocol,
    ProtocolOptions,
};
use crate::capture::SampleKind;
use crate::hand::{Joint, JointPositions, Side};

/// Number of joints of OpenXR.
pub const OPENXR_JOINTS: usize = 26;

/// Number of joints of WebXR.
pub const WEBXR_JOINTS: usize = 25;

/// The protocol of the joints of OpenXR.
pub const OPENXR: Protocol = protocol::<OPENXR_JOINTS>(
    "openxr",
    "26 joints of OpenXR for each hand, as lines of JSON",
    |_, _| Ok(encoder(&OPENXR)),
);

/// The protocol of the joints of WebXR.
pub const WEBXR: Protocol = protocol::<WEBXR_JOINTS>(
    "webxr",
    "25 joints of WebXR for each hand, as lines of JSON",
    |_, _| Ok(encoder(&WEBXR)),
);

const fn protocol<const JOINTS: usize>(
    name: &'static str,
    summary: &'static str,
    encoder: fn(&ProtocolOptions, &EncoderPlan) -> Result<Encoder, String>,
) -> Protocol {
    Protocol {
        name,
        summary,
        sample: SampleKind::Joints,
        has_both_hands: true,
        has_parts: false,
        position_noise: PositionNoise::None,
        carriers: Carriers::Any,
        // Joints whose numbers have one digit. Lines without hands are shorter, and they are few.
        min_packet_bytes: 8 * JOINTS,
        default_baud: None,
        feedback: None,
        options: &[&HAND, &MIN_SCORE, &RATE],
        nominal_rate_hz: |options| Some(space::number(options, &RATE)),
        decoder: |options| {
            Box::new(LineDecoder::with_parser(JointParser::<JOINTS>::new(
                options,
            )))
        },
        encoder,
    }
}

fn encoder(protocol: &'static Protocol) -> Encoder {
    Box::new(|readings, bytes| {
        let line = encode(protocol, time_us(readings), &hands(readings));
        bytes.extend(line.into_bytes());
    })
}

/// Largest coordinate, in metres: no room is larger.
const MAX_COORDINATE: f64 = 100.0;

/// Parser of lines of hands with `JOINTS` joints, the last of which are [`WEBXR_JOINTS`].
#[derive(Clone, Debug)]
struct JointParser<const JOINTS: usize> {
    min_score: f64,
    hands: TrackedHands,
}

/// The hands at one instant.
#[derive(Debug, Deserialize)]
struct Line {
    time_us: Option<u64>,
    hands: ArrayVec<Hand, MAX_HANDS>,
}

#[derive(Debug, Deserialize)]
struct Hand {
    label: Label,
    #[serde(default = "certain")]
    score: f64,
    joints: ArrayVec<TrackedPosition, OPENXR_JOINTS>,
}

impl<const JOINTS: usize> JointParser<JOINTS> {
    fn new(options: &ProtocolOptions) -> Self {
        Self {
            min_score: space::number(options, &MIN_SCORE),
            hands: TrackedHands::new(space::number(options, &RATE)),
        }
    }

    /// Returns the joints of a hand that is followed.
    fn positions(hand: &Hand) -> Result<JointPositions, PacketError> {
        if hand.joints.len() != JOINTS {
            let text = format!("{} joints instead of {JOINTS}", hand.joints.len());
            return Err(PacketError::new(InvalidPacket::WrongSize, text));
        }
        let mut positions = JointPositions::default();
        let joints = &Joint::ALL[Joint::Wrist.index()..];
        let listed = &hand.joints[JOINTS - WEBXR_JOINTS..];
        for (&joint, TrackedPosition(position)) in joints.iter().zip(listed) {
            let Some(position) = position else {
                continue;
            };
            if position.iter().any(|axis| axis.abs() > MAX_COORDINATE) {
                let text = format!("the joint `{joint}` is more than {MAX_COORDINATE} m away");
                return Err(PacketError::new(InvalidPacket::NotFinite, text));
            }
            positions.set(joint, (*position).into());
        }
        Ok(positions)
    }
}

impl<const JOINTS: usize> LineParser for JointParser<JOINTS> {
    /// Four hands of 26 joints of eight numbers with 22 digits are 20 kB; the rest is for other fields.
    const MAX_LINE_BYTES: usize = 32 * 1024;

    fn parse(&mut self, line: &[u8], emit: &mut dyn FnMut(Packet)) -> Result<(), PacketError> {
        let line: Line = serde_json::from_slice(line)?;
        let mut best = BestHands::new(self.min_score);
        for hand in &line.hands {
            check_score(hand.score)?;
            let positions = Self::positions(hand)?;
            if !positions.is_empty() {
                best.add(hand.label.0, hand.score, positions);
            }
        }
        let time = self.hands.start_line(line.time_us)?;
        self.hands.emit(time, best.hands(), emit);
        Ok(())
    }

    fn reset(&mut self) {
        self.hands.reset();
    }
}

/// Writes hands with their positions in the world as a line of `protocol` with its line end.
pub fn encode(
    protocol: &Protocol,
    time_us: Option<u64>,
    hands: &[(Side, JointPositions)],
) -> String {
    let hands = hands.iter().map(|(side, positions)| {
        let listed = Joint::ALL[Joint::Wrist.index()..].iter();
        let listed = listed.map(|&joint| positions.get(joint).map(|at| at.to_array()));
        // The palm is half-way along the middle metacarpal; readers that need it compute it.
        let palm = (*protocol == OPENXR).then_some(None);
        let joints: Vec<Option<[f64; 3]>> = palm.into_iter().chain(listed).collect();
        serde_json::json!({ "label": side, "joints": joints })
    });
    let hands: Vec<_> = hands.collect();
    let line = match time_us {
        Some(time) => serde_json::json!({ "time_us": time, "hands": hands }),
        None => serde_json::json!({ "hands": hands }),
    };
    format!("{line}\n")
}

#[cfg(test)]
mod tests {
    use glam::DVec3;

    use super::*;
    use crate::capture::Sample;

    /// Returns a hand whose joints are known but for one fingertip.
    fn hand() -> JointPositions {
        let mut positions = JointPositions::default();
        for &joint in &Joint::ALL[Joint::Wrist.index()..] {
            let at = joint.index() as f64;
            if joint != Joint::RingTip {
                positions.set(joint, DVec3::new(0.01 * at, 1.0, -0.3));
            }
        }
        positions
    }

    fn decode(
        protocol: &Protocol,
        lines: &[String],
    ) -> (Vec<Packet>, super::super::InvalidPackets) {
        let mut decoder = (protocol.decoder)(&ProtocolOptions::default());
        let mut packets = Vec::new();
        for line in lines {
            decoder.push(line.as_bytes(), &mut |packet| packets.push(packet));
        }
        (packets, decoder.stats().invalid)
    }

    fn joints(packet: &Packet) -> &JointPositions {
        match &packet.sample {
            Sample::Joints { positions } => positions,
            other => panic!("{other:?}"),
        }
    }

    #[test]
    fn encoded_hands_are_decoded_with_their_sides() {
        for protocol in [&OPENXR, &WEBXR] {
            let both = [(Side::Left, hand()), (Side::Right, hand())];
            let (packets, _) = decode(protocol, &[encode(protocol, Some(5), &both)]);
            let sides: Vec<_> = packets.iter().map(|packet| packet.side).collect();
            assert_eq!(sides, [Some(Side::Left), Some(Side::Right)]);
            assert!(packets.iter().all(|packet| *joints(packet) == hand()));
        }
    }

    #[test]
    fn rotations_and_radii_do_not_count_and_a_hand_that_disappears_has_no_joints() {
        let plain = encode(&WEBXR, None, &[(Side::Right, hand())]);
        let full = plain.replace(",-0.3]", ",-0.3,0.0,0.7,0.0,0.7,0.01]");
        let empty = "{\"hands\":[]}\n".to_owned();
        let low = plain.replacen("{\"joints\"", "{\"score\":0.4,\"joints\"", 1);
        let (packets, invalid) = decode(&WEBXR, &[empty.clone(), full, empty, low]);
        assert_eq!(invalid.total(), 0);
        let known: Vec<_> = packets.iter().map(|p| joints(p).known().count()).collect();
        assert_eq!(known, [24, 0, 0], "nothing before the hand was seen");
    }

    #[test]
    fn a_joint_whose_numbers_are_nan_in_javascript_is_not_followed_and_its_radius_does_not_count() {
        let plain = encode(&WEBXR, None, &[(Side::Right, hand())]);
        let mut line: serde_json::Value = serde_json::from_str(&plain).expect("a line of JSON");
        let listed = line["hands"][0]["joints"]
            .as_array_mut()
            .expect("the joints");
        listed[0] = serde_json::json!([null, null, null]);
        let rotation_and_radius = serde_json::json!([0, 0, 0, 1, null]);
        let numbers = rotation_and_radius.as_array().expect("a list").clone();
        listed[1]
            .as_array_mut()
            .expect("a position")
            .extend(numbers);
        let (packets, invalid) = decode(&WEBXR, &[format!("{line}\n")]);
        assert_eq!((packets.len(), invalid.total()), (1, 0));
        let known: Vec<_> = joints(&packets[0])
            .known()
            .map(|(joint, _)| joint)
            .collect();
        let followed = hand();
        let followed = followed.known().map(|(joint, _)| joint);
        let expected: Vec<_> = followed.filter(|&joint| joint != Joint::Wrist).collect();
        assert_eq!(known, expected);
    }

    #[test]
    fn invalid_lines_are_counted_by_reason() {
        let valid = encode(&OPENXR, Some(2_000_000), &[(Side::Right, hand())]);
        let with = |from: &str, to: &str| {
            let line = valid.replacen(from, to, 1);
            assert_ne!(line, valid);
            line.replace("2000000", "3000000")
        };
        for (line, reason) in [
            (format!("{}\n", &valid[..99]), InvalidPacket::Truncated),
            (with("[null,", "["), InvalidPacket::WrongSize),
            (with("[null,", "[null,null,"), InvalidPacket::WrongSize),
            (with("-0.3]", "-0.3,0,0,0,0,0,0]"), InvalidPacket::WrongSize),
            (with("1.0,", "1e300,"), InvalidPacket::NotFinite),
            (with("1.0,", "1e999,"), InvalidPacket::NotFinite),
            (valid.clone(), InvalidPacket::OutOfOrder),
            (valid.replace("2000000", "1000001"), InvalidPacket::TooOld),
            (with("right", "up"), InvalidPacket::Unknown),
            ("{}\n".to_owned(), InvalidPacket::Unknown),
        ] {
            let (packets, invalid) = decode(&OPENXR, &[valid.clone(), line.clone()]);
            assert_eq!((packets.len(), invalid.get(reason)), (1, 1), "{line}");
        }
    }
}
