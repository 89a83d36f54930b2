//! Readings that a source has decoded and not yet passed on.

use std::collections::VecDeque;
use std::time::Instant;

use super::low_counts::LowCounts;
use super::warnings;
use crate::capture::packet_clock::PacketClock;
use crate::capture::protocol::{InvalidPacket, InvalidPackets, Packet, StreamFormat};
use crate::capture::sender_clock::SenderClock;
use crate::capture::{Reading, SourceEvent};

/// Readings of the last read, in order.
pub struct PendingReadings {
    pub readings: VecDeque<Reading>,
    clock: PacketClock,
    /// The clock that detects old readings; `None` if old readings are not dropped.
    pub sender: Option<SenderClock>,
    /// Readings that were dropped because of their age.
    pub too_old: InvalidPackets,
    /// Number of packets so far that the decoder has refused because they state much earlier times than a packet before them.
    earlier: u64,
    /// `true` if the latest reading was too old.
    is_late: bool,
    /// The value of `is_late` at the latest call of [`warn`](Self::warn).
    was_late: bool,
    low_counts: LowCounts,
    /// `true` if a warning about the counts is due.
    has_low_counts: bool,
}

impl PendingReadings {
    /// Creates an empty queue of a stream with room for this number of readings.
    pub fn new(capacity: usize, is_live: bool, format: &StreamFormat) -> Self {
        Self {
            readings: VecDeque::with_capacity(capacity),
            clock: PacketClock::new(is_live),
            sender: None,
            too_old: InvalidPackets::default(),
            earlier: 0,
            is_late: false,
            was_late: false,
            low_counts: LowCounts::new(format),
            has_low_counts: false,
        }
    }

    /// Adds a packet of a stream of which `received` bytes had arrived by `now`, unless it is too old.
    pub fn push(&mut self, packet: Packet, now: Instant, received: u64, format: &StreamFormat) {
        if let (Some(sender), Some(sent_at)) = (&mut self.sender, packet.sent_at) {
            self.is_late = sender.is_too_old(now, sent_at);
            if self.is_late {
                self.too_old.count(InvalidPacket::TooOld);
                return;
            }
        }
        self.has_low_counts |= self.low_counts.update(&packet.sample);
        let bytes_after = received.saturating_sub(packet.end) as usize;
        let (nominal, sent_at) = (packet.time, packet.sent_at);
        self.readings.push_back(Reading {
            time: self.clock.stamp(now, bytes_after, format, nominal, sent_at),
            side: packet.side,
            part: packet.part,
            sample: packet.sample,
        });
    }

    /// Handles bytes without a packet that arrived at `now`; `refused` are all packets so far that the decoder has refused.
    pub fn note_refused(&mut self, now: Instant, refused: InvalidPackets) {
        let earlier = refused.get(InvalidPacket::TooOld);
        if let Some(sender) = &mut self.sender
            && earlier > self.earlier
        {
            sender.note_refused(now);
        }
        self.earlier = earlier;
    }

    /// Warns if readings began to be too old since the latest call, and if their counts are too low.
    pub fn warn(&mut self, name: &str) {
        if self.is_late && !self.was_late {
            warnings::too_late(name);
        }
        self.was_late = self.is_late;
        if std::mem::take(&mut self.has_low_counts) {
            warnings::low_counts(name);
        }
    }

    /// Removes the oldest reading.
    pub fn pop(&mut self) -> Option<SourceEvent> {
        self.readings.pop_front().map(SourceEvent::Reading)
    }
}
