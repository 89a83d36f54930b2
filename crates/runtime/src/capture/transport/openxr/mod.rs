//! Hands that an OpenXR runtime tracks, located at a fixed rate and passed on as lines of the protocol `openxr`.
//!
//! The session has no graphics (`XR_MND_headless`), so it runs beside the application that draws in the headset.

#[cfg(feature = "openxr")]
mod advice;
#[cfg(feature = "openxr")]
mod hand_session;
#[cfg(feature = "openxr")]
mod session_state;
#[cfg(feature = "openxr")]
mod system;
#[cfg(feature = "openxr")]
pub use self::hand_session::{HandSession, describe_runtime};

#[cfg(not(feature = "openxr"))]
mod unsupported;
#[cfg(not(feature = "openxr"))]
pub use self::unsupported::{HandSession, describe_runtime};

use std::io::{Error, ErrorKind, Read, Result};
use std::ops::RangeInclusive;
use std::thread;
use std::time::{Duration, Instant};

use super::{Scheme, Transport, open_stream};
use crate::capture::connection::{ByteStream, ConnectError, Connection, Connector, READ_TIMEOUT};
use ademan_core::capture::protocol::joint_sets::{OPENXR, encode};
use ademan_core::hand::{JointPositions, Side};
use ademan_core::message::escape;

/// The `openxr` transport.
pub const TRANSPORT: Transport = Transport {
    scheme: SCHEME,
    is_remote: false,
    is_datagram: true,
    needs_token: false,
    is_device: true,
    has_address: false,
    default_baud: None,
    // `doctor` checks the runtime in any case.
    probe: None,
    check_address: |address| match address {
        "" => Ok(()),
        _ => Err("`openxr:` has no address, write `openxr:` or `openxr:?rate_hz=120`".to_owned()),
    },
    open: |uri| {
        let connector = OpenXrConnector {
            name: uri.to_string(),
            rate_hz: uri.rate_hz,
        };
        open_stream(uri, connector)
    },
};

const SCHEME: Scheme = Scheme {
    name: "openxr",
    syntax: "openxr:",
    summary: "hands that an OpenXR runtime such as Monado or WiVRn tracks (feature `openxr`)",
    example: "openxr:?rate_hz=90",
};

/// Rate of a runtime that does not state the rate of its display, in hertz.
const DEFAULT_RATE_HZ: u32 = 90;

/// Rates at which hands can be located, in hertz.
const RATES_HZ: RangeInclusive<u32> = 1..=1000;

/// Longest time in which a runtime has to answer. A later answer shows hands of the past and is dropped.
const MAX_ANSWER_TIME: Duration = Duration::from_millis(50);

/// `true` if the program was built with the feature `openxr`.
pub const HAS_OPENXR: bool = cfg!(feature = "openxr");

/// Checks the option `protocol`, which has one value.
pub fn check_protocol(name: &str) -> std::result::Result<(), String> {
    if name == OPENXR.name {
        Ok(())
    } else {
        Err(format!(
            "an OpenXR runtime gives joints, not packets of the protocol `{name}`; leave out `protocol`"
        ))
    }
}

/// Reads the option `rate_hz`.
pub fn parse_rate(value: &str) -> std::result::Result<u32, String> {
    let rate = value.parse().ok().filter(|rate| RATES_HZ.contains(rate));
    rate.ok_or_else(|| {
        let (value, from, to) = (escape(value), RATES_HZ.start(), RATES_HZ.end());
        format!("`{value}` is not a rate, write {from} to {to} times per second: `rate_hz=90`")
    })
}

/// The positions of the tracked hands at one instant.
#[derive(Clone, Copy, Debug, Default)]
pub struct TrackedHands {
    /// Microseconds on the clock of the runtime.
    pub time_us: u64,
    /// The joints of each hand, by side; `None` while the hand is not tracked. A joint that is not tracked is missing.
    pub hands: [Option<JointPositions>; Side::COUNT],
}

/// Connector that starts a session with the runtime.
#[derive(Clone)]
struct OpenXrConnector {
    /// Source URI, for messages.
    name: String,
    /// `None` for the rate of the display.
    rate_hz: Option<u32>,
}

impl Connector for OpenXrConnector {
    const IS_LIVE: bool = true;
    const RECONNECTS: bool = true;
    const IS_DATAGRAM: bool = true;
    /// More than a line with 25 joints of both hands, whose numbers have 24 characters at most.
    const READ_BYTES: usize = 1 << 14;

    fn connect(&mut self) -> std::result::Result<Connection, ConnectError> {
        let session = HandSession::open(&self.name)?;
        let display_rate = session.display_rate_hz();
        let display_rate = display_rate.filter(|rate| RATES_HZ.contains(rate));
        let rate_hz = self.rate_hz.or(display_rate).unwrap_or(DEFAULT_RATE_HZ);
        let endpoint = format!("{}, {rate_hz} times per second", session.runtime());
        Ok(Connection {
            bytes: Box::new(HandLines::new(session, rate_hz)),
            readiness: None,
            endpoint,
        })
    }
}

