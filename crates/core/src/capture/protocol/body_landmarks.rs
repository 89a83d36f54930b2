//! Lines of JSON with the landmarks of a body, as the pose models of MediaPipe find them.
//!
//! ```json
//! {"time_us":12500,"pose_world_landmarks":[[0.06,-0.65,-0.12,0.99],…]}
//! ```
//!
//! One object per line, with [`BODY_LANDMARKS`] landmarks of one person: x, y and z in metres and the visibility, which
//! may be missing, as may the time. Other fields are ignored. A line with another number of landmarks, with a position beyond
//! [`MAX_COORDINATE`] or with a visibility outside 0 to 1 is skipped.
//!
//! An image without a person has `null` for the landmarks, or its time and no landmarks. The packet of such a line has no visible
//! landmark.

use arrayvec::ArrayVec;
use serde::{Deserialize, Deserializer};

use super::bone_lengths::{self, BONES};
use super::line_times::LineTimes;
use super::lines::{LineDecoder, LineParser};
use super::tracked_hands::RATE;
use super::{Carriers, InvalidPacket, Packet, PacketError, PositionNoise, Protocol, space};
use crate::capture::body::{BODY_LANDMARKS, BodyLandmarks, Landmark};
use crate::capture::markers::LiveFit;
use crate::capture::{Reading, Sample, SampleKind};

/// The protocol of body landmarks.
pub const PROTOCOL: Protocol = Protocol {
    name: "body-landmarks",
    summary: "33 body landmarks of MediaPipe in metres per line of JSON",
    sample: SampleKind::Body,
    has_both_hands: true,
    has_parts: false,
    position_noise: PositionNoise::Landmarks,
    carriers: Carriers::Any,
    // The name of the field, and `[0,0,0],` for each landmark.
    min_packet_bytes: 26 + 8 * BODY_LANDMARKS,
    default_baud: None,
    feedback: None,
    options: &[&space::HAND, &BONES, &RATE],
    nominal_rate_hz: |options| Some(space::number(options, &RATE)),
    decoder: |options| {
        Box::new(LineDecoder::with_parser(BodyParser {
            bones: bone_lengths::fit(options, &RATE),
            ..BodyParser::default()
        }))
    },
    encoder: |_, _| {
        Ok(Box::new(|readings, bytes| {
            bytes.extend(encode(&merged(readings)).into_bytes())
        }))
    },
};

/// Largest coordinate, in metres: no room is larger.
pub const MAX_COORDINATE: f32 = 100.0;

/// Parser of lines with one body.
#[derive(Clone, Debug, Default)]
pub struct BodyParser {
    bones: Option<LiveFit>,
    times: LineTimes,
    /// `true` once a body was seen.
    was_seen: bool,
}

/// Creates a decoder at the start of a stream.
pub fn decoder() -> LineDecoder<BodyParser> {
    LineDecoder::with_parser(BodyParser::default())
}

impl LineParser for BodyParser {
    /// 33 landmarks of four numbers with 17 digits are 3 kB; the rest is for other fields.
    const MAX_LINE_BYTES: usize = 24 * 1024;

    fn parse(&mut self, line: &[u8], emit: &mut dyn FnMut(Packet)) -> Result<(), PacketError> {
        let line: Line = serde_json::from_str(std::str::from_utf8(line)?)?;
        let time_us = line.time_us;
        let seen = line.body()?;
        let time = self.times.check(time_us)?;
        let body = match seen {
            Some(mut body) => {
                self.was_seen = true;
                if let Some(fit) = &mut self.bones {
                    bone_lengths::fit_body(fit, &mut body);
                }
                body
            }
            None if self.was_seen => unseen(),
            None => return Ok(()),
        };
        emit(Packet::of_line(Sample::Body(body), time));
        Ok(())
    }

    fn reset(&mut self) {
        if let Some(fit) = &mut self.bones {
            fit.reset();
        }
        self.times = LineTimes::default();
        self.was_seen = false;
    }
}

/// The fields of a line that count.
#[derive(Deserialize)]
struct Line {
    time_us: Option<u64>,
    /// `None` if the field is missing, and `Some(None)` if it is `null`.
    #[serde(default, deserialize_with = "stated")]
    pose_world_landmarks: Option<Option<ArrayVec<Landmark, BODY_LANDMARKS>>>,
}

