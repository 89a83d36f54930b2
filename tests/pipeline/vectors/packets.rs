use ademan::capture::hc11::{Framing, Hc11Decoder};
use serde_json::Value;

use super::check::{bytes, list, text};

pub fn packets(file: &Value) -> usize {
    let cases = list(&file["cases"]);
    for case in cases {
        let name = text(&case["name"]);
        let framing: Framing = text(&case["framing"]).parse().expect("a framing");
        let rule = match framing {
            Framing::Double06 => "confirmed",
            Framing::Hash => "rescan",
        };
        let stream = bytes(&case["hex"]);
        let wanted: Vec<Vec<u8>> = list(&case["expected"][rule]).iter().map(bytes).collect();
        let early = case["expected"]["confirmed_before_end_of_stream"].as_u64();
        for cut in cuts(case, stream.len()) {
            let (frames, before_end) = decode(framing, &stream, &cut);
            assert_eq!(frames, wanted, "{name}, cut into {cut:?}");
            if let Some(early) = early {
                assert_eq!(before_end as u64, early, "{name}: out before the end");
            }
        }
    }
    cases.len()
}

/// The stream whole, byte by byte, and as the case cuts it.
fn cuts(case: &Value, length: usize) -> Vec<Vec<usize>> {
    let mut cuts = vec![vec![length], vec![1; length]];
    if let Some(chunks) = case["chunks"].as_array() {
        cuts.push(
            chunks
                .iter()
                .map(|size| size.as_u64().expect("a size") as usize)
                .collect(),
        );
    }
    cuts
}

/// The frames of a stream that comes in pieces of these sizes, and how many were out before its end.
fn decode(framing: Framing, stream: &[u8], pieces: &[usize]) -> (Vec<Vec<u8>>, usize) {
    let mut decoder = Hc11Decoder::new(framing);
    let mut frames = Vec::new();
    let mut rest = stream;
    for &size in pieces {
        let (piece, after) = rest.split_at(size.min(rest.len()));
        decoder.push(piece, &mut |frame| frames.push(frame.to_vec()));
        rest = after;
    }
    decoder.push(rest, &mut |frame| frames.push(frame.to_vec()));
    let before_end = frames.len();
    decoder.finish(&mut |frame| frames.push(frame.to_vec()));
    (frames, before_end)
}
