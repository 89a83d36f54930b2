//! The spacenav protocol, versions 0 and 1: what is in its packets, and what a request is answered with.
//!
//! A packet is eight 32-bit numbers in the byte order of the machine (spacenavd, `src/proto.h` and
//! `src/proto_unix.c`).

use super::{Axes, BUTTONS};

/// The numbers of an event, a request or an answer.
pub(super) type Packet = [i32; 8];

/// The bytes of a packet.
pub(super) const LENGTH: usize = 32;

/// What every request and answer has in the upper half of its first number.
const TAG: i32 = 0x7faa_0000;

/// A change of version; the version is the last byte. As a sensitivity it would not be a number.
const VERSION: i32 = TAG | 0x5500;

/// The newest version that is spoken here.
const NEWEST: i32 = 1;

const MOTION: i32 = 0;
const PRESS: i32 = 1;
const RELEASE: i32 = 2;

/// Bits of the mask of events.
const MOTIONS: i32 = 0x01;
const BUTTON_EVENTS: i32 = 0x02;
const DEVICE_EVENTS: i32 = 0x04;

const DONE: i32 = 0;
const REFUSED: i32 = -1;

/// The bytes of a text that are in one packet.
const CHUNK: usize = 24;

/// Marks packets of a text after its first.
const CONTINUED: i32 = 0x1_0000;

/// What the device is called.
const NAME: &str = "Ademan";

/// A device of a kind that the protocol has no number for.
const UNKNOWN_TYPE: i32 = 0;

/// What a client and the server agreed on.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct ClientSettings {
    version: i32,
    sensitivity: f32,
    mask: i32,
}

impl Default for ClientSettings {
    fn default() -> Self {
        Self {
            version: 0,
            sensitivity: 1.0,
            mask: MOTIONS | BUTTON_EVENTS,
        }
    }
}

impl ClientSettings {
    /// The bytes of what the client says next.
    pub fn length_heard(&self) -> usize {
        match self.version {
            0 => size_of::<i32>(),
            _ => LENGTH,
        }
    }

    /// Takes what a client of version 0 says: a sensitivity, or the wish for another version. Gives the
    /// answer, if there is one.
    pub fn hear(&mut self, word: i32) -> Option<i32> {
        if word & !0xff == VERSION {
            self.version = (word & 0xff).min(NEWEST);
            if self.version > 0 {
                self.mask |= DEVICE_EVENTS;
            }
            return Some(VERSION | self.version);
        }
        self.set_sensitivity(word);
        None
    }

    /// Does what a client of version 1 asks for; gives the answer, which may be several packets or none.
    pub fn answer(&mut self, request: Packet, path: &str) -> Vec<Packet> {
        let value = request[1];
        let answer = match request[0] & 0xffff {
            // The name of the client; nobody waits for an answer.
            0x1000 => return Vec::new(),
            0x1001 if self.set_sensitivity(value) => Some(value),
            0x1002 => Some(self.sensitivity.to_bits() as i32),
            0x1003 => {
                self.mask = value;
                Some(value)
            }
            0x1004 => Some(self.mask),
            0x2000 => return text(request[0], NAME),
            0x2001 => return text(request[0], path),
            0x2002 => Some(AXES),
            0x2003 => Some(BUTTONS as i32),
            // 0x2004 asks for USB ids, which there are none of.
            0x2005 => Some(UNKNOWN_TYPE),
            _ => None,
        };
        let mut packet = request;
        packet[7] = REFUSED;
        if let Some(value) = answer {
            packet[1] = value;
            packet[7] = DONE;
        }
        vec![packet]
    }

    /// Whether it was a number.
    fn set_sensitivity(&mut self, bits: i32) -> bool {
        let sensitivity = f32::from_bits(bits as u32);
        if sensitivity.is_finite() {
            self.sensitivity = sensitivity;
        }
        sensitivity.is_finite()
    }

    /// Whether the client wants to hear of motion.
    pub fn has_motion(&self) -> bool {
        self.mask & MOTIONS != 0
    }

    /// Whether the client wants to hear of buttons.
    pub fn has_buttons(&self) -> bool {
        self.mask & BUTTON_EVENTS != 0
    }

