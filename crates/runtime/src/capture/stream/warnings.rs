//! Warnings about the bytes and the readings of a source.

use std::time::Duration;

use crate::capture::connection::Connector;
use crate::capture::garbage::GarbageDetector;
use crate::capture::protocol::{Decoder, PacketError, StreamFormat};
use ademan_core::message::escape;

/// Warns of bytes that form no packet. `likely` states what the bytes look like, and what to do.
pub fn garbage(name: &str, decoder: &dyn Decoder, likely: Option<String>, format: &StreamFormat) {
    let error = decoder.last_error();
    let seconds = GarbageDetector::TIMEOUT.as_secs();
    if format.baud.is_none() && likely.is_none() && error.is_none() && is_understood(decoder) {
        tracing::warn!(
            source = name,
            "{name} sends valid packets, but none has shown an arm or hand for {seconds} s; check that it sees the hand"
        );
        return;
    }
    let advice = match (likely, error) {
        (Some(likely), _) => format!("; it {likely}"),
        // A wrong bit rate changes bytes, so that any error may follow.
        _ if format.baud.is_some() => "; check baud and protocol".to_owned(),
        (None, Some(_)) => String::new(),
        (None, None) => "; check protocol and its options".to_owned(),
    };
    tracing::warn!(
        source = name,
        "no valid packet from {name} for {seconds} s{}{advice}",
        reason(error)
    );
}

/// Returns `true` if bytes were read that are neither skipped nor pending: images without a hand are valid and give no packet.
fn is_understood(decoder: &dyn Decoder) -> bool {
    let stats = decoder.stats();
    stats.bytes > stats.skipped_bytes + decoder.pending_bytes() as u64
}

/// Warns that most packets are invalid, for the reason of the latest one.
pub fn nearly_all_invalid(name: &str, error: &PacketError) {
    tracing::warn!(
        source = name,
        "nearly all packets from {name} for {} s are invalid{}",
        GarbageDetector::TIMEOUT.as_secs(),
        reason(Some(error))
    );
}

/// Warns that a stream had no packet up to its end. Takes the arguments of [`garbage`].
pub fn nothing_valid(name: &str, error: Option<&PacketError>, likely: Option<String>) {
    let advice = likely.map_or(String::new(), |likely| format!("; it {likely}"));
    let error = reason(error);
    tracing::warn!(source = name, "no valid packet in {name}{error}{advice}");
}

/// Returns the error in the latest packet, with its separator; empty if there is none.
fn reason(error: Option<&PacketError>) -> String {
    error.map_or(String::new(), |error| {
        format!(": {}", escape(&error.to_string()))
    })
}

/// Warns that several senders send at the same time, of which one is read.
pub fn several_senders(name: &str) {
    tracing::warn!(
        source = name,
        "several senders send to {name}, and only one is read; end the others, or let a program that opens a socket for each packet \
         keep one"
    );
}

/// Warns that readings are dropped because of their age.
pub fn too_late(name: &str) {
    tracing::warn!(
        source = name,
        "readings from {name} arrive too late and are dropped; the network or its router is overloaded"
    );
}

/// Warns that the counts of fingers look like counts of a converter with fewer bits than the source states.
pub fn low_counts(name: &str) {
    tracing::warn!(
        source = name,
        "no finger of {name} has a count above 1023 of 4095; if the converter of the glove has 10 bits, as on an Arduino Nano, add \
         `max=1023` to the source, and repeat a calibration that was made without it"
    );
}

/// Warns that no byte, datagram or message has arrived for a time.
pub fn no_byte<C: Connector>(name: &str, time: Duration) {
    let (missing, advice) = if C::IS_DATAGRAM {
        (
            "no datagram has arrived at",
            "start the program that sends, and check its address and port",
        )
    } else if C::HAS_SENDERS {
        (
            "no message has arrived at",
            "start the program or open the page that sends, and check its address and port",
        )
    } else {
        (
            "no byte has arrived from",
            "check that the board has power and sends, and that its TX is wired to RX",
        )
    };
    tracing::warn!(
        source = name,
        "{missing} {name} for {} s; {advice}",
        time.as_secs()
    );
}
