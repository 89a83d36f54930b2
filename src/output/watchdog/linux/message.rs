//! Messages to the watchdog.

use crate::device::KeyCode;
use crate::device::pressed_keys::KeyDirection;

/// The byte that the watchdog sends when it is ready. Any other data is the reason why it cannot work.
pub const READY: u8 = b'.';

/// A message to the watchdog.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum WatchdogMessage {
    /// A key is about to be pressed.
    KeyDown(KeyCode),
    /// A key has been released.
    KeyUp(KeyCode),
    /// The first axis is about to leave its center.
    AxesDeflected,
    /// All axes are centered.
    AxesCentered,
    /// The process is alive. The watchdog replies with [`WatchdogReply::Alive`] or [`WatchdogReply::Released`].
    Heartbeat,
    /// A question whether the watchdog is alive, which says nothing about the process. The reply is
    /// [`WatchdogReply::Probed`].
    Probe,
}

/// A reply of the watchdog, one byte.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum WatchdogReply {
    /// To a heartbeat.
    Alive,
    /// To the first heartbeat after the watchdog has released the keys of the process.
    Released,
    /// To a probe.
    Probed,
}

impl WatchdogReply {
    /// Encodes the reply.
    pub fn to_byte(self) -> u8 {
        match self {
            Self::Alive => b'a',
            Self::Released => b'r',
            Self::Probed => b'p',
        }
    }

    /// Decodes a reply. Returns `None` for an unknown one.
    pub fn from_byte(byte: u8) -> Option<Self> {
        let mut all = [Self::Alive, Self::Released, Self::Probed].into_iter();
        all.find(|reply| reply.to_byte() == byte)
    }
}

impl WatchdogMessage {
    /// Length of an encoded message: a letter for the kind and the event code of the key, big-endian.
    pub const BYTES: usize = 3;

    /// Returns the message for a key event.
    pub fn from_key(key: KeyCode, direction: KeyDirection) -> Self {
        match direction {
            KeyDirection::Press => Self::KeyDown(key),
            KeyDirection::Release => Self::KeyUp(key),
        }
    }

    /// Encodes the message.
    pub fn to_bytes(self) -> [u8; Self::BYTES] {
        let (kind, code) = match self {
            Self::KeyDown(key) => (b'd', key.event_code()),
            Self::KeyUp(key) => (b'u', key.event_code()),
            Self::AxesDeflected => (b'x', 0),
            Self::AxesCentered => (b'c', 0),
            Self::Heartbeat => (b'a', 0),
            Self::Probe => (b'p', 0),
        };
        let [high, low] = code.to_be_bytes();
        [kind, high, low]
    }

    /// Decodes a message. Returns `None` for an unknown kind or key.
    pub fn from_bytes([kind, high, low]: [u8; Self::BYTES]) -> Option<Self> {
        let key = || KeyCode::from_event_code(u16::from_be_bytes([high, low]));
        match kind {
            b'd' => key().map(Self::KeyDown),
            b'u' => key().map(Self::KeyUp),
            b'x' => Some(Self::AxesDeflected),
            b'c' => Some(Self::AxesCentered),
            b'a' => Some(Self::Heartbeat),
            b'p' => Some(Self::Probe),
            _ => None,
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_message_is_decoded_as_it_was_encoded() {
        let down = KeyCode::all().map(WatchdogMessage::KeyDown);
        let up = KeyCode::all().map(WatchdogMessage::KeyUp);
        let others = [
            WatchdogMessage::AxesDeflected,
            WatchdogMessage::AxesCentered,
            WatchdogMessage::Heartbeat,
            WatchdogMessage::Probe,
        ];
        for message in down.chain(up).chain(others) {
            let decoded = WatchdogMessage::from_bytes(message.to_bytes());
            assert_eq!(decoded, Some(message));
        }
        assert_eq!(WatchdogMessage::from_bytes([b'd', 255, 255]), None);
        assert_eq!(WatchdogMessage::from_bytes([0, 0, 30]), None);
    }
}