/// Reads a field that is there.
fn stated<'de, D: Deserializer<'de>, T: Deserialize<'de>>(
    deserializer: D,
) -> Result<Option<T>, D::Error> {
    T::deserialize(deserializer).map(Some)
}

impl Line {
    /// Returns the body; `None` for an image without one.
    fn body(self) -> Result<Option<BodyLandmarks>, PacketError> {
        match (self.pose_world_landmarks, self.time_us) {
            (Some(points), _) => points.map(body).transpose(),
            (None, Some(_)) => Ok(None),
            (None, None) => {
                let text = "it has neither `pose_world_landmarks` nor `time_us`";
                Err(PacketError::new(InvalidPacket::Unknown, text))
            }
        }
    }
}

/// Returns a body of which nothing is visible.
fn unseen() -> BodyLandmarks {
    let landmark = Landmark {
        position: [0.0; 3],
        confidence: 0.0,
    };
    BodyLandmarks {
        points: [landmark; BODY_LANDMARKS].into(),
    }
}

/// Returns the body of a list of landmarks. An error states why it is not valid.
pub(super) fn body(
    points: ArrayVec<Landmark, BODY_LANDMARKS>,
) -> Result<BodyLandmarks, PacketError> {
    if points.len() != BODY_LANDMARKS {
        return Err(PacketError::new(
            InvalidPacket::WrongSize,
            format!("{} landmarks instead of {BODY_LANDMARKS}", points.len()),
        ));
    }
    for (index, landmark) in points.iter().enumerate() {
        let is_near = |coordinate: &f32| coordinate.abs() <= MAX_COORDINATE;
        if !landmark.position.iter().all(is_near) {
            return Err(PacketError::new(
                InvalidPacket::NotFinite,
                format!("landmark {index} is more than {MAX_COORDINATE} m away"),
            ));
        }
        if !(0.0..=1.0).contains(&landmark.confidence) {
            return Err(PacketError::new(
                InvalidPacket::NotFinite,
                format!("the visibility of landmark {index} is not from 0 to 1"),
            ));
        }
    }
    Ok(BodyLandmarks { points })
}

/// Returns the landmarks of one body: of each, the one with the highest confidence.
fn merged(readings: &[Reading]) -> BodyLandmarks {
    let mut merged = BodyLandmarks::default();
    for reading in readings {
        let Sample::Body(body) = &reading.sample else {
            continue;
        };
        if merged.points.is_empty() {
            merged = body.clone();
        }
        for (landmark, other) in merged.points.iter_mut().zip(&body.points) {
            if other.confidence > landmark.confidence {
                *landmark = *other;
            }
        }
    }
    merged
}

