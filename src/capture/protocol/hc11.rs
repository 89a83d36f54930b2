//! The packets of the HC11 glove: 64 counts between marks, found in a stream that may be cut anywhere.

use super::restart_text::TextDetector;
use crate::capture::{Channels, SourceStats};
use crate::names::named_enum;

/// Bytes between the marks of a frame: one per sensor channel, in wire order.
pub const BODY_BYTES: usize = 64;
/// Bytes of a whole frame on the wire, marks included, in both framings.
pub const PACKET_BYTES: usize = 66;

named_enum! {
    /// How a frame is marked. Neither framing escapes its data: a body may contain its own mark.
    #[derive(Default)]
    pub enum Framing ("framing") {
        /// Two bytes 06 before the body, as the glove's firmware sends them. A frame is let out when the
        /// two marks of the next one are in, or when the stream ends.
        #[default]
        Double06 = "double06",
        /// A `#` before the body and one after it. A frame is let out with its end mark.
        Hash = "hash",
    }
}

impl Framing {
    const fn mark(self) -> u8 {
        match self {
            Self::Double06 => 0x06,
            Self::Hash => b'#',
        }
    }

    /// Where marks must stand, counted from the first byte of a frame. Those at 66 and 67 are the next frame's.
    const fn mark_offsets(self) -> &'static [usize] {
        match self {
            Self::Double06 => &[0, 1, 66, 67],
            Self::Hash => &[0, 65],
        }
    }

    const fn body_start(self) -> usize {
        match self {
            Self::Double06 => 2,
            Self::Hash => 1,
        }
    }

    /// Bytes from the first mark of a frame that decide about it while the stream goes on.
    const fn bytes_to_decide(self) -> usize {
        match self {
            Self::Double06 => PACKET_BYTES + 2,
            Self::Hash => PACKET_BYTES,
        }
    }

    /// Judges whether a frame starts with `window`, as early as its bytes allow.
    fn judge(self, window: &[u8], bytes_to_decide: usize) -> Verdict<'_> {
        let is_wrong = |&place: &usize| window.get(place).is_some_and(|&byte| byte != self.mark());
        if self.mark_offsets().iter().any(is_wrong) {
            return Verdict::NotHere;
        }
        if window.len() < bytes_to_decide {
            return Verdict::Undecided;
        }
        match window
            .get(self.body_start()..)
            .and_then(<[u8]>::first_chunk)
        {
            Some(body) => Verdict::Frame(body),
            None => Verdict::Undecided,
        }
    }
}

enum Verdict<'a> {
    Frame(&'a [u8; BODY_BYTES]),
    NotHere,
    Undecided,
}

/// Writes `body` as the glove does: with the marks of `framing`.
pub fn encode(framing: Framing, body: &[u8; BODY_BYTES]) -> [u8; PACKET_BYTES] {
    let mut frame = [framing.mark(); PACKET_BYTES];
    frame[framing.body_start()..][..BODY_BYTES].copy_from_slice(body);
    frame
}

/// The counts that a frame's body carries: one byte for each channel, in wire order.
pub fn channels(body: &[u8; BODY_BYTES]) -> Channels {
    Channels {
        full_scale: u16::from(u8::MAX),
        counts: body.iter().copied().map(u16::from).collect(),
    }
}

/// Finds frames in a stream of bytes. The frames do not depend on how the stream is cut.
///
/// Follows the rules `confirmed` (for [`Framing::Double06`]) and `rescan` (for [`Framing::Hash`]) of the
/// glove's specification: the earliest start whose marks all fit wins; a start that does not fit moves on by
/// one byte. Holds a fixed number of bytes, whatever comes in.
///
/// Every byte is counted once: `bytes = 66 · readings + skipped_bytes + waiting`.
#[derive(Clone, Debug)]
pub struct Hc11Decoder {
    framing: Framing,
    buffer: [u8; CAPACITY],
    start: usize,
    end: usize,
    stats: SourceStats,
    is_searching: bool,
    text: TextDetector,
}

/// Room for the 67 bytes that may be undecided, and for enough new ones that moving them to the front is rare.
const CAPACITY: usize = 512;

