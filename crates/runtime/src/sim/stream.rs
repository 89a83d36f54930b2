//! A simulated person whose readings go through the bytes of a protocol.

use std::collections::VecDeque;
use std::time::Duration;

use super::SimulatedTypist;
use crate::capture::protocol::{Carriers, Decoder, Encoder, EncoderPlan, Packet};
use crate::capture::{CaptureError, Reading, Source, SourceEvent, SourceStats, StreamFormat};
use ademan_core::hand::Side;
use ademan_core::time::Timestamp;

/// Packets per second of a protocol that states no rate.
const DEFAULT_RATE_HZ: f64 = 60.0;

/// Returns the time between two packets that a simulated person sends in a format: by its rate, else its bit rate.
pub fn packet_period(format: &StreamFormat) -> Duration {
    let rate_hz = (format.protocol.nominal_rate_hz)(&format.options);
    rate_hz
        .map(|rate_hz| Duration::from_secs_f64(1.0 / rate_hz))
        .or(format.packet_period())
        .unwrap_or(Duration::from_secs_f64(1.0 / DEFAULT_RATE_HZ))
}

/// A simulated person as a [`Source`] of what the decoder of a protocol makes of the bytes of its encoder.
///
/// A protocol that shows both hands has one stream; otherwise each hand has its own.
pub struct SimulatedStream {
    typist: SimulatedTypist,
    streams: Vec<Stream>,
    period: Duration,
    packets: u32,
    pending: VecDeque<Reading>,
    has_ended: bool,
}

/// The byte stream of one hand, or of all.
struct Stream {
    /// The hand; `None` if the stream shows all, or if there is only one.
    side: Option<Side>,
    encoder: Encoder,
    decoder: Box<dyn Decoder>,
    is_datagram: bool,
    period: Duration,
    /// Packets without a time of their own so far.
    packets: u32,
    /// The bytes of one packet.
    bytes: Vec<u8>,
}

impl SimulatedStream {
    /// Passes the readings of a person, whose sensors give samples of the protocol, through its bytes. An error states the
    /// option of the protocol that a simulated sensor does not support.
    pub fn new(typist: SimulatedTypist, format: &StreamFormat) -> Result<Self, String> {
        let period = packet_period(format);
        let plan = EncoderPlan {
            packet_period: period,
            count_packets: &|| typist.count_packets(),
        };
        let stream = |side: Option<Side>, own_format: StreamFormat| {
            Ok(Stream {
                side,
                encoder: own_format.encoder(&plan)?,
                decoder: own_format.decoder(),
                is_datagram: own_format.protocol.carriers == Carriers::Datagrams,
                period,
                packets: 0,
                bytes: Vec::new(),
            })
        };
        let has_two_hands = typist.hand_count() > 1;
        let streams: Result<Vec<Stream>, String> = if format.protocol.has_both_hands {
            stream(None, format.clone()).map(|stream| vec![stream])
        } else {
            typist
                .sides()
                .map(|side| stream(has_two_hands.then_some(side), format.clone().for_hand(side)))
                .collect()
        };
        Ok(Self {
            streams: streams?,
            typist,
            period,
            packets: 0,
            pending: VecDeque::new(),
            has_ended: false,
        })
    }

    /// Sends the next packet of each stream, or ends the streams.
    fn advance(&mut self) {
        let Some(samples) = self.typist.next_samples() else {
            self.has_ended = true;
            for stream in &mut self.streams {
                stream.finish(&mut self.pending);
            }
            return;
        };
        self.packets += 1;
        let time = Timestamp(0) + self.period * self.packets;
        let readings: Vec<Reading> = samples
            .into_iter()
            .map(|(side, sample)| Reading::new(time, Some(side), sample))
            .collect();
        for stream in &mut self.streams {
            let is_shown =
                |reading: &&Reading| stream.side.is_none() || reading.side == stream.side;
            let shown: Vec<Reading> = readings.iter().filter(is_shown).cloned().collect();
            stream.send(&shown, &mut self.pending);
        }
    }
}

impl Stream {
    /// Encodes a packet and decodes its bytes.
    fn send(&mut self, readings: &[Reading], pending: &mut VecDeque<Reading>) {
        self.bytes.clear();
        (self.encoder)(readings, &mut self.bytes);
        let mut receive = receiver(self.side, self.period, &mut self.packets, pending);
        self.decoder.push(&self.bytes, &mut receive);
        if self.is_datagram {
            self.decoder.finish(&mut receive);
        }
    }

    fn finish(&mut self, pending: &mut VecDeque<Reading>) {
        let mut receive = receiver(self.side, self.period, &mut self.packets, pending);
        self.decoder.finish(&mut receive);
    }
}

/// Returns a function that makes readings of packets.
fn receiver(
    side: Option<Side>,
    period: Duration,
    packets: &mut u32,
    pending: &mut VecDeque<Reading>,
) -> impl FnMut(Packet) {
    move |packet| {
        let time = packet.time.unwrap_or_else(|| {
            *packets += 1;
            Timestamp(0) + period * *packets
        });
        pending.push_back(Reading::new(time, packet.side.or(side), packet.sample));
    }
}

impl Source for SimulatedStream {
    fn next(&mut self) -> Result<SourceEvent, CaptureError> {
        if self.pending.is_empty() && !self.has_ended {
            self.advance();
        }
        Ok(match self.pending.pop_front() {
            Some(reading) => SourceEvent::Reading(reading),
            None if self.has_ended => SourceEvent::End,
            None => SourceEvent::Idle,
        })
    }

    fn name(&self) -> &str {
        self.typist.name()
    }

    fn packet_period(&self) -> Option<Duration> {
        Some(self.period)
    }

    fn is_live(&self) -> bool {
        false
    }

    fn stats(&self) -> SourceStats {
        let mut stats = SourceStats::default();
        for stream in &self.streams {
            let decoded = stream.decoder.stats();
            stats.readings += decoded.readings;
            stats.bytes += decoded.bytes;
            stats.skipped_bytes += decoded.skipped_bytes;
            stats.resyncs += decoded.resyncs;
            stats.invalid += decoded.invalid;
        }
        stats.readings -= self.pending.len() as u64;
        stats
    }
}
