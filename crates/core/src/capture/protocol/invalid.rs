//! Packets that a decoder refuses, by reason.

use std::fmt;
use std::ops::{Add, AddAssign};

use serde::{Serialize, Serializer};

use crate::names::named_enum;

named_enum! {
    /// The reason why a decoder refuses a packet.
    pub enum InvalidPacket ("reason") {
        /// The packet ends too early.
        Truncated = "truncated",
        /// The packet is too long, or has another number of values than the protocol.
        WrongSize = "wrong-size",
        /// A value is not a finite number, or beyond what the sensor can measure.
        NotFinite = "not-finite",
        /// The packet repeats the time of an earlier packet, or was overtaken by it.
        OutOfOrder = "out-of-order",
        /// The packet was delayed for so long that it no longer shows the hand as it is.
        TooOld = "too-old",
        /// The packet comes from another sender than the packets before it.
        UnknownSender = "unknown-sender",
        /// The packet does not have the form of the protocol.
        Unknown = "unknown",
    }
}

/// Numbers of invalid packets by reason. Serialised as a map of the numbers that are not 0.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct InvalidPackets([u64; InvalidPacket::COUNT]);

impl InvalidPackets {
    /// Counts one packet.
    pub fn count(&mut self, reason: InvalidPacket) {
        self.0[reason.index()] += 1;
    }

    /// Returns the number of packets that are invalid for this reason.
    pub fn get(&self, reason: InvalidPacket) -> u64 {
        self.0[reason.index()]
    }

    /// Returns the number of all invalid packets.
    pub fn total(&self) -> u64 {
        self.0.iter().sum()
    }

    /// Iterates over the reasons that occurred, with their numbers.
    pub fn known(&self) -> impl Iterator<Item = (InvalidPacket, u64)> + '_ {
        let all = InvalidPacket::ALL.iter().copied().zip(self.0);
        all.filter(|(_, count)| *count > 0)
    }
}

impl Add for InvalidPackets {
    type Output = Self;

    fn add(mut self, other: Self) -> Self {
        self += other;
        self
    }
}

impl AddAssign for InvalidPackets {
    fn add_assign(&mut self, other: Self) {
        for (sum, count) in self.0.iter_mut().zip(other.0) {
            *sum += count;
        }
    }
}

impl Serialize for InvalidPackets {
    fn serialize<S: Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        serializer.collect_map(self.known())
    }
}

/// Error in a packet: its kind for the statistics, and its text for messages.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct PacketError {
    /// Kind of the error.
    pub reason: InvalidPacket,
    text: String,
}

impl PacketError {
    /// Creates an error; `text` states what is wrong with the packet.
    pub fn new(reason: InvalidPacket, text: impl Into<String>) -> Self {
        Self {
            reason,
            text: text.into(),
        }
    }

    /// Creates the error of a packet with `count` values instead of `expected`.
    pub(super) fn wrong_count(count: usize, expected: usize) -> Self {
        let reason = if count < expected {
            InvalidPacket::Truncated
        } else {
            InvalidPacket::WrongSize
        };
        Self::new(reason, format!("{count} values instead of {expected}"))
    }
}

impl fmt::Display for PacketError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(&self.text)
    }
}

impl std::error::Error for PacketError {}

impl From<serde_json::Error> for PacketError {
    fn from(error: serde_json::Error) -> Self {
        // Each packet is a text of its own: its first line is any line of a file.
        let text = error
            .to_string()
            .replace(" at line 1 column ", " at column ");
        let reason = match error.classify() {
            serde_json::error::Category::Eof => InvalidPacket::Truncated,
            _ if text.starts_with("number out of range") => InvalidPacket::NotFinite,
            _ if text.starts_with("invalid length") => InvalidPacket::WrongSize,
            _ => InvalidPacket::Unknown,
        };
        // The time is the only whole number of 64 bits in a line.
        let advice = if text.contains("expected u64") {
            "; `time_us` is a whole number of microseconds"
        } else {
            ""
        };
        Self::new(reason, text + advice)
    }
}

impl From<std::str::Utf8Error> for PacketError {
    fn from(error: std::str::Utf8Error) -> Self {
        Self::new(InvalidPacket::Unknown, error.to_string())
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn errors_of_json_are_counted_by_what_is_wrong() {
        for (json, reason) in [
            ("[1,2", InvalidPacket::Truncated),
            ("", InvalidPacket::Truncated),
            ("[1,2]", InvalidPacket::WrongSize),
            ("[1,2,1e999]", InvalidPacket::NotFinite),
            ("[1,2,\"x\"]", InvalidPacket::Unknown),
            ("hello", InvalidPacket::Unknown),
        ] {
            let error = serde_json::from_str::<[f64; 3]>(json).expect_err("an invalid packet");
            assert_eq!(PacketError::from(error).reason, reason, "{json}");
        }
    }

    #[test]
    fn a_time_that_is_no_whole_number_has_a_remedy() {
        for json in ["2.5", "-1", "\"12\""] {
            let error = serde_json::from_str::<Option<u64>>(json).expect_err("no time");
            let text = PacketError::from(error).to_string();
            let remedy = "; `time_us` is a whole number of microseconds";
            assert!(text.ends_with(remedy), "{text}");
        }
        let error = serde_json::from_str::<f64>("\"12\"").expect_err("no number");
        assert!(!PacketError::from(error).to_string().contains("time_us"));
    }

    #[test]
    fn an_error_of_json_has_the_column_in_its_line() {
        let error = serde_json::from_str::<[f64; 3]>("[1,2,x]").expect_err("no number");
        let error: Box<dyn std::error::Error> = PacketError::from(error).into();
        assert_eq!(error.to_string(), "expected value at column 6");
    }

    #[test]
    fn only_reasons_that_occurred_are_serialised() {
        let mut invalid = InvalidPackets::default();
        invalid.count(InvalidPacket::TooOld);
        let twice = invalid + invalid;
        assert_eq!(twice.total(), 2);
        assert_eq!(
            serde_json::to_string(&twice).expect("a map"),
            r#"{"too-old":2}"#
        );
    }
}
