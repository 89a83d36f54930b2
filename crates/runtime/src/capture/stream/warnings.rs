//! Warnings about a device from which nothing is understood.

use std::time::Duration;

use crate::capture::garbage::GarbageDetector;

/// Warns of bytes that form no packet. `error` is the reason of the decoder with its separator, or empty; `likely` states what the
/// bytes look like, and what to do.
pub fn garbage(name: &str, error: &str, likely: Option<String>) {
    let advice = match likely {
        Some(likely) => format!("it {likely}"),
        None => "check baud and protocol".to_owned(),
    };
    tracing::warn!(
        source = name,
        "no valid packet from {name} for {} s{error}; {advice}",
        GarbageDetector::TIMEOUT.as_secs()
    );
}

/// Warns that a stream had no packet up to its end. Takes the arguments of [`garbage`].
pub fn nothing_valid(name: &str, error: &str, likely: Option<String>) {
    let advice = likely.map_or(String::new(), |likely| format!("; it {likely}"));
    tracing::warn!(source = name, "no valid packet in {name}{error}{advice}");
}

/// Warns that no byte has arrived for a time.
pub fn no_byte(name: &str, time: Duration) {
    tracing::warn!(
        source = name,
        "no byte has arrived from {name} for {} s; check that the board has power and sends, and that its TX is wired to RX",
        time.as_secs()
    );
}
