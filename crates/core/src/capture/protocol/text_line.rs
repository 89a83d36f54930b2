//! Text lines of joint angles: 64 numbers in degrees per line, by the channel of the HC11 glove.
//!
//! The sender is a program that reads the glove and filters its angles. Numbers are separated by blanks or tabs and
//! may have an exponent: `12.5 -0.0 1.0E-5 …`. A line ends with LF or CR LF. A line that does not have exactly
//! [`VALUES`] finite numbers is skipped. In a datagram the line end may be missing.
//!
//! A line for another machine ends with the time at which it was sent, in microseconds: `… 0.0 time_us=12500`.

use std::io::Write;

use super::line_times::LineTimes;
use super::lines::{LineDecoder, LineParser};
use super::{
    Carriers, InvalidPacket, Packet, PacketError, PositionNoise, Protocol, ProtocolOption, space,
};
use crate::capture::{Sample, SampleKind};
use crate::hand::{Dof, JointAngles};
use crate::message::escape;
use crate::time::Timestamp;

/// The text line protocol.
pub const PROTOCOL: Protocol = Protocol {
    name: "text-line",
    summary: "64 joint angles in degrees per line of text, by the channel of the HC11 glove",
    sample: SampleKind::Angles,
    has_both_hands: false,
    has_parts: false,
    position_noise: PositionNoise::None,
    carriers: Carriers::Any,
    // One digit and one separator per value.
    min_packet_bytes: 2 * VALUES,
    default_baud: None,
    feedback: None,
    options: &[&RATE],
    nominal_rate_hz: |options| Some(space::number(options, &RATE)),
    decoder: |_| Box::new(decoder()),
    encoder: |_, _| {
        Ok(Box::new(|readings, bytes| {
            for reading in readings {
                if let Sample::Angles { angles } = &reading.sample {
                    bytes.extend(encode(angles).into_bytes());
                }
            }
        }))
    },
};

/// The lines per second of a file.
pub(super) const RATE: ProtocolOption = ProtocolOption {
    name: "rate_hz",
    default: "100",
    summary: "lines per second of a file, 0.1 to 10000",
    check: |value| space::check_range(value, 0.1..=10_000.0, "lines per second"),
};

/// Numbers in a line: one for each channel of the HC11 glove.
pub const VALUES: usize = 64;

/// Wire index of each angle. A sensor over two joints gives both the same angle. The other indices are unused by
/// the sender or belong to joints without a sensor.
const WIRE_INDICES: [(usize, Dof); 21] = [
    (4, Dof::WristFlexion),
    (41, Dof::WristDeviation),
    (25, Dof::ForearmSupination),
    (17, Dof::ElbowFlexion),
    (60, Dof::IndexDipFlexion),
    (60, Dof::IndexPipFlexion),
    (12, Dof::IndexMcpFlexion),
    (36, Dof::IndexMcpAbduction),
    (52, Dof::MiddleDipFlexion),
    (52, Dof::MiddlePipFlexion),
    (57, Dof::MiddleMcpFlexion),
    (9, Dof::RingDipFlexion),
    (9, Dof::RingPipFlexion),
    (33, Dof::RingMcpFlexion),
    (49, Dof::LittleDipFlexion),
    (49, Dof::LittlePipFlexion),
    (34, Dof::LittleMcpFlexion),
    (44, Dof::ThumbIpFlexion),
    (44, Dof::ThumbMcpFlexion),
    (20, Dof::ThumbCmcFlexion),
    (28, Dof::ThumbCmcAbduction),
];

/// The start of the time in a line.
const TIME: &str = "time_us=";

/// Separates the time from the numbers of a line.
pub(super) fn split_time(line: &str) -> Result<(&str, Option<u64>), PacketError> {
    let Some((numbers, time)) = line.rsplit_once(TIME) else {
        return Ok((line, None));
    };
    let parsed = time.trim_ascii_end().parse().map_err(|_| {
        let text = format!("`{TIME}{}` is not a time", escape(time));
        PacketError::new(InvalidPacket::Unknown, text)
    });
    Ok((numbers, Some(parsed?)))
}

/// Reads the numbers of a line; the line end may be missing. An error states why the line is not valid.
pub fn parse(line: &str) -> Result<[f64; VALUES], PacketError> {
    numbers(line.trim_end_matches(['\r', '\n']).split([' ', '\t']))
}

/// Reads the finite numbers in words, of which empty ones are ignored.
pub(super) fn numbers<'w, const N: usize>(
    words: impl Iterator<Item = &'w str>,
) -> Result<[f64; N], PacketError> {
    let mut numbers = [0.0; N];
    let mut count = 0;
    for word in words.filter(|word| !word.is_empty()) {
        let number: f64 = word.parse().map_err(|_| {
            let text = format!("`{}` is not a number", escape(word));
            PacketError::new(InvalidPacket::Unknown, text)
        })?;
        if !number.is_finite() {
            let text = format!("`{word}` is not finite");
            return Err(PacketError::new(InvalidPacket::NotFinite, text));
        }
        if let Some(slot) = numbers.get_mut(count) {
            *slot = number;
        }
        count += 1;
    }
    if count != N {
        return Err(PacketError::wrong_count(count, N));
    }
    Ok(numbers)
}

