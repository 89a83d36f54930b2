//! Tests of HC11 framing and decoding.

use super::*;

const VECTORS: &str = concat!(
    env!("CARGO_MANIFEST_DIR"),
    "/../../tests/vectors/glove_packets.json"
);

struct Case {
    name: String,
    framing: Framing,
    stream: Vec<u8>,
    chunks: Vec<usize>,
    bodies: Vec<Vec<u8>>,
    before_end: Option<usize>,
}

fn from_hex(text: &str) -> Vec<u8> {
    let digits: Vec<u8> = text
        .chars()
        .map(|digit| digit.to_digit(16).expect("a hex digit") as u8)
        .collect();
    digits
        .chunks_exact(2)
        .map(|pair| pair[0] << 4 | pair[1])
        .collect()
}

fn cases() -> Vec<Case> {
    let text = std::fs::read_to_string(VECTORS).expect("the vectors are in the tree");
    let file: serde_json::Value = serde_json::from_str(&text).expect("they are JSON");
    let cases = file["cases"].as_array().expect("a list of cases");
    cases.iter().map(read_case).collect()
}

fn read_case(case: &serde_json::Value) -> Case {
    let framing: Framing = case["framing"].as_str().unwrap().parse().unwrap();
    let rule = match framing {
        Framing::Double06 => "confirmed",
        Framing::Hash => "rescan",
    };
    let expected = &case["expected"];
    let bodies = expected[rule].as_array().expect("bodies of the rule");
    Case {
        name: case["name"].as_str().unwrap().to_owned(),
        framing,
        stream: from_hex(case["hex"].as_str().unwrap()),
        chunks: serde_json::from_value(case["chunks"].clone()).unwrap(),
        bodies: bodies
            .iter()
            .map(|body| from_hex(body.as_str().unwrap()))
            .collect(),
        before_end: expected["confirmed_before_end_of_stream"]
            .as_u64()
            .map(|count| count as usize),
    }
}

fn packet_body(packet: &Packet) -> Vec<u8> {
    body(&packet.sample).expect("64 counts of 8 bits").to_vec()
}

/// Decodes in pieces of the given sizes; the rest of the stream is the last piece.
fn decode(
    case: &Case,
    sizes: impl IntoIterator<Item = usize>,
) -> (Vec<Vec<u8>>, usize, SourceStats) {
    let mut decoder = Hc11Decoder::new(case.framing);
    let mut bodies = Vec::new();
    let mut emit = |packet: Packet| {
        let end = packet.end as usize;
        let whole = &case.stream[end - PACKET_BYTES..end];
        assert_eq!(
            whole[case.framing.body_start()..][..BODY_BYTES],
            packet_body(&packet),
            "{} at {end}",
            case.name
        );
        bodies.push(packet_body(&packet));
    };
    let mut rest = case.stream.as_slice();
    for size in sizes {
        let (piece, later) = rest.split_at(size.min(rest.len()));
        decoder.push(piece, &mut emit);
        assert!(decoder.pending_bytes() < 68, "{}", case.name);
        rest = later;
        if rest.is_empty() {
            break;
        }
    }
    decoder.push(rest, &mut emit);
    let before_end = decoder.stats();
    assert_eq!(
        before_end.bytes,
        66 * before_end.readings + before_end.skipped_bytes + decoder.pending_bytes() as u64,
        "{}",
        case.name
    );
    decoder.finish(&mut emit);
    let stats = decoder.stats();
    assert_eq!(
        (stats.bytes, decoder.pending_bytes()),
        (66 * stats.readings + stats.skipped_bytes, 0)
    );
    (bodies, before_end.readings as usize, stats)
}

