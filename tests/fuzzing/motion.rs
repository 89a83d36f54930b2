//! Texts of motion capture and lines of cameras: every byte is counted once, for any split of the stream.

use ademan::capture::Sample;
use ademan::capture::protocol::{Packet, Protocol, ProtocolOptions, bvh, markers};

/// Decodes a motion capture text. The first byte is the length of the pieces that the rest arrives in. Returns `true` if
/// there is a frame.
pub fn bvh(data: &[u8]) -> bool {
    decode(&bvh::PROTOCOL, data)
}

/// Decodes lines of markers. The first byte is the length of the pieces that the rest arrives in. Returns `true` if there
/// is a line that gives a position.
pub fn markers(data: &[u8]) -> bool {
    decode(&markers::PROTOCOL, data)
}

fn decode(protocol: &Protocol, data: &[u8]) -> bool {
    let Some((&length, stream)) = data.split_first() else {
        return false;
    };
    let whole = packets(protocol, stream, stream.len().max(1));
    let cut = packets(protocol, stream, usize::from(length).max(1));
    // Two numbers that are not finite are never equal.
    let (whole, cut) = (format!("{whole:?}"), format!("{cut:?}"));
    assert_eq!(whole, cut, "the packets depend on the split of the stream");
    whole != "[]"
}

fn packets(protocol: &Protocol, stream: &[u8], length: usize) -> Vec<Packet> {
    let mut decoder = (protocol.decoder)(&ProtocolOptions::default());
    let mut packets = Vec::new();
    for piece in stream.chunks(length) {
        decoder.push(piece, &mut |packet| packets.push(packet));
        let counts = decoder.stats();
        let not_used = counts.skipped_bytes + decoder.pending_bytes() as u64;
        assert!(not_used <= counts.bytes, "a byte is counted twice");
    }
    decoder.finish(&mut |packet| packets.push(packet));
    let counts = decoder.stats();
    assert_eq!(
        (decoder.pending_bytes(), counts.bytes),
        (0, stream.len() as u64)
    );
    assert_eq!(counts.readings, packets.len() as u64);
    for packet in &packets {
        let Sample::Joints { positions } = &packet.sample else {
            panic!("{packet:?}");
        };
        assert!(!positions.is_empty());
        assert!(packet.end <= stream.len() as u64);
    }
    packets
}

/// Returns motion capture texts, the first byte being the length of the pieces.
pub fn bvh_seeds() -> Vec<Vec<u8>> {
    let hand = "HIERARCHY\r\nROOT Hips\r\n{\r\n\tOFFSET 0 9.5e1 0\r\n\tCHANNELS 6 Xposition Yposition Zposition \
        Zrotation Xrotation Yrotation\r\n\tJOINT RightArm\r\n\t{\r\n\t\tOFFSET -18 45 0\r\n\t\tCHANNELS 3 Zrotation \
        Xrotation Yrotation\r\n\t\tJOINT RightHand\r\n\t\t{\r\n\t\t\tOFFSET -50 0 0\r\n\t\t\tCHANNELS 0\r\n\t\t\tEnd \
        Site\r\n\t\t\t{\r\n\t\t\t\tOFFSET -18 0 0\r\n\t\t\t}\r\n\t\t}\r\n\t}\r\n}\r\nMOTION\r\nFrames:\t3\r\nFrame \
        Time: .0083333\r\n1 2 3 4 5 6 7 8 9\r\n-1 -2 -3 -4 -5 -6 -7 -8 -9\r\n0 0 0 0 0 0 0 0 1e-3\r\n";
    let mixed = "hierarchy root rhand { offset 0 0 0 channels 1 YROTATION end site { offset 1 1 1 } } motion Frames:2 \
        Frame Time:0.01 45 90";
    [seeds(&[hand, mixed]), super::hostile::bvh()].concat()
}

/// Returns lines of cameras, the first byte being the length of the pieces.
pub fn marker_seeds() -> Vec<Vec<u8>> {
    let labelled = r#"{"time_us":12500,"cameras":[{"position":[2,2,2],"markers":[{"label":"elbow","point":[1,1.5,1]}]},
        {"position":[-2,2,2],"markers":[{"label":"elbow","direction":[2,-1,-2]},{"direction":[2,-1,-2.5]}]}]}"#;
    let images = r#"{"cameras":[{"position":[0,1,2],"orientation":[1,0,0,0],"focal_px":[800,800],"center_px":[640,360],
        "markers":[{"label":"RWRA","image":[720,360]},{"label":"RWRB","image":[700,360]},{"image":[1,2]}]},
        {"position":[2.2,1,0],"markers":[{"label":"RWRA","direction":[-3,0,0]},{"direction":[-3,0,0.01]}]},
        {"position":[2.2,1.5,0],"markers":[{"direction":[-3,-0.5,0]}]}]}"#;
    seeds(&[labelled, images].map(|line| format!("{}\n", line.replace('\n', " ")).repeat(2)))
}

fn seeds(texts: &[impl AsRef<str>]) -> Vec<Vec<u8>> {
    let seed = |text: &str| std::iter::once(40).chain(text.bytes()).collect();
    texts.iter().map(|text| seed(text.as_ref())).collect()
}
