//! The spacenav protocol, versions 0 and 1: packets, requests and replies.
//!
//! A packet is eight 32-bit numbers in the byte order of the machine (spacenavd, `src/proto.h` and
//! `src/proto_unix.c`).

use super::{AXES, Axes, BUTTON_COUNT};

/// An event, a request or a reply.
pub(super) type Packet = [i32; 8];

/// Length of a packet.
pub(super) const PACKET_BYTES: usize = 32;

/// Upper half of the first number of every request and reply.
const TAG: i32 = 0x7faa_0000;

/// Change of the protocol version; the version is the last byte. As a sensitivity it would be NaN.
const VERSION: i32 = TAG | 0x5500;

/// Newest supported version.
const MAX_VERSION: i32 = 1;

const MOTION: i32 = 0;
const PRESS: i32 = 1;
const RELEASE: i32 = 2;

/// Bits of the event mask.
const MOTION_EVENTS: i32 = 0x01;
const BUTTON_EVENTS: i32 = 0x02;
const DEVICE_EVENTS: i32 = 0x04;

const SUCCESS: i32 = 0;
const FAILURE: i32 = -1;

/// Bytes of a string per packet.
const STRING_BYTES: usize = 24;

/// Flag of the packets of a string after the first.
const CONTINUED: i32 = 0x1_0000;

/// The name of the device.
const NAME: &str = "Ademan";

/// The device type of devices that the protocol does not list.
const UNKNOWN_TYPE: i32 = 0;

/// The settings of a client.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct ClientSettings {
    version: i32,
    sensitivity: f32,
    event_mask: i32,
}

impl Default for ClientSettings {
    fn default() -> Self {
        Self {
            version: 0,
            sensitivity: 1.0,
            event_mask: MOTION_EVENTS | BUTTON_EVENTS,
        }
    }
}

impl ClientSettings {
    /// Returns the length of the next request.
    pub fn request_bytes(&self) -> usize {
        match self.version {
            0 => size_of::<i32>(),
            _ => PACKET_BYTES,
        }
    }

    /// Handles a request of version 0, which is a sensitivity or a change of the version. Returns the reply, if any.
    pub fn reply_to_number(&mut self, number: i32) -> Option<i32> {
        if number & !0xff == VERSION {
            self.version = (number & 0xff).min(MAX_VERSION);
            if self.version > 0 {
                self.event_mask |= DEVICE_EVENTS;
            }
            return Some(VERSION | self.version);
        }
        self.set_sensitivity(number);
        None
    }

    /// Handles a request of version 1. Returns the reply, which may be several packets or none. `path` is the path
    /// of the socket.
    pub fn reply_to_packet(&mut self, request: Packet, path: &str) -> Vec<Packet> {
        let value = request[1];
        let reply = match request[0] & 0xffff {
            // The name of the client has no reply.
            0x1000 => return Vec::new(),
            0x1001 if self.set_sensitivity(value) => Some(value),
            0x1002 => Some(self.sensitivity.to_bits() as i32),
            0x1003 => {
                self.event_mask = value;
                Some(value)
            }
            0x1004 => Some(self.event_mask),
            0x2000 => return string_packets(request[0], NAME),
            0x2001 => return string_packets(request[0], path),
            0x2002 => Some(AXES.len() as i32),
            0x2003 => Some(BUTTON_COUNT as i32),
            // 0x2004 requests USB ids, which the device does not have.
            0x2005 => Some(UNKNOWN_TYPE),
            _ => None,
        };
        let mut packet = request;
        packet[7] = FAILURE;
        if let Some(answer) = reply {
            packet[1] = answer;
            packet[7] = SUCCESS;
        }
        vec![packet]
    }

    /// Sets the sensitivity from the bits of an `f32`. Returns `false` if it is not finite.
    fn set_sensitivity(&mut self, bits: i32) -> bool {
        let sensitivity = f32::from_bits(bits as u32);
        if sensitivity.is_finite() {
            self.sensitivity = sensitivity;
        }
        sensitivity.is_finite()
    }

    /// Returns `true` if the client receives motion events.
    pub fn wants_motion(&self) -> bool {
        self.event_mask & MOTION_EVENTS != 0
    }

    /// Returns `true` if the client receives button events.
    pub fn wants_buttons(&self) -> bool {
        self.event_mask & BUTTON_EVENTS != 0
    }

