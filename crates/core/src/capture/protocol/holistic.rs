//! Lines of JSON with a body and its hands, as the holistic model of MediaPipe finds them in one image.
//!
//! ```json
//! {"time_us":12500,"image_size":[640,480],"pose_world_landmarks":[[0.06,-0.65,-0.12,0.99],…],
//!  "hands":[{"label":"right","image":[[0.52,0.81,0.0],…],"world":[[0.01,0.07,0.02],…]}]}
//! ```
//!
//! A line has the fields of [`body_landmarks`] and of [`hand_landmarks`], with their limits. The body places the arms, and the
//! hands hang from its wrists. A body that is not seen is missing or `null`.
//!
//! Arms are measured from the trunk, hands from the camera. A hand that a camera in front of the person sees is therefore turned about
//! its wrist to the axes of the trunk, or a person who leans back would bend the wrists. A mirrored image shows the body
//! mirrored, too.

use arrayvec::ArrayVec;
use glam::{DMat3, DVec3};
use serde::Deserialize;

use super::hand_landmarks::{Hand, HandParser};
use super::lines::{LineDecoder, LineParser};
use super::tracked_hands::MAX_HANDS;
use super::{Packet, PacketError, Protocol, ProtocolOptions, body_landmarks, hand_landmarks};
use crate::capture::Sample;
use crate::capture::body::{BODY_LANDMARKS, BodyLandmarks, Landmark};
use crate::hand::{HandPart, Joint, JointPositions, Side};

/// The protocol of holistic landmarks.
pub const PROTOCOL: Protocol = Protocol {
    name: "holistic",
    summary: "33 body landmarks and 21 landmarks of each hand of MediaPipe, as lines of JSON",
    has_parts: true,
    decoder: |options| Box::new(decoder(options)),
    encoder: |_, _| {
        Err(
            "a simulated camera finds a body or hands; use `body-landmarks` or `hand-landmarks`"
                .to_owned(),
        )
    },
    ..hand_landmarks::PROTOCOL
};

/// Creates a decoder at the start of a stream.
pub fn decoder(options: &ProtocolOptions) -> LineDecoder<HolisticParser> {
    LineDecoder::with_parser(HolisticParser {
        hands: HandParser::new(options),
        trunk_from_camera: [None; Side::COUNT],
    })
}

/// The left shoulder and the left hip; the right ones follow.
const SHOULDERS: usize = 11;
const HIPS: usize = 23;

/// Parser of lines with a body and its hands.
#[derive(Clone, Debug)]
pub struct HolisticParser {
    hands: HandParser,
    /// The rotations, by side, that the latest body gives its hands.
    trunk_from_camera: [Option<DMat3>; Side::COUNT],
}

/// The fields of a line that count.
#[derive(Deserialize)]
struct Line {
    time_us: Option<u64>,
    image_size: Option<[f64; 2]>,
    pose_world_landmarks: Option<ArrayVec<Landmark, BODY_LANDMARKS>>,
    hands: ArrayVec<Hand, MAX_HANDS>,
}

impl LineParser for HolisticParser {
    /// The sum of the limits of both protocols.
    const MAX_LINE_BYTES: usize = 48 * 1024;

    fn parse(&mut self, line: &[u8], emit: &mut dyn FnMut(Packet)) -> Result<(), PacketError> {
        let line: Line = serde_json::from_slice(line)?;
        let body = line.pose_world_landmarks.map(body_landmarks::body);
        let body = body.transpose()?;
        let mut hands = *self.hands.best_hands(&line.hands, line.image_size)?.hands();
        let line_time = self.hands.hands.start_line(line.time_us)?;
        if let Some(mut body) = body {
            if self.hands.is_mirrored() {
                flip(&mut body);
            }
            self.see_trunk(&body);
            emit(Packet {
                time: Some(line_time.time),
                sent_at: line_time.stated,
                part: Some(HandPart::Arm),
                ..Packet::new(Sample::Body(body), 0)
            });
        }
        for (hand, rotation) in hands.iter_mut().zip(self.trunk_from_camera) {
            if let (Some(positions), Some(rotation)) = (hand, rotation) {
                *positions = turned(positions, rotation);
            }
        }
        self.hands.hands.emit(line_time, &hands, &mut |packet| {
            emit(Packet {
                part: Some(HandPart::Fingers),
                ..packet
            });
        });
        Ok(())
    }

