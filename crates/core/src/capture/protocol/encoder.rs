//! Encoders, which write readings as the packets of a protocol.

use std::time::Duration;

use super::{ProtocolOption, ProtocolOptions};
use crate::capture::{Reading, Sample};
use crate::hand::{JointPositions, Side};

/// Encoder of one byte stream, the inverse of a [`Decoder`](super::Decoder).
///
/// Appends the packet that shows readings of one time, one for each hand. Readings of another kind than the sample of the
/// protocol are left out.
pub type Encoder = Box<dyn FnMut(&[Reading], &mut Vec<u8>) + Send>;

/// The packets that an encoder is going to write.
#[derive(Clone, Copy)]
pub struct EncoderPlan<'a> {
    /// Time between two packets.
    pub packet_period: Duration,
    /// Counts the packets, for formats that state their number before the first one.
    pub count_packets: &'a dyn Fn() -> u64,
}

/// Checks that options have their defaults. The error names the first option that differs.
pub(super) fn require_defaults(
    options: &ProtocolOptions,
    required: &[&ProtocolOption],
) -> Result<(), String> {
    match required
        .iter()
        .find(|option| options.get(option) != option.default)
    {
        None => Ok(()),
        Some(ProtocolOption { name, default, .. }) => Err(format!(
            "a simulated sensor only sends `{name}={default}`; leave `{name}` out"
        )),
    }
}

/// Returns the hands whose joints the readings show. A reading without a side shows the right hand.
pub(super) fn hands(readings: &[Reading]) -> Vec<(Side, JointPositions)> {
    let hand = |reading: &Reading| match reading.sample {
        Sample::Joints { positions } => Some((reading.side.unwrap_or(Side::Right), positions)),
        _ => None,
    };
    readings.iter().filter_map(hand).collect()
}

/// Returns the time of the readings in microseconds.
pub(super) fn time_us(readings: &[Reading]) -> Option<u64> {
    readings.first().map(|reading| reading.time.0)
}
