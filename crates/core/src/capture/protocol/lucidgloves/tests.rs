use super::*;
use crate::capture::protocol::Decoder;

fn counts(line: &str, max: u16) -> Option<Vec<u16>> {
    let fields = Fields::parse(line.as_bytes()).ok()?;
    Some(fields.channels(max).counts.to_vec())
}

const UNKNOWN: u16 = Channels::UNKNOWN;

#[test]
fn a_line_of_the_firmware_is_decoded() {
    let line = "A100B200C300D400E500F2047G4095P0HJ(AB)2047(BB)0(CB)4095(DB)2047(EB)2047";
    let counts = counts(line, 4095).expect("a packet");
    assert_eq!(counts.len(), CHANNELS);
    assert_eq!(counts[CURL..SPLAY], [100, 200, 300, 400, 500]);
    assert_eq!(counts[SPLAY..JOINT], [2047, 0, 4095, 2047, 2047]);
    assert_eq!(
        counts[JOINT..JOINT + 8],
        [100, 100, 100, 100, 200, 200, 200, 200]
    );
    assert_eq!(counts[STICK_X..BUTTONS], [2047, 4095, 0]);
    assert_eq!(counts[BUTTONS..], [4095, 0, 4095, 0, 0, 0, 0, 0]);
}

#[test]
fn joints_take_precedence_over_the_curl_and_a_missing_finger_is_unknown() {
    let counts = counts("B1000(BAB)7(BAD)4095(DAC)12", 4095).expect("a packet");
    assert_eq!(
        counts[CURL..SPLAY],
        [UNKNOWN, 1000, UNKNOWN, UNKNOWN, UNKNOWN]
    );
    assert_eq!(counts[SPLAY..JOINT], [MIDDLE; 5]);
    let joints: Vec<&[u16]> = counts[JOINT..STICK_X].chunks(JOINTS).collect();
    assert_eq!(joints[1], [1000, 7, 1000, 4095]);
    assert_eq!(joints[3], [UNKNOWN, UNKNOWN, 12, UNKNOWN]);
    for unknown in [0, 2, 4] {
        assert_eq!(joints[unknown], [UNKNOWN; JOINTS]);
    }
    assert_eq!(
        counts[STICK_X..],
        [MIDDLE, MIDDLE, 0, 0, 0, 0, 0, 0, 0, 0, 0]
    );
}

#[test]
fn values_are_scaled_from_the_converter_and_clamped() {
    let curls = |line: &str, max: u16| counts(line, max).map(|counts| counts[..3].to_vec());
    assert_eq!(curls("A0B1023C512", 1023), Some(vec![0, 4095, 2050]));
    assert_eq!(
        curls("A-5B4096C99999999999999999999", 4095),
        Some(vec![0, 4095, 4095])
    );
    assert_eq!(curls("A1B0C2", 1), Some(vec![4095, 0, 4095]));
    // The trigger of the firmware reaches one more than the largest value.
    assert_eq!(counts("A0P4096", 4095).unwrap()[TRIGGER], 4095);
    // The largest count of a converter is never taken for an unknown one.
    assert_eq!(curls("A65535B0C0", 65535), Some(vec![4095, 0, 0]));
}

#[test]
fn a_legacy_line_is_decoded() {
    let counts = counts("1&2&3&4&5&2047&4095&0&1&0&1&0&1\r", 4095).expect("a packet");
    assert_eq!(counts[CURL..SPLAY], [1, 2, 3, 4, 5]);
    assert_eq!(counts[JOINT..JOINT + 4], [1; 4]);
    assert_eq!(counts[STICK_X..BUTTONS], [2047, 4095, 0]);
    assert_eq!(counts[BUTTONS..], [0, 4095, 0, 4095, 0, 4095, 0, 0]);
}

