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

mod guard;
mod hands;
mod means;
mod remnants;
mod watch;

use std::time::Duration;

use enigo::Direction;

use crate::device::KeyCode;

pub(super) use super::launch::BEAT;
pub use super::launch::Launch;
pub(super) use guard::{Guard, Lost};
pub(super) use means::{Device, Means};
pub use watch::watch;

/// After how long without one the guardian lets go of everything: three signs may be late.
const SILENCE: Duration = Duration::from_millis(200);

/// What a guardian is told.
#[derive(Clone, Copy, Debug, PartialEq)]
enum Word {
    /// This key goes down.
    Down(KeyCode),
    /// It came up.
    Up(KeyCode),
    /// An axis leaves its rest.
    Deflected,
    /// All axes are back.
    Centred,
    /// A character is about to be written, with keys that only whoever writes it knows.
    Writing,
    /// It is written.
    Written,
    /// The program is alive.
    Alive,
}

/// What a guardian says when it can let go of keys; anything else it says is why it cannot.
const READY: u8 = b'.';

impl Word {
    /// The length of a word, in bytes.
    const BYTES: usize = 3;

    fn of(key: KeyCode, direction: Direction) -> Self {
        match direction {
            Direction::Release => Self::Up(key),
            _ => Self::Down(key),
        }
    }

    fn to_bytes(self) -> [u8; Self::BYTES] {
        let (kind, code) = match self {
            Self::Down(key) => (b'd', key.event_code()),
            Self::Up(key) => (b'u', key.event_code()),
            Self::Deflected => (b'x', 0),
            Self::Centred => (b'c', 0),
            Self::Writing => (b'w', 0),
            Self::Written => (b'n', 0),
            Self::Alive => (b'a', 0),
        };
        let [high, low] = code.to_be_bytes();
        [kind, high, low]
    }

    fn from_bytes([kind, high, low]: [u8; Self::BYTES]) -> Option<Self> {
        let key = || KeyCode::from_event_code(u16::from_be_bytes([high, low]));
        match kind {
            b'd' => key().map(Self::Down),
            b'u' => key().map(Self::Up),
            b'x' => Some(Self::Deflected),
            b'c' => Some(Self::Centred),
            b'w' => Some(Self::Writing),
            b'n' => Some(Self::Written),
            b'a' => Some(Self::Alive),
            _ => None,
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_word_is_understood() {
        let keys = KeyCode::all().flat_map(|key| [Word::Down(key), Word::Up(key)]);
        let others = [
            Word::Deflected,
            Word::Centred,
            Word::Writing,
            Word::Written,
            Word::Alive,
        ];
        for word in keys.chain(others) {
            assert_eq!(Word::from_bytes(word.to_bytes()), Some(word));
        }
        assert_eq!(Word::from_bytes([b'd', 255, 255]), None);
        assert_eq!(Word::from_bytes([0, 0, 30]), None);
    }
}