impl Hc11Decoder {
    /// A decoder at the start of a stream.
    pub fn new(framing: Framing) -> Self {
        Self {
            framing,
            buffer: [0; CAPACITY],
            start: 0,
            end: 0,
            stats: SourceStats::default(),
            is_searching: false,
            text: TextDetector::default(),
        }
    }

    /// Takes the next bytes of the stream and hands each frame that is now certain to `emit`.
    pub fn push(&mut self, mut bytes: &[u8], emit: &mut impl FnMut(&[u8; BODY_BYTES])) {
        self.stats.bytes += bytes.len() as u64;
        while !bytes.is_empty() {
            self.move_to_front_when_full();
            let (piece, rest) = bytes.split_at(bytes.len().min(CAPACITY - self.end));
            self.buffer[self.end..][..piece.len()].copy_from_slice(piece);
            self.end += piece.len();
            self.settle(self.framing.bytes_to_decide(), emit);
            bytes = rest;
        }
    }

    /// Ends the stream: a whole frame that waited for the next one comes out, what is left is skipped.
    pub fn finish(&mut self, emit: &mut impl FnMut(&[u8; BODY_BYTES])) {
        self.settle(PACKET_BYTES, emit);
        self.reset();
    }

    /// Skips what waits, for a stream that broke off: what comes next has nothing to do with it.
    pub fn reset(&mut self) {
        self.stats.skipped_bytes += self.pending_bytes() as u64;
        (self.start, self.end) = (0, 0);
        self.is_searching = false;
    }

    /// Bytes that may still become part of a frame, 0..=67.
    pub fn pending_bytes(&self) -> usize {
        self.end - self.start
    }

    /// Whether a line of text has come in since the last call, after a frame: what a board says that starts
    /// anew.
    pub fn take_text(&mut self) -> bool {
        self.text.take()
    }

    /// What came in. `readings` are frames; `resyncs` are the runs of skipped bytes that were searched for a
    /// frame (the cut frame at the end of a stream is skipped without a search).
    pub fn stats(&self) -> SourceStats {
        self.stats
    }

    fn settle(&mut self, bytes_to_decide: usize, emit: &mut impl FnMut(&[u8; BODY_BYTES])) {
        loop {
            let window = &self.buffer[self.start..self.end];
            match self.framing.judge(window, bytes_to_decide) {
                Verdict::Frame(body) => {
                    emit(body);
                    self.start += PACKET_BYTES;
                    self.stats.readings += 1;
                    self.is_searching = false;
                    self.text.see_frame();
                }
                Verdict::NotHere => self.skip_byte(),
                Verdict::Undecided => return,
            }
        }
    }

    fn skip_byte(&mut self) {
        self.text.see_byte(self.buffer[self.start]);
        self.start += 1;
        self.stats.skipped_bytes += 1;
        self.stats.resyncs += u64::from(!self.is_searching);
        self.is_searching = true;
    }

