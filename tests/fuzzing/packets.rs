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
        let whole = frames(framing, stream, stream.len().max(1));
        let cut = frames(framing, stream, usize::from(length).max(1));
        assert_eq!(whole, cut, "the packets depend on the split of the stream");
        has_packet |= !whole.is_empty();
    }
    has_packet
}

fn frames(framing: Framing, stream: &[u8], length: usize) -> Vec<[u8; BODY_BYTES]> {
    let mut decoder = Hc11Decoder::new(framing);
    let mut frames = Vec::new();
    for piece in stream.chunks(length) {
        decoder.push(piece, &mut |packet| {
            frames.push(body(&packet.sample).expect("channels"))
        });
        assert!(decoder.pending_bytes() < PACKET_BYTES + 2);
        check_counts(&decoder, frames.len());
    }
    decoder.finish(&mut |packet| frames.push(body(&packet.sample).expect("channels")));
    check_counts(&decoder, frames.len());
    let counts = decoder.stats();
    assert_eq!(
        (decoder.pending_bytes(), counts.bytes),
        (0, stream.len() as u64)
    );
    frames
}

fn check_counts(decoder: &Hc11Decoder, frames: usize) {
    let counts = decoder.stats();
    let of_frames = PACKET_BYTES as u64 * counts.readings;
    let accounted = of_frames + counts.skipped_bytes + decoder.pending_bytes() as u64;
    assert_eq!(counts.bytes, accounted, "a byte is counted twice or never");
    assert_eq!(counts.readings, frames as u64);
}

/// Returns a stream of packets in each framing.
pub fn seeds() -> Vec<Vec<u8>> {
    let stream = |&framing: &Framing| {
        let frame = |number: u8| encode(framing, &std::array::from_fn(|at| number ^ at as u8));
        let frames = (0..12).flat_map(frame);
        std::iter::once(66).chain(frames).collect()
    };
    Framing::ALL.iter().map(stream).collect()
}