#[test]
fn lines_that_name_no_finger_or_are_damaged_are_no_packets() {
    for line in [
        // Blank lines of Wi-Fi gloves, information, boot messages.
        "",
        "\r",
        "Z(ZV)3(ZG)0(ZH)1",
        "(ZV)3(ZG)0(ZH)1",
        "rst:0x1 (POWERON_RESET),boot:0x13 (SPI_FAST_FLASH_BOOT)",
        "ets Jul 29 2019 12:21:46",
        "Starting the BLE work!",
        "BOOT",
        // Lines without a finger, such as the rest of one whose start was lost.
        "F2047G2047P0",
        "(EB)2047",
        "J",
        // Starts inside a number or a key.
        "95B200C300D400E500",
        "B)2047(BB)2047",
        // A cut line with the next one after it.
        "A100B200C3A100B200C300D400E500",
        "A1B2C3D4E5J(ABA1B2C3D4E5J",
        "A1B2JJ",
        // Wrong numbers and characters.
        "AB200",
        "A-B200",
        "A1 B2",
        "A1;B2",
        "A1.5",
        "a1b2",
        "()1A1",
        "(ABCD)1A1",
        "(A",
        "A1\0",
        "\u{feff}A1",
        // The wrong number of values.
        "1&2&3&4&5&6&7&8&9&10&11&12",
        "1&2&3&4&5&6&7&8&9&10&11&12&13&14",
        "1&2&3&4&5&6&7&8&9&10&11&12&x",
        "1&2&3&4&5&6&7&8&9&10&11&12&",
        "&&&&&&&&&&&&",
    ] {
        assert!(Fields::parse(line.as_bytes()).is_err(), "{line}");
    }
    assert!(Fields::parse(b"A1\xff").is_err());
    for (line, reason) in [
        ("A1B2A1B2", InvalidPacket::Truncated),
        ("1&2&3", InvalidPacket::Truncated),
        ("1&2&3&4&5&6&7&8&9&10&11&12&13&14", InvalidPacket::WrongSize),
        ("F1G2", InvalidPacket::Unknown),
        ("boot", InvalidPacket::Unknown),
    ] {
        let error = Fields::parse(line.as_bytes()).expect_err(line);
        assert_eq!(error.reason, reason, "{line}");
    }
}

#[test]
fn channels_that_a_line_does_not_name_are_unsent() {
    let unsent = |line: &str| {
        let fields = Fields::parse(line.as_bytes()).expect("a packet");
        let unsent = fields.channels(FULL_SCALE).unsent;
        let channels = (0..CHANNELS).filter(|channel| unsent.contains(*channel));
        channels.collect::<Vec<_>>()
    };
    let splays = [5, 6, 7, 8, 9];
    assert_eq!(unsent("A1B2C3D4E5"), [&splays[..], &[30, 31, 32]].concat());
    assert_eq!(unsent("A1F2047G2047P0"), splays);
    assert_eq!(unsent("A1F1G1P1(BB)2047(CB)2047"), [5, 8, 9]);
    assert_eq!(
        unsent("1&2&3&4&5&6&7&0&0&0&0&0&0"),
        [&splays[..], &[32]].concat()
    );
}

/// Returns the counts of some channels of a packet.
fn counts_of<const N: usize>(packet: Packet, channels: [usize; N]) -> [u16; N] {
    let Sample::Channels(sample) = packet.sample else {
        panic!("a glove sends channels");
    };
    channels.map(|channel| sample.counts[channel])
}

#[test]
fn a_joint_and_a_splay_that_an_earlier_line_had_are_0_if_they_are_left_out() {
    let mut decoder = decoder(FULL_SCALE);
    let mut seen = Vec::new();
    // The splay and the second joint of the index finger, of which the last line does not know the curl.
    let stream = "B900C5\nB900(BB)7(BAC)300\nB900\nC5\n";
    decoder.push(stream.as_bytes(), &mut |packet| {
        seen.push(counts_of(packet, [SPLAY + 1, JOINT + JOINTS + 2]));
    });
    assert_eq!(seen, [[MIDDLE, 900], [7, 300], [0, 0], [MIDDLE, UNKNOWN]]);
}