    /// Returns a motion event at the sensitivity of the client; the period is the time since the last motion.
    pub fn motion_packet(&self, axes: Axes, period_ms: i32) -> Packet {
        let [x, y, z, rx, ry, rz] = axes.map(|axis| (axis as f32 * self.sensitivity) as i32);
        [MOTION, x, y, z, rx, ry, rz, period_ms]
    }
}

/// Returns a button event.
pub(super) fn button_packet(number: usize, is_pressed: bool) -> Packet {
    let kind = if is_pressed { PRESS } else { RELEASE };
    [kind, number as i32, is_pressed.into(), 0, 0, 0, 0, 0]
}

/// Returns a string as packets of 24 bytes each; the last number has the count of remaining bytes.
fn string_packets(kind: i32, text: &str) -> Vec<Packet> {
    let packet = |(index, chunk): (usize, &[u8])| {
        let mut bytes = [0; STRING_BYTES];
        bytes[..chunk.len()].copy_from_slice(chunk);
        let mut packet = [0; 8];
        packet[0] = kind;
        for (number, word) in packet[1..].iter_mut().zip(bytes.as_chunks::<4>().0) {
            *number = i32::from_ne_bytes(*word);
        }
        let remaining = (text.len() - index * STRING_BYTES) as i32;
        packet[7] = remaining | if index > 0 { CONTINUED } else { 0 };
        packet
    };
    text.as_bytes()
        .chunks(STRING_BYTES)
        .enumerate()
        .map(packet)
        .collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    fn request(settings: &mut ClientSettings, kind: i32, value: i32) -> Packet {
        let reply = settings.reply_to_packet([TAG | kind, value, 0, 0, 0, 0, 0, 0], "");
        assert_eq!(reply[0][0], TAG | kind);
        reply[0]
    }

    #[test]
    fn both_sides_use_the_newest_version_that_both_support() {
        for (requested, agreed, length) in [(0, 0, 4), (1, 1, 32), (2, 1, 32), (255, 1, 32)] {
            let mut settings = ClientSettings::default();
            assert_eq!(
                settings.reply_to_number(VERSION | requested),
                Some(VERSION | agreed)
            );
            assert_eq!(settings.request_bytes(), length);
        }
    }

    #[test]
    fn a_sensitivity_that_is_not_finite_is_rejected() {
        let mut settings = ClientSettings::default();
        assert_eq!(settings.reply_to_number(2.5_f32.to_bits() as i32), None);
        assert_eq!(settings.reply_to_number(f32::NAN.to_bits() as i32), None);
        let rejected = request(&mut settings, 0x1001, f32::INFINITY.to_bits() as i32);
        assert_eq!(rejected[7], FAILURE);
        assert_eq!(
            settings.motion_packet([2, -2, 350, 0, 0, 1], 9),
            [0, 5, -5, 875, 0, 0, 2, 9]
        );
    }

    #[test]
    fn a_large_sensitivity_saturates() {
        let settings = ClientSettings {
            sensitivity: f32::MAX,
            ..ClientSettings::default()
        };
        let packet = settings.motion_packet([350, -350, 0, 0, 0, 0], 1);
        assert_eq!(packet[1..4], [i32::MAX, i32::MIN, 0]);
    }

    #[test]
    fn requests_are_answered_and_unknown_ones_rejected() {
        let mut settings = ClientSettings::default();
        let half = 0.5_f32.to_bits() as i32;
        let table = [
            (0x1002, 0, 1.0_f32.to_bits() as i32),
            (0x1001, half, half),
            (0x1002, 0, half),
            (0x1004, 0, 0x03),
            (0x1003, 0x02, 0x02),
            (0x1004, 0, 0x02),
            (0x2002, 0, 6),
            (0x2003, 0, 4),
            (0x2005, 0, 0),
        ];
        for (kind, value, expected) in table {
            let reply = request(&mut settings, kind, value);
            assert_eq!((reply[1], reply[7]), (expected, SUCCESS), "{kind:#x}");
        }
        for kind in [0x2004, 0x2006, 0x3000, 0x4000, 0] {
            assert_eq!(request(&mut settings, kind, 0)[7], FAILURE, "{kind:#x}");
        }
        assert!(settings.reply_to_packet([TAG | 0x1000; 8], "").is_empty());
    }

    #[test]
    fn a_long_string_is_sent_in_several_packets() {
        let packets = string_packets(5, "0123456789abcdefghijklmnopq");
        assert_eq!(packets.len(), 2);
        assert_eq!((packets[0][7], packets[1][7]), (27, 3 | CONTINUED));
        assert_eq!(packets[1][1].to_ne_bytes(), *b"opq\0");
    }
}
