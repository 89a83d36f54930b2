//! The glove's packets: every byte is counted once, however the stream is cut.

use ademan::capture::hc11::{BODY_BYTES, Framing, Hc11Decoder, PACKET_BYTES, body, encode};
use ademan::capture::protocol::Decoder;

/// The first byte says how long the pieces are that the rest comes in. Whether there was a frame.
pub fn packets(data: &[u8]) -> bool {
    let Some((&length, stream)) = data.split_first() else {
        return false;
    };
    let mut is_frame = false;
    for &framing in Framing::ALL {
        let whole = frames(framing, stream, stream.len().max(1));
        let cut = frames(framing, stream, usize::from(length).max(1));
        assert_eq!(whole, cut, "the frames depend on how the stream is cut");
        is_frame |= !whole.is_empty();
    }
    is_frame
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

/// Streams of frames, of which one in each framing is whole.
pub fn seeds() -> Vec<Vec<u8>> {
    let stream = |&framing: &Framing| {
        let frame = |number: u8| encode(framing, &std::array::from_fn(|at| number ^ at as u8));
        let frames = (0..12).flat_map(frame);
        std::iter::once(66).chain(frames).collect()
    };
    Framing::ALL.iter().map(stream).collect()
}
