//! Lines of JSON with a body and its hands, as the holistic model of MediaPipe finds them in one image.
//!
//! ```json
//! {"time_us":12500,"image_size":[640,480],"pose_world_landmarks":[[0.06,-0.65,-0.12,0.99],…],
//!  "hands":[{"label":"right","image":[[0.52,0.81,0.0],…],"world":[[0.01,0.07,0.02],…]}]}
//! ```
//!
//! A line has the fields of [`body_landmarks`] and of [`hand_landmarks`], with their limits. The body places the arms, and the
//! hands hang from its wrists. A body that is not seen is missing or `null`.

use arrayvec::ArrayVec;
use serde::Deserialize;

use super::hand_landmarks::{Hand, HandParser};
use super::lines::{LineDecoder, LineParser};
use super::tracked_hands::MAX_HANDS;
use super::{Packet, PacketError, Protocol, ProtocolOptions, body_landmarks, hand_landmarks};
use crate::capture::Sample;
use crate::capture::body::{BODY_LANDMARKS, Landmark};
use crate::hand::HandPart;

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
    })
}

/// Parser of lines with a body and its hands.
#[derive(Clone, Debug)]
pub struct HolisticParser {
    hands: HandParser,
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
        let hands = self.hands.best_hands(&line.hands, line.image_size)?;
        let line_time = self.hands.hands.start_line(line.time_us)?;
        if let Some(body) = body {
            emit(Packet {
                time: Some(line_time.time),
                sent_at: line_time.stated,
                part: Some(HandPart::Arm),
                ..Packet::new(Sample::Body(body), 0)
            });
        }
        self.hands
            .hands
            .emit(line_time, hands.hands(), &mut |packet| {
                emit(Packet {
                    part: Some(HandPart::Fingers),
                    ..packet
                });
            });
        Ok(())
    }

    fn reset(&mut self) {
        self.hands.reset();
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
    use super::*;
    use crate::capture::body::BodyLandmarks;
    use crate::capture::protocol::{Decoder, InvalidPacket, hand_landmarks};
    use crate::hand::{Finger, Joint, JointPositions, Side};
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
}