#[test]
fn a_glove_that_connects_again_may_measure_less() {
    let mut decoder = decoder(FULL_SCALE);
    let mut seen = Vec::new();
    // The curl, the splay and the second joint of the index finger.
    let mut emit = |packet| seen.push(counts_of(packet, [CURL + 1, SPLAY + 1, JOINT + JOINTS + 2]));
    decoder.push(b"B900(BB)7(BAC)300\n", &mut emit);
    decoder.reset();
    decoder.push(b"B800\n", &mut emit);
    assert_eq!(seen, [[900, 7, 300], [800, MIDDLE, 800]]);
}

#[test]
fn unknown_keys_are_ignored() {
    let plain = Fields::parse(b"A1B2");
    assert!(plain.is_ok());
    assert_eq!(Fields::parse(b"A1X9Q(XY)3(AZ)-4(FAA)2B2T"), plain);
}

#[test]
fn encoded_channels_are_decoded() {
    let mut channels = Channels {
        full_scale: FULL_SCALE,
        counts: (0..CHANNELS as u16).map(|count| 90 * count).collect(),
        unsent: Default::default(),
    };
    for (index, count) in channels.counts[BUTTONS..].iter_mut().enumerate() {
        *count = FULL_SCALE * (index as u16 % 2);
    }
    for unknown in [CURL + 2, JOINT + 8, JOINT + 9, JOINT + 10, JOINT + 11] {
        channels.counts[unknown] = UNKNOWN;
    }
    let line = Fields::from_channels(&channels).encode();
    let fields = Fields::parse(line.trim_end().as_bytes()).expect("a packet");
    assert_eq!(fields.channels(FULL_SCALE), channels);
    assert!(line.len() <= LucidParser::MAX_LINE_BYTES);
}

#[test]
fn a_stream_gives_the_packets_in_pieces_of_any_size() {
    let stream = "0C30\nA1B2C3\r\n\r\nrst:0x1\nA4B5(ZV)1\n1&2&3&4&5&6&7&0&0&0&0&0&0\nA7B8";
    for size in [1, 2, 7, 100] {
        let mut decoder = decoder(4095);
        let mut thumbs = Vec::new();
        let mut emit = |packet: Packet| match packet.sample {
            Sample::Channels(channels) => thumbs.push(channels.counts[0]),
            other => panic!("{other:?}"),
        };
        for piece in stream.as_bytes().chunks(size) {
            decoder.push(piece, &mut emit);
        }
        decoder.finish(&mut emit);
        assert_eq!(thumbs, [1, 4, 1, 7], "pieces of {size}");
        let stats = decoder.stats();
        assert_eq!((stats.readings, stats.skipped_bytes), (4, 5 + 2 + 8));
        assert_eq!(stats.resyncs, 2, "a blank line is no loss of packets");
    }
}

#[test]
fn the_first_line_of_a_serial_port_counts_if_its_start_shows() {
    for (first, expected) in [
        ("0&2&3&4&5&6&7&0&0&0&0&0&0", &[7][..]),
        ("A1B2C3", &[1, 7][..]),
        ("B2C3", &[7][..]),
        ("", &[7][..]),
    ] {
        let mut decoder = decoder(4095);
        decoder.start_anywhere();
        let mut thumbs = Vec::new();
        let stream = format!("{first}\r\n7&2&3&4&5&6&7&0&0&0&0&0&0\r\n");
        decoder.push(stream.as_bytes(), &mut |packet| match packet.sample {
            Sample::Channels(channels) => thumbs.push(channels.counts[0]),
            other => panic!("{other:?}"),
        });
        assert_eq!(thumbs, expected, "{first}");
    }
}

#[test]
fn an_endless_line_is_skipped_in_bounded_memory() {
    let mut decoder = decoder(4095);
    for _ in 0..1000 {
        decoder.push(&[b'A'; 1000], &mut |_| panic!("no line end"));
    }
    assert_eq!(decoder.line_capacity(), LucidParser::MAX_LINE_BYTES);
    let mut packets = 0;
    decoder.push(b"\nA1\n", &mut |_| packets += 1);
    assert_eq!((packets, decoder.stats().resyncs), (1, 1));
}