/// Decodes in pieces of the given size with a pause after each. Returns the bodies.
fn decode_with_pauses(case: &Case, sizes: impl IntoIterator<Item = usize>) -> Vec<Vec<u8>> {
    let mut decoder = Hc11Decoder::new(case.framing);
    let mut bodies = Vec::new();
    let mut emit = |packet: Packet| bodies.push(packet_body(&packet));
    let mut rest = case.stream.as_slice();
    for size in sizes {
        let (piece, later) = rest.split_at(size.min(rest.len()));
        decoder.push(piece, &mut emit);
        decoder.pause(&mut emit);
        rest = later;
    }
    decoder.push(rest, &mut emit);
    decoder.finish(&mut emit);
    bodies
}

#[test]
fn the_vectors_decode_alike_with_pauses_between_pieces_of_any_size() {
    let mut random = fastrand::Rng::with_seed(2);
    for case in &cases() {
        let length = case.stream.len();
        for size in [1, 2, 33, 64, 66, 67, 132] {
            let sizes = std::iter::repeat_n(size, length / size);
            let bodies = decode_with_pauses(case, sizes);
            assert_eq!(bodies, case.bodies, "{} in pieces of {size}", case.name);
        }
        let bodies = decode_with_pauses(case, case.chunks.iter().copied());
        assert_eq!(bodies, case.bodies, "{} in its chunks", case.name);
        for _ in 0..20 {
            let sizes: Vec<usize> = (0..length / 60).map(|_| random.usize(1..130)).collect();
            let rechunked = decode_with_pauses(case, sizes.iter().copied());
            assert_eq!(rechunked, case.bodies, "{} in {sizes:?}", case.name);
        }
    }
}

/// Pushes a packet without its last `missing` bytes and then a pause. Returns the number of packets emitted.
fn push_and_pause(decoder: &mut Hc11Decoder, missing: usize) -> usize {
    let mut packets = 0;
    let packet = encode(Framing::Double06, &[100; BODY_BYTES]);
    decoder.push(&packet[..PACKET_BYTES - missing], &mut |_| packets += 1);
    decoder.pause(&mut |_| packets += 1);
    packets
}

#[test]
fn a_sender_that_pauses_after_every_packet_confirms_packets_by_its_pauses() {
    let mut decoder = Hc11Decoder::new(Framing::Double06);
    let packets: Vec<usize> = (0..11).map(|_| push_and_pause(&mut decoder, 0)).collect();
    // The ninth packet is confirmed by its pause, at once.
    assert_eq!(packets, [0, 1, 1, 1, 1, 1, 1, 1, 2, 1, 1]);
    assert!(!decoder.awaits_pause(), "it was this pause");
}

#[test]
fn a_pause_within_a_packet_confirms_nothing_until_eight_packets_were_whole_again() {
    let mut decoder = Hc11Decoder::new(Framing::Double06);
    for _ in 0..10 {
        push_and_pause(&mut decoder, 0);
    }
    assert_eq!(push_and_pause(&mut decoder, 1), 0, "it lost a byte");
    let packets: Vec<usize> = (0..10).map(|_| push_and_pause(&mut decoder, 0)).collect();
    assert_eq!(packets, [0, 1, 1, 1, 1, 1, 1, 1, 2, 1]);
    assert_eq!(decoder.stats().skipped_bytes, 65);
}

#[test]
fn the_vectors_decode_alike_in_pieces_of_any_size() {
    let cases = cases();
    assert!(cases.len() > 30, "only {} cases", cases.len());
    let mut random = fastrand::Rng::with_seed(1);
    for case in &cases {
        let (bodies, before_end, stats) = decode(case, []);
        assert_eq!(bodies, case.bodies, "{}", case.name);
        if let Some(expected) = case.before_end {
            assert_eq!(before_end, expected, "{}", case.name);
        }
        let whole = (bodies, before_end, stats);
        assert_eq!(
            decode(case, std::iter::repeat(1)),
            whole,
            "{} byte by byte",
            case.name
        );
        assert_eq!(
            decode(case, case.chunks.iter().copied()),
            whole,
            "{} in its chunks",
            case.name
        );
        for _ in 0..20 {
            let sizes: Vec<usize> = (0..case.stream.len() + 1)
                .map(|_| random.usize(..130))
                .collect();
            assert_eq!(
                decode(case, sizes.iter().copied()),
                whole,
                "{} in {sizes:?}",
                case.name
            );
        }
    }
}

