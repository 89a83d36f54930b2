//! The simulated gloves at the far ends of their lines, at the lines' real pace.

use std::io::{Result, Write};
use std::time::Instant;

use crossbeam_channel::{Receiver, at, select};

use super::{GloveCounts, SimulatedTypist};
use crate::capture::Hc11Format;
use crate::capture::hc11::{BODY_BYTES, encode};

/// What was played.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct PlaybackStats {
    /// Frames sent on each line.
    pub packets: u64,
    /// Whether it was told to end early.
    pub is_cancelled: bool,
}

/// The ends of lines that gloves write to, one for each hand.
pub type PacketWriters = Vec<Box<dyn Write + Send>>;

/// Writes the packets of a typist to a line for each hand until all is typed, or something comes in on
/// `stop`.
///
/// Each packet goes out when its last byte would have left the converter box at the line's baud.
pub fn play(
    mut typist: SimulatedTypist,
    writers: &mut PacketWriters,
    line: Hc11Format,
    stop: &Receiver<()>,
) -> Result<PlaybackStats> {
    let start = Instant::now();
    let mut played = PlaybackStats::default();
    while let Some(frame) = typist.next_packets() {
        played.packets += 1;
        let due = start + line.packet_period().mul_f64(played.packets as f64);
        select! {
            recv(stop) -> _ => {
                played.is_cancelled = true;
                return Ok(played);
            }
            recv(at(due)) -> _ => {}
        }
        for (writer, counts) in writers.iter_mut().zip(&frame) {
            writer.write_all(&encode(line.framing, &body(counts)))?;
        }
    }
    writers.iter_mut().try_for_each(|writer| writer.flush())?;
    Ok(played)
}

fn body(counts: &GloveCounts) -> [u8; BODY_BYTES] {
    let mut body = [0; BODY_BYTES];
    for (byte, count) in body.iter_mut().zip(counts) {
        // The converters of this glove have eight bits.
        *byte = (*count).min(255) as u8;
    }
    body
}
