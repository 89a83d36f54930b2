//! Warnings about a device from which nothing is understood.

use std::time::Duration;

use crate::capture::garbage::GarbageDetector;

/// Warns of bytes that form no packet. `error` is the reason of the decoder with its separator, or empty.
pub fn garbage(name: &str, error: &str) {
    tracing::warn!(
        source = name,
        "no valid packet from {name} for {} s{error}; check baud and protocol",
        GarbageDetector::TIMEOUT.as_secs()
    );
}

/// Warns that no byte has arrived for a time.
pub fn no_byte(name: &str, time: Duration) {
    tracing::warn!(
        source = name,
        "no byte has arrived from {name} for {} s; check that the board has power and sends, and that its TX is wired to RX",
        time.as_secs()
    );
}