    fn reset(&mut self) {
        self.hands.reset();
        self.trunk_from_camera = [None; Side::COUNT];
    }
}

impl HolisticParser {
    /// Sets the axes of the trunk from a body. A trunk without a direction changes nothing. Other cameras than one in front of the
    /// person move with the person, or see no trunk.
    fn see_trunk(&mut self, body: &BodyLandmarks) {
        if !self.hands.is_camera_in_front() {
            return;
        }
        for &side in Side::ALL {
            let latest = &mut self.trunk_from_camera[side.index()];
            *latest = trunk_from_camera(body, side).or(*latest);
        }
    }
}

/// Returns the rotation from the axes in which a camera in front of the person shows hands to the axes in which the arm of a side is
/// measured: to the right along the shoulders, up the trunk, and backwards.
fn trunk_from_camera(body: &BodyLandmarks, side: Side) -> Option<DMat3> {
    let at = |landmark: usize| {
        let [x, y, z] = body.points[landmark].position.map(f64::from);
        DVec3::new(-x, -y, z)
    };
    let across = at(SHOULDERS + Side::Right.index()) - at(SHOULDERS + Side::Left.index());
    let right = across.try_normalize()?;
    let upward = at(SHOULDERS + side.index()) - at(HIPS + side.index());
    let up = upward.reject_from_normalized(right).try_normalize()?;
    Some(DMat3::from_cols(right, up, right.cross(up)).transpose())
}

/// Returns a hand that is turned about its wrist.
fn turned(positions: &JointPositions, rotation: DMat3) -> JointPositions {
    let wrist = positions.get(Joint::Wrist).unwrap_or_default();
    let mut turned = *positions;
    for (joint, position) in positions.known() {
        turned.set(joint, wrist + rotation * (position - wrist));
    }
    turned
}

/// Mirrors a body back that was found in a mirrored image, where its left side is the right one.
fn flip(body: &mut BodyLandmarks) {
    for landmark in &mut body.points {
        landmark.position[0] = -landmark.position[0];
    }
    // The nose is alone, each eye has three landmarks, and the others are pairs.
    let (left_eye, rest) = body.points[1..].split_at_mut(3);
    let (right_eye, pairs) = rest.split_at_mut(3);
    left_eye.swap_with_slice(right_eye);
    for pair in pairs.chunks_exact_mut(2) {
        pair.swap(0, 1);
    }
}

/// Joins a line of [`body_landmarks::encode`] and one of [`hand_landmarks::encode`].
pub fn join(body: &str, hands: &str) -> String {
    let body = body.trim_end().trim_end_matches('}');
    let hands = hands.trim_start_matches('{');
    format!("{body},{hands}")
}

#[cfg(test)]
mod tests {
    use glam::DQuat;

    use super::*;
    use crate::capture::protocol::{Decoder, InvalidPacket};
    use crate::hand::Finger;
    use crate::time::Timestamp;

    fn body() -> String {
        let landmark = |index: usize| Landmark {
            position: [0.01 * index as f32, -0.5, 0.25],
            confidence: 0.5,
        };
        body_landmarks::encode(&BodyLandmarks {
            points: (0..BODY_LANDMARKS).map(landmark).collect(),
        })
    }

