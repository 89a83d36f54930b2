//! A second, small process that lets go of keys when this one cannot.
//!
//! An X server keeps a key down for as long as nobody lets go of it, whatever became of the program that
//! pressed it; a Wayland compositor keeps buttons; and everybody, the kernel too, keeps the keys of a program that is
//! stopped. So a program that presses keys starts a guardian, which is told of every key before it goes down and
//! after it came up. When the program dies, in whatever way, or does not give a sign of life for 200 ms while a key is
//! down, the guardian lets go of what is down.
//!
//! On X11 it does so on a connection of its own. A compositor and the kernel take a release only from the keyboard that
//! has pressed, so there it has a second handle of the program's own connection or devices.

mod client;
mod releaser;
mod target;
mod stuck_keys;
mod watch;

use std::time::Duration;

use enigo::Direction;

use crate::device::KeyCode;

pub(super) use super::launch::HEARTBEAT_INTERVAL;
pub use super::launch::WatchdogSettings;
pub(super) use client::{WatchdogClient, WatchdogLost};
pub(super) use target::{DeviceHandle, ReleaseTarget};
pub use watch::run;

/// After how long without one the guardian lets go of everything: three signs may be late.
const HEARTBEAT_TIMEOUT: Duration = Duration::from_millis(200);

/// What a guardian is told.
#[derive(Clone, Copy, Debug, PartialEq)]
enum WatchdogMessage {
    /// This key goes down.
    KeyDown(KeyCode),
    /// It came up.
    KeyUp(KeyCode),
    /// An axis leaves its rest.
    AxesDeflected,
    /// All axes are back.
    AxesCentered,
    /// A character is about to be written, with keys that only whoever writes it knows.
    TextStarted,
    /// It is written.
    TextFinished,
    /// The program is alive.
    Heartbeat,
}

/// What a guardian says when it can let go of keys; anything else it says is why it cannot.
const READY: u8 = b'.';

impl WatchdogMessage {
    /// The length of a word, in bytes.
    const BYTES: usize = 3;

    fn of(key: KeyCode, direction: Direction) -> Self {
        match direction {
            Direction::Release => Self::KeyUp(key),
            _ => Self::KeyDown(key),
        }
    }

    fn to_bytes(self) -> [u8; Self::BYTES] {
        let (kind, code) = match self {
            Self::KeyDown(key) => (b'd', key.event_code()),
            Self::KeyUp(key) => (b'u', key.event_code()),
            Self::AxesDeflected => (b'x', 0),
            Self::AxesCentered => (b'c', 0),
            Self::TextStarted => (b'w', 0),
            Self::TextFinished => (b'n', 0),
            Self::Heartbeat => (b'a', 0),
        };
        let [high, low] = code.to_be_bytes();
        [kind, high, low]
    }

    fn from_bytes([kind, high, low]: [u8; Self::BYTES]) -> Option<Self> {
        let key = || KeyCode::from_event_code(u16::from_be_bytes([high, low]));
        match kind {
            b'd' => key().map(Self::KeyDown),
            b'u' => key().map(Self::KeyUp),
            b'x' => Some(Self::AxesDeflected),
            b'c' => Some(Self::AxesCentered),
            b'w' => Some(Self::TextStarted),
            b'n' => Some(Self::TextFinished),
            b'a' => Some(Self::Heartbeat),
            _ => None,
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_word_is_understood() {
        let keys = KeyCode::all()
            .flat_map(|key| [WatchdogMessage::KeyDown(key), WatchdogMessage::KeyUp(key)]);
        let others = [
            WatchdogMessage::AxesDeflected,
            WatchdogMessage::AxesCentered,
            WatchdogMessage::TextStarted,
            WatchdogMessage::TextFinished,
            WatchdogMessage::Heartbeat,
        ];
        for word in keys.chain(others) {
            assert_eq!(WatchdogMessage::from_bytes(word.to_bytes()), Some(word));
        }
        assert_eq!(WatchdogMessage::from_bytes([b'd', 255, 255]), None);
        assert_eq!(WatchdogMessage::from_bytes([0, 0, 30]), None);
    }
}
