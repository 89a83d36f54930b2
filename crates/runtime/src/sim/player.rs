//! Playback of a simulated person to the far ends of loopback lines, in real time.

use std::io::{Result, Write};
use std::time::{Duration, Instant};

use crossbeam_channel::{Receiver, at, select};

use super::{GloveCounts, SimulatedTypist};
use crate::capture::Hc11Format;
use crate::capture::hc11::{BODY_BYTES, encode};

/// Longest lateness that packets catch up by following each other faster than on a line. A longer burst would show a hand that moves
/// faster than it does, and the session drops the oldest readings of a burst.
const MAX_LATENESS: Duration = Duration::from_millis(20);

/// Statistics of a playback.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct PlaybackStats {
    /// Packets written to each line.
    pub packets: u64,
    /// `true` if the playback was cancelled before its end.
    pub is_cancelled: bool,
}

/// The ends of lines that gloves write to, one for each hand.
pub type PacketWriters = Vec<Box<dyn Write + Send>>;

/// Writes the packets of a simulated person, one line for each hand, until the end or until `cancel` receives.
///
/// Each packet is written at the time at which a converter box would have sent its last byte at the baud of the line. If this thread is
/// late, the hand pauses.
pub fn play(
    mut typist: SimulatedTypist,
    writers: &mut PacketWriters,
    format: Hc11Format,
    cancel: &Receiver<()>,
) -> Result<PlaybackStats> {
    let mut start = Instant::now();
    let mut stats = PlaybackStats::default();
    while let Some(packets) = typist.next_packets() {
        stats.packets += 1;
        let due = start + format.packet_period().mul_f64(stats.packets as f64);
        let lateness = Instant::now().saturating_duration_since(due);
        if lateness > MAX_LATENESS {
            start += lateness;
        }
        select! {
            recv(cancel) -> _ => {
                stats.is_cancelled = true;
                return Ok(stats);
            }
            recv(at(due)) -> _ => {}
        }
        for (writer, counts) in writers.iter_mut().zip(&packets) {
            writer.write_all(&encode(format.framing, &body(counts)))?;
        }
    }
    writers.iter_mut().try_for_each(|writer| writer.flush())?;
    Ok(stats)
}

fn body(counts: &GloveCounts) -> [u8; BODY_BYTES] {
    let mut body = [0; BODY_BYTES];
    for (byte, count) in body.iter_mut().zip(counts) {
        // The converters of this glove have eight bits.
        *byte = (*count).min(255) as u8;
    }
    body
}
