//! The packets of the glove: every byte is counted once, for any split of the stream.

use ademan::capture::hc11::{BODY_BYTES, Framing, Hc11Decoder, PACKET_BYTES, body, encode};
use ademan::capture::protocol::Decoder;

/// Decodes an input. The first byte is the length of the pieces that the rest arrives in. Returns `true` if there is a
/// packet.
pub fn packets(data: &[u8]) -> bool {
    let Some((&length, stream)) = data.split_first() else {
        return false;
    };
    let mut has_packet = false;
    for &framing in Framing::ALL {
        let whole = bodies(framing, stream, stream.len().max(1));
        let cut = bodies(framing, stream, usize::from(length).max(1));
        assert_eq!(whole, cut, "the packets depend on the split of the stream");
        has_packet |= !whole.is_empty();
    }
    has_packet
}

fn bodies(framing: Framing, stream: &[u8], length: usize) -> Vec<[u8; BODY_BYTES]> {
    let mut decoder = Hc11Decoder::new(framing);
    let mut bodies = Vec::new();
    for piece in stream.chunks(length) {
        decoder.push(piece, &mut |packet| {
            bodies.push(body(&packet.sample).expect("channels"))
        });
        assert!(decoder.pending_bytes() < PACKET_BYTES + 2);
        check_counts(&decoder, bodies.len());
    }
    decoder.finish(&mut |packet| bodies.push(body(&packet.sample).expect("channels")));
    check_counts(&decoder, bodies.len());
    let counts = decoder.stats();
    assert_eq!(
        (decoder.pending_bytes(), counts.bytes),
        (0, stream.len() as u64)
    );
    bodies
}

fn check_counts(decoder: &Hc11Decoder, bodies: usize) {
    let counts = decoder.stats();
    let of_packets = PACKET_BYTES as u64 * counts.readings;
    let accounted = of_packets + counts.skipped_bytes + decoder.pending_bytes() as u64;
    assert_eq!(counts.bytes, accounted, "a byte is counted twice or never");
    assert_eq!(counts.readings, bodies as u64);
}

/// Returns a stream of packets in each framing.
pub fn seeds() -> Vec<Vec<u8>> {
    let stream = |&framing: &Framing| {
        let packet_of = |number: u8| encode(framing, &std::array::from_fn(|at| number ^ at as u8));
        let packets = (0..12).flat_map(packet_of);
        std::iter::once(66).chain(packets).collect()
    };
    Framing::ALL.iter().map(stream).collect()
}