    /// The axes as this client wants them, and the time since the last motion in milliseconds.
    pub fn motion(&self, axes: Axes, period: i32) -> Packet {
        let [x, y, z, rx, ry, rz] = axes.map(|axis| (axis as f32 * self.sensitivity) as i32);
        [MOTION, x, y, z, rx, ry, rz, period]
    }
}

/// How many axes there are.
const AXES: i32 = super::AXES.len() as i32;

/// A button that goes down or comes up.
pub(super) fn button(number: usize, is_down: bool) -> Packet {
    let kind = if is_down { PRESS } else { RELEASE };
    [kind, number as i32, is_down.into(), 0, 0, 0, 0, 0]
}

/// A text as an answer: 24 bytes in a packet, and how many are left from there on.
fn text(kind: i32, text: &str) -> Vec<Packet> {
    let packet_of = |(place, chunk): (usize, &[u8])| {
        let mut bytes = [0; CHUNK];
        bytes[..chunk.len()].copy_from_slice(chunk);
        let mut packet = [0; 8];
        packet[0] = kind;
        for (number, bytes) in packet[1..].iter_mut().zip(bytes.as_chunks::<4>().0) {
            *number = i32::from_ne_bytes(*bytes);
        }
        let left = (text.len() - place * CHUNK) as i32;
        packet[7] = left | if place > 0 { CONTINUED } else { 0 };
        packet
    };
    text.as_bytes()
        .chunks(CHUNK)
        .enumerate()
        .map(packet_of)
        .collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    fn ask(terms: &mut ClientSettings, kind: i32, value: i32) -> Packet {
        let answer = terms.answer([TAG | kind, value, 0, 0, 0, 0, 0, 0], "");
        assert_eq!(answer[0][0], TAG | kind);
        answer[0]
    }

    #[test]
    fn a_handshake_settles_on_the_newest_version_that_both_speak() {
        for (asked, spoken, length) in [(0, 0, 4), (1, 1, 32), (2, 1, 32), (255, 1, 32)] {
            let mut terms = ClientSettings::default();
            assert_eq!(terms.hear(VERSION | asked), Some(VERSION | spoken));
            assert_eq!(terms.length_heard(), length);
        }
    }

    #[test]
    fn a_sensitivity_that_is_no_number_changes_nothing() {
        let mut terms = ClientSettings::default();
        assert_eq!(terms.hear(2.5_f32.to_bits() as i32), None);
        assert_eq!(terms.hear(f32::NAN.to_bits() as i32), None);
        let refused = ask(&mut terms, 0x1001, f32::INFINITY.to_bits() as i32);
        assert_eq!(refused[7], REFUSED);
        assert_eq!(
            terms.motion([2, -2, 350, 0, 0, 1], 9),
            [0, 5, -5, 875, 0, 0, 2, 9]
        );
    }

    #[test]
    fn a_sensitivity_of_any_size_makes_numbers_that_fit() {
        let terms = ClientSettings {
            sensitivity: f32::MAX,
            ..ClientSettings::default()
        };
        let packet = terms.motion([350, -350, 0, 0, 0, 0], 1);
        assert_eq!(packet[1..4], [i32::MAX, i32::MIN, 0]);
    }

    #[test]
    fn requests_are_answered_and_unknown_ones_refused() {
        let mut terms = ClientSettings::default();
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
        for (kind, value, answered) in table {
            let answer = ask(&mut terms, kind, value);
            assert_eq!((answer[1], answer[7]), (answered, DONE), "{kind:#x}");
        }
        for kind in [0x2004, 0x2006, 0x3000, 0x4000, 0] {
            assert_eq!(ask(&mut terms, kind, 0)[7], REFUSED, "{kind:#x}");
        }
        assert!(terms.answer([TAG | 0x1000; 8], "").is_empty());
    }

    #[test]
    fn a_long_text_is_told_in_parts() {
        let parts = text(5, "0123456789abcdefghijklmnopq");
        assert_eq!(parts.len(), 2);
        assert_eq!((parts[0][7], parts[1][7]), (27, 3 | CONTINUED));
        assert_eq!(parts[1][1].to_ne_bytes(), *b"opq\0");
    }
}
