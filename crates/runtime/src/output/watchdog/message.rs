//! Messages to the watchdog.

use crate::output::character_key::{CharacterKey, KeymapChange};
use ademan_core::device::KeyCode;
use ademan_core::device::pressed_keys::KeyDirection;

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
    /// A key is about to be added to the keymap, or has been removed from it.
    CharacterKey(CharacterKey, KeymapChange),
    /// The process is alive. The watchdog replies with [`WatchdogReply::Alive`] or [`WatchdogReply::Released`].
    Heartbeat,
    /// Asks if the watchdog is alive; it does not show that the process is. The reply is
    /// [`WatchdogReply::Probed`].
    Probe,
}

/// A reply of the watchdog, one byte.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum WatchdogReply {
    /// The reply to a heartbeat.
    Alive,
    /// The reply to the first heartbeat after the watchdog has released the keys of the process.
    Released,
    /// The reply to a probe.
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
    /// Length of an encoded message: a letter for the kind, the code of the key, and its keysym if it types a character,
    /// big-endian.
    pub const BYTES: usize = 7;

    /// Returns the message for a key event.
    pub fn from_key(key: KeyCode, direction: KeyDirection) -> Self {
        match direction {
            KeyDirection::Press => Self::KeyDown(key),
            KeyDirection::Release => Self::KeyUp(key),
        }
    }

    /// Encodes the message.
    pub fn to_bytes(self) -> [u8; Self::BYTES] {
        let (kind, code, keysym) = match self {
            Self::KeyDown(key) => (b'd', key.event_code(), 0),
            Self::KeyUp(key) => (b'u', key.event_code(), 0),
            Self::AxesDeflected => (b'x', 0, 0),
            Self::AxesCentered => (b'c', 0, 0),
            Self::CharacterKey(key, KeymapChange::Added) => (b'k', key.code.into(), key.keysym),
            Self::CharacterKey(key, KeymapChange::Removed) => (b'r', key.code.into(), key.keysym),
            Self::Heartbeat => (b'a', 0, 0),
            Self::Probe => (b'p', 0, 0),
        };
        let [high, low] = code.to_be_bytes();
        let [a, b, c, d] = keysym.to_be_bytes();
        [kind, high, low, a, b, c, d]
    }

    /// Decodes a message. Returns `None` for an unknown kind or key.
    pub fn from_bytes([kind, high, low, keysym @ ..]: [u8; Self::BYTES]) -> Option<Self> {
        let key = || KeyCode::from_event_code(u16::from_be_bytes([high, low]));
        let character_key = CharacterKey {
            code: low,
            keysym: u32::from_be_bytes(keysym),
        };
        match kind {
            b'd' => key().map(Self::KeyDown),
            b'u' => key().map(Self::KeyUp),
            b'x' => Some(Self::AxesDeflected),
            b'c' => Some(Self::AxesCentered),
            b'k' => Some(Self::CharacterKey(character_key, KeymapChange::Added)),
            b'r' => Some(Self::CharacterKey(character_key, KeymapChange::Removed)),
            b'a' => Some(Self::Heartbeat),
            b'p' => Some(Self::Probe),
            _ => None,
        }
    }
}

/// The watchdog has exited, or does not read.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct WatchdogLost;

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_message_is_decoded_as_it_was_encoded() {
        let down = KeyCode::all().map(WatchdogMessage::KeyDown);
        let up = KeyCode::all().map(WatchdogMessage::KeyUp);
        let key = CharacterKey {
            code: 250,
            keysym: 0x0110_ffff,
        };
        let others = [
            WatchdogMessage::CharacterKey(key, KeymapChange::Added),
            WatchdogMessage::CharacterKey(key, KeymapChange::Removed),
            WatchdogMessage::AxesDeflected,
            WatchdogMessage::AxesCentered,
            WatchdogMessage::Heartbeat,
            WatchdogMessage::Probe,
        ];
        for message in down.chain(up).chain(others) {
            let decoded = WatchdogMessage::from_bytes(message.to_bytes());
            assert_eq!(decoded, Some(message));
        }
        assert_eq!(
            WatchdogMessage::from_bytes([b'd', 255, 255, 0, 0, 0, 0]),
            None
        );
        assert_eq!(WatchdogMessage::from_bytes([0, 0, 30, 0, 0, 0, 0]), None);
    }
}