    fn move_to_front_when_full(&mut self) {
        if self.end < CAPACITY {
            return;
        }
        self.buffer.copy_within(self.start..self.end, 0);
        (self.start, self.end) = (0, self.pending_bytes());
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::capture::test_random::Random;

    const VECTORS: &str = concat!(
        env!("CARGO_MANIFEST_DIR"),
        "/tests/vectors/glove_packets.json"
    );

    struct Case {
        name: String,
        framing: Framing,
        stream: Vec<u8>,
        chunks: Vec<usize>,
        frames: Vec<Vec<u8>>,
        before_end: Option<usize>,
    }

    fn unhex(text: &str) -> Vec<u8> {
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
        let frames = expected[rule].as_array().expect("frames of the rule");
        Case {
            name: case["name"].as_str().unwrap().to_owned(),
            framing,
            stream: unhex(case["hex"].as_str().unwrap()),
            chunks: serde_json::from_value(case["chunks"].clone()).unwrap(),
            frames: frames
                .iter()
                .map(|frame| unhex(frame.as_str().unwrap()))
                .collect(),
            before_end: expected["confirmed_before_end_of_stream"]
                .as_u64()
                .map(|count| count as usize),
        }
    }

    /// Decodes in pieces of the sizes given; the rest of the stream is the last piece.
    fn decode(
        case: &Case,
        sizes: impl IntoIterator<Item = usize>,
    ) -> (Vec<Vec<u8>>, usize, SourceStats) {
        let mut decoder = Hc11Decoder::new(case.framing);
        let mut frames = Vec::new();
        let mut emit = |body: &[u8; BODY_BYTES]| frames.push(body.to_vec());
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
        let counts = decoder.stats();
        assert_eq!(
            (counts.bytes, decoder.pending_bytes()),
            (66 * counts.readings + counts.skipped_bytes, 0)
        );
        (frames, before_end.readings as usize, counts)
    }

    #[test]
    fn the_vectors_decode_alike_however_they_are_cut() {
        let cases = cases();
        assert!(cases.len() > 30, "only {} cases", cases.len());
        let mut random = Random::new(1);
        for case in &cases {
            let (frames, before_end, counts) = decode(case, []);
            assert_eq!(frames, case.frames, "{}", case.name);
            if let Some(expected) = case.before_end {
                assert_eq!(before_end, expected, "{}", case.name);
            }
            let whole = (frames, before_end, counts);
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
                    .map(|_| random.below(130))
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
    fn what_is_encoded_comes_back_in_both_framings() {
        let mut random = Random::new(7);
        for &framing in Framing::ALL {
            let bodies: Vec<[u8; BODY_BYTES]> = (0..50)
                .map(|_| [(); BODY_BYTES].map(|()| random.byte()))
                .collect();
            let mut decoder = Hc11Decoder::new(framing);
            let mut frames = Vec::new();
            for body in &bodies {
                decoder.push(&encode(framing, body), &mut |body| frames.push(*body));
            }
            decoder.finish(&mut |body| frames.push(*body));
            assert_eq!(frames, bodies, "{framing}");
            assert_eq!(decoder.stats().skipped_bytes, 0, "{framing}");
        }
    }

    #[test]
    fn a_megabyte_of_noise_gives_no_frame_and_nothing_piles_up() {
        let mut random = Random::new(3);
        let mut decoder = Hc11Decoder::new(Framing::Double06);
        for _ in 0..1024 {
            let noise = [(); 1024].map(|()| random.byte());
            decoder.push(&noise, &mut |_| panic!("a frame in noise"));
            assert!(decoder.pending_bytes() < 68);
        }
        let counts = decoder.stats();
        assert_eq!(counts.bytes, 1 << 20);
        assert_eq!(counts.resyncs, 1);
        assert_eq!(
            counts.skipped_bytes + decoder.pending_bytes() as u64,
            counts.bytes
        );
        assert!(size_of::<Hc11Decoder>() < 1024);
    }

    #[test]
    fn a_wrong_mark_is_rejected_as_soon_as_it_is_seen() {
        let mut decoder = Hc11Decoder::new(Framing::Double06);
        let mut stream = encode(Framing::Double06, &[9; BODY_BYTES]).to_vec();
        decoder.push(&stream, &mut |_| panic!("not confirmed yet"));
        assert_eq!(decoder.pending_bytes(), PACKET_BYTES);
        stream.clear();
        decoder.push(&[7], &mut |_| panic!("not confirmed"));
        assert_eq!(decoder.pending_bytes(), 0);
        assert_eq!(decoder.stats().resyncs, 1);
    }

    #[test]
    fn a_frame_waits_for_the_next_marks_and_no_longer() {
        let mut decoder = Hc11Decoder::new(Framing::Double06);
        let mut frames = 0;
        let mut emit = |_: &[u8; BODY_BYTES]| frames += 1;
        decoder.push(&encode(Framing::Double06, &[9; BODY_BYTES]), &mut emit);
        decoder.push(&[6], &mut emit);
        assert_eq!(decoder.stats().readings, 0);
        decoder.push(&[6], &mut emit);
        assert_eq!(decoder.stats().readings, 1);
        assert_eq!(frames, 1);
    }

    #[test]
    fn what_waited_before_a_break_is_not_joined_with_what_comes_after() {
        let frame = encode(Framing::Double06, &[9; BODY_BYTES]);
        let mut decoder = Hc11Decoder::new(Framing::Double06);
        decoder.push(&frame[..30], &mut |_| panic!("half a frame"));
        decoder.reset();
        assert_eq!(decoder.stats().skipped_bytes, 30);
        decoder.push(&frame[30..], &mut |_| panic!("the other half"));
        decoder.push(&[6, 6], &mut |_| panic!("confirmed the other half"));
    }
}