/// Returns the joint angles in the numbers of a line.
pub fn angles(values: &[f64; VALUES]) -> JointAngles {
    let mut angles = JointAngles::default();
    for (index, dof) in WIRE_INDICES {
        angles.set(dof, values[index].to_radians());
    }
    angles
}

/// Returns `angles` as a line without a time, see [`write()`].
pub fn encode(angles: &JointAngles) -> String {
    let mut line = Vec::new();
    write(angles, None, &mut line);
    String::from_utf8(line).expect("a line is ASCII")
}

/// Appends `angles` as a line with its line end, with six decimals. Unknown angles and unused indices are 0. With `time`, the
/// line states it.
pub fn write(angles: &JointAngles, time: Option<Timestamp>, line: &mut Vec<u8>) {
    let mut values = [0.0; VALUES];
    for (index, dof) in WIRE_INDICES {
        values[index] = angles.get(dof).to_degrees();
    }
    for value in values {
        // Two of three numbers are unused, and formatting one takes 100 ns.
        let written = match f64::to_bits(value) {
            0 => line.write_all(b"0.000000 "),
            _ => write!(line, "{value:.6} "),
        };
        written.expect("a vector accepts all bytes");
    }
    let written = match time {
        Some(time) => writeln!(line, "{TIME}{}", time.0),
        None => line.write_all(b"\n"),
    };
    written.expect("a vector accepts all bytes");
}

/// Parser of one text line.
#[derive(Clone, Copy, Debug, Default)]
pub struct TextLineParser {
    times: LineTimes,
}

/// Creates a decoder at the start of a stream.
pub fn decoder() -> LineDecoder<TextLineParser> {
    LineDecoder::with_parser(TextLineParser::default())
}

impl LineParser for TextLineParser {
    /// 64 numbers of 63 characters.
    const MAX_LINE_BYTES: usize = 4096;

    fn parse(&mut self, line: &[u8], emit: &mut dyn FnMut(Packet)) -> Result<(), PacketError> {
        let (numbers, time) = split_time(std::str::from_utf8(line)?)?;
        let angles = angles(&parse(numbers)?);
        let time = self.times.check(time)?;
        emit(Packet::of_line(Sample::Angles { angles }, time));
        Ok(())
    }

