//! What is down: the account that every output of keys keeps.

use arrayvec::ArrayVec;

use crate::device::KeyCode;

/// The keys that are down, in the order in which they were pressed.
///
/// Takes no memory from the heap, so that the loop may keep one.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct PressedKeys {
    // Every key is in it at most once, and there are fewer keys than places.
    keys: ArrayVec<KeyCode, { PressedKeys::CAPACITY }>,
}

impl PressedKeys {
    /// More codes than [`KeyCode`] knows.
    pub const CAPACITY: usize = 160;

    /// Notes that `key` goes down. `false`, and nothing noted, when it is down already.
    pub fn press(&mut self, key: KeyCode) -> bool {
        !self.contains(key) && self.keys.try_push(key).is_ok()
    }

    /// Notes that `key` comes up. `false` when it was not down.
    pub fn release(&mut self, key: KeyCode) -> bool {
        let Some(place) = self.keys.iter().position(|held| *held == key) else {
            return false;
        };
        self.keys.remove(place);
        true
    }

    /// Whether `key` is down.
    pub fn contains(&self, key: KeyCode) -> bool {
        self.keys.contains(&key)
    }

    /// How many keys are down.
    pub fn count(&self) -> usize {
        self.keys.len()
    }

    /// Whether nothing is down.
    pub fn is_empty(&self) -> bool {
        self.keys.is_empty()
    }

    /// The order in which to let go of everything: the last pressed first, modifiers at the end, so
    /// that no key is ever down without the modifiers that were meant with it.
    pub fn release_order(&self) -> impl Iterator<Item = KeyCode> + '_ {
        let of_kind = |modifier: bool| {
            let newest_first = self.keys.iter().rev().copied();
            newest_first.filter(move |key| key.is_modifier() == modifier)
        };
        of_kind(false).chain(of_kind(true))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn key(name: &str) -> KeyCode {
        name.parse().unwrap()
    }

    #[test]
    fn a_key_goes_down_once_and_comes_up_once() {
        let mut held = PressedKeys::default();
        assert!(held.press(key("Q")));
        assert!(!held.press(key("Q")));
        assert!(held.contains(key("Q")));
        assert!(held.release(key("Q")));
        assert!(!held.release(key("Q")));
        assert!(held.is_empty());
    }

    #[test]
    fn the_last_pressed_comes_up_first_and_modifiers_come_up_last() {
        let mut held = PressedKeys::default();
        for name in ["A", "ShiftLeft", "B", "AltRight", "C"] {
            held.press(key(name));
        }
        held.release(key("B"));
        let order: Vec<_> = held.release_order().map(KeyCode::name).collect();
        assert_eq!(order, ["C", "A", "AltRight", "ShiftLeft"]);
    }

    #[test]
    fn all_keys_there_are_can_be_down_at_once() {
        let mut held = PressedKeys::default();
        assert!(KeyCode::all().all(|key| held.press(key)));
        assert_eq!(held.release_order().count(), KeyCode::all().count());
    }
}
