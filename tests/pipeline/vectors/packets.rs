use ademan::capture::hc11::{Framing, Hc11Decoder, body};
use ademan::capture::protocol::Decoder;
use serde_json::Value;

use super::check::{bytes, list, text};

pub fn packets(file: &Value) -> usize {
    let cases = list(&file["cases"]);
    for case in cases {
        let name = text(&case["name"]);
        let framing: Framing = text(&case["framing"]).parse().expect("a valid framing");
        let rule = match framing {
            Framing::Double06 => "confirmed",
            Framing::Hash => "rescan",
        };
        let stream = bytes(&case["hex"]);
        let wanted: Vec<Vec<u8>> = list(&case["expected"][rule]).iter().map(bytes).collect();
        let before_end = case["expected"]["confirmed_before_end_of_stream"].as_u64();
        for cut in cuts(case, stream.len()) {
            let (packets, decoded_early) = decode(framing, &stream, &cut);
            assert_eq!(packets, wanted, "{name}, cut into {cut:?}");
            if let Some(before_end) = before_end {
                assert_eq!(decoded_early as u64, before_end, "{name}: before the end");
            }
        }
    }
    cases.len()
}

/// Returns the chunk sizes to test: the whole stream, single bytes, and the sizes of the case.
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

/// Decodes a stream in chunks of these sizes. Returns the packets and the number decoded before the end of the stream.
fn decode(framing: Framing, stream: &[u8], sizes: &[usize]) -> (Vec<Vec<u8>>, usize) {
    let mut decoder = Hc11Decoder::new(framing);
    let mut packets = Vec::new();
    let mut rest = stream;
    for &size in sizes {
        let (chunk, after) = rest.split_at(size.min(rest.len()));
        decoder.push(chunk, &mut |packet| {
            packets.push(body(&packet.sample).expect("channels").to_vec())
        });
        rest = after;
    }
    decoder.push(rest, &mut |packet| {
        packets.push(body(&packet.sample).expect("channels").to_vec())
    });
    let before_end = packets.len();
    decoder.finish(&mut |packet| packets.push(body(&packet.sample).expect("channels").to_vec()));
    (packets, before_end)
}