    fn reset(&mut self) {
        self.times = LineTimes::default();
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::capture::protocol::Decoder;

    const VECTORS: &str = concat!(
        env!("CARGO_MANIFEST_DIR"),
        "/../../tests/vectors/glove_text_line.json"
    );

    struct Case {
        name: String,
        line: String,
        values: Result<Vec<f64>, String>,
    }

    fn cases() -> Vec<Case> {
        let text = std::fs::read_to_string(VECTORS).expect("the vectors are in the tree");
        let file: serde_json::Value = serde_json::from_str(&text).expect("they are JSON");
        let cases = file["cases"].as_array().expect("a list of cases");
        let read = |case: &serde_json::Value| Case {
            name: case["name"].as_str().unwrap().to_owned(),
            line: case["line"].as_str().unwrap().to_owned(),
            values: match case["error"].as_str() {
                Some(error) => Err(error.replace("no values", "0 values")),
                None => Ok(serde_json::from_value(case["values"].clone()).unwrap()),
            },
        };
        cases.iter().map(read).collect()
    }

    #[test]
    fn the_vectors_parse_or_are_rejected() {
        let cases = cases();
        assert!(cases.len() >= 13, "only {} cases", cases.len());
        for Case { name, line, values } in cases {
            match (parse(&line), values) {
                (Ok(parsed), Ok(expected)) => assert_eq!(parsed[..], expected, "{name}"),
                (Err(error), Err(expected)) => assert!(
                    error
                        .to_string()
                        .contains(expected.trim_start_matches("a ")),
                    "{name}: {error}, not {expected}"
                ),
                (parsed, expected) => panic!("{name}: {parsed:?}, not {expected:?}"),
            }
        }
    }

    #[test]
    fn a_first_number_without_its_start_changes_no_angle() {
        let numbers: [f64; VALUES] = std::array::from_fn(|index| index as f64);
        let mut cut = numbers;
        cut[0] = 7.0;
        assert_eq!(angles(&cut), angles(&numbers));
    }

    #[test]
    fn only_blanks_and_tabs_separate_numbers() {
        let half = ["1.5"; VALUES / 2].join(" ");
        let line = |between: &str, last: &str| format!("{half}{between}{half}{last}");
        for (separator, end) in [(" ", "\n"), ("\t \t", " \r\n"), (" ", "\t"), (" ", "")] {
            assert_eq!(parse(&line(separator, end)), Ok([1.5; VALUES]));
        }
        for separator in ["\r", "\n", "\u{b}", "\u{c}", "\u{a0}", ",", ""] {
            assert!(parse(&line(separator, "\n")).is_err(), "{separator:?}");
        }
    }

    #[test]
    fn a_byte_order_mark_before_the_first_line_is_skipped() {
        let mut decoder = decoder();
        let line = encode(&angles(&[45.0; VALUES]));
        let mark = "\u{feff}";
        let stream = [mark, &line, mark, &line].concat();
        let mut count = 0;
        for byte in stream.as_bytes() {
            decoder.push(&[*byte], &mut |_| count += 1);
        }
        assert_eq!((count, decoder.stats().invalid.total()), (1, 1));
    }

    #[test]
    fn a_line_may_state_its_time_and_one_that_is_repeated_or_no_number_is_refused() {
        let angles = angles(&[45.0; VALUES]);
        let line = |time| {
            let mut line = Vec::new();
            write(&angles, Some(Timestamp(time)), &mut line);
            String::from_utf8(line).unwrap()
        };
        let mut decoder = decoder();
        let untimed = encode(&angles);
        let wrong = [&untimed[..untimed.len() - 1], "time_us=-5\n"].concat();
        let stream = [untimed.clone(), line(7), line(7), wrong, line(8)].concat();
        let mut times = Vec::new();
        decoder.push(stream.as_bytes(), &mut |packet| {
            times.push(packet.sent_at);
            assert_eq!(packet.time, packet.sent_at);
            let Sample::Angles { angles: received } = packet.sample else {
                panic!("{packet:?}");
            };
            let difference = received.get(Dof::WristFlexion) - angles.get(Dof::WristFlexion);
            assert!(difference.abs() < 1e-6);
        });
        assert_eq!(times, [None, Some(Timestamp(7)), Some(Timestamp(8))]);
        let invalid = decoder.stats().invalid;
        assert_eq!(invalid.get(InvalidPacket::OutOfOrder), 1);
        assert_eq!(invalid.get(InvalidPacket::Unknown), 1);
    }

    #[test]
    fn a_stream_of_the_vectors_gives_the_valid_lines_in_pieces_of_any_size() {
        let cases = cases();
        let stream: String = cases.iter().map(|case| case.line.as_str()).collect();
        let expected: Vec<JointAngles> = cases
            .iter()
            .filter_map(|case| case.values.as_ref().ok())
            .map(|values| angles(&values[..].try_into().unwrap()))
            .collect();
        let mut random = fastrand::Rng::with_seed(2);
        for round in 0..200 {
            let mut decoder = decoder();
            let mut received = Vec::new();
            let mut packet_bytes = 0;
            let mut rest = stream.as_bytes();
            while !rest.is_empty() {
                let (piece, later) =
                    rest.split_at(random.usize(1..=rest.len().min(1 + round * 20)));
                decoder.push(piece, &mut |packet| {
                    let end = packet.end as usize;
                    assert_eq!(stream.as_bytes()[end - 1], b'\n');
                    let start = stream[..end - 1].rfind('\n').map_or(0, |start| start + 1);
                    packet_bytes += (end - start) as u64;
                    received.push(packet.sample);
                });
                rest = later;
            }
            let stats = decoder.stats();
            assert_eq!(stats.bytes, packet_bytes + stats.skipped_bytes);
            let expected: Vec<Sample> = expected
                .iter()
                .map(|&angles| Sample::Angles { angles })
                .collect();
            assert_eq!(received, expected);
        }
    }

    #[test]
    fn encoded_angles_are_decoded() {
        let mut sent = JointAngles::default();
        for (index, (_, dof)) in WIRE_INDICES.into_iter().enumerate() {
            sent.set(dof, 0.01 * index as f64);
        }
        let received = angles(&parse(&encode(&sent)).unwrap());
        for (wire_index, dof) in WIRE_INDICES {
            let shared = WIRE_INDICES.iter().rfind(|(other, _)| *other == wire_index);
            let (_, last) = shared.expect("the index itself");
            assert!((received.get(dof) - sent.get(*last)).abs() < 1e-7, "{dof}");
            assert!(received.is_known(dof));
        }
    }

    #[test]
    fn a_datagram_needs_no_line_end() {
        let line = encode(&JointAngles::default());
        let mut decoder = decoder();
        for _ in 0..2 {
            decoder.push(line.trim_end().as_bytes(), &mut |_| panic!("no line end"));
            let mut packets = 0;
            decoder.finish(&mut |_| packets += 1);
            assert_eq!((packets, decoder.pending_bytes()), (1, 0));
        }
    }

    #[test]
    fn an_endless_line_is_skipped_in_bounded_memory() {
        let mut decoder = decoder();
        for _ in 0..1000 {
            decoder.push(&[b'1'; 1000], &mut |_| panic!("no line end"));
        }
        assert_eq!(decoder.line_capacity(), TextLineParser::MAX_LINE_BYTES);
        let line = encode(&JointAngles::default());
        let mut packets = 0;
        decoder.push(format!("\n{line}").as_bytes(), &mut |_| packets += 1);
        assert_eq!((packets, decoder.stats().skipped_bytes), (1, 1_000_001));
        assert_eq!(decoder.stats().resyncs, 1);
    }
}