/// Reader of one line per read, at the rate of the source.
struct HandLines {
    session: HandSession,
    period: Duration,
    next: Instant,
    /// `true` if a hand was tracked before. Lines without a hand are sent only from then on.
    has_seen_hand: bool,
}

impl HandLines {
    fn new(session: HandSession, rate_hz: u32) -> Self {
        Self {
            session,
            period: Duration::from_secs(1) / rate_hz,
            next: Instant::now(),
            has_seen_hand: false,
        }
    }

    /// Waits for the next instant to locate the hands, for [`READ_TIMEOUT`] at most. Returns `true` if it has come.
    fn wait(&mut self) -> bool {
        let wait = self.next.saturating_duration_since(Instant::now());
        thread::sleep(wait.min(READ_TIMEOUT));
        if wait > READ_TIMEOUT {
            return false;
        }
        // A thread that was held up does not catch up with instants that have passed.
        self.next = (self.next + self.period).max(Instant::now());
        true
    }
}

impl ByteStream for HandLines {
    /// Returns `true`: a read waits for the next instant, and for the runtime.
    fn may_block(&self) -> bool {
        true
    }
}

impl Read for HandLines {
    fn read(&mut self, buffer: &mut [u8]) -> Result<usize> {
        if !self.wait() {
            return Err(Error::from(ErrorKind::WouldBlock));
        }
        let asked_at = Instant::now();
        let tracked = self.session.locate()?;
        self.has_seen_hand |= tracked.hands.iter().any(Option::is_some);
        // A runtime that stood still answers with the hands of a time that has passed.
        if asked_at.elapsed() > MAX_ANSWER_TIME || !self.has_seen_hand {
            return Err(Error::from(ErrorKind::WouldBlock));
        }
        let line = line(&tracked);
        let Some(room) = buffer.get_mut(..line.len()) else {
            return Err(Error::other("the line of both hands is too long"));
        };
        room.copy_from_slice(line.as_bytes());
        Ok(line.len())
    }
}

/// Returns the line of JSON of hands, with its line end.
fn line(tracked: &TrackedHands) -> String {
    let sides = Side::ALL.iter();
    let hands = sides.filter_map(|&side| Some((side, tracked.hands[side.index()]?)));
    let hands: Vec<(Side, JointPositions)> = hands.collect();
    encode(&OPENXR, Some(tracked.time_us), &hands)
}

#[cfg(test)]
mod tests {
    use glam::DVec3;

    use super::*;
    use ademan_core::capture::Sample;
    use ademan_core::capture::protocol::{Packet, ProtocolOptions};
    use ademan_core::hand::Joint;

    fn decode(all: &[TrackedHands]) -> Vec<Packet> {
        let mut decoder = (OPENXR.decoder)(&ProtocolOptions::default());
        let mut packets = Vec::new();
        for tracked in all {
            decoder.push(line(tracked).as_bytes(), &mut |packet| packets.push(packet));
        }
        packets
    }

    fn tracked(time_us: u64, hand: Option<JointPositions>) -> TrackedHands {
        TrackedHands {
            time_us,
            hands: [None, hand],
        }
    }

    #[test]
    fn a_line_has_the_tracked_joints_and_none_of_a_hand_that_was_lost() {
        let mut positions = JointPositions::default();
        positions.set(Joint::Wrist, DVec3::new(0.1, 1.2, -0.3));
        // Number with the most digits.
        let odd = DVec3::splat(f64::from(-0.012_345_679_f32));
        positions.set(Joint::IndexTip, odd);
        let packets = decode(&[tracked(1_000, Some(positions)), tracked(2_000, None)]);
        let joints = packets.iter().map(|packet| {
            assert_eq!(packet.side, Some(Side::Right));
            match &packet.sample {
                Sample::Joints { positions: joints } => *joints,
                other => panic!("{other:?}"),
            }
        });
        let joints: Vec<JointPositions> = joints.collect();
        assert_eq!(joints, [positions, JointPositions::default()]);
    }

    #[test]
    fn the_longest_line_fits_the_buffer() {
        let mut positions = JointPositions::default();
        for &joint in Joint::ALL {
            positions.set(joint, DVec3::splat(-f64::from(f32::MIN_POSITIVE)));
        }
        let tracked = TrackedHands {
            time_us: u64::MAX,
            hands: [Some(positions); 2],
        };
        let length = line(&tracked).len();
        assert!(length <= OpenXrConnector::READ_BYTES, "{length}");
        assert!(length > 2 * 25 * 3 * 20, "{length}");
    }
}
