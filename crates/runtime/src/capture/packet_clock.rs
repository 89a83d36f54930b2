//! Time stamps of packets.

use std::time::{Duration, Instant};

use super::RESTART_PAUSE;
use super::protocol::StreamFormat;
use ademan_core::time::Timestamp;

/// Latest time that is used as a packet states it: 285 years. Later packets get times that are 1 µs apart.
const LATEST: Timestamp = Timestamp(1 << 53);

/// Clock that stamps the packets of a stream.
pub(super) enum PacketClock {
    /// Monotonic time since the source was opened.
    Live { opened: Instant, last: Timestamp },
    /// Time that the packets state, else their number times the nominal packet period.
    Nominal {
        packets: u64,
        last: Timestamp,
        /// The latest time that a packet has stated.
        stated: Timestamp,
        /// Time by which packets are later than they state, because their sender has started again.
        shift: Duration,
    },
}

impl PacketClock {
    /// Creates a clock that starts now.
    pub fn new(is_live: bool) -> Self {
        let last = Timestamp::default();
        if is_live {
            Self::Live {
                opened: Instant::now(),
                last,
            }
        } else {
            Self::Nominal {
                packets: 0,
                last,
                stated: Timestamp::default(),
                shift: Duration::ZERO,
            }
        }
    }

    /// Returns the time at which the last byte of a packet arrived, if `bytes_after` more bytes had arrived by `now`.
    /// Always later than the previous result. `nominal` is the time of the packet in a file, if it has one, and `sent_at` the time that
    /// its sender states.
    pub fn stamp(
        &mut self,
        now: Instant,
        bytes_after: usize,
        format: &StreamFormat,
        nominal: Option<Timestamp>,
        sent_at: Option<Timestamp>,
    ) -> Timestamp {
        let (time, last) = match self {
            Self::Live { opened, last } => {
                let arrived = Timestamp::default() + now.saturating_duration_since(*opened);
                (arrived - format.transmission_time(bytes_after), last)
            }
            Self::Nominal {
                packets,
                last,
                stated,
                shift,
            } => {
                *packets += 1;
                let time = nominal.unwrap_or_else(|| format.nominal_time(*packets));
                if let Some(sent_at) = sent_at {
                    if sent_at < *stated {
                        // Without the shift, all packets of the new run would be in the past, and get times 1 µs apart.
                        *shift = (*last + RESTART_PAUSE).since(sent_at);
                    }
                    *stated = sent_at;
                }
                (time + *shift, last)
            }
        };
        *last = time.min(LATEST).max(Timestamp(last.0 + 1));
        *last
    }
}

#[cfg(test)]
mod tests {
    use std::num::NonZeroU32;

    use super::*;
    use crate::capture::hc11::Hc11Format;
    use crate::capture::protocol::text_line;

    #[test]
    fn packets_of_one_read_are_dated_back_by_the_bytes_after_them() {
        let format = StreamFormat::from(Hc11Format {
            baud: NonZeroU32::new(9600).unwrap(),
            ..Hc11Format::default()
        });
        let mut clock = PacketClock::new(true);
        let PacketClock::Live { opened, .. } = clock else {
            panic!("not live");
        };
        let now = opened + Duration::from_secs(1);
        let mut stamp = |at, bytes| clock.stamp(at, bytes, &format, None, None).0;
        assert_eq!(stamp(now, 96), 900_000);
        assert_eq!(stamp(now, 30), 968_750);
        assert_eq!(stamp(now, 96), 968_751);
        assert_eq!(stamp(opened, 0), 968_752);
        assert_eq!(stamp(now + Duration::from_secs(1), 0), 2_000_000);
    }

    /// Returns the times in a file of packets that state these times.
    fn stamped(stated: impl IntoIterator<Item = u64>) -> Vec<u64> {
        let format = StreamFormat::new(&text_line::PROTOCOL);
        let mut clock = PacketClock::new(false);
        let now = Instant::now();
        let mut stamp = |time| {
            let time = Some(Timestamp(time));
            clock.stamp(now, 0, &format, time, time).0
        };
        stated.into_iter().map(&mut stamp).collect()
    }

    #[test]
    fn packets_of_a_sender_that_has_started_again_follow_after_a_pause_at_their_distances() {
        let stated = [2_000_000, 2_010_000, 2_010_000, 5_000, 15_000, 0];
        let expected = [
            2_000_000, 2_010_000, 2_010_001, 3_010_001, 3_020_001, 4_020_001,
        ];
        assert_eq!(stamped(stated), expected);
    }

    #[test]
    fn packets_of_a_sender_that_starts_again_and_again_from_its_latest_time_stay_in_order() {
        let times = stamped((0..5000).map(|index| LATEST.0 * (index % 2)));
        assert!(times.windows(2).all(|pair| pair[0] < pair[1]));
    }
}