/// Writes landmarks as a line with its line end.
pub fn encode(landmarks: &BodyLandmarks) -> String {
    let points: Vec<[f32; 4]> = landmarks.points.iter().map(|&point| point.into()).collect();
    let line = serde_json::json!({ "pose_world_landmarks": points });
    format!("{line}\n")
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::capture::protocol::{Decoder, ProtocolOptions};

    fn some_body() -> BodyLandmarks {
        let landmark = |index: usize| Landmark {
            position: [0.01 * index as f32, -0.5, 0.25],
            confidence: 0.5,
        };
        BodyLandmarks {
            points: (0..BODY_LANDMARKS).map(landmark).collect(),
        }
    }

    fn parse(line: &str) -> Result<BodyLandmarks, PacketError> {
        let line: Line = serde_json::from_str(line)?;
        Ok(line.body()?.expect("a body"))
    }

    /// Returns a line whose last landmark is `last`.
    fn line_with(last: &str) -> String {
        let others = "[0,0,0],".repeat(BODY_LANDMARKS - 1);
        format!("{{\"pose_world_landmarks\":[{others}{last}]}}")
    }

    #[test]
    fn encoded_landmarks_are_decoded() {
        assert_eq!(parse(&encode(&some_body())), Ok(some_body()));
        let without_visibility = parse(&line_with("[1,2.5,-3]")).expect("a valid line");
        let last = Landmark {
            position: [1.0, 2.5, -3.0],
            confidence: 1.0,
        };
        assert_eq!(without_visibility.points.last(), Some(&last));
        let with_more = line_with("[0,0,0]").replace('{', "{\"time\":{\"s\":[1,2]},");
        assert!(parse(&with_more).is_ok());
        assert!(PROTOCOL.min_packet_bytes <= line_with("[0,0,0]").len());
    }

    #[test]
    fn every_invalid_line_is_refused_with_its_reason() {
        for (line, reason) in [
            (line_with("[0,0,0],[0,0,0]"), "no more than 33"),
            (
                line_with("[0,0,0]").replacen("[0,0,0],", "", 1),
                "32 landmarks",
            ),
            (line_with("[0,0]"), "three or four numbers"),
            (line_with("[0,0,0,1,2]"), "no more than 4"),
            (line_with("[0,0,NaN]"), "expected value"),
            (line_with("[0,0,null]"), "null"),
            (line_with("[0,0,1e999]"), "out of range"),
            (line_with("[0,0,1e30]"), "100 m"),
            (line_with("[0,0,1e300]"), "out of range"),
            (line_with("[0,0,0,7.5]"), "from 0 to 1"),
            (line_with("[0,0,0,-0.1]"), "from 0 to 1"),
            ("{}".into(), "neither `pose_world_landmarks` nor"),
            ("".into(), "EOF"),
            ("[".repeat(10_000), "invalid"),
            (
                format!("{{\"a\":{}1{}}}", "[".repeat(5_000), "]".repeat(5_000)),
                "",
            ),
            (
                "{\"pose_world_landmarks\":[],\"pose_world_landmarks\":[]}".into(),
                "duplicate field",
            ),
        ] {
            let error = parse(&line).expect_err("an invalid line").to_string();
            assert!(error.contains(reason), "{reason}: {error}");
        }
    }

    #[test]
    fn a_stream_gives_the_valid_lines_in_pieces_of_any_size() {
        let stream = format!(
            "noise\r\n{}{{}}\n\n{}",
            encode(&some_body()),
            line_with("[0,0,0]\r\n")
        );
        let stream = format!("{stream}\n{}", encode(&some_body()).replace('\n', "\r\n"));
        for size in [1, 7, 100, 4_096] {
            let mut decoder = decoder();
            let mut received = Vec::new();
            for piece in stream.as_bytes().chunks(size) {
                decoder.push(piece, &mut |packet| received.push(packet.sample));
            }
            assert_eq!(received.len(), 2, "pieces of {size}");
            assert!(
                received
                    .iter()
                    .all(|sample| *sample == Sample::Body(some_body()))
            );
            assert_eq!(decoder.pending_bytes(), 0);
        }
    }

    #[test]
    fn an_image_without_a_person_shows_nothing_of_the_body_that_was_seen_before() {
        let body = encode(&some_body());
        let no_person = "{\"pose_world_landmarks\":null}\n";
        let of_bridge = "{\"time_us\":5,\"image_size\":[640,480],\"hands\":[]}\n";
        let mut decoder = decoder();
        let mut visible = Vec::new();
        for line in [no_person, of_bridge, body.as_str(), no_person, "{}\n"] {
            decoder.push(line.as_bytes(), &mut |packet| {
                let Sample::Body(shown) = packet.sample else {
                    panic!("no body");
                };
                assert_eq!(shown.points.len(), BODY_LANDMARKS);
                visible.push(shown.points.iter().any(|point| point.confidence > 0.0));
            });
        }
        assert_eq!(visible, [true, false], "nothing before the body was seen");
        assert_eq!(
            decoder.stats().invalid.total(),
            1,
            "the line without fields"
        );
        decoder.reset();
        decoder.push(no_person.as_bytes(), &mut |packet| panic!("{packet:?}"));
    }

    #[test]
    fn a_line_may_state_its_time_which_is_later_than_in_the_line_before() {
        let line =
            |time: u64| encode(&some_body()).replacen('{', &format!("{{\"time_us\":{time},"), 1);
        let mut decoder = decoder();
        let mut times = Vec::new();
        for text in [
            line(2_000_000),
            line(2_033_000),
            line(2_033_000),
            line(1_500_000),
            encode(&some_body()),
            line(5),
            line(7).replace(":7,", ":7.5,"),
        ] {
            decoder.push(text.as_bytes(), &mut |packet| {
                assert_eq!(packet.time, packet.sent_at);
                times.push(packet.time.map(|time| time.0));
            });
        }
        let expected = [Some(2_000_000), Some(2_033_000), None, Some(5)];
        assert_eq!(times, expected);
        let invalid = decoder.stats().invalid;
        for reason in [
            InvalidPacket::OutOfOrder,
            InvalidPacket::TooOld,
            InvalidPacket::Unknown,
        ] {
            assert_eq!(invalid.get(reason), 1, "{reason}");
        }
    }

    #[test]
    fn fixed_bones_keep_the_length_of_a_forearm_that_is_measured_with_noise() {
        let mut random = fastrand::Rng::with_seed(3);
        let lines: Vec<String> = (0..300)
            .map(|index| {
                let mut body = some_body();
                let turn = 0.02 * index as f32;
                let places = [
                    (11, [0.2, 0.0, 0.0]),
                    (12, [-0.2, 0.0, 0.0]),
                    (13, [0.2, 0.3, 0.0]),
                    (15, [0.2 + 0.26 * turn.cos(), 0.3, 0.26 * turn.sin()]),
                ];
                for (landmark, place) in places {
                    // A standard deviation of 1 mm.
                    let noise = |_| (0..12).map(|_| random.f32()).sum::<f32>() - 6.0;
                    let noise = [0; 3].map(noise).map(|it| 0.001 * it);
                    body.points[landmark].position =
                        std::array::from_fn(|axis| place[axis] + noise[axis]);
                }
                encode(&body)
            })
            .collect();
        let spread_mm = |bones: &str| {
            let mut options = ProtocolOptions::default();
            options.set(&BONES, bones).unwrap();
            let mut decoder = (PROTOCOL.decoder)(&options);
            let mut lengths = Vec::new();
            decoder.push(lines.concat().as_bytes(), &mut |packet| {
                let Sample::Body(body) = packet.sample else {
                    panic!("no body");
                };
                let [elbow, wrist] =
                    [13, 15].map(|index: usize| glam::Vec3::from(body.points[index].position));
                lengths.push(elbow.distance(wrist));
            });
            // The first 3 s measure the lengths.
            let lengths = &lengths[90..];
            let most = lengths.iter().copied().fold(f32::MIN, f32::max);
            1000.0 * (most - lengths.iter().copied().fold(f32::MAX, f32::min))
        };
        let (free, fixed) = (spread_mm("free"), spread_mm("fixed"));
        println!("spread of the forearm at 1 mm of noise: {free:.2} mm free, {fixed:.5} mm fixed");
        assert!(free > 5.0 && fixed < 0.001, "{free} {fixed}");
    }

    #[test]
    fn fixed_bones_are_measured_again_after_the_stream_broke_off() {
        let mut options = ProtocolOptions::default();
        options.set(&BONES, "fixed").unwrap();
        let mut decoder = (PROTOCOL.decoder)(&options);
        for forearm in [0.26_f32, 0.3] {
            let mut body = some_body();
            body.points[13].position = [0.2, 0.3, 0.0];
            body.points[15].position = [0.2 + forearm, 0.3, 0.0];
            let mut length = 0.0;
            decoder.push(encode(&body).repeat(100).as_bytes(), &mut |packet| {
                let Sample::Body(fitted) = packet.sample else {
                    panic!("no body");
                };
                let [elbow, wrist] =
                    [13, 15].map(|index: usize| glam::Vec3::from(fitted.points[index].position));
                length = elbow.distance(wrist);
            });
            assert!((length - forearm).abs() < 1e-4, "{length}, not {forearm}");
            decoder.reset();
        }
    }

    #[test]
    fn a_number_of_a_megabyte_is_skipped_in_bounded_memory() {
        let mut decoder = decoder();
        let line = line_with(&format!("[0,0,0.{}]", "1".repeat(1 << 20))) + "\n";
        decoder.push(line.as_bytes(), &mut |_| panic!("a line that is too long"));
        let mut packets = 0;
        decoder.push(encode(&some_body()).as_bytes(), &mut |_| packets += 1);
        assert_eq!(packets, 1);
    }
}