    /// Returns a line with a hand whose fingers are straight.
    fn hands(time_us: u64) -> String {
        let mut positions = JointPositions::default();
        positions.set(Joint::Wrist, glam::DVec3::new(0.0, -0.1, -0.4));
        for (index, finger) in Finger::ALL.iter().enumerate() {
            for (number, &joint) in finger.joints().iter().enumerate() {
                let forward = -0.4 - 0.03 * number as f64;
                let at = glam::DVec3::new(0.02 * index as f64 - 0.04, -0.1, forward);
                positions.set(joint, at);
            }
        }
        hand_landmarks::encode(Some(time_us), &[(Side::Right, positions)])
    }

    fn packets(line: &str) -> Vec<Packet> {
        let mut packets = Vec::new();
        decoder(&ProtocolOptions::default()).push(line.as_bytes(), &mut |it| packets.push(it));
        packets
    }

    fn parts(line: &str) -> Vec<(HandPart, Option<Side>, Option<Timestamp>)> {
        let packets = packets(line).into_iter();
        packets
            .map(|it| (it.part.expect("a part"), it.side, it.time))
            .collect()
    }

    #[test]
    fn a_line_has_a_body_and_hands_of_the_same_time() {
        let time = Some(Timestamp(5));
        let fingers = (HandPart::Fingers, Some(Side::Right), time);
        let line = join(&body(), &hands(5));
        assert_eq!(parts(&line), [(HandPart::Arm, None, time), fingers]);
        assert_eq!(parts(&hands(5)), [fingers], "without a body");
        let no_body = hands(5).replace("{\"time", "{\"pose_world_landmarks\":null,\"time");
        assert_eq!(parts(&no_body), [fingers]);
        let no_hands = join(&body(), "{\"time_us\":5,\"hands\":[]}\n");
        assert_eq!(parts(&no_hands), [(HandPart::Arm, None, time)]);
    }

    #[test]
    fn the_protocols_of_the_parts_read_such_a_line_too() {
        let line = join(&body(), &hands(5));
        for protocol in [&body_landmarks::PROTOCOL, &hand_landmarks::PROTOCOL] {
            let mut decoder = (protocol.decoder)(&ProtocolOptions::default());
            let mut packets = 0;
            decoder.push(line.as_bytes(), &mut |_| packets += 1);
            assert_eq!(packets, 1, "{}", protocol.name);
        }
    }

    #[test]
    fn a_line_that_is_invalid_in_one_part_gives_none_and_states_the_reason() {
        let short = body().replacen("[0.0,-0.5,0.25,0.5],", "", 1);
        for (line, reason) in [
            (join(&short, &hands(1)), InvalidPacket::WrongSize),
            (
                join(
                    &body(),
                    &hands(1).replacen("\"score\":1.0", "\"score\":7.0", 1),
                ),
                InvalidPacket::NotFinite,
            ),
            (body(), InvalidPacket::Unknown),
            ("{}\n".into(), InvalidPacket::Unknown),
            ("noise\n".into(), InvalidPacket::Unknown),
        ] {
            let mut decoder = decoder(&ProtocolOptions::default());
            decoder.push(line.as_bytes(), &mut |packet| panic!("{packet:?}"));
            let error = decoder.last_error().expect("an error");
            assert_eq!(error.reason, reason, "{error}");
        }
    }

    /// Returns the world landmarks of a body and of its right hand, whose fingers are straight, before a camera; both are turned.
    fn person(rotation: DQuat) -> (Vec<[f64; 3]>, Vec<[f64; 3]>) {
        let turned = |at: [f64; 3]| (rotation * DVec3::from_array(at)).to_array();
        let body = (0..BODY_LANDMARKS).map(|index| match index {
            11 => [0.2, -0.5, 0.0],
            12 => [-0.2, -0.5, 0.0],
            23 => [0.1, 0.0, 0.0],
            24 => [-0.1, 0.0, 0.0],
            _ => [0.01 * index as f64, -0.2, -0.3],
        });
        let hand = (0..hand_landmarks::HAND_LANDMARKS).map(|index| {
            let (finger, bone) = (index.div_ceil(4) as f64, ((index + 3) % 4) as f64);
            match index {
                0 => [0.0, 0.0, 0.1],
                _ => [0.02 * finger - 0.04, 0.01 * bone, 0.05 - 0.03 * bone],
            }
        });
        (body.map(turned).collect(), hand.map(turned).collect())
    }