#[test]
fn encoded_bodies_are_decoded_in_both_framings() {
    let mut random = fastrand::Rng::with_seed(7);
    for &framing in Framing::ALL {
        let sent: Vec<[u8; BODY_BYTES]> = (0..50)
            .map(|_| [(); BODY_BYTES].map(|()| random.u8(..)))
            .collect();
        let mut decoder = Hc11Decoder::new(framing);
        let mut received = Vec::new();
        let mut emit = |packet: Packet| received.push(packet_body(&packet));
        for body in &sent {
            decoder.push(&encode(framing, body), &mut emit);
        }
        decoder.finish(&mut emit);
        assert_eq!(received, sent, "{framing}");
        assert_eq!(decoder.stats().skipped_bytes, 0, "{framing}");
    }
}

#[test]
fn a_megabyte_of_noise_gives_no_packet_and_a_bounded_buffer() {
    let mut random = fastrand::Rng::with_seed(3);
    let mut decoder = Hc11Decoder::new(Framing::Double06);
    for _ in 0..1024 {
        let noise = [(); 1024].map(|()| random.u8(..));
        decoder.push(&noise, &mut |_| panic!("a packet in noise"));
        assert!(decoder.pending_bytes() < 68);
    }
    let stats = decoder.stats();
    assert_eq!(stats.bytes, 1 << 20);
    assert_eq!(stats.resyncs, 1);
    assert_eq!(
        stats.skipped_bytes + decoder.pending_bytes() as u64,
        stats.bytes
    );
    assert!(size_of::<Hc11Decoder>() < 1024);
}

#[test]
fn a_wrong_mark_rejects_a_packet_immediately() {
    let mut decoder = Hc11Decoder::new(Framing::Double06);
    let packet = encode(Framing::Double06, &[9; BODY_BYTES]);
    decoder.push(&packet, &mut |_| panic!("not confirmed yet"));
    assert_eq!(decoder.pending_bytes(), PACKET_BYTES);
    decoder.push(&[7], &mut |_| panic!("not confirmed"));
    assert_eq!(decoder.pending_bytes(), 0);
    assert_eq!(decoder.stats().resyncs, 1);
}

#[test]
fn a_packet_is_emitted_with_the_marks_of_the_next_one() {
    let mut decoder = Hc11Decoder::new(Framing::Double06);
    let mut packets = 0;
    let mut emit = |_| packets += 1;
    decoder.push(&encode(Framing::Double06, &[9; BODY_BYTES]), &mut emit);
    decoder.push(&[6], &mut emit);
    assert_eq!(decoder.stats().readings, 0);
    decoder.push(&[6], &mut emit);
    assert_eq!(decoder.stats().readings, 1);
    assert_eq!(packets, 1);
}

#[test]
fn bytes_before_a_reset_are_not_joined_with_bytes_after_it() {
    let packet = encode(Framing::Double06, &[9; BODY_BYTES]);
    let mut decoder = Hc11Decoder::new(Framing::Double06);
    decoder.push(&packet[..30], &mut |_| panic!("half a packet"));
    decoder.reset();
    assert_eq!(decoder.stats().skipped_bytes, 30);
    decoder.push(&packet[30..], &mut |_| panic!("the other half"));
    decoder.push(&[6, 6], &mut |_| panic!("confirmed the other half"));
}

#[test]
fn a_packet_takes_660_bit_times() {
    for (baud, expected) in [
        (9600, Duration::from_micros(68_750)),
        (660, Duration::from_secs(1)),
    ] {
        let format = Hc11Format {
            framing: Framing::Hash,
            baud: NonZeroU32::new(baud).unwrap(),
        };
        assert_eq!(format.packet_period(), expected);
        let format = StreamFormat::from(format);
        assert_eq!(format.packet_period(), Some(expected));
        assert_eq!(format.nominal_time(3).0, 3 * expected.as_micros() as u64);
    }
}