    fn line_of(body: &[[f64; 3]], label: &str, hand: &[[f64; 3]]) -> String {
        let hands = serde_json::json!([{ "label": label, "world": hand }]);
        let line = serde_json::json!({ "pose_world_landmarks": body, "hands": hands });
        format!("{line}\n")
    }

    /// Returns the packets of a stream and the hands in it, relative to their wrists.
    fn decoded(options: &ProtocolOptions, stream: &str) -> (Vec<Packet>, Vec<JointPositions>) {
        let mut all = Vec::new();
        decoder(options).push(stream.as_bytes(), &mut |packet| all.push(packet));
        let hands = all.iter().filter_map(|packet| match &packet.sample {
            Sample::Joints { positions } => Some(*positions),
            _ => None,
        });
        let hands = hands.collect();
        (all, hands)
    }

    #[test]
    fn a_hand_keeps_its_direction_from_the_trunk_when_the_camera_is_turned() {
        let options = ProtocolOptions::default();
        let (body, hand) = person(DQuat::IDENTITY);
        let (_, straight) = decoded(&options, &line_of(&body, "right", &hand));
        let tip = straight[0].get(Joint::IndexTip).expect("a fingertip");
        let expected = DVec3::new(0.0, -0.03, -0.14);
        assert!(tip.distance(expected) < 1e-6, "{tip}");
        for rotation in [
            DQuat::from_rotation_y(0.6),
            DQuat::from_rotation_x(-0.4),
            DQuat::from_rotation_z(0.3) * DQuat::from_rotation_y(-0.5),
        ] {
            let (turned_body, turned_hand) = person(rotation);
            let with_body = line_of(&turned_body, "right", &turned_hand);
            let hands = serde_json::json!([{ "label": "right", "world": turned_hand }]);
            let without_body = serde_json::json!({ "hands": hands });
            let (_, seen) = decoded(&options, &format!("{with_body}{without_body}\n"));
            assert_eq!(seen.len(), 2);
            for positions in &seen {
                for (joint, position) in positions.known() {
                    let unturned = straight[0].get(joint).expect("the same joints");
                    assert!(position.distance(unturned) < 1e-6, "{rotation} {joint}");
                }
            }
        }
    }

    #[test]
    fn a_mirrored_image_shows_the_same_body_and_hand() {
        let (body, hand) = person(DQuat::from_rotation_y(0.3));
        let mirror = |[x, y, z]: [f64; 3]| [-x, y, z];
        let partner = |index: usize| match index {
            0 => 0,
            1..=3 => index + 3,
            4..=6 => index - 3,
            _ if index % 2 == 1 => index + 1,
            _ => index - 1,
        };
        let mirrored_body: Vec<_> = (0..body.len())
            .map(|index| mirror(body[partner(index)]))
            .collect();
        let mirrored_hand: Vec<_> = hand.iter().map(|&at| mirror(at)).collect();
        let mut options = ProtocolOptions::default();
        let (plain, _) = decoded(&options, &line_of(&body, "right", &hand));
        options.set(&hand_landmarks::MIRRORED, "yes").unwrap();
        let stream = line_of(&mirrored_body, "left", &mirrored_hand);
        let (mirrored, _) = decoded(&options, &stream);
        assert_eq!(plain.len(), 2);
        for (packet, expected) in mirrored.iter().zip(&plain) {
            assert_eq!(packet.side, expected.side);
            assert_eq!(packet.sample, expected.sample);
        }
        assert_eq!(mirrored.len(), plain.len());
    }
}
